//! Points between solved points: each halving of the gaps starts from a polynomial through what is solved.

/// Solved points that a start is interpolated from at most; the error goes with this power of the gap.
pub(crate) const STENCIL: usize = 12;
/// Where the widest lattice has its places on a line, as shares of it: closer together towards the ends, as polynomials through
/// few points want it (the extrema of Chebyshev's polynomial of the sixth degree).
const COARSEST: [f64; 7] = [0.0, 0.067, 0.25, 0.5, 0.75, 0.933, 1.0];

/// A point halfway between two known ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Midpoint {
    pub(crate) at: usize,
    /// The nearest known ones before and behind.
    pub(crate) beside: [usize; 2],
    stencil: [(usize, f64); STENCIL],
    count: usize,
}

impl Midpoint {
    /// The known points around it with their weights in the polynomial through them.
    pub(crate) fn known(&self) -> &[(usize, f64)] {
        &self.stencil[..self.count]
    }

    /// How much of the way between those beside it leads to it.
    pub(crate) fn share(&self) -> f64 {
        let [before, behind] = self.beside;
        (self.at - before) as f64 / (behind - before) as f64
    }
}

/// The places on a line of `length` points that are solved first: both ends, some between, and `anchor`.
pub(crate) fn lattice(length: usize, anchor: usize) -> Vec<usize> {
    let last = length.saturating_sub(1);
    let places = COARSEST.iter().map(|share| (share * last as f64).round() as usize);
    let mut places: Vec<usize> = places.chain([anchor]).collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// Some places on a line, and as many between them that none is further from the next one than `widest`.
pub(crate) fn denser(known: &[usize], widest: usize) -> Vec<usize> {
    let mut places = known.to_vec();
    for gap in known.windows(2) {
        let parts = (gap[1] - gap[0]).div_ceil(widest);
        places.extend((1..parts).map(|part| gap[0] + (gap[1] - gap[0]) * part / parts));
    }
    places.sort_unstable();
    places
}

/// The points of a line between the known ones, in the order in which they follow from these: all of a level depend on earlier levels only.
/// `places` tells where on the line each of them stands.
pub(crate) fn levels(places: &[usize], known: &[usize]) -> Vec<Vec<Midpoint>> {
    let mut known = known.to_vec();
    let mut levels = Vec::new();
    loop {
        let gaps = known.windows(2).enumerate().filter(|(_, gap)| gap[1] - gap[0] > 1);
        let level: Vec<Midpoint> = gaps.map(|(k, gap)| midpoint(places, &known, k, [gap[0], gap[1]])).collect();
        if level.is_empty() {
            return levels;
        }
        known.extend(level.iter().map(|point| point.at));
        // two rows in order, one after the other
        known.sort();
        levels.push(level);
    }
}

/// The point between `known[k]` and `known[k + 1]`.
fn midpoint(places: &[usize], known: &[usize], k: usize, beside: [usize; 2]) -> Midpoint {
    let at = (beside[0] + beside[1]) / 2;
    let known = &known[stencil(k, known.len())];
    let (mut around, mut stencil) = ([0; STENCIL], [(0, 0.0); STENCIL]);
    let around = &mut around[..known.len()];
    for (place, point) in around.iter_mut().zip(known) {
        *place = places[*point];
    }
    for ((entry, point), weight) in stencil.iter_mut().zip(known).zip(weights(around, places[at])) {
        *entry = (*point, weight);
    }
    Midpoint { at, beside, stencil, count: known.len() }
}

/// Which of some known points in a row a point between number `k` and the next one is interpolated from.
pub(crate) fn stencil(k: usize, count: usize) -> std::ops::Range<usize> {
    let width = STENCIL.min(count);
    let first = (k + 1).saturating_sub(STENCIL / 2).min(count - width);
    first..first + width
}

/// The weights of values at some places, [`STENCIL`] at most, in the coefficient of the highest power of the polynomial through them.
pub(crate) fn divided_difference(places: &[usize]) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
    products(places, [1.0; STENCIL]).into_iter().take(places.len()).map(|product| 1.0 / product)
}

/// Lagrange's weights of some places for a value at `at`, which is none of them.
fn weights(places: &[usize], at: usize) -> impl Iterator<Item = f64> {
    let mut from = [1.0; STENCIL];
    for (from, place) in from.iter_mut().zip(places) {
        *from = at as f64 - *place as f64;
    }
    let all: f64 = from.iter().product();
    products(places, from).into_iter().take(places.len()).map(move |product| all / product)
}

/// What is given for each of some places, times the distances of all others from it.
fn products(places: &[usize], mut products: [f64; STENCIL]) -> [f64; STENCIL] {
    let mut to = [0.0; STENCIL];
    for (to, place) in to.iter_mut().zip(places) {
        *to = *place as f64;
    }
    for other in 0..places.len() {
        for k in 0..STENCIL {
            // of all places at once, which is vectors
            products[k] *= if k == other { 1.0 } else { to[k] - to[other] };
        }
    }
    products
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_of_a_line_follows_once() {
        for length in [1, 2, 3, 5, 31, 61, 501, 1000] {
            for anchor in [0, length / 2, length - 1] {
                let start = lattice(length, anchor);
                assert!(start.len() <= 8 && start.contains(&anchor) && start.contains(&(length - 1)));
                let mut seen = start.clone();
                for level in levels(&(0..length).collect::<Vec<_>>(), &start) {
                    assert!(level.iter().all(|point| point.known().iter().all(|(place, _)| seen.contains(place))));
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
        let evenly: Vec<usize> = (0..100).collect();
        let with_gaps: Vec<usize> = (0..100).map(|k| if k < 20 { k } else { k + 7 }).collect();
        for places in [evenly, with_gaps] {
            for point in levels(&places, &lattice(100, 47)).iter().skip(1).flatten() {
                let found: f64 = point.known().iter().map(|(place, weight)| weight * f(places[*place])).sum();
                assert!((found - f(places[point.at])).abs() < 1e-9, "{point:?}");
            }
        }
    }
}
