//! Whole numbers near a point, in the order of a quadratic form.

use crate::equations::solution::Range;

/// `q(x) = ½ (x − middle)ᵀ H (x − middle)` for whole numbers x within ranges.
#[derive(Clone, Debug)]
pub(crate) struct WholeNumbers {
    middle: Vec<f64>,
    /// R with `H = Rᵀ R`, upper triangle.
    root: Vec<Vec<f64>>,
}

/// Steps of a walk for each place that it may find.
const STEPS: usize = 16;

/// Numbers that are chosen one after the other.
struct Walk<'r> {
    level: f64,
    ranges: &'r [Range],
    most: usize,
    at: Vec<f64>,
    found: Vec<Place>,
    steps: usize,
}

/// A place and its q.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) at: Vec<f64>,
    pub(crate) q: f64,
}

impl WholeNumbers {
    /// `None` if H is not positive definite.
    pub(crate) fn new(middle: Vec<f64>, hessian: &[Vec<f64>]) -> Option<WholeNumbers> {
        let n = middle.len();
        let mut root = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in i..n {
                let known: f64 = (0..i).map(|k| root[k][i] * root[k][j]).sum();
                let rest = hessian[i][j] - known;
                root[i][j] = if i == j { rest.sqrt() } else { rest / root[i][i] };
            }
            // a comparison that fails for NaN, too
            if !(root[i][i] > 0.0 && root[i][i].is_finite()) {
                return None;
            }
        }
        Some(WholeNumbers { middle, root })
    }

    /// A place with a small q, one number after the other rounded; never more than half a step from the middle in each.
    pub(crate) fn near(&self, ranges: &[Range]) -> Place {
        let n = self.middle.len();
        let mut at = vec![0.0; n];
        let mut q = 0.0;
        for i in (0..n).rev() {
            let best = self.best(i, &at);
            at[i] = best.clamp(ranges[i].low, ranges[i].high).round();
            q += self.share(i, at[i] - best);
        }
        Place { at, q }
    }

    /// q of one step in each number while the others follow: half of what the deepest point between two steps has, times
    /// four.
    pub(crate) fn step(&self) -> f64 {
        (0..self.middle.len()).map(|i| self.share(i, 1.0)).sum()
    }

    /// All places with a q of at most `level`, in a settled order; `None` if they are more than `most`, or far more have to
    /// be looked at.
    pub(crate) fn within(&self, level: f64, ranges: &[Range], most: usize) -> Option<Vec<Place>> {
        let count = self.middle.len();
        let mut walk = Walk { level, ranges, most, at: vec![0.0; count], found: Vec::new(), steps: 0 };
        self.descend(count, 0.0, &mut walk).then_some(walk.found)
    }

    /// Chooses the numbers before `open`; whether there is still room.
    fn descend(&self, open: usize, q: f64, walk: &mut Walk<'_>) -> bool {
        let Some(i) = open.checked_sub(1) else {
            walk.found.push(Place { at: walk.at.clone(), q });
            return walk.found.len() <= walk.most;
        };
        let best = self.best(i, &walk.at);
        let reach = (2.0 * (walk.level - q).max(0.0)).sqrt() / self.root[i][i];
        let mut next = (best - reach).max(walk.ranges[i].low).ceil();
        let last = (best + reach).min(walk.ranges[i].high).floor();
        while next <= last {
            walk.at[i] = next;
            walk.steps += 1;
            if walk.steps > STEPS * walk.most || !self.descend(i, q + self.share(i, next - best), walk) {
                return false;
            }
            next += 1.0;
        }
        true
    }

    /// Where number i makes q least if the later ones are chosen.
    fn best(&self, i: usize, at: &[f64]) -> f64 {
        let later: f64 = (i + 1..at.len()).map(|j| self.root[i][j] * (at[j] - self.middle[j])).sum();
        self.middle[i] - later / self.root[i][i]
    }

    /// What a distance of number i from there adds to q.
    fn share(&self, i: usize, by: f64) -> f64 {
        0.5 * (self.root[i][i] * by).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_below_a_level_is_found_once() {
        // skewed: the axes of the ellipse lie nowhere near those of the numbers
        let hessian = [vec![2.0, 10.3], vec![10.3, 53.6]];
        let middle = vec![0.3, -1.2];
        let numbers = WholeNumbers::new(middle.clone(), &hessian).expect("positive definite");
        let ranges = [Range { low: -40.0, high: 40.0 }, Range { low: -8.0, high: 8.0 }];
        let q = |x: f64, y: f64| {
            let d = [x - middle[0], y - middle[1]];
            0.5 * (hessian[0][0] * d[0] * d[0] + 2.0 * hessian[0][1] * d[0] * d[1] + hessian[1][1] * d[1] * d[1])
        };
        for level in [0.0, 0.3, 2.0, 20.0] {
            let found = numbers.within(level, &ranges, 10_000).expect("few");
            let all = (-40..=40).flat_map(|x| (-8..=8).map(move |y| [f64::from(x), f64::from(y)]));
            let expected = all.filter(|at| q(at[0], at[1]) <= level).count();
            assert_eq!(found.len(), expected, "level {level}");
            assert!(found.iter().all(|place| (place.q - q(place.at[0], place.at[1])).abs() < 1e-12));
        }
        let near = numbers.near(&ranges);
        assert!(numbers.within(near.q, &ranges, 10_000).expect("few").contains(&near));
        assert_eq!(numbers.within(20.0, &ranges, 3), None);
        // so far out that a step of one is none
        let far = WholeNumbers::new(vec![1e17, 0.0], &hessian).expect("positive definite");
        let endless = [Range { low: f64::MIN, high: f64::MAX }; 2];
        assert_eq!(far.within(1e6, &endless, 100), None);
    }

    #[test]
    fn a_saddle_has_no_order() {
        assert!(WholeNumbers::new(vec![0.0; 2], &[vec![1.0, 2.0], vec![2.0, 1.0]]).is_none());
        assert!(WholeNumbers::new(vec![0.0], &[vec![f64::NAN]]).is_none());
    }

    #[test]
    fn what_lies_beyond_the_ranges_is_left_out() {
        let numbers = WholeNumbers::new(vec![7.6], &[vec![2.0]]).expect("positive");
        let ranges = [Range { low: -3.0, high: 7.0 }];
        let near = numbers.near(&ranges);
        assert_eq!(near.at, [7.0]);
        assert!((near.q - 0.36).abs() < 1e-12 && (numbers.step() - 1.0).abs() < 1e-12);
        assert_eq!(numbers.within(0.3, &ranges, 10), Some(Vec::new()));
    }
}
