//! Points between solved points: each halving of the gaps starts from a polynomial through what is solved.

/// Solved points that a start is interpolated from; the error goes with this power of the gap.
const STENCIL: usize = 8;
/// Gaps that the widest lattice leaves on a line.
const COARSEST: usize = 4;

/// A point halfway between two known ones, and the known ones around it with their weights in the polynomial through them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Midpoint {
    pub(crate) at: usize,
    pub(crate) known: Vec<(usize, f64)>,
    /// The nearest known ones before and behind.
    pub(crate) beside: [usize; 2],
}

/// The places on a line of `length` points that are solved first: both ends, some between, and `anchor`.
pub(crate) fn lattice(length: usize, anchor: usize) -> Vec<usize> {
    let last = length.saturating_sub(1);
    let stride = last.div_ceil(COARSEST).next_power_of_two();
    let mut places: Vec<usize> = (0..length).step_by(stride).chain([anchor, last]).collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// The points of a line in the order in which they follow from the known ones: all of a level depend on earlier levels only.
pub(crate) fn levels(length: usize, known: &[usize]) -> Vec<Vec<Midpoint>> {
    let mut known = known.to_vec();
    let mut levels = Vec::new();
    while known.len() < length {
        let gaps = known.windows(2).enumerate().filter(|(_, gap)| gap[1] - gap[0] > 1);
        let level: Vec<Midpoint> = gaps.map(|(k, gap)| midpoint(&known, k, [gap[0], gap[1]])).collect();
        known.extend(level.iter().map(|point| point.at));
        known.sort_unstable();
        levels.push(level);
    }
    levels
}

/// The point between `known[k]` and `known[k + 1]`.
fn midpoint(known: &[usize], k: usize, beside: [usize; 2]) -> Midpoint {
    let at = (beside[0] + beside[1]) / 2;
    let count = STENCIL.min(known.len());
    let first = (k + 1).saturating_sub(STENCIL / 2).min(known.len() - count);
    let stencil = &known[first..first + count];
    Midpoint { at, known: stencil.iter().map(|&place| (place, weight(stencil, place, at))).collect(), beside }
}

/// The coefficient of the highest power in the polynomial through some places and their values.
pub(crate) fn divided_difference(places: &[usize], value: impl Fn(usize) -> f64) -> f64 {
    let term = |k: usize| {
        let others = places.iter().filter(|other| **other != places[k]);
        value(k) / others.map(|&other| places[k] as f64 - other as f64).product::<f64>()
    };
    (0..places.len()).map(term).sum()
}

/// Lagrange's weight of one place among others, for a value at `at`.
fn weight(places: &[usize], place: usize, at: usize) -> f64 {
    let others = places.iter().filter(|other| **other != place);
    others.map(|&other| (at as f64 - other as f64) / (place as f64 - other as f64)).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_of_a_line_follows_once() {
        for length in [1, 2, 3, 5, 31, 61, 501, 1000] {
            for anchor in [0, length / 2, length - 1] {
                let start = lattice(length, anchor);
                assert!(start.len() <= 7 && start.contains(&anchor) && start.contains(&(length - 1)));
                let mut seen = start.clone();
                for level in levels(length, &start) {
                    assert!(level.iter().all(|point| point.known.iter().all(|(place, _)| seen.contains(place))));
                    seen.extend(level.iter().map(|point| point.at));
                }
                seen.sort_unstable();
                assert_eq!(seen, (0..length).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn polynomials_of_the_fifth_degree_are_met() {
        let f = |x: usize| (x as f64 / 40.0 - 1.0).powi(5) + x as f64;
        for level in levels(100, &lattice(100, 47)).iter().skip(1) {
            for point in level {
                let found: f64 = point.known.iter().map(|(place, weight)| weight * f(*place)).sum();
                assert!((found - f(point.at)).abs() < 1e-9, "{point:?}");
            }
        }
    }
}
