//! On which side of a surface the steel lies: one answer for all of it.

use flank_expr::Expr;
use flank_expr::geometry::Vector3;

use crate::codes::Code;
use crate::context::Context;
use crate::diagnostic::Diagnostic;
use crate::model::Bounded;
use crate::source::Span;

/// Points in each direction at which the side is looked at.
const LOOKS: usize = 5;

/// Whether `raw`, square to a surface, points against `outward`: the same answer everywhere in the ranges, or an error.
pub(crate) fn is_flipped<'g>(
    context: &mut Context<'g>,
    span: Span,
    unknowns: &[Bounded<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Option<bool> {
    let parts = [raw.dot(outward), raw.norm(), outward.norm()];
    let (mut along, mut against) = (0, 0);
    for mut look in 0..LOOKS.pow(unknowns.len() as u32) {
        let mut values = context.values().to_vec();
        for unknown in unknowns {
            let share = ((look % LOOKS) as f64 + 0.5) / LOOKS as f64;
            look /= LOOKS;
            values[unknown.variable.as_variable()?.index()] = unknown.low + (unknown.high - unknown.low) * share;
        }
        let found = context.graph.evaluate(&parts, &values);
        let cosine = found[0] / (found[1] * found[2]);
        along += usize::from(cosine > 1e-9);
        against += usize::from(cosine < -1e-9);
    }
    let message = match (along, against) {
        (0, 0) if has_unknown_values(context, unknowns, &parts) => return Some(false),
        (0, 0) => "this side is neither in front of the surface nor behind it",
        (_, 0) => return Some(false),
        (0, _) => return Some(true),
        _ => "this side is in front of some points of the surface and behind others",
    };
    let help = "name a direction that points into the steel everywhere (it may depend on the parameters): \
                `body towards [0, 0, -1]`";
    context.report(Diagnostic::new(Code::SteelSide, span, message).help(help));
    None
}

/// True if ranges or parameters have no values yet: a definition looked at by itself.
fn has_unknown_values<'g>(context: &Context<'g>, unknowns: &[Bounded<'g>], parts: &[Expr<'g>]) -> bool {
    let is_open = |unknown: &Bounded<'g>| unknown.low.is_nan() || unknown.high.is_nan();
    let own: Vec<_> = unknowns.iter().map(|unknown| unknown.variable.as_variable()).collect();
    let depends = context.graph.variables_of(parts);
    unknowns.iter().any(is_open)
        || depends.iter().any(|v| !own.contains(&Some(*v)) && context.values()[v.index()].is_nan())
}
