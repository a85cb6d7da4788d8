//! Lines whose points are given by the targets of line and lane: computed and tested at once, in the order in which a field keeps
//! their numbers.

use flank_expr::{Expr, LaneEvaluator, LaneTape, Tape, TapeError, Varies};

use crate::given::Given;
use crate::lanes::{CLEAR, Lanes, PREDICTED};
use crate::newton::TOLERANCE;
use crate::solution::Range;
use crate::step::{Linear, Wanted};
use crate::system::System;

/// Lays out the numbers of a point as a field keeps them, then one that is positive or no number where the point is no plain
/// root: with residuals, unknowns in their ranges, all conditions met, numbers for what else is wanted, and a clear determinant
/// of the sign that it has around there.
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
    let graph = unknowns[0].graph();
    let [lows, highs] = ["low", "high"]
        .map(|name| (0..unknowns.len()).map(|k| graph.variable(format!("{name} {k}"))).collect::<Vec<Expr<'g>>>());
    let side = graph.variable("side");
    let determinant = linear.scaled_determinant();
    let residual = most(wanted.residuals.iter().map(|residual| residual.abs())).unwrap_or(graph.constant(0.0));

    let [ends, conditions] = [unknowns.len(), wanted.conditions.len()];
    let outside = (0..ends).map(|k| (lows[k] - unknowns[k]).max(unknowns[k] - highs[k]));
    let unmet = (0..conditions).map(|k| f64::MIN_POSITIVE - wanted.conditions[k]);
    let endless = wanted.vital().map(|sum| sum.abs() - f64::MAX);
    let off = [residual - PREDICTED * TOLERANCE, CLEAR - determinant * side];
    let verdict = most(outside.chain(unmet).chain(endless).chain(off)).expect("two are always there");

    let numbers = [unknowns, &[determinant, residual], wanted.extras].concat();
    let outputs = [numbers.as_slice(), &[verdict]].concat();
    let inputs = [unknowns, parameters, &linear.widths, &lows, &highs, &[side]].concat();
    let definitions: Vec<_> = given.iter().map(|given| (unknowns[given.unknown], given.form)).collect();
    let tape = Tape::with_definitions(&outputs, &inputs, &definitions)?;
    let mut varies = vec![Varies::Freely; unknowns.len()];
    varies.extend([Varies::ByRun, Varies::ByLane]);
    varies.extend(vec![Varies::Seldom; 3 * unknowns.len()]);
    varies.push(Varies::ByLane);
    Ok(LaneTape::with_inputs(&tape, &varies).writing(numbers.len()))
}

fn most<'g>(terms: impl Iterator<Item = Expr<'g>>) -> Option<Expr<'g>> {
    terms.reduce(|a, b| a.max(b))
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

    /// Adds what depends on the first target alone.
    pub(crate) fn prepare(&mut self, target: f64, prepared: &mut Vec<f64>) {
        self.evaluator.set_uniform(self.size, target);
        self.evaluator.prepare(prepared);
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

    /// The numbers of the first lanes of a line by what [`OnLine::prepare`] has found for it; whether all are plain roots.
    pub(crate) fn run(&mut self, prepared: &[f64], count: usize, out: &mut [Lanes]) -> bool {
        self.evaluator.set_prepared(prepared);
        self.evaluator.run_into(count, out);
        let verdicts = self.evaluator.output(out.len());
        verdicts[..count].iter().fold(true, |all, verdict| all & (*verdict <= 0.0))
    }
}
