//! Tapes for whole lines of points: the numbers of a point in the order in which a field keeps them, with a verdict on whether it is a
//! plain root.

use flank_expr::{Expr, LaneTape, Tape, TapeError, Varies};

use crate::equations::closed_form::Given;
use crate::equations::step::{Linear, RootOutputs};
use crate::equations::tolerance::{CLEAR, PREDICTED, TOLERANCE};

/// Lays out [`PlainRoot`] of points with some unknowns in closed form, the others as expected, and so the determinant.
///
/// Inputs are the unknowns (those in closed form without effect), the parameters, the determinant, and the lower and the upper end
/// of each range.
///
/// # Errors
/// If something depends on a variable that is neither an unknown nor a parameter.
pub(crate) fn expected<'g>(
    wanted: &RootOutputs<'_, 'g>,
    given: &[Given<'g>],
    [unknowns, parameters]: [&[Expr<'g>]; 2],
) -> Result<LaneTape, TapeError> {
    let determinant = unknowns[0].graph().variable("determinant there");
    let root = PlainRoot::new(wanted, unknowns, determinant, determinant.abs() - f64::MAX);
    let [lows, highs] = &root.ends;
    let inputs = [unknowns, parameters, &[determinant], lows, highs].concat();
    let tape = Tape::of_numbers(&root.outputs, &inputs, &definitions(given, unknowns))?;
    let mut varies = vec![Varies::Freely; inputs.len()];
    varies[unknowns.len() + parameters.len() + 1..].fill(Varies::Seldom);
    Ok(LaneTape::with_inputs(&tape, &varies).writing(root.written()))
}

/// Lays out [`PlainRoot`] of points whose unknowns are all given; a plain root has a clear determinant of the sign that it has around
/// there.
///
/// Inputs are the unknowns (without effect, as all are given), two parameters, of which the first one is that of the line and the
/// second one that of the lane, the width, the lower and the upper end of each range, and the sign of the determinant.
///
/// # Errors
/// If something depends on a variable that is neither an unknown nor a parameter.
pub(crate) fn laid_out<'g>(
    wanted: &RootOutputs<'_, 'g>,
    given: &[Given<'g>],
    linear: &Linear<'g>,
    [unknowns, parameters]: [&[Expr<'g>]; 2],
) -> Result<LaneTape, TapeError> {
    let side = unknowns[0].graph().variable("side of the fold");
    let determinant = linear.scaled_determinant();
    let root = PlainRoot::new(wanted, unknowns, determinant, CLEAR - determinant * side);
    let [lows, highs] = &root.ends;
    let inputs = [unknowns, parameters, &linear.widths, lows, highs, &[side]].concat();
    let tape = Tape::of_numbers(&root.outputs, &inputs, &definitions(given, unknowns))?;
    let mut varies = vec![Varies::Freely; unknowns.len()];
    varies.extend([Varies::ByRun, Varies::ByLane]);
    varies.extend(vec![Varies::Seldom; 3 * unknowns.len()]);
    varies.push(Varies::ByLane);
    Ok(LaneTape::with_inputs(&tape, &varies).writing(root.written()))
}

/// The numbers of a point as functions of its unknowns.
struct PlainRoot<'g> {
    /// The numbers as a field keeps them, then one that is positive or no number where the point is no plain root: with residuals
    /// that need no step, unknowns in their ranges, all conditions met, and numbers for what else is wanted.
    outputs: Vec<Expr<'g>>,
    /// Variables for the lower ends of the ranges and the upper ones.
    ends: [Vec<Expr<'g>>; 2],
}

impl<'g> PlainRoot<'g> {
    /// Where `doubt` is positive or no number the point is no plain root either.
    fn new(
        wanted: &RootOutputs<'_, 'g>,
        unknowns: &[Expr<'g>],
        determinant: Expr<'g>,
        doubt: Expr<'g>,
    ) -> PlainRoot<'g> {
        let graph = determinant.graph();
        let [lows, highs] = ["low", "high"]
            .map(|name| (0..unknowns.len()).map(|k| graph.variable(format!("{name} {k}"))).collect::<Vec<Expr<'g>>>());
        let residual = most(wanted.residuals.iter().map(|residual| residual.abs())).unwrap_or(graph.constant(0.0));
        let outside = (0..unknowns.len()).map(|k| (lows[k] - unknowns[k]).max(unknowns[k] - highs[k]));
        let unmet = wanted.conditions.iter().map(|condition| f64::MIN_POSITIVE - *condition);
        let endless = wanted.vital().map(|sum| sum.abs() - f64::MAX);
        let off = [residual - PREDICTED * TOLERANCE, doubt];
        let verdict = most(outside.chain(unmet).chain(endless).chain(off)).expect("two are always there");
        let outputs = [unknowns, &[determinant, residual], wanted.extras, &[verdict]].concat();
        PlainRoot { outputs, ends: [lows, highs] }
    }

    /// How many of the outputs a field keeps.
    fn written(&self) -> usize {
        self.outputs.len() - 1
    }
}

/// Unknowns in closed form.
fn definitions<'g>(given: &[Given<'g>], unknowns: &[Expr<'g>]) -> Vec<(Expr<'g>, Expr<'g>)> {
    given.iter().map(|given| (unknowns[given.unknown], given.form)).collect()
}

/// The largest of some terms, by pairs and pairs of pairs: of a row of maxima each waits for the one before.
fn most<'g>(terms: impl Iterator<Item = Expr<'g>>) -> Option<Expr<'g>> {
    let mut terms: Vec<Expr<'g>> = terms.collect();
    while terms.len() > 1 {
        terms = terms.chunks(2).map(|pair| pair.iter().copied().reduce(|a, b| a.max(b)).unwrap_or(pair[0])).collect();
    }
    terms.pop()
}
