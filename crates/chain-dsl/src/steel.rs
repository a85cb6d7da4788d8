//! The side of a tool's surface on which its steel lies.

use flank_expr::geometry::{Surface, Vector3};
use flank_expr::{Expr, Graph};

use crate::codes::Code;
use crate::context::Context;
use crate::diagnostic::Diagnostic;
use crate::model::Bounded;
use crate::syntax::ast::{self, Side};

/// Points in each direction at which the side of the steel is looked at.
const LOOKS: usize = 5;

/// `|r_u × r_v|` below this is rounding: the points make no surface.
const NO_AREA: f64 = 1e-12;

/// What was seen at some points of a surface.
#[derive(Default)]
struct Seen {
    /// Points at which `r_u × r_v` points out of the steel, and into it.
    out: usize,
    into: usize,
    /// Points that cannot be computed.
    undefined: usize,
    /// Points without a normal.
    flat: usize,
    /// The greatest component of a normal that was seen last: its index and sign.
    normal: Option<(usize, f64)>,
}

/// Whether `r_u × r_v` points into the steel: the same answer all over the surface, or an error.
pub(crate) fn is_flipped<'g>(
    context: &mut Context<'g>,
    written: &ast::ToolSurface,
    [u, v]: [&Bounded<'g>; 2],
    position: Vector3<'g>,
    towards: Vector3<'g>,
) -> Option<bool> {
    let graph: &'g Graph = context.graph;
    let zero = graph.constant(0.0);
    let outward = match &written.body.side {
        Side::Inside => Vector3([position.0[0], position.0[1], zero]),
        Side::Outside => -Vector3([position.0[0], position.0[1], zero]),
        Side::Towards(_) => -towards,
    };
    let [x, y, z] = Surface::raw_normal([u.variable, v.variable], position).0;
    let [ox, oy, oz] = outward.0;
    let parts = [x, y, z, ox, oy, oz];
    let seen = look(context, &parts, [u, v])?;
    match (seen.out, seen.into) {
        (0, 0) if [u, v].iter().any(|p| p.low.is_nan() || p.high.is_nan()) => Some(false),
        (0, 0) if unknown_values(context, &parts, [u, v]) => Some(false),
        (_, 0) if seen.out > 0 => Some(false),
        (0, _) if seen.into > 0 => Some(true),
        _ => {
            let diagnostic = no_side(written, [u, v], &seen);
            context.report(diagnostic);
            None
        }
    }
}

/// Evaluates normal and direction at points all over the surface.
fn look<'g>(context: &Context<'g>, parts: &[Expr<'g>; 6], [u, v]: [&Bounded<'g>; 2]) -> Option<Seen> {
    let mut seen = Seen::default();
    let places = [u.variable.as_variable()?.index(), v.variable.as_variable()?.index()];
    let at = |bounded: &Bounded<'g>, step: usize| {
        let share = (step as f64 + 0.5) / LOOKS as f64;
        bounded.low + (bounded.high - bounded.low) * share
    };
    for k in 0..LOOKS * LOOKS {
        let mut values = context.values().to_vec();
        values[places[0]] = at(u, k / LOOKS);
        values[places[1]] = at(v, k % LOOKS);
        let found = context.graph.evaluate(parts, &values);
        seen.add(&found[..3], &found[3..]);
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
fn no_side(written: &ast::ToolSurface, [u, v]: [&Bounded<'_>; 2], seen: &Seen) -> Diagnostic {
    let (point, body) = (written.at.span, written.body.span);
    let (u, v) = (&u.name, &v.name);
    if seen.undefined == LOOKS * LOOKS {
        let message = format!("the points cannot be computed anywhere in the ranges of `{u}` and `{v}`");
        let help = "look for a root of a negative number, an `asin` of more than 1, 0 / 0";
        return Diagnostic::new(Code::NotANumber, point, message).help(help);
    }
    if seen.normal.is_none() {
        let message = "these points make a line or a single point, not a surface";
        let help = format!("let the point move in two directions with `{u}` and `{v}`");
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
fn unknown_values<'g>(context: &Context<'g>, parts: &[Expr<'g>], [u, v]: [&Bounded<'g>; 2]) -> bool {
    let own = [u.variable.as_variable(), v.variable.as_variable()];
    context
        .graph
        .variables_of(parts)
        .iter()
        .any(|variable| !own.contains(&Some(*variable)) && context.values()[variable.index()].is_nan())
}
