//! Values that equations give: `root(x in a .. b: f(x))`, and the axes of closed loops.

use flank_expr::{Expr, Interval, NoRoot, Unknown, roots};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::syntax::ast::Call;
use crate::values::context::{Context, Role, Unranged};
use crate::values::dimension::shown;
use crate::values::value::{Scope, Value};

/// Boxes that a proof takes in a common case: what it costs in steps.
const BOXES: usize = 256;

/// Why equations do not give their unknowns.
pub(crate) enum Unsolved {
    /// A parameter has no value yet, or the room is used up, which has been reported.
    Unknown,
    /// Something moves without ends.
    Endless(String),
    /// A word for what is wrong, and where.
    Not(NoRoot, String),
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
        match self.solved(&[value], &[unknown], scope, bound.value.span) {
            Ok(roots) => Value::Scalar(roots[0], dimension),
            Err(Unsolved::Unknown) => Value::Scalar(variable, dimension),
            Err(Unsolved::Endless(what)) => self.rootless(bound.value.span, &format!("{what} has no range"), None),
            Err(Unsolved::Not(why, place)) => {
                let [low, high] = [low, high].map(|end| shown(end, dimension));
                let name = &bound.name.node;
                let (why, help) = match why {
                    NoRoot::None(_) => (format!("nowhere from {low} to {high}{place} is this zero"), "widen the range"),
                    NoRoot::Several(_) => (
                        format!("from {low} to {high}{place}, this is zero more than once"),
                        "narrow the range to the root that is meant",
                    ),
                    NoRoot::Unproven(_) => (
                        format!("whether this is zero once from {low} to {high} is not decided{place}"),
                        "keep double roots, poles and kinks out of the range, and narrow what moves",
                    ),
                    NoRoot::TooFast => (
                        format!("no polynomial comes near `{name}`, so fast does it change"),
                        "narrow what moves, or let fewer things move",
                    ),
                };
                self.rootless(bound.value.span, &why, Some(help))
            }
        }
    }

    fn rootless(&mut self, span: Span, why: &str, help: Option<&str>) -> Value<'g> {
        let message = format!("this root cannot be proven: {why}");
        let help = help.unwrap_or("give it one, or keep it out of the root");
        self.report(Diagnostic::new(Code::Unproven, span, message).help(help));
        Value::Poison
    }

    /// The unknowns of equations as functions of what else is in them.
    pub(crate) fn solved(
        &mut self,
        residuals: &[Expr<'g>],
        unknowns: &[Unknown<'g>],
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
        roots(residuals, unknowns, &others).map_err(|why| {
            let place = match &why {
                NoRoot::None(at) | NoRoot::Several(at) | NoRoot::Unproven(at) => self.place(&moving, at, scope),
                NoRoot::TooFast => String::new(),
            };
            Unsolved::Not(why, place)
        })
    }

    /// The values of what moves, in words; nothing if nothing does.
    fn place(&self, moving: &[Expr<'g>], at: &[f64], scope: &Scope<'g>) -> String {
        let value = |(variable, value): (&Expr<'g>, &f64)| {
            let dimension = scope.values().find_map(|known| match known {
                Value::Scalar(expr, dimension) if expr == variable => Some(*dimension),
                _ => None,
            });
            let value = dimension.map_or_else(|| format!("{value:.6}"), |dimension| shown(*value, dimension));
            format!("`{variable}` = {value}")
        };
        let values: Vec<String> = moving.iter().zip(at).map(value).collect();
        if values.is_empty() { String::new() } else { format!(" at {}", values.join(", ")) }
    }
}
