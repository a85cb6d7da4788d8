//! The side of a tool's surface on which its steel lies.

use flank_expr::Expr;
use flank_expr::geometry::Vector3;

use crate::codes::Code;
use crate::context::Context;
use crate::diagnostic::Diagnostic;
use crate::model::Bounded;
use crate::source::Span;

/// Points in each direction at which the side of the steel is looked at.
const LOOKS: usize = 5;

/// `|r_u × r_v|` below this is rounding: the points make no surface.
const NO_AREA: f64 = 1e-12;

/// What was seen at some points of a surface.
#[derive(Default)]
struct Seen {
    /// All of them.
    looks: usize,
    /// Points at which the normal points out of the steel, and into it.
    out: usize,
    into: usize,
    /// Points that cannot be computed.
    undefined: usize,
    /// Points without a normal.
    flat: usize,
    /// The greatest component of a normal that was seen last: its index and sign.
    normal: Option<(usize, f64)>,
}

/// Where a surface is written: its points, the side of its steel, the segment of a profile that it runs along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    pub(crate) point: Span,
    pub(crate) side: Span,
    pub(crate) segment: Option<Span>,
}

/// Whether `raw`, square to a surface, points against `outward`: the same answer everywhere in the ranges of the unknowns, or
/// an error.
pub(crate) fn is_flipped<'g>(
    context: &mut Context<'g>,
    places: Places,
    unknowns: &[Bounded<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Option<bool> {
    let [x, y, z] = raw.0;
    let [ox, oy, oz] = outward.0;
    let parts = [x, y, z, ox, oy, oz];
    let seen = look(context, &parts, unknowns)?;
    match (seen.out, seen.into) {
        (0, 0) if unknowns.iter().any(|unknown| unknown.low.is_nan() || unknown.high.is_nan()) => Some(false),
        (0, 0) if unknown_values(context, &parts, unknowns) => Some(false),
        (_, 0) if seen.out > 0 => Some(false),
        (0, _) if seen.into > 0 => Some(true),
        _ => {
            let mut diagnostic = no_side([places.point, places.side], unknowns, &seen);
            if let Some(segment) = places.segment {
                diagnostic = diagnostic.note(segment, "along this segment");
            }
            context.report(diagnostic);
            None
        }
    }
}

/// Evaluates normal and direction at points all over the surface.
fn look<'g>(context: &Context<'g>, parts: &[Expr<'g>; 6], unknowns: &[Bounded<'g>]) -> Option<Seen> {
    let mut seen = Seen::default();
    let mut values = context.values().to_vec();
    for mut k in 0..LOOKS.pow(unknowns.len() as u32) {
        for unknown in unknowns {
            let share = ((k % LOOKS) as f64 + 0.5) / LOOKS as f64;
            k /= LOOKS;
            values[unknown.variable.as_variable()?.index()] = unknown.low + (unknown.high - unknown.low) * share;
        }
        let found = context.graph.evaluate(parts, &values);
        seen.add(&found[..3], &found[3..]);
        seen.looks += 1;
    }
    Some(seen)
}

impl Seen {
    fn add(&mut self, normal: &[f64], outward: &[f64]) {
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (length, along) = (norm(normal), normal.iter().zip(outward).map(|(n, o)| n * o).sum::<f64>());
        if length.is_nan() {
            self.undefined += 1;
        } else if length < NO_AREA {
            self.flat += 1;
        } else {
            let greatest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()));
            self.normal = greatest.map(|index| (index, normal[index].signum()));
            let cosine = along / (length * norm(outward));
            self.out += usize::from(cosine > 1e-9);
            self.into += usize::from(cosine < -1e-9);
        }
    }

    /// A direction along an axis that leaves the surface: `[0, 1, 0]`.
    fn example(&self) -> String {
        let (index, sign) = self.normal.unwrap_or((2, -1.0));
        let parts: Vec<String> = (0..3).map(|k| if k == index { sign.to_string() } else { "0".to_string() }).collect();
        format!("`body towards [{}]` or its opposite", parts.join(", "))
    }
}

/// Why a surface has no side that the steel lies on.
fn no_side([point, body]: [Span; 2], unknowns: &[Bounded<'_>], seen: &Seen) -> Diagnostic {
    let names: Vec<String> = unknowns.iter().map(|unknown| format!("`{}`", unknown.name)).collect();
    let names = names.join(" and ");
    if seen.undefined == seen.looks {
        let message = format!("the points cannot be computed anywhere in the ranges of {names}");
        let help = "look for a root of a negative number, an `asin` of more than 1, 0 / 0";
        return Diagnostic::new(Code::NotANumber, point, message).help(help);
    }
    if seen.normal.is_none() {
        let message = "these points make a line or a single point, not a surface";
        let help = format!("let the point move in two directions with {names}");
        return Diagnostic::new(Code::SteelSide, point, message).help(help);
    }
    let (message, hint) = if seen.out + seen.into == 0 {
        ("this direction is zero or runs along the surface: it does not say on which side the steel lies", "")
    } else {
        let message = "this is one side of the surface at some points, and the other side at others";
        (message, "; it may depend on the parameters")
    };
    let help = format!("name a direction that points into the steel everywhere, such as {}{hint}", seen.example());
    Diagnostic::new(Code::SteelSide, body, message).help(help)
}

/// True if the expressions depend on parameters without values (a definition looked at by itself).
fn unknown_values<'g>(context: &Context<'g>, parts: &[Expr<'g>], unknowns: &[Bounded<'g>]) -> bool {
    let own: Vec<_> = unknowns.iter().map(|unknown| unknown.variable.as_variable()).collect();
    let is_open = |variable: &flank_expr::VariableId| context.values()[variable.index()].is_nan();
    let depends = context.graph.variables_of(parts);
    depends.iter().any(|variable| !own.contains(&Some(*variable)) && is_open(variable))
}
