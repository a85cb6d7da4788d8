//! Calls that bind a name or ask for one: `sum(k in 1 .. n: …)`, `integral(t in a .. b: …)`, `derivative(f, x)`.

use flank_expr::{End, Expr, Interval, Unproven};

use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::diagnostics::{Diagnostic, Note};
use crate::syntax::ast::{self, Argument, BinaryOperator, Bound, Call, Expression, ExpressionKind};
use crate::values::context::{Context, Role, Unranged};
use crate::values::dimension::{Dimension, shown};
use crate::values::functions;
use crate::values::value::{Constant, Scope, Value};

/// For each operation of an integrand: some hundred parts of its range are bounded to an order of some thirty.
const STEPS_OF_AN_INTEGRAL: usize = 500;

impl ast::Function {
    /// Whether it takes a derivative by this argument.
    pub(crate) fn differentiates_by(&self, argument: &str) -> bool {
        let mut found = false;
        for part in self.lets.iter().map(|binding| &binding.value).chain([&self.body]) {
            part.each(&mut |part| found |= by(part).is_some_and(|name| name.node == argument));
        }
        found
    }
}

/// The name that a `derivative` is taken by.
fn by(expression: &Expression) -> Option<&Name> {
    match &expression.kind {
        ExpressionKind::Call(call) if call.function.node == "derivative" => match &call.arguments.get(1)?.value.kind {
            ExpressionKind::Path(path) => path.segments.first().filter(|_| path.segments.len() == 1),
            _ => None,
        },
        _ => None,
    }
}

impl<'g> Context<'g> {
    /// A range with a name that stands where no name is bound.
    pub(super) fn unbound(&mut self, bound: &Bound, span: Span) -> Value<'g> {
        let message = format!("`{} in … : …` is no value by itself", bound.name.node);
        let help = "it is what a sum, an integral or a root runs over, as in `sum(k in 1 .. n: …)`";
        self.report(Diagnostic::new(Code::WrongArguments, span, message).help(help));
        Value::Poison
    }

    /// `sum(k in low .. high: value)`: written out, so that all that holds of `+` holds of it.
    pub(super) fn total(&mut self, call: &Call, scope: &Scope<'g>) -> Value<'g> {
        let Some(bound) = self.bound(call, "sum(k in 1 .. n: x^k / k)") else { return Value::Poison };
        let low = self.whole_end(&bound.range.low, scope, "the lower end of a sum");
        let high = self.whole_end(&bound.range.high, scope, "the upper end of a sum");
        match (low, high) {
            (Some(Whole::Known(low)), Some(Whole::Known(high))) => self.written_out(bound, (low, high), scope),
            // a definition without values: one term tells the dimension and most mistakes
            (Some(Whole::Known(low)), Some(Whole::Unknown)) => {
                self.term(bound, self.graph.constant(low), &mut scope.clone())
            }
            (Some(_), Some(_)) => {
                let index = self.variable(bound.name.node.clone(), Role::Parameter, f64::NAN);
                self.term(bound, index, &mut scope.clone())
            }
            _ => Value::Poison,
        }
    }

    fn written_out(&mut self, bound: &Bound, (low, high): (f64, f64), scope: &Scope<'g>) -> Value<'g> {
        let mut inner = scope.clone();
        let first = self.term(bound, self.graph.constant(low), &mut inner);
        if high < low {
            return zero(&first, self);
        }
        let (mut total, mut index) = (first, low);
        while index < high && !matches!(total, Value::Poison) {
            index += 1.0;
            if !self.step(bound.value.span) {
                return Value::Poison;
            }
            let findings = self.findings();
            let term = self.term(bound, self.graph.constant(index), &mut inner);
            let text = format!("with `{}` = {index}", bound.name.node);
            self.note_since(findings, bound.value.span, &Note { span: bound.name.span, text });
            let span = bound.value.span;
            total = self.binary(BinaryOperator::Add, (total, term), (span, span), span);
        }
        total
    }

    /// The value for one value of the name.
    fn term(&mut self, bound: &Bound, index: Expr<'g>, inner: &mut Scope<'g>) -> Value<'g> {
        inner.insert(bound.name.node.clone(), Value::Scalar(index, Dimension::NUMBER));
        match self.evaluate(&bound.value, inner) {
            term @ (Value::Scalar(..) | Value::Vector(_) | Value::Poison) => term,
            other => {
                let message = format!("there is no sum of what is {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, bound.value.span, message));
                Value::Poison
            }
        }
    }

    fn whole_end(&mut self, written: &Expression, scope: &Scope<'g>, what: &str) -> Option<Whole> {
        /// Beyond, whole numbers have gaps.
        const LARGEST: f64 = 9_007_199_254_740_992.0;
        let end = self.scalar(written, scope, Dimension::NUMBER, what)?;
        if matches!(self.constant(end), Constant::Unknown) {
            return Some(Whole::Unknown);
        }
        let end = self.require_constant(end, written.span, what)?;
        if end.fract() != 0.0 || end.abs() > LARGEST {
            let message = format!("{what} must be a whole number, not {end}");
            let help = "a parameter that is whole is a `count`";
            self.report(Diagnostic::new(Code::WrongDimension, written.span, message).help(help));
            return None;
        }
        Some(Whole::Known(end))
    }

    /// `derivative(value, variable)`
    pub(super) fn derivative(&mut self, call: &Call, scope: &Scope<'g>) -> Value<'g> {
        let Some(arguments) = functions::arguments(self, call, 2, scope, |_| {
            "it takes a value and the variable by which it is derived".to_string()
        }) else {
            return Value::Poison;
        };
        let [(value, written), (by, by_written)] = arguments.as_slice() else { return Value::Poison };
        let (by, dimension) = match by {
            Value::Poison => return Value::Poison,
            Value::Scalar(by, dimension) if self.role(*by).is_some_and(|role| role != Role::Parameter) => {
                (*by, *dimension)
            }
            other => {
                let message = format!("a derivative is taken by a variable, this is {}", self.no_variable(other));
                let help = "a variable is a motion, a surface's parameter, an axis in its machine, \
                            or what a function takes; what is made of variables is none";
                self.report(Diagnostic::new(Code::WrongArguments, by_written.span, message).help(help));
                return Value::Poison;
            }
        };
        self.slope(value, (by, dimension), written.span)
    }

    fn no_variable(&self, value: &Value<'g>) -> String {
        match value {
            Value::Scalar(expr, _) if self.role(*expr).is_some() => "a parameter, which stands still".to_owned(),
            Value::Scalar(expr, _) if expr.as_constant().is_some() => "a constant".to_owned(),
            Value::Scalar(..) => "a formula".to_owned(),
            other => other.described(),
        }
    }

    fn slope(&mut self, value: &Value<'g>, by: (Expr<'g>, Dimension), span: Span) -> Value<'g> {
        match value {
            Value::Poison => Value::Poison,
            Value::Scalar(expr, dimension) => {
                if !self.spend(self.graph.size(&[*expr]), span) {
                    return Value::Poison;
                }
                Value::Scalar(expr.derivative(by.0), dimension.over(by.1))
            }
            Value::Vector(parts) => Value::Vector(parts.iter().map(|part| self.slope(part, by, span)).collect()),
            other => {
                let message = format!("there is no derivative of {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, span, message));
                Value::Poison
            }
        }
    }

    /// A variable in the place of an argument, for what a function differentiates by it.
    pub(super) fn own_variable(&mut self, name: &Name, given: Expr<'g>) -> Expr<'g> {
        let (role, value) = match self.constant(given) {
            Constant::Known(value) => (Role::StandingArgument, value),
            Constant::Unknown => (Role::StandingArgument, f64::NAN),
            Constant::Moves(_) => (Role::MovingArgument, f64::NAN),
        };
        let variable = self.variable(name.node.clone(), role, value);
        if self.is_count(given) {
            self.set_count(variable);
        }
        if let (Role::MovingArgument, Ok(range)) = (role, self.enclosure(given)) {
            self.set_range(variable, range);
        }
        variable
    }

    /// `integral(t in low .. high: value)`
    pub(super) fn integral(&mut self, call: &Call, scope: &Scope<'g>) -> Value<'g> {
        let Some(bound) = self.bound(call, "integral(t in 0 deg .. turn: speed(t))") else { return Value::Poison };
        let (low, high) = (self.evaluate(&bound.range.low, scope), self.evaluate(&bound.range.high, scope));
        let (from, to, dimension) = match (low, high) {
            (Value::Poison, _) | (_, Value::Poison) => return Value::Poison,
            (Value::Scalar(from, a), Value::Scalar(to, b)) if a.sum(b).is_some() => (from, to, a.sum(b).unwrap_or(a)),
            (a, b) => {
                let message = format!("an integral does not run from {} to {}", a.described(), b.described());
                self.report(Diagnostic::new(Code::WrongDimension, bound.range.span, message));
                return Value::Poison;
            }
        };
        let variable = self.variable(bound.name.node.clone(), Role::Integration, f64::NAN);
        let ends = match (self.enclosure(from), self.enclosure(to)) {
            (Ok(low), Ok(high)) => {
                self.set_range(variable, Interval::new(low.lo.min(high.lo), low.hi.max(high.hi)));
                Ok([End { expr: from, range: low }, End { expr: to, range: high }])
            }
            (Err(reason), _) | (_, Err(reason)) => {
                self.set_range(variable, Interval::WHOLE);
                Err(reason)
            }
        };
        let mut inner = scope.clone();
        inner.insert(bound.name.node.clone(), Value::Scalar(variable, dimension));
        let integrand = self.evaluate(&bound.value, &inner);
        match ends {
            Err(Unranged::Endless(what)) => self.unproven(bound, format!("{what} has no range")),
            ends => self.integral_of(&integrand, bound, (variable, dimension), ends.ok()),
        }
    }

    fn integral_of(
        &mut self,
        integrand: &Value<'g>,
        bound: &Bound,
        (variable, dimension): (Expr<'g>, Dimension),
        ends: Option<[End<'g>; 2]>,
    ) -> Value<'g> {
        match integrand {
            Value::Poison => Value::Poison,
            Value::Vector(parts) => Value::Vector(
                parts.iter().map(|part| self.integral_of(part, bound, (variable, dimension), ends)).collect(),
            ),
            Value::Scalar(expr, own) => {
                let product = own.times(dimension);
                let ranges = self.ranges_of(*expr).map(|mut ranges| {
                    ranges.retain(|(other, _)| *other != variable);
                    ranges
                });
                let (ends, ranges) = match (ends, ranges) {
                    (_, Err(Unranged::Endless(what))) => {
                        return self.unproven(bound, format!("{what} has no range"));
                    }
                    // a definition without values
                    (None, _) | (_, Err(Unranged::Unknown)) => return Value::Scalar(*expr, product),
                    (Some(ends), Ok(ranges)) => (ends, ranges),
                };
                if !self.spend(STEPS_OF_AN_INTEGRAL * self.graph.size(&[*expr]), bound.value.span) {
                    return Value::Poison;
                }
                match flank_expr::integral(*expr, variable, ends, &ranges) {
                    Ok(value) => Value::Scalar(value, product),
                    Err(Unproven::Unbounded(at)) => {
                        let name = &bound.name.node;
                        let at = shown(at, dimension);
                        self.unproven(bound, format!("what is integrated cannot be bounded near `{name}` = {at}"))
                    }
                    Err(reason) => self.unproven(bound, reason.to_string()),
                }
            }
            other => {
                let message = format!("there is no integral of {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, bound.value.span, message));
                Value::Poison
            }
        }
    }

    fn unproven(&mut self, bound: &Bound, why: String) -> Value<'g> {
        let message = format!("this integral cannot be proven: {why}");
        let help = "keep poles, kinks and joints of curves out of the range, narrow what moves, or split it";
        self.report(Diagnostic::new(Code::Unproven, bound.value.span, message).help(help));
        Value::Poison
    }

    /// The one argument of a call that binds a name.
    pub(super) fn bound<'c>(&mut self, call: &'c Call, example: &str) -> Option<&'c Bound> {
        if let [Argument { name: None, value: Expression { kind: ExpressionKind::Bound(bound), .. } }] =
            call.arguments.as_slice()
        {
            return Some(bound);
        }
        let message = format!("`{}` takes a name, its range and a value for each", call.function.node);
        let help = format!("for example `{example}`");
        self.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(help));
        None
    }

    /// A value of a function with the arguments that were given in the place of its own variables.
    pub(super) fn with_given(&mut self, value: Value<'g>, own: &[(Expr<'g>, Expr<'g>)], span: Span) -> Value<'g> {
        match value {
            value if own.is_empty() => value,
            Value::Scalar(expr, dimension) => {
                if !self.spend(self.graph.size(&[expr]), span) {
                    return Value::Poison;
                }
                Value::Scalar(self.graph.substitute(&[expr], own)[0], dimension)
            }
            Value::Vector(parts) => {
                Value::Vector(parts.into_iter().map(|part| self.with_given(part, own, span)).collect())
            }
            other => other,
        }
    }
}

/// An end of a sum.
enum Whole {
    Known(f64),
    /// It depends on a parameter that has no value yet.
    Unknown,
}

/// Zero in the shape and the dimension of a value.
fn zero<'g>(value: &Value<'g>, context: &Context<'g>) -> Value<'g> {
    match value {
        Value::Scalar(_, dimension) => Value::Scalar(context.graph.constant(0.0), *dimension),
        Value::Vector(parts) => Value::Vector(parts.iter().map(|part| zero(part, context)).collect()),
        _ => Value::Poison,
    }
}
