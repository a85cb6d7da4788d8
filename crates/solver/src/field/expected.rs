//! Lines whose points are looked at where they are expected, and kept as they are if all are roots there.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::{Expr, InstructionSet, LANES, LaneEvaluator, LaneTape, Tape, TapeError, Varies};

use super::plain::{PlainRoot, are_plain, definitions};
use super::strip::{Strip, is_same_side};
use super::{Mark, Shape};
use crate::given::Given;
use crate::lanes::Lanes;
use crate::line::Midpoint;
use crate::solution::Range;
use crate::step::Wanted;

/// Where there are no more lanes, the others are left out.
const FEW: usize = 8;

/// Lays out [`PlainRoot`] of points with some unknowns in closed form, the others as expected, and so the determinant.
///
/// Inputs are the unknowns (those in closed form without effect), the parameters, the determinant, and the lower and the upper end
/// of each range.
///
/// # Errors
/// If something depends on a variable that is neither an unknown nor a parameter.
pub(crate) fn expected<'g>(
    wanted: &Wanted<'_, 'g>,
    given: &[Given<'g>],
    [unknowns, parameters]: [&[Expr<'g>]; 2],
) -> Result<LaneTape, TapeError> {
    let determinant = unknowns[0].graph().variable("determinant there");
    let root = PlainRoot::new(wanted, unknowns, determinant, determinant.abs() - f64::MAX);
    let [lows, highs] = &root.ends;
    let inputs = [unknowns, parameters, &[determinant], lows, highs].concat();
    let tape = Tape::with_definitions(&root.outputs, &inputs, &definitions(given, unknowns))?;
    let mut varies = vec![Varies::Freely; inputs.len()];
    varies[unknowns.len() + parameters.len() + 1..].fill(Varies::Seldom);
    Ok(LaneTape::with_inputs(&tape, &varies).writing(root.written()))
}

/// What looks at such lines.
pub(crate) struct Expected<'s> {
    evaluator: LaneEvaluator<'s>,
    instructions: InstructionSet,
    /// Numbers of the unknowns that are not in closed form.
    open: Vec<usize>,
    determinant: usize,
}

impl<'s> Expected<'s> {
    /// `determinant` is the number of that input, the one after unknowns and parameters. `given` are the numbers of the unknowns in
    /// closed form.
    pub(crate) fn new(
        tape: &'s LaneTape,
        instructions: InstructionSet,
        ranges: &[Range],
        determinant: usize,
        given: &[usize],
    ) -> Expected<'s> {
        let mut evaluator = LaneEvaluator::new(tape, instructions);
        let size = ranges.len();
        for (k, range) in ranges.iter().enumerate() {
            evaluator.set_uniform(determinant + 1 + k, range.low);
            evaluator.set_uniform(determinant + 1 + size + k, range.high);
        }
        Expected { evaluator, instructions, open: (0..size).filter(|k| !given.contains(k)).collect(), determinant }
    }

    fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// What is expected of an unknown or, after the unknowns, a parameter.
    fn input(&mut self, k: usize) -> &mut Lanes {
        self.evaluator.input(k)
    }

    /// The determinants, no numbers where they may vanish.
    fn determinant(&mut self) -> &mut Lanes {
        self.evaluator.input(self.determinant)
    }

    /// The numbers of the first lanes; whether all are plain roots.
    fn run(&mut self, count: usize, out: &mut [Lanes]) -> bool {
        self.evaluator.run_into(count, out);
        are_plain(self.evaluator.output(out.len()), count)
    }
}

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
            self.marks[midpoint.at][..self.width].fill(Mark::Solved);
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

    use crate::anchor::{Choice, Several, solve_settled};
    use crate::grid::Grid;
    use crate::roots::{MOST_BOXES, all_roots};
    use crate::solution::{Outcome, Range};
    use crate::system::System;

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
        let roots = |ranges: &[Range], targets: &[f64; 2]| all_roots(&system, ranges, targets, MOST_BOXES);
        let choice = Choice {
            roots: &roots,
            keep: None,
            several: Several::Refuse,
            most_boxes: MOST_BOXES,
            reach: None,
            periodic: &[],
            planes: None,
        };
        let grid = Grid::new(&system, &ranges, (&targets, counts), None);
        let (field, effort) = solve_settled(grid, None, &choice);
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
}
