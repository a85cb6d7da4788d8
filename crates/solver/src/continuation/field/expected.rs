//! Lines whose points are looked at where they are expected, and kept as they are if all are roots there.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::LANES;

use super::strip::{Strip, is_same_side};
use super::{Mark, Shape};
use crate::continuation::line::Midpoint;
use crate::newton::batch::Lanes;
use crate::newton::lines::Expected;

/// Where there are no more lanes, the others are left out.
const FEW: usize = 8;

impl Strip<'_> {
    /// Whether the points of a whole line are plain roots where whole lines let them be expected; only then the line counts as known.
    pub(super) fn is_as_expected(
        &mut self,
        midpoint: &Midpoint,
        expected: &mut Expected<'_>,
        targets: &[Lanes; 2],
    ) -> bool {
        let Shape { size, planes, .. } = self.shape;
        for k in 0..2 {
            *expected.input(size + k) = targets[k];
        }
        expected.instructions().dispatch(
            #[inline(always)]
            || {
                for k in 0..expected.open.len() {
                    let unknown = expected.open[k];
                    if self.width > FEW {
                        let sums = self.sums(midpoint.known(), unknown);
                        *expected.input(unknown) = sums;
                    } else {
                        let sums = self.sums::<FEW>(midpoint.known(), unknown);
                        expected.input(unknown)[..FEW].copy_from_slice(&sums);
                    }
                }
                let [before, behind] = midpoint.beside.map(|line| self.plane(line, size));
                let determinant = expected.determinant();
                for lane in 0..LANES {
                    let is_known = is_same_side(before[lane], behind[lane]);
                    determinant[lane] = if is_known { 0.5 * (before[lane] + behind[lane]) } else { f64::NAN };
                }
            },
        );
        let line = &mut self.values.as_chunks_mut::<LANES>().0[midpoint.at * planes..][..planes];
        let is_met = expected.run(self.width, line);
        if is_met {
            self.marks[midpoint.at][..self.width].fill(Mark::Plain);
        }
        is_met
    }

    /// Weighted sums of a number of the first points of some lines.
    #[inline(always)]
    pub(super) fn sums<const COUNT: usize>(&self, known: &[(usize, f64)], plane: usize) -> [f64; COUNT] {
        let mut sums = [0.0; COUNT];
        for (line, weight) in known {
            let values = self.plane(*line, plane);
            for lane in 0..COUNT {
                sums[lane] += weight * values[lane];
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use crate::continuation::choice::{Choice, Several};
    use crate::continuation::field::Field;
    use crate::continuation::follow::solve_settled;
    use crate::continuation::grid::{Grid, GridReport};
    use crate::equations::solution::{Outcome, Range};
    use crate::equations::system::System;
    use crate::roots::{MOST_BOXES, all_roots};

    /// A grid whose branch is the only one.
    fn solved(system: &System, ranges: &[Range], (targets, counts): (&[[f64; 2]], [usize; 2])) -> (Field, GridReport) {
        let roots = |ranges: &[Range], targets: &[f64; 2]| all_roots(system, ranges, targets, MOST_BOXES);
        let choice = Choice {
            roots: &roots,
            keep: None,
            several: Several::Refuse,
            tells_others: true,
            most_boxes: MOST_BOXES,
            reach: None,
            periodic: &[],
            planes: None,
        };
        solve_settled(Grid::new(system, ranges, (targets, counts), None), None, &choice)
    }

    /// x³ + x = u with u = a + b, beyond x's range, a condition and where an extra number ends: each point is what bisection says.
    #[test]
    fn lines_that_are_only_in_part_as_expected() {
        let graph = Graph::new();
        let [x, u, a, b] = ["x", "u", "a", "b"].map(|name| graph.variable(name));
        let residuals = [x * x * x + x - u, u - a - b];
        let system = System::new(&residuals, &[x, u], &[a, b]).expect("nothing is unbound");
        let system = system.with_conditions(&residuals, &[1.1 - x], &[(x + 0.8).sqrt()], &[x, u, a, b]);
        let system = system.expect("nothing is unbound");
        assert!(system.lanes.given.as_ref().is_some_and(|given| given.unknowns == [1] && given.expected.is_some()));
        let ranges = [Range { low: -0.9, high: 1.3 }, Range { low: -9.0, high: 9.0 }];
        let counts = [90, 130];
        let target = |k: usize| [(k / counts[1]) as f64 / 25.0 - 2.0, (k % counts[1]) as f64 / 65.0 - 0.5];
        let targets: Vec<[f64; 2]> = (0..counts[0] * counts[1]).map(target).collect();
        let (field, effort) = solved(&system, &ranges, (&targets, counts));
        for (k, [a, b]) in targets.iter().enumerate() {
            let expected = bisected(a + b);
            match field.outcome(k) {
                Some(Outcome::Solved) => {
                    assert!((-0.8..1.1).contains(&expected), "{expected} is no solution");
                    assert!((field.value(k, 0) - expected).abs() <= 1e-11 && field.residual(k) <= 1e-11);
                    assert!((field.extra(k, 0) - (expected + 0.8).sqrt()).abs() <= 1e-8, "{expected}");
                }
                Some(Outcome::CutAway(_)) => assert!((1.1..1.3).contains(&expected)),
                Some(Outcome::Singular) => assert!((-0.9..-0.8).contains(&expected)),
                _ => assert!(!(-0.9..1.3).contains(&expected), "{a} {b}: {expected} is not found"),
            }
        }
        assert!(field.solved() > 6000);
        // nearly half of the points are no solutions, and cost what it takes to say why
        assert!(effort.evaluations < 6 * targets.len() as u64, "{effort:?}");
    }

    fn bisected(sum: f64) -> f64 {
        let (mut low, mut high) = (-3.0, 3.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if middle * middle * middle + middle < sum { low = middle } else { high = middle }
        }
        low
    }

    /// x = 1 / (a + b) beyond its pole, its range and a condition, with some targets beside the lines: each point is what the
    /// closed form says.
    #[test]
    fn lines_that_fail_in_part() {
        let graph = Graph::new();
        let [x, u, a, b] = ["x", "u", "a", "b"].map(|name| graph.variable(name));
        let residuals = [x * (u + b) - 1.0, u - a];
        let system = System::new(&residuals, &[x, u], &[a, b]).expect("nothing is unbound");
        let system = system.with_conditions(&residuals, &[4.5 - x], &[x * x], &[x, u, a, b]);
        let system = system.expect("nothing is unbound");
        assert!(system.lanes.given.as_ref().is_some_and(|given| given.on_lines.is_some()));
        let ranges = [Range { low: 0.2, high: 5.0 }, Range { low: -3.0, high: 3.0 }];
        let counts = [60, 75];
        let target = |k: usize| {
            let (i, j) = (k / counts[1], k % counts[1]);
            let aside = if i == 41 && j == 50 || j == 7 && i == 30 { 1e-3 } else { 0.0 };
            [-1.0 + 3.0 * i as f64 / 59.0 + aside, j as f64 / 74.0 - aside]
        };
        let targets: Vec<[f64; 2]> = (0..counts[0] * counts[1]).map(target).collect();
        let (field, _) = solved(&system, &ranges, (&targets, counts));
        for (k, [a, b]) in targets.iter().enumerate() {
            let expected = 1.0 / (a + b);
            match field.outcome(k) {
                Some(Outcome::Solved) => {
                    assert!((0.2..4.5).contains(&expected));
                    let found: Vec<f64> = field.unknowns(k).chain([field.extra(k, 0)]).collect();
                    let pairs = found.iter().zip([expected, *a, expected * expected]);
                    pairs.for_each(|(found, expected)| {
                        assert!((found - expected).abs() <= 1e-11 * expected.abs().max(1.0))
                    });
                }
                Some(Outcome::CutAway(_)) => assert!((4.5..5.0).contains(&expected)),
                _ => assert!(!(0.2..5.0).contains(&expected), "{a} {b}: {expected} is not found"),
            }
        }
        assert!(field.solved() > 2000);
    }
}
