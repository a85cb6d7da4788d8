//! Expressions of the text become symbolic scalars, their dimensions checked on the way.

use std::borrow::Cow;
use std::fmt;

use flank_expr::{CurveId, Expr};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::Span;
use crate::limits;
use crate::syntax::ast::{self, BinaryOperator, Expression, ExpressionKind, Range, UnaryOperator};
use crate::values::context::Context;
use crate::values::dimension::{self, Dimension};
use crate::values::functions;
use crate::values::grids;
use crate::values::segment::Segment;
use crate::values::tables;
use crate::values::value::{Constant, Scope, Value, article};

impl<'g> Context<'g> {
    /// The value of an expression; what is wrong in it is reported and becomes poison.
    pub(crate) fn evaluate(&mut self, expression: &Expression, scope: &Scope<'g>) -> Value<'g> {
        if !self.step(expression.span) {
            return Value::Poison;
        }
        let value = match &expression.kind {
            ExpressionKind::Number(value, units) => self.number(*value, units, expression.span),
            ExpressionKind::Text(_) => Value::Text,
            ExpressionKind::Path(path) => self.path(path, scope),
            ExpressionKind::Call(call) => self.call(call, scope),
            ExpressionKind::Vector(parts) => {
                Value::Vector(parts.iter().map(|part| self.evaluate(part, scope)).collect())
            }
            ExpressionKind::Index(vector, index) => self.index(vector, index, scope),
            ExpressionKind::Unary(operator, operand) => {
                let value = self.evaluate(operand, scope);
                let scalar = value.as_scalar();
                let value = self.unary(operator.node, value, operand.span);
                self.follow_negated_angle(scalar, &value);
                value
            }
            ExpressionKind::Binary(operator, left, right) => {
                let values = (self.evaluate(left, scope), self.evaluate(right, scope));
                let scalars = [values.0.as_scalar(), values.1.as_scalar()];
                let value = self.binary(operator.node, values, (left.span, right.span), operator.span);
                self.follow_angles(operator.node, [left, right], scalars, &value);
                value
            }
            ExpressionKind::If(condition, yes, no) => self.conditional(condition, yes, no, scope),
            ExpressionKind::Bound(bound) => self.unbound(bound, expression.span),
            ExpressionKind::Error => Value::Poison,
        };
        if value.greatest_power() > limits::POWER.most {
            self.report(limits::POWER.exceeded(expression.span));
            return Value::Poison;
        }
        value
    }

    /// An expression that must have a dimension.
    pub(crate) fn scalar(
        &mut self,
        expression: &Expression,
        scope: &Scope<'g>,
        wanted: Dimension,
        what: impl fmt::Display + Copy,
    ) -> Option<Expr<'g>> {
        let value = self.evaluate(expression, scope);
        self.require(&value, wanted, expression.span, what)
    }

    /// An expression that must be a vector of two or three of one dimension.
    pub(crate) fn vector<const N: usize>(
        &mut self,
        expression: &Expression,
        scope: &Scope<'g>,
        wanted: Dimension,
        what: impl fmt::Display + Copy,
    ) -> Option<[Expr<'g>; N]> {
        let value = self.evaluate(expression, scope);
        let parts = match &value {
            Value::Poison => return None,
            Value::Vector(parts) if parts.len() == N => parts,
            other => {
                let message = format!("{what} must be a vector of {N}, this is {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, expression.span, message));
                return None;
            }
        };
        let written = expression.parts(N);
        let names = ["x", "y", "z"];
        let found: [Option<Expr<'g>>; N] = std::array::from_fn(|k| {
            self.require(&parts[k], wanted, written[k].span, format_args!("{} of {what}", names[k]))
        });
        found.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// Both ends of a range as numbers; `None` where they are not known (or wrong, and reported).
    pub(crate) fn range(
        &mut self,
        range: &Range,
        scope: &Scope<'g>,
        wanted: Dimension,
        what: impl fmt::Display + Copy,
    ) -> Option<(f64, f64)> {
        self.ends(range, scope, wanted, what).map(|(values, _)| values)
    }

    /// Both ends of a range as numbers, and as they are written.
    pub(crate) fn ends(
        &mut self,
        range: &Range,
        scope: &Scope<'g>,
        wanted: Dimension,
        what: impl fmt::Display + Copy,
    ) -> Option<((f64, f64), [Expr<'g>; 2])> {
        let low = self.scalar(&range.low, scope, wanted, format_args!("the lower end of {what}"));
        let high = self.scalar(&range.high, scope, wanted, format_args!("the upper end of {what}"));
        let low_value =
            low.and_then(|low| self.require_constant(low, range.low.span, format_args!("the range of {what}")));
        let high_value =
            high.and_then(|high| self.require_constant(high, range.high.span, format_args!("the range of {what}")));
        let (low_value, high_value) = (low_value?, high_value?);
        if low_value >= high_value {
            self.report_empty(range, [low_value, high_value], wanted, what);
            return None;
        }
        Some(((low_value, high_value), [low?, high?]))
    }

    /// Reports a range whose ends are one, or the wrong way round.
    pub(crate) fn report_empty(
        &mut self,
        range: &Range,
        [low, high]: [f64; 2],
        of: Dimension,
        what: impl fmt::Display,
    ) {
        let is_turned = low > high;
        let help = if is_turned { "put the smaller end first" } else { "give it two different ends" };
        let [low, high] =
            [(low, &range.low), (high, &range.high)].map(|(end, written)| dimension::shown_like(end, of, written));
        let message = format!("the range of {what} is empty: {low} is not below {high}");
        let empty = Diagnostic::new(Code::EmptyRange, range.span, message).help(help);
        self.report(if is_turned {
            empty.rewriting(Rewriting::Exchange([range.low.span, range.high.span]))
        } else {
            empty
        });
    }

    /// A dimension as written.
    pub(crate) fn dimension(&mut self, written: &ast::Dimension) -> Option<Dimension> {
        let mut product = Dimension::NUMBER;
        for (name, exponent) in &written.factors {
            match dimension::named(&name.node) {
                Some(base) => product = product.times(base.power(*exponent)),
                None => {
                    self.unknown(name, "dimension", ["length", "angle", "number", "count"].into_iter());
                    return None;
                }
            }
        }
        if product.greatest_power() > limits::POWER.most {
            self.report(limits::POWER.exceeded(written.span));
            return None;
        }
        Some(product)
    }

    fn number(&mut self, value: f64, units: &[(crate::diagnostics::source::Name, i32)], span: Span) -> Value<'g> {
        let (mut number, mut product) = (value, Dimension::NUMBER);
        for (name, exponent) in units {
            let Some((_, base)) = dimension::unit_size(&name.node) else {
                self.unknown(name, "unit", ["mm", "um", "cm", "inch", "deg", "rad", "rev"].into_iter());
                return Value::Poison;
            };
            number = dimension::convert(number, &name.node, *exponent).unwrap_or(f64::NAN);
            product = product.times(base.power(*exponent));
        }
        if !number.is_finite() {
            self.not_finite(number, None, span, "this number");
            return Value::Poison;
        }
        Value::Scalar(self.graph.constant(number), product)
    }

    fn path(&mut self, path: &ast::Path, scope: &Scope<'g>) -> Value<'g> {
        let joined = match &path.segments[..] {
            [only] => Cow::Borrowed(only.node.as_str()),
            segments => segments.iter().map(|segment| segment.node.as_str()).collect::<Vec<_>>().join(".").into(),
        };
        if let Some(value) = scope.get(&*joined) {
            // lists of lists of lists: what is copied is paid for
            return if self.spend(value.size(), path.span) { value.clone() } else { Value::Poison };
        }
        if joined == "pi" {
            return Value::Scalar(self.graph.constant(std::f64::consts::PI), Dimension::NUMBER);
        }
        if self.moving.contains(&*joined) {
            let message = format!("`{joined}` moves, and what is stated here must stand still");
            let help = format!(
                "name `{joined}` where it moves something: in a transform of a frame, in `couple`, or in a `let`"
            );
            self.report(Diagnostic::new(Code::NotConstant, path.span, message).help(help));
            return Value::Poison;
        }
        // what is wrong with the whole has been reported
        let known = path.segments.iter().take(path.segments.len() - 1);
        let mut whole = String::new();
        for segment in known {
            whole.push_str(&segment.node);
            if matches!(scope.get(&whole), Some(Value::Poison)) {
                return Value::Poison;
            }
            whole.push('.');
        }
        let name = crate::diagnostics::source::Spanned { node: joined.into_owned(), span: path.span };
        self.unknown_value(&name, scope.keys().map(String::as_str));
        Value::Poison
    }

    fn index(&mut self, vector: &Expression, index: &Expression, scope: &Scope<'g>) -> Value<'g> {
        let value = self.evaluate(vector, scope);
        let Some(position) = self.scalar(index, scope, Dimension::NUMBER, "an index") else {
            return Value::Poison;
        };
        let Some(position) = self.require_constant(position, index.span, "an index") else {
            return Value::Poison;
        };
        match value {
            Value::Vector(parts) if position.fract() == 0.0 && (0.0..parts.len() as f64).contains(&position) => {
                parts[position as usize].clone()
            }
            Value::Vector(parts) => {
                let message = format!("there is no element {position} in a vector of {}", parts.len());
                self.report(Diagnostic::new(Code::WrongArguments, index.span, message).help("elements count from 0"));
                Value::Poison
            }
            Value::Poison => Value::Poison,
            other => {
                let message = format!("only a vector has elements, this is {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, vector.span, message));
                Value::Poison
            }
        }
    }

    fn unary(&mut self, operator: UnaryOperator, value: Value<'g>, span: Span) -> Value<'g> {
        match (operator, value) {
            (_, Value::Poison) => Value::Poison,
            (UnaryOperator::Negate, Value::Scalar(expr, dimension)) => Value::Scalar(-expr, dimension),
            (UnaryOperator::Negate, Value::Vector(parts)) => {
                Value::Vector(parts.into_iter().map(|part| self.unary(operator, part, span)).collect())
            }
            (UnaryOperator::Not, Value::Truth(truth)) => Value::Truth(truth.map(|truth| !truth)),
            (_, other) => {
                let wanted = if operator == UnaryOperator::Not { "a condition" } else { "a number or a vector" };
                let message = format!("this must be {wanted}, it is {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, span, message));
                Value::Poison
            }
        }
    }

    pub(super) fn binary(
        &mut self,
        operator: BinaryOperator,
        values: (Value<'g>, Value<'g>),
        spans: (Span, Span),
        operator_span: Span,
    ) -> Value<'g> {
        use BinaryOperator as Op;
        match (operator, values) {
            (_, (Value::Poison, _) | (_, Value::Poison)) => Value::Poison,
            (Op::Add | Op::Subtract, (Value::Scalar(a, da), Value::Scalar(b, db))) => {
                self.sum(operator, (a, da), (b, db), spans, operator_span)
            }
            (Op::Add | Op::Subtract, (Value::Vector(a), Value::Vector(b))) if a.len() == b.len() => Value::Vector(
                a.into_iter().zip(b).map(|pair| self.binary(operator, pair, spans, operator_span)).collect(),
            ),
            (Op::Multiply, (Value::Scalar(a, da), Value::Scalar(b, db))) => Value::Scalar(a * b, da.times(db)),
            (Op::Divide, (Value::Scalar(a, da), Value::Scalar(b, db))) => self.quotient((a, da), (b, db), spans.1),
            (Op::Multiply, (factor @ Value::Scalar(..), Value::Vector(parts)))
            | (Op::Multiply | Op::Divide, (Value::Vector(parts), factor @ Value::Scalar(..))) => Value::Vector(
                parts
                    .into_iter()
                    .map(|part| self.binary(operator, (part, factor.clone()), spans, operator_span))
                    .collect(),
            ),
            (Op::Power, (Value::Scalar(a, da), Value::Scalar(b, db))) => self.power((a, da), (b, db), spans),
            (Op::And | Op::Or, (Value::Truth(a), Value::Truth(b))) => Value::Truth(match (operator, a, b) {
                (Op::And, Some(false), _) | (Op::And, _, Some(false)) => Some(false),
                (Op::Or, Some(true), _) | (Op::Or, _, Some(true)) => Some(true),
                (_, Some(a), Some(_)) => Some(a),
                _ => None,
            }),
            (
                Op::Less | Op::LessEqual | Op::Greater | Op::GreaterEqual | Op::Equal | Op::NotEqual,
                (Value::Scalar(a, da), Value::Scalar(b, db)),
            ) => self.comparison(operator, (a, da), (b, db), spans),
            (_, (a, b)) => {
                let message =
                    format!("`{}` does not go with {} and {}", symbol(operator), a.described(), b.described());
                self.report(Diagnostic::new(Code::WrongDimension, operator_span, message));
                Value::Poison
            }
        }
    }

    fn sum(
        &mut self,
        operator: BinaryOperator,
        (a, da): (Expr<'g>, Dimension),
        (b, db): (Expr<'g>, Dimension),
        spans: (Span, Span),
        operator_span: Span,
    ) -> Value<'g> {
        let add = operator == BinaryOperator::Add;
        // an angle is a number where it must be: cos(g) + xi * sin(g); a bare constant beside it is a forgotten unit
        let plain = [(a, da), (b, db)].iter().any(|(x, d)| *d == Dimension::NUMBER && x.as_constant().is_some());
        let mixed =
            [da, db] == [Dimension::NUMBER, Dimension::ANGLE] || [da, db] == [Dimension::ANGLE, Dimension::NUMBER];
        let sum = if mixed && !plain { Some(Dimension::NUMBER) } else { da.sum(db) };
        if let Some(dimension) = sum {
            return Value::Scalar(if add { a + b } else { a - b }, dimension);
        }
        let verb = if add { "add" } else { "subtract" };
        let message = format!("cannot {verb} {da} and {db}");
        let diagnostic = Diagnostic::new(Code::WrongDimension, operator_span, message)
            .note(spans.0, Value::Scalar(a, da).described())
            .note(spans.1, Value::Scalar(b, db).described());
        self.report(with_missing_unit(diagnostic, [(a, da, spans.0), (b, db, spans.1)]));
        Value::Poison
    }

    fn quotient(&mut self, (a, da): (Expr<'g>, Dimension), (b, db): (Expr<'g>, Dimension), span: Span) -> Value<'g> {
        if b.is_zero() {
            self.report(Diagnostic::new(Code::NotANumber, span, "division by zero"));
            return Value::Poison;
        }
        Value::Scalar(a / b, da.over(db))
    }

    fn power(
        &mut self,
        (base, base_dimension): (Expr<'g>, Dimension),
        (exponent, exponent_dimension): (Expr<'g>, Dimension),
        spans: (Span, Span),
    ) -> Value<'g> {
        if exponent_dimension != Dimension::NUMBER {
            let message =
                format!("an exponent must be a number, this is {} {exponent_dimension}", article(exponent_dimension));
            self.report(Diagnostic::new(Code::WrongDimension, spans.1, message));
            return Value::Poison;
        }
        let whole =
            exponent.as_constant().filter(|value| value.fract() == 0.0 && value.abs() <= limits::POWER.most as f64);
        match whole {
            Some(whole) => Value::Scalar(base.powi(whole as i32), base_dimension.power(whole as i32)),
            None if base_dimension.length == 0 => Value::Scalar(base.pow(exponent), Dimension::NUMBER),
            None if exponent.as_constant().is_some_and(|value| value.fract() == 0.0) => {
                self.report(limits::POWER.exceeded(spans.1));
                Value::Poison
            }
            None => {
                let message = format!("a {base_dimension} can only be raised to a whole constant power");
                let help = match self.constant(exponent) {
                    Constant::Known(value) if value.fract() == 0.0 => {
                        "write the number itself: a dimension does not depend on parameters"
                    }
                    _ => "`sqrt` takes the root of an area",
                };
                self.report(Diagnostic::new(Code::WrongDimension, spans.1, message).help(help));
                Value::Poison
            }
        }
    }

    fn comparison(
        &mut self,
        operator: BinaryOperator,
        (a, da): (Expr<'g>, Dimension),
        (b, db): (Expr<'g>, Dimension),
        spans: (Span, Span),
    ) -> Value<'g> {
        if da.sum(db).is_none() {
            let message = format!("cannot compare {da} and {db}");
            let diagnostic = Diagnostic::new(Code::WrongDimension, spans.0.to(spans.1), message);
            self.report(with_missing_unit(diagnostic, [(a, da, spans.0), (b, db, spans.1)]));
            return Value::Poison;
        }
        for (side, span) in [(a, spans.0), (b, spans.1)] {
            if let Constant::Moves(name) = self.constant(side) {
                let message = format!("a condition must be decided before anything moves, but depends on {name}");
                self.report(Diagnostic::new(Code::NotConstant, span, message));
                return Value::Poison;
            }
        }
        let (Constant::Known(a), Constant::Known(b)) = (self.constant(a), self.constant(b)) else {
            return Value::Truth(None);
        };
        Value::Truth(Some(match operator {
            BinaryOperator::Less => a < b,
            BinaryOperator::LessEqual => a <= b,
            BinaryOperator::Greater => a > b,
            BinaryOperator::GreaterEqual => a >= b,
            BinaryOperator::NotEqual => a != b,
            _ => a == b,
        }))
    }

    /// Whether a condition holds, if its values are known; nothing if it is none (which has been reported).
    pub(crate) fn truth(&mut self, condition: &Expression, scope: &Scope<'g>) -> Option<Option<bool>> {
        match self.evaluate(condition, scope) {
            Value::Truth(truth) => Some(truth),
            Value::Poison => None,
            other => {
                let message = format!("this must be a condition, it is {}", other.described());
                let help = "compare it with something, as in `a > 0`";
                self.report(Diagnostic::new(Code::WrongDimension, condition.span, message).help(help));
                None
            }
        }
    }

    fn conditional(
        &mut self,
        condition: &Expression,
        yes: &Expression,
        no: &Expression,
        scope: &Scope<'g>,
    ) -> Value<'g> {
        let Some(truth) = self.truth(condition, scope) else { return Value::Poison };
        match truth {
            Some(true) => self.evaluate(yes, scope),
            Some(false) => self.evaluate(no, scope),
            // a definition without values: both ways are looked at
            None => {
                let (yes_value, no_value) = (self.evaluate(yes, scope), self.evaluate(no, scope));
                if let (Value::Scalar(_, a), Value::Scalar(_, b)) = (&yes_value, &no_value)
                    && a.sum(*b).is_none()
                {
                    let message =
                        format!("`then` gives {}, but `else` gives {}", yes_value.described(), no_value.described());
                    self.report(Diagnostic::new(Code::WrongDimension, no.span, message));
                    return Value::Poison;
                }
                yes_value
            }
        }
    }

    fn call(&mut self, call: &ast::Call, scope: &Scope<'g>) -> Value<'g> {
        match call.function.node.as_str() {
            "curve" => return tables::curve(self, call),
            "grid" => return grids::grid(self, call),
            "sum" => return self.total(call, scope),
            "integral" => return self.integral(call, scope),
            "root" => return self.root(call, scope),
            "derivative" => return self.derivative(call, scope),
            _ => {}
        }
        match scope.get(&call.function.node) {
            Some(Value::Curve(curve, x, y)) => return self.on_curve(call, (*curve, *x, *y), scope),
            Some(Value::Grid(grid)) => return self.on_grid(call, &grid.clone(), scope),
            Some(Value::Segment(segment)) => return self.on_segment(call, &segment.clone(), scope),
            Some(Value::Profile(_)) => return self.outside_profile(call),
            Some(Value::Poison) => return Value::Poison,
            _ => {}
        }
        let Some(function) = self.functions.get(&call.function.node).cloned() else {
            return functions::call(self, call, scope);
        };
        if self.call_depth >= limits::CALL_DEPTH.most {
            self.report(limits::CALL_DEPTH.exceeded(call.function.span));
            return Value::Poison;
        }
        // it did not parse: how many arguments it takes is not known
        if matches!(function.body.kind, ExpressionKind::Error) {
            call.arguments.iter().for_each(|argument| drop(self.evaluate(&argument.value, scope)));
            return Value::Poison;
        }
        let count = function.arguments.len();
        let taken = |context: &mut Context<'g>| functions::parameters(context, &function);
        let Some(arguments) = functions::arguments(self, call, count, scope, taken) else {
            return Value::Poison;
        };
        let mut inner = Scope::new();
        let mut own = Vec::new();
        for ((value, given), (name, written)) in arguments.into_iter().zip(&function.arguments) {
            let what = format_args!("`{}` of `{}`", name.node, function.name.node);
            let findings = self.findings();
            let Some(value) = self.of_type(&value, written, given, what) else {
                let taken = functions::parameters(self, &function);
                self.help_since(findings, &taken);
                return Value::Poison;
            };
            let value = match value {
                Value::Scalar(given, dimension) if function.differentiates_by(&name.node) => {
                    let variable = self.own_variable(name, given);
                    own.push((variable, given));
                    Value::Scalar(variable, dimension)
                }
                other => other,
            };
            inner.insert(name.node.clone(), value);
        }
        self.call_depth += 1;
        let value = self.function_body(&function, inner);
        self.call_depth -= 1;
        self.with_given(value, &own, call.span)
    }

    fn on_curve(
        &mut self,
        call: &ast::Call,
        (curve, x, y): (CurveId, Dimension, Dimension),
        scope: &Scope<'g>,
    ) -> Value<'g> {
        let Some(arguments) = functions::arguments(self, call, 1, scope, |_| format!("it takes {} {x}", article(x)))
        else {
            return Value::Poison;
        };
        let what = format_args!("the argument of `{}`", call.function.node);
        match self.require(&arguments[0].0, x, arguments[0].1.span, what) {
            Some(at) => Value::Scalar(at.on_curve(curve, 0), y),
            None => Value::Poison,
        }
    }

    /// The point of a profile in a surface along it.
    fn on_segment(&mut self, call: &ast::Call, segment: &Segment<'g>, scope: &Scope<'g>) -> Value<'g> {
        let Some(arguments) =
            functions::arguments(self, call, 1, scope, |_| "it takes a length, the run along it".to_string())
        else {
            return Value::Poison;
        };
        let what = format_args!("the argument of `{}`", call.function.node);
        match self.require(&arguments[0].0, Dimension::LENGTH, arguments[0].1.span, what) {
            Some(run) => Value::Vector(segment.point(run).map(|x| Value::Scalar(x, Dimension::LENGTH)).into()),
            None => Value::Poison,
        }
    }

    fn outside_profile(&mut self, call: &ast::Call) -> Value<'g> {
        let name = &call.function.node;
        let message = format!("which segment of `{name}` is meant shows only in a surface along it");
        let help = format!("give the surface a parameter such as `s: along {name}`");
        self.report(Diagnostic::new(Code::WrongKind, call.function.span, message).help(help));
        Value::Poison
    }

    /// The value of a function whose arguments are in the scope.
    pub(crate) fn function_body(&mut self, function: &ast::Function, mut scope: Scope<'g>) -> Value<'g> {
        for binding in &function.lets {
            let value = self.evaluate(&binding.value, &scope);
            scope.insert(binding.name.node.clone(), value);
        }
        let value = self.evaluate(&function.body, &scope);
        let Some(promised) = &function.result else {
            return value;
        };
        let what = format_args!("the value of `{}`", function.name.node);
        self.of_type(&value, promised, &function.body, what).unwrap_or(Value::Poison)
    }

    /// A value of a type, which may be better known by it than by itself: an angle where a number is wanted.
    fn of_type(
        &mut self,
        value: &Value<'g>,
        wanted: &ast::Type,
        written: &Expression,
        what: impl fmt::Display + Copy,
    ) -> Option<Value<'g>> {
        let dimension = self.dimension(&wanted.dimension)?;
        let Some(size) = wanted.size else {
            let value = self.require(value, dimension, written.span, what)?;
            return Some(Value::Scalar(self.counted(value, wanted, written, what)?, dimension));
        };
        match value {
            Value::Poison => None,
            Value::Vector(parts) if parts.len() == size => {
                let mut found = Vec::new();
                for (k, (part, written)) in parts.iter().zip(written.parts(size)).enumerate() {
                    let what = format_args!("element {k} of {what}");
                    let part = self.require(part, dimension, written.span, what)?;
                    let part = self.counted(part, wanted, written, what)?;
                    found.push(Value::Scalar(part, dimension));
                }
                Some(Value::Vector(found))
            }
            other => {
                let message = format!("{what} must be a vector of {size}, this is {}", other.described());
                self.report(Diagnostic::new(Code::WrongDimension, written.span, message));
                None
            }
        }
    }

    /// A value as it is, unless a count is wanted and it is none: counts are whole, from 0 where no range of their own says otherwise, and what
    /// moves is one only as a motion that counts.
    fn counted(
        &mut self,
        value: Expr<'g>,
        wanted: &ast::Type,
        written: &Expression,
        what: impl fmt::Display,
    ) -> Option<Expr<'g>> {
        if !wanted.dimension.is_count() || self.is_count(value) {
            return Some(value);
        }
        let help = "what need not be a whole number from 0 is a `number`";
        let (code, message) = match self.constant_kept(value) {
            Constant::Known(number) if number.is_finite() && number.fract() != 0.0 => {
                (Code::WrongDimension, format!("{what} is a count: it must be a whole number, not {number}"))
            }
            Constant::Known(number) if number < 0.0 => {
                (Code::WrongDimension, format!("{what} is a count, and {number} is below 0"))
            }
            Constant::Moves(name) => {
                (Code::NotConstant, format!("{what} is a count and must stand still, but depends on {name}"))
            }
            Constant::Known(_) | Constant::Unknown => return Some(value),
        };
        self.report(Diagnostic::new(code, written.span, message).help(help));
        None
    }
}

/// Says what to write where a plain number meets a length or an angle.
fn with_missing_unit<'g>(diagnostic: Diagnostic, [a, b]: [(Expr<'g>, Dimension, Span); 2]) -> Diagnostic {
    let (number, (other, dimension, place)) = if a.1 == Dimension::NUMBER { (a, b) } else { (b, a) };
    let (Some(value), Dimension::NUMBER) = (number.0.as_constant(), number.1) else { return diagnostic };
    match dimension {
        Dimension::LENGTH => {
            let help = format!("give the number its unit: `{value} mm`");
            diagnostic.help(help).rewriting(Rewriting::Unit(number.2, "mm"))
        }
        Dimension::ANGLE => {
            let [unit, number] = [Rewriting::Unit(number.2, "deg"), Rewriting::Per(place, "rad")];
            // `20 + tilt` lacks a unit; `1 + e * cos(g)` is a number, and so is the angle in it
            let is_value = other.as_variable().is_some() || other.as_constant().is_some();
            if is_value && value.abs() != 1.0 {
                let help = format!("give the number its unit (`{value} deg`), or make the angle a number by `/ 1 rad`");
                diagnostic.help(help).rewriting(unit).rewriting(number)
            } else {
                let help = format!("make the angle a number by `/ 1 rad`, or give the number its unit (`{value} deg`)");
                diagnostic.help(help).rewriting(number).rewriting(unit)
            }
        }
        _ => diagnostic,
    }
}

fn symbol(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => "+",
        BinaryOperator::Subtract => "-",
        BinaryOperator::Multiply => "*",
        BinaryOperator::Divide => "/",
        BinaryOperator::Power => "^",
        BinaryOperator::Less => "<",
        BinaryOperator::LessEqual => "<=",
        BinaryOperator::Greater => ">",
        BinaryOperator::GreaterEqual => ">=",
        BinaryOperator::Equal => "==",
        BinaryOperator::NotEqual => "!=",
        BinaryOperator::And => "and",
        BinaryOperator::Or => "or",
    }
}
