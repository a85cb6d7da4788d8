//! Coordinates of a sample that do not tell the points of a surface apart: where one is given, the other follows.

use flank_expr::Expr;
use nalgebra::DMatrix;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::{GeneratedSurface, Sample};
use crate::values::context::Context;

use super::sliding::{LOOKS, share, value};

/// Of the determinant of rows of length one, what rounding leaves where it is zero.
const NOTHING: f64 = 1e-9;

/// Reports a sample whose coordinates depend on each other wherever the unknowns lie in their ranges.
pub(super) fn check_independence<'g>(
    context: &mut Context<'g>,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
    span: Span,
) -> bool {
    let [first, second] = &sample.coordinates;
    if are_independent(surface, [first.value, second.value], context.values().to_vec()) {
        return true;
    }
    let message = format!(
        "`{}` and `{}` do not tell points of `{}` apart: where one is given, the other follows",
        first.name, second.name, surface.name
    );
    let help = "sample by two coordinates that change by themselves over the surface, such as `rho` and `z` on the flank of a cylindrical gear";
    context.report(Diagnostic::new(Code::SampleShape, span, message).help(help));
    false
}

/// Whether there is a place where constraints and coordinates fix the unknowns, as far as it can be looked at.
fn are_independent<'g>(surface: &GeneratedSurface<'g>, coordinates: [Expr<'g>; 2], mut values: Vec<f64>) -> bool {
    let made = &surface.surface;
    let (graph, size) = (coordinates[0].graph(), made.unknowns.len());
    let slopes =
        made.constraints.iter().chain(&coordinates).flat_map(|f| made.unknowns.iter().map(|p| f.derivative(*p)));
    let slopes: Vec<Expr<'g>> = slopes.collect();
    let widths: Vec<f64> = surface.unknowns.iter().map(|unknown| unknown.high - unknown.low).collect();
    let mut is_seen = false;
    for look in 0..LOOKS {
        for (j, unknown) in surface.unknowns.iter().enumerate() {
            *value(&mut values, unknown) = unknown.low + widths[j] * share(look, j);
        }
        let slopes = graph.evaluate(&slopes, &values);
        let mut rows = DMatrix::from_fn(size, size, |i, j| slopes[i * size + j] * widths[j]);
        // a motion that only slides is reported elsewhere
        if rows.row_iter().take(made.constraints.len()).any(|row| row.norm() == 0.0) {
            continue;
        }
        for mut row in rows.row_iter_mut().filter(|row| row.norm() > 0.0) {
            row /= row.norm();
        }
        let determinant = rows.determinant();
        if determinant.abs() > NOTHING {
            return true;
        }
        is_seen |= !determinant.is_nan();
    }
    !is_seen
}
