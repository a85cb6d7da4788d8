//! Coordinates of a sample that do not tell the points of a surface apart: where one is given, the other follows.

use flank_expr::Expr;
use nalgebra::DMatrix;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::{GeneratedSurface, Parameter, Sample};
use crate::values::context::Context;

use super::sliding::{LOOKS, share, value};

/// Of the determinant of rows of length one, what rounding leaves where it is zero.
const NOTHING: f64 = 1e-9;

/// Reports a sample whose coordinates depend on each other wherever the unknowns lie in their ranges. `parameters` are those of the job, its
/// machines and its tools: each after those that its value depends on.
pub(super) fn check_independence<'g>(
    context: &mut Context<'g>,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
    (span, parameters): (Span, &[&Parameter<'g>]),
) -> bool {
    let [first, second] = &sample.coordinates;
    let coordinates = [first.value, second.value];
    if are_independent(surface, coordinates, context.values().to_vec()) {
        return true;
    }
    if let Some(Parameter { name, written, .. }) = zero_count(context, (surface, coordinates), parameters) {
        let message = format!(
            "`{name}` is 0: nothing is left of `{}` of which `{}` and `{}` tell points apart, as they do where it is 1",
            surface.name, first.name, second.name
        );
        // once, however many surfaces are sampled
        let help = format!("give `{name}` another value; a range such as `count in 1 .. 1000` says what it may be");
        context.report(Diagnostic::new(Code::SampleShape, *written, message).help(help));
        return false;
    }
    let message = format!(
        "`{}` and `{}` do not tell points of `{}` apart: where one is given, the other follows",
        first.name, second.name, surface.name
    );
    let help = "sample by two coordinates that change by themselves over the surface, such as `rho` and `z` on the flank of a cylindrical gear";
    context.report(Diagnostic::new(Code::SampleShape, span, message).help(help));
    false
}

/// The count that is zero and would leave coordinates independent if it were one.
fn zero_count<'p, 'g>(
    context: &Context<'g>,
    (surface, coordinates): (&GeneratedSurface<'g>, [Expr<'g>; 2]),
    parameters: &[&'p Parameter<'g>],
) -> Option<&'p Parameter<'g>> {
    let place = |of: &Parameter<'g>| of.variable.as_variable().expect("parameters are variables").index();
    let would_do = |zero: &&&Parameter<'g>| {
        let mut values = context.values().to_vec();
        for of in parameters {
            let is_zero = of.variable == zero.variable;
            values[place(of)] = if is_zero { 1.0 } else { context.graph.evaluate(&[of.definition], &values)[0] };
        }
        are_independent(surface, coordinates, values)
    };
    parameters.iter().filter(|of| of.is_count && of.value == 0.0).find(would_do).copied()
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
