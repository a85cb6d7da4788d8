//! The side of a tool's surface on which its steel lies.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::values::context::Context;

/// Points at which the side of the steel is looked at: a part that is a twenty-fifth of the surface has some of them.
const LOOKS: usize = 100;

/// `|r_u × r_v|` below this is rounding: the points make no surface.
const NO_AREA: f64 = 1e-12;

/// What was seen at some points of a surface.
#[derive(Default)]
pub(crate) struct Seen {
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
    unknowns: &[RangedVariable<'g>],
    raw: Vector3<'g>,
    outward: Vector3<'g>,
) -> Option<bool> {
    let flipped = side(context, unknowns, raw, outward);
    flipped
        .map_err(|seen| {
            let mut diagnostic = no_side([places.point, places.side], unknowns, &seen);
            if let Some(segment) = places.segment {
                diagnostic = diagnostic.note(segment, "along this segment");
            }
            context.report(diagnostic);
        })
        .ok()
}

/// The same, or what was seen instead of one answer.
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
        (_, 0) if seen.out > 0 => Ok(false),
        (0, _) if seen.into > 0 => Ok(true),
        _ => Err(seen),
    }
}

/// Evaluates normal and direction at points all over the surface.
fn look<'g>(context: &Context<'g>, parts: &[Expr<'g>; 6], unknowns: &[RangedVariable<'g>]) -> Seen {
    let inputs = context.variables_of(parts);
    let tape = Tape::new(parts, &inputs).expect("what the parts depend on are the inputs");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let mut values: Vec<f64> = inputs.iter().map(|input| context.value_of(*input)).collect();
    let place = |unknown: &RangedVariable<'g>| inputs.iter().position(|input| *input == unknown.variable);
    let places: Vec<Option<usize>> = unknowns.iter().map(place).collect();
    let steps = steps(unknowns.len());
    let mut seen = Seen::default();
    for look in 0..LOOKS {
        for ((unknown, place), step) in unknowns.iter().zip(&places).zip(&steps) {
            let share = (0.5 + look as f64 * step).fract();
            if let Some(place) = place {
                values[*place] = unknown.low + (unknown.high - unknown.low) * share;
            }
        }
        let mut found = [0.0; 6];
        evaluator.run(&values, &mut found);
        seen.add(&found[..3], &found[3..]);
        seen.looks += 1;
    }
    seen
}

/// How far, as a share of each range, one point lies from the one before, so that they fill all directions evenly, and none stands at the
/// same part of a turn again and again: powers of the root of x^(d + 1) = x + 1, the golden ratio's sequence in d directions.
fn steps(directions: usize) -> Vec<f64> {
    let root = (0..32).fold(2.0_f64, |x, _| (1.0 + x).powf(1.0 / (directions + 1) as f64));
    (1..=directions).map(|k| root.powi(-(k as i32))).collect()
}

impl Seen {
    /// No point could be computed.
    pub(crate) fn is_undefined(&self) -> bool {
        self.undefined == self.looks
    }

    /// No point had a normal.
    pub(crate) fn is_flat(&self) -> bool {
        self.normal.is_none()
    }

    /// The direction lay in the surface at all points.
    pub(crate) fn runs_along(&self) -> bool {
        self.out + self.into == 0
    }

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
    let (message, hint) = if seen.runs_along() {
        ("this direction is zero or runs along the surface: it does not say on which side the steel lies", "")
    } else {
        let message = "this is one side of the surface at some points, and the other side at others";
        (message, "; it may depend on the parameters")
    };
    let help = format!("name a direction that points into the steel everywhere, such as {}{hint}", seen.example());
    Diagnostic::new(Code::SteelSide, body, message).help(help)
}

/// True if the expressions depend on parameters without values (a definition looked at by itself).
fn unknown_values<'g>(context: &Context<'g>, parts: &[Expr<'g>], unknowns: &[RangedVariable<'g>]) -> bool {
    let is_own = |variable: &Expr<'g>| unknowns.iter().any(|unknown| unknown.variable == *variable);
    let depends = context.variables_of(parts);
    depends.iter().any(|variable| !is_own(variable) && context.value_of(*variable).is_nan())
}
