//! Values that equations give: `root(x in a .. b: f(x))`, and the axes of closed loops.

use flank_expr::{Expr, Interval, NoRoot, Unknown, every_root, has_one_root, roots};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::syntax::ast::{Bound, Call};
use crate::values::context::{Context, Role, Unranged};
use crate::values::dimension::{Dimension, shown, shown_like};
use crate::values::value::{Scope, Value};

/// Boxes that a proof takes in a common case: what it costs in steps.
const BOXES: usize = 256;

/// One of several solutions of equations.
pub(crate) struct Branch {
    /// The value of each unknown where there are several.
    pub(crate) values: Vec<f64>,
    /// Which unknown has to lie where, so that this one alone is left wherever all else lies.
    pub(crate) keep: Option<(usize, [f64; 2])>,
}

fn unproven(span: Span, why: &str, help: String) -> Diagnostic {
    Diagnostic::new(Code::Unproven, span, format!("this root cannot be proven: {why}")).help(help)
}

/// Why equations do not give their unknowns.
pub(crate) enum Unsolved {
    /// A parameter has no value yet, or the room is used up, which has been reported.
    Unknown,
    /// Something moves without ends.
    Endless(String),
    /// What is wrong, and where in words.
    Not(NoRoot, String),
    /// There are several solutions: where in words, and which.
    Several(String, Vec<Branch>),
}

impl<'g> Context<'g> {
    /// `root(x in low .. high: value)`: where the value is zero.
    pub(super) fn root(&mut self, call: &Call, scope: &Scope<'g>) -> Value<'g> {
        let Some(bound) = self.bound(call, "root(x in 0 .. 1: x - cos(x * 1 rad))") else { return Value::Poison };
        let (low, high) = (self.evaluate(&bound.range.low, scope), self.evaluate(&bound.range.high, scope));
        let dimension = match (low, high) {
            (Value::Poison, _) | (_, Value::Poison) => return Value::Poison,
            (Value::Scalar(_, a), Value::Scalar(_, b)) if a.sum(b).is_some() => a.sum(b).unwrap_or(a),
            (a, b) => {
                let message = format!("a root does not lie between {} and {}", a.described(), b.described());
                self.report(Diagnostic::new(Code::WrongDimension, bound.range.span, message));
                return Value::Poison;
            }
        };
        let what = format!("root `{}`", bound.name.node);
        let findings = self.findings();
        let range = self.range(&bound.range, scope, dimension, &what);
        let is_wrong = range.is_none() && self.findings() > findings;
        let variable = self.variable(bound.name.node.clone(), Role::Unknown, f64::NAN);
        self.set_range(variable, range.map_or(Interval::WHOLE, |(low, high)| Interval::new(low, high)));
        let mut inner = scope.clone();
        inner.insert(bound.name.node.clone(), Value::Scalar(variable, dimension));
        let value = match self.evaluate(&bound.value, &inner) {
            Value::Poison => return Value::Poison,
            _ if is_wrong => return Value::Poison,
            Value::Scalar(value, _) => value,
            other => {
                let message =
                    format!("a root is where a number, a length or an angle is zero, not {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, bound.value.span, message));
                return Value::Poison;
            }
        };
        // a definition without values
        let Some((low, high)) = range else { return Value::Scalar(variable, dimension) };
        let unknown = Unknown { variable, range: Interval::new(low, high) };
        match self.solved(&[value], &[unknown], &[dimension], scope, bound.value.span) {
            Ok(roots) => Value::Scalar(roots[0], dimension),
            Err(Unsolved::Unknown) => Value::Scalar(variable, dimension),
            Err(Unsolved::Endless(what)) => {
                let help = "give it one, or keep it out of the root".to_owned();
                self.rootless(bound.value.span, &format!("{what} has no range"), help)
            }
            Err(Unsolved::Several(place, branches)) => {
                let [low, high] = written_ends(bound, [low, high], dimension);
                let why = format!("from {low} to {high}{place}, this is zero more than once");
                let name = &bound.name.node;
                let told = branches.iter().map(|branch| {
                    let value = shown_briefly(branch.values[0], dimension);
                    let range = branch.keep.map(|(_, ends)| ends.map(|end| shown(end, dimension)).join(" .. "));
                    range.map_or_else(|| value.clone(), |range| format!("{value} by `{name} in {range}`"))
                });
                let help = format!("narrow the range to the root that is meant{}", listed(told.collect()));
                let mut open = unproven(bound.value.span, &why, help);
                for (value, ends) in branches.iter().filter_map(|branch| Some((branch.values[0], branch.keep?.1))) {
                    let range = ends.map(|end| shown(end, dimension)).join(" .. ");
                    open = open.cure(format!("take {}", shown_briefly(value, dimension)), bound.range.span, range);
                }
                self.report(open);
                Value::Poison
            }
            Err(Unsolved::Not(why, place)) => {
                let [low, high] = written_ends(bound, [low, high], dimension);
                let name = &bound.name.node;
                let (why, help) = match why {
                    NoRoot::None(_) => (format!("nowhere from {low} to {high}{place} is this zero"), "widen the range"),
                    NoRoot::Several(_) | NoRoot::Unproven(_) => (
                        format!("whether this is zero once from {low} to {high} is not decided{place}"),
                        "keep double roots, poles and kinks out of the range, and narrow what moves",
                    ),
                    NoRoot::TooFast => (
                        format!("no polynomial comes near `{name}`, so fast does it change"),
                        "narrow what moves, or let fewer things move",
                    ),
                };
                self.rootless(bound.value.span, &why, help.to_owned())
            }
        }
    }

    fn rootless(&mut self, span: Span, why: &str, help: String) -> Value<'g> {
        self.report(unproven(span, why, help));
        Value::Poison
    }

    /// The unknowns of equations as functions of what else is in them.
    pub(crate) fn solved(
        &mut self,
        residuals: &[Expr<'g>],
        unknowns: &[Unknown<'g>],
        dimensions: &[Dimension],
        scope: &Scope<'g>,
        span: Span,
    ) -> Result<Vec<Expr<'g>>, Unsolved> {
        if unknowns.iter().any(|unknown| !unknown.range.continuous) {
            return Err(Unsolved::Unknown);
        }
        let mut others = Vec::new();
        for residual in residuals {
            let ranges = self.ranges_of(*residual).map_err(|why| match why {
                Unranged::Unknown => Unsolved::Unknown,
                Unranged::Endless(what) => Unsolved::Endless(what),
            })?;
            for (variable, range) in ranges {
                let is_known = others.iter().any(|(other, _)| *other == variable)
                    || unknowns.iter().any(|unknown| unknown.variable == variable);
                if !is_known {
                    others.push((variable, range));
                }
            }
        }
        if !self.spend(BOXES * self.graph.count(residuals).shared, span) {
            return Err(Unsolved::Unknown);
        }
        let moving: Vec<Expr<'g>> =
            others.iter().filter(|(_, range)| range.lo < range.hi).map(|(variable, _)| *variable).collect();
        roots(residuals, unknowns, &others).map_err(|why| match &why {
            NoRoot::Several(at) => {
                let place = self.place(&moving, at, scope);
                let branches = branches((residuals, unknowns, dimensions), &others, at);
                Unsolved::Several(place, branches)
            }
            NoRoot::None(at) | NoRoot::Unproven(at) => {
                let place = self.place(&moving, at, scope);
                Unsolved::Not(why, place)
            }
            NoRoot::TooFast => Unsolved::Not(why, String::new()),
        })
    }

    /// The values of what moves, in words; nothing if nothing does.
    fn place(&self, moving: &[Expr<'g>], at: &[f64], scope: &Scope<'g>) -> String {
        let value = |(variable, value): (&Expr<'g>, &f64)| {
            let dimension = scope.values().find_map(|known| match known {
                Value::Scalar(expr, dimension) if expr == variable => Some(*dimension),
                _ => None,
            });
            let value = dimension.map_or_else(|| format!("{value:.6}"), |dimension| rounded(*value, dimension, 1e6));
            format!("`{variable}` = {value}")
        };
        let values: Vec<String> = moving.iter().zip(at).map(value).collect();
        if values.is_empty() { String::new() } else { format!(" at {}", values.join(", ")) }
    }
}

/// The solutions where what moves has these values.
fn branches<'g>(
    (residuals, unknowns, dimensions): (&[Expr<'g>], &[Unknown<'g>], &[Dimension]),
    others: &[(Expr<'g>, Interval)],
    at: &[f64],
) -> Vec<Branch> {
    let mut moving = at.iter();
    let value = |range: &Interval| if range.lo < range.hi { *moving.next().unwrap_or(&range.lo) } else { range.lo };
    let values: Vec<f64> = others.iter().map(|other| &other.1).map(value).collect();
    let places: Vec<(Expr<'g>, f64)> = others.iter().map(|other| other.0).zip(values).collect();
    let solutions = every_root(residuals, unknowns, &places);
    let branch = |own: &Vec<f64>| {
        let keep = (0..unknowns.len()).find_map(|k| {
            let range = unknowns[k].range;
            let ends = [(own[k], range.lo, -1.0), (own[k], range.hi, 1.0)].map(|(value, end, side)| {
                let beside = solutions.iter().map(|other| other[k]).filter(|other| (other - value) * side > 0.0);
                let nearest = beside.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
                nearest.map_or(end, |nearest| between(value, nearest, dimensions[k]))
            });
            let mut narrowed = unknowns.to_vec();
            narrowed[k].range = Interval::new(ends[0], ends[1]);
            has_one_root(residuals, &narrowed, others).then_some((k, ends))
        });
        Branch { values: own.clone(), keep }
    };
    solutions.iter().map(branch).collect()
}

/// A number half-way between two, with as few decimals as leave it in the middle half.
fn between(one: f64, other: f64, dimension: Dimension) -> f64 {
    let unit = if dimension == Dimension::ANGLE { 1.0_f64.to_radians() } else { 1.0 };
    let (middle, room) = (0.5 * (one + other), 0.25 * (one - other).abs());
    (0..9)
        .map(|decimals| 10.0_f64.powi(decimals) / unit)
        .map(|scale| (middle * scale).round() / scale)
        .find(|rounded| (rounded - middle).abs() <= room)
        .unwrap_or(middle)
}

/// The ends of a range, each in the unit that it is written in.
fn written_ends(bound: &Bound, ends: [f64; 2], dimension: Dimension) -> [String; 2] {
    let written = [&bound.range.low, &bound.range.high];
    [0, 1].map(|k| shown_like(ends[k], dimension, written[k]))
}

/// With three decimals.
pub(crate) fn shown_briefly(value: f64, dimension: Dimension) -> String {
    rounded(value, dimension, 1e3)
}

/// As a multiple of a part of its unit.
fn rounded(value: f64, dimension: Dimension, parts: f64) -> String {
    let unit = if dimension == Dimension::ANGLE { 1.0_f64.to_radians() } else { 1.0 };
    shown((value / unit * parts).round() / parts * unit, dimension)
}

/// The rest of a sentence that lists something, if there is something.
pub(crate) fn listed(branches: Vec<String>) -> String {
    if branches.is_empty() { String::new() } else { format!(": {}", branches.join("; ")) }
}
