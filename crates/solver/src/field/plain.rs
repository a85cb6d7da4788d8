//! The numbers of a point in the order in which a field keeps them, with a verdict on whether it is a plain root.

use flank_expr::Expr;

use crate::given::Given;
use crate::lanes::{Lanes, PREDICTED};
use crate::newton::TOLERANCE;
use crate::step::Wanted;

/// The numbers of a point as functions of its unknowns.
pub(super) struct PlainRoot<'g> {
    /// The numbers as a field keeps them, then one that is positive or no number where the point is no plain root: with residuals
    /// that need no step, unknowns in their ranges, all conditions met, and numbers for what else is wanted.
    pub(super) outputs: Vec<Expr<'g>>,
    /// Variables for the lower ends of the ranges and the upper ones.
    pub(super) ends: [Vec<Expr<'g>>; 2],
}

impl<'g> PlainRoot<'g> {
    /// Where `doubt` is positive or no number the point is no plain root either.
    pub(super) fn new(
        wanted: &Wanted<'_, 'g>,
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
    pub(super) fn written(&self) -> usize {
        self.outputs.len() - 1
    }
}

/// Unknowns in closed form.
pub(super) fn definitions<'g>(given: &[Given<'g>], unknowns: &[Expr<'g>]) -> Vec<(Expr<'g>, Expr<'g>)> {
    given.iter().map(|given| (unknowns[given.unknown], given.form)).collect()
}

/// Whether the first points are plain roots by their verdicts.
#[inline]
pub(super) fn are_plain(verdicts: &Lanes, count: usize) -> bool {
    verdicts[..count].iter().fold(true, |all, verdict| all & (*verdict <= 0.0))
}

fn most<'g>(terms: impl Iterator<Item = Expr<'g>>) -> Option<Expr<'g>> {
    terms.reduce(|a, b| a.max(b))
}
