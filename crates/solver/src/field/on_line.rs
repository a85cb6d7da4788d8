//! Lines whose points are given by the targets of line and lane: computed and tested at once, in the order in which a field keeps
//! their numbers.

use flank_expr::{Expr, LaneEvaluator, LaneTape, Tape, TapeError, Varies};

use super::plain::{PlainRoot, are_plain, definitions};
use crate::given::Given;
use crate::lanes::{CLEAR, Lanes};
use crate::solution::Range;
use crate::step::{Linear, Wanted};
use crate::system::System;

/// Lays out [`PlainRoot`] of points whose unknowns are all given; a plain root has a clear determinant of the sign that it has around
/// there.
///
/// Inputs are the unknowns (without effect, as all are given), two parameters, of which the first one is that of the line and the
/// second one that of the lane, the width, the lower and the upper end of each range, and the sign of the determinant.
///
/// # Errors
/// If something depends on a variable that is neither an unknown nor a parameter.
pub(crate) fn laid_out<'g>(
    wanted: &Wanted<'_, 'g>,
    given: &[Given<'g>],
    linear: &Linear<'g>,
    [unknowns, parameters]: [&[Expr<'g>]; 2],
) -> Result<LaneTape, TapeError> {
    let side = unknowns[0].graph().variable("side of the fold");
    let determinant = linear.scaled_determinant();
    let root = PlainRoot::new(wanted, unknowns, determinant, CLEAR - determinant * side);
    let [lows, highs] = &root.ends;
    let inputs = [unknowns, parameters, &linear.widths, lows, highs, &[side]].concat();
    let tape = Tape::with_definitions(&root.outputs, &inputs, &definitions(given, unknowns))?;
    let mut varies = vec![Varies::Freely; unknowns.len()];
    varies.extend([Varies::ByRun, Varies::ByLane]);
    varies.extend(vec![Varies::Seldom; 3 * unknowns.len()]);
    varies.push(Varies::ByLane);
    Ok(LaneTape::with_inputs(&tape, &varies).writing(root.written()))
}

/// What computes such lines.
pub(crate) struct OnLine<'s> {
    evaluator: LaneEvaluator<'s>,
    size: usize,
    /// The sign of the determinants around there.
    side: f64,
}

impl<'s> OnLine<'s> {
    /// None if equations do not give all unknowns.
    pub(crate) fn new(system: &'s System, ranges: &[Range]) -> Option<OnLine<'s>> {
        let tape = system.lanes.given.as_ref()?.on_lines.as_ref()?;
        let mut evaluator = LaneEvaluator::new(tape, system.instructions());
        let size = ranges.len();
        for (k, range) in ranges.iter().enumerate() {
            for (kind, value) in [range.width(), range.low, range.high].into_iter().enumerate() {
                evaluator.set_uniform(size + 2 + kind * size + k, value);
            }
        }
        Some(OnLine { evaluator, size, side: 0.0 })
    }

    /// What follows from the first target of a line, if it is the same on all of the line, and the second ones are those of another.
    pub(crate) fn prepared(&mut self, line: &[[f64; 2]], other: &[[f64; 2]]) -> Option<Vec<f64>> {
        let first = line.first()?[0];
        let differs = |(target, other): (&[f64; 2], &[f64; 2])| (target[0] != first) | (target[1] != other[1]);
        if line.iter().zip(other).map(differs).fold(false, |any, differs| any | differs) {
            return None;
        }
        let mut prepared = Vec::new();
        self.evaluator.set_uniform(self.size, first);
        self.evaluator.prepare(&mut prepared);
        Some(prepared)
    }

    /// The second targets, for all lines that follow.
    pub(crate) fn set_second_targets(&mut self, targets: &Lanes) {
        *self.evaluator.input(self.size + 1) = *targets;
    }

    /// A determinant around there, for all lines that follow.
    pub(crate) fn set_determinant(&mut self, determinant: f64) {
        // not anew what depends on the lane alone
        if determinant.signum() != self.side {
            self.side = determinant.signum();
            self.evaluator.input(4 * self.size + 2).fill(self.side);
        }
    }

    /// The numbers of the first lanes of a line by what [`OnLine::prepared`] has found for it; whether all are plain roots.
    pub(crate) fn run(&mut self, prepared: &[f64], count: usize, out: &mut [Lanes]) -> bool {
        self.evaluator.set_prepared(prepared);
        self.evaluator.run_into(count, out);
        are_plain(self.evaluator.output(out.len()), count)
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
        let (field, _) = solve_settled(grid, None, &choice);
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
