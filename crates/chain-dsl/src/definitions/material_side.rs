//! The side of a tool's surface on which its steel lies.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, Tape};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::values::context::Context;
use crate::values::steel_side::{Moving, Seen, SteelSide, in_lanes, looked};

/// Where a surface is written: its points, the side of its steel, the segment of a profile that it runs along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    pub(crate) point: Span,
    pub(crate) side: Span,
    pub(crate) segment: Option<Span>,
    /// Whether nothing else has its side of the steel from the same words.
    pub(crate) is_alone: bool,
}

/// Whether `raw`, square to a surface, points against `outward`: the same answer everywhere in the ranges of the unknowns, or
/// an error.
pub(crate) fn is_flipped<'g>(
    context: &mut Context<'g>,
    places: Places,
    unknowns: &[RangedVariable<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Option<bool> {
    let flipped = noted_side(context, unknowns, raw, outward);
    flipped
        .map_err(|seen| {
            let mut diagnostic = no_side([places.point, places.side], unknowns, &seen);
            if diagnostic.code == Code::SteelSide && diagnostic.span == places.side && places.is_alone {
                for written in seen.examples().into_iter().flatten() {
                    diagnostic = diagnostic.cure(format!("write `{written}`"), places.side, written);
                }
            }
            if let Some(segment) = places.segment {
                diagnostic = diagnostic.note(segment, "along this segment");
            }
            context.report(diagnostic);
        })
        .ok()
}

/// The same, or what was seen instead of one answer. The answer is kept for the model.
pub(crate) fn noted_side<'g>(
    context: &mut Context<'g>,
    unknowns: &[RangedVariable<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Result<bool, Seen> {
    let is_flipped = side(context, unknowns, raw, outward)?;
    let ([x, y, z], [ox, oy, oz]) = (raw.0, outward.0);
    let parts = [x, y, z, ox, oy, oz];
    let unknowns = unknowns.iter().map(|of| (of.variable, of.low, of.high)).collect();
    context.steel_sides.push(SteelSide { parts, unknowns, is_flipped });
    Ok(is_flipped)
}

/// The same without keeping it.
pub(crate) fn side<'g>(
    context: &Context<'g>,
    unknowns: &[RangedVariable<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Result<bool, Seen> {
    let [x, y, z] = raw.0;
    let [ox, oy, oz] = outward.0;
    let parts = [x, y, z, ox, oy, oz];
    let seen = look(context, &parts, unknowns);
    match (seen.out, seen.into) {
        (0, 0) if unknowns.iter().any(|unknown| unknown.low.is_nan() || unknown.high.is_nan()) => Ok(false),
        (0, 0) if unknown_values(context, &parts, unknowns) => Ok(false),
        _ => seen.one_side().ok_or(seen),
    }
}

/// Evaluates normal and direction at points all over the surface.
fn look<'g>(context: &Context<'g>, parts: &[Expr<'g>; 6], unknowns: &[RangedVariable<'g>]) -> Seen {
    let inputs = context.variables_of(parts);
    let tape = Tape::new(parts, &inputs).expect("what the parts depend on are the inputs");
    let values: Vec<f64> = inputs.iter().map(|input| context.value_of(*input)).collect();
    let place = |unknown: &RangedVariable<'g>| inputs.iter().position(|input| *input == unknown.variable);
    let moving: Vec<Moving> = unknowns.iter().map(|of| (place(of), of.low, of.high)).collect();
    looked(&in_lanes(&tape, &moving), &values, &moving)
}

/// Why a surface has no side that the steel lies on.
pub(crate) fn no_side([point, body]: [Span; 2], unknowns: &[RangedVariable<'_>], seen: &Seen) -> Diagnostic {
    let names: Vec<String> = unknowns.iter().map(|unknown| format!("`{}`", unknown.name)).collect();
    let names = names.join(" and ");
    if seen.is_undefined() {
        let message = format!("the points cannot be computed anywhere in the ranges of {names}");
        let help = "look for a root of a negative number, an `asin` of more than 1, 0 / 0";
        return Diagnostic::new(Code::NotANumber, point, message).help(help);
    }
    if seen.is_flat() {
        let message = "these points make a line or a single point, not a surface";
        let help = format!("let the point move in two directions with {names}");
        return Diagnostic::new(Code::SteelSide, point, message).help(help);
    }
    let message = if seen.runs_along() {
        "this direction is zero or runs along the surface: it does not say on which side the steel lies"
    } else {
        "this is one side of the surface at some points, and the other side at others"
    };
    let examples = seen.examples().map(|[example, _]| format!("such as `{example}` or its opposite"));
    let hint = examples.unwrap_or_else(|| "which may depend on the parameters".to_string());
    let help = format!("name a direction that points into the steel everywhere, {hint}");
    Diagnostic::new(Code::SteelSide, body, message).help(help)
}

/// True if the expressions depend on parameters without values (a definition looked at by itself).
fn unknown_values<'g>(context: &Context<'g>, parts: &[Expr<'g>], unknowns: &[RangedVariable<'g>]) -> bool {
    let is_own = |variable: &Expr<'g>| unknowns.iter().any(|unknown| unknown.variable == *variable);
    let depends = context.variables_of(parts);
    depends.iter().any(|variable| !is_own(variable) && context.value_of(*variable).is_nan())
}
