//! On which side of what an edge sweeps its steel lies.

use flank_expr::geometry::{Chain, Edge};

use crate::definitions::material_side;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::values::context::Context;
use crate::values::steel_side::Seen;

use super::available::Available;

/// Which motion the normal of a sweep is taken from, and whether it has to be turned round: the first one, counts last, of which the
/// steel lies on one side of what the edge sweeps with it. On the points that the other motions leave of that, all give the same normal.
pub(super) fn side<'g>(
    context: &mut Context<'g>,
    available: &Available<'g>,
    edge: &Edge<'g>,
    driven: &Chain<'g>,
    motions: &[(RangedVariable<'g>, Span)],
) -> Option<(usize, bool)> {
    let unknowns: Vec<RangedVariable<'g>> =
        available.unknowns.iter().chain(motions.iter().map(|(motion, _)| motion)).cloned().collect();
    let mut order: Vec<usize> = (0..motions.len()).collect();
    order.sort_by_key(|&k| motions[k].0.is_count);
    let mut seen = Vec::new();
    for k in order {
        let raw = edge.raw_normal(driven, motions[k].0.variable);
        match material_side::noted_side(context, &unknowns, raw, edge.steel) {
            Ok(flipped) => return Some((k, flipped)),
            Err(what) => seen.push((k, what)),
        }
    }
    seen.sort_by_key(|(k, _)| *k);
    let diagnostic = match seen.iter().find(|(_, seen)| seen.is_undefined()) {
        Some((_, seen)) => material_side::no_side([available.named; 2], &unknowns, seen),
        None => no_side(available.named, motions, &seen),
    };
    context.report(diagnostic);
    None
}

/// Why none of the motions says on which side the steel lies.
fn no_side(edge: Span, motions: &[(RangedVariable<'_>, Span)], seen: &[(usize, Seen)]) -> Diagnostic {
    let reason = |k: usize, seen: &Seen| {
        let motion = &motions[k].0.name;
        if seen.is_flat() {
            format!("`{motion}` moves the edge along itself or not at all")
        } else if seen.runs_along() {
            format!("with `{motion}` the edge moves along its own `body`, not across it")
        } else {
            format!(
                "what the edge sweeps with `{motion}` has the steel on one side in a part of the ranges, on the other in the rest"
            )
        }
    };
    let help = match seen.iter().any(|(_, seen)| !seen.is_flat() && !seen.runs_along()) {
        true => "narrow the ranges to where the edge cuts, or let its `body` depend on its parameter",
        false => {
            "an edge leaves a surface where it moves across its own line and its `body`: another motion, or another `body`"
        }
    };
    if let [(k, seen)] = seen {
        return Diagnostic::new(Code::SteelSide, edge, reason(*k, seen)).help(help);
    }
    let message = "none of the motions says on which side of what this edge leaves its steel lies";
    let diagnostic = Diagnostic::new(Code::SteelSide, edge, message).help(help);
    seen.iter().fold(diagnostic, |diagnostic, (k, seen)| diagnostic.note(motions[*k].1, reason(*k, seen)))
}
