//! The functions that the language brings along.

use std::fmt;

use flank_expr::geometry::Vector3;
use flank_expr::{Binary, Expr, Unary};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::syntax::ast;
use crate::values::context::Context;
use crate::values::dimension::Dimension;
use crate::values::value::{Scope, Value, article};

/// What a function takes and gives.
#[derive(Clone, Copy)]
enum Function {
    /// Angle in, number out.
    OfAngle(Unary),
    /// Number in, angle out.
    ToAngle(Unary),
    /// Number in, number out.
    OfNumber(Unary),
    Abs,
    /// Two of one dimension in, the same out.
    Choice(Binary),
    Sqrt,
    Hypot,
    Atan2,
    Involute,
    ArcInvolute,
    /// Σ cₖ·xᵏ
    Poly,
    /// Σ aₖ·xᵏ/k!
    Taylor,
    Dot,
    Cross,
    Norm,
}

impl Function {
    /// What it takes, in words.
    fn taken(self) -> String {
        let what = match self {
            Function::OfAngle(_) | Function::Involute => "an angle",
            Function::ToAngle(_) | Function::OfNumber(_) | Function::ArcInvolute => "a number",
            Function::Abs | Function::Sqrt => "a number, a length or an angle",
            Function::Choice(_) | Function::Hypot => "two values of one dimension",
            Function::Atan2 => "`y` and `x` of one dimension",
            Function::Poly | Function::Taylor => "a variable and a list of coefficients",
            Function::Dot | Function::Cross => "two vectors of 3",
            Function::Norm => "a vector of 3",
        };
        format!("it takes {what}")
    }
}

/// What a function of the user takes, in words: `turn`, an angle, and so on.
pub(crate) fn parameters(context: &mut Context<'_>, function: &ast::Function) -> String {
    let mut each = Vec::new();
    for (name, written) in &function.arguments {
        let dimension = context.dimension(&written.dimension).map_or(String::new(), |found| found.to_string());
        let size = written.size.map_or(String::new(), |size| format!("[{size}]"));
        each.push(format!("`{}` ({dimension}{size})", name.node));
    }
    format!("it takes {}", each.join(", "))
}

const FUNCTIONS: [(&str, usize, Function); 27] = [
    ("sin", 1, Function::OfAngle(Unary::Sin)),
    ("cos", 1, Function::OfAngle(Unary::Cos)),
    ("tan", 1, Function::OfAngle(Unary::Tan)),
    ("asin", 1, Function::ToAngle(Unary::Asin)),
    ("acos", 1, Function::ToAngle(Unary::Acos)),
    ("atan", 1, Function::ToAngle(Unary::Atan)),
    ("sinh", 1, Function::OfNumber(Unary::Sinh)),
    ("cosh", 1, Function::OfNumber(Unary::Cosh)),
    ("tanh", 1, Function::OfNumber(Unary::Tanh)),
    ("asinh", 1, Function::OfNumber(Unary::Asinh)),
    ("acosh", 1, Function::OfNumber(Unary::Acosh)),
    ("atanh", 1, Function::OfNumber(Unary::Atanh)),
    ("exp", 1, Function::OfNumber(Unary::Exp)),
    ("ln", 1, Function::OfNumber(Unary::Ln)),
    ("abs", 1, Function::Abs),
    ("min", 2, Function::Choice(Binary::Min)),
    ("max", 2, Function::Choice(Binary::Max)),
    ("sqrt", 1, Function::Sqrt),
    ("hypot", 2, Function::Hypot),
    ("atan2", 2, Function::Atan2),
    ("inv", 1, Function::Involute),
    ("arcinv", 1, Function::ArcInvolute),
    ("poly", 2, Function::Poly),
    ("taylor", 2, Function::Taylor),
    ("dot", 2, Function::Dot),
    ("cross", 2, Function::Cross),
    ("norm", 1, Function::Norm),
];

/// Calls of a form of their own.
const FORMS: [&str; 4] = ["sum", "integral", "root", "derivative"];

/// Names of the functions that the language brings along.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, ..)| *name).chain(FORMS)
}

/// A value and what it is written as.
pub(crate) type Argument<'a, 'g> = (Value<'g>, &'a ast::Expression);

/// The arguments of a call that takes `count` of them by position; `taken` says which, where they are not so many.
pub(crate) fn arguments<'a, 'g>(
    context: &mut Context<'g>,
    call: &'a ast::Call,
    count: usize,
    scope: &Scope<'g>,
    taken: impl FnOnce(&mut Context<'g>) -> String,
) -> Option<Vec<Argument<'a, 'g>>> {
    let name = &call.function.node;
    if call.arguments.len() != count {
        let message = format!("`{name}` takes {count} argument{}, not {}", plural(count), call.arguments.len());
        let wrong = Diagnostic::new(Code::WrongArguments, call.span, message);
        let taken = taken(context);
        context.report(if count > 0 { wrong.help(taken) } else { wrong });
        return None;
    }
    if let Some(named) = call.arguments.iter().find_map(|argument| argument.name.as_ref()) {
        let message = format!("arguments of `{name}` have no names");
        context.report(Diagnostic::new(Code::WrongArguments, named.span, message));
        return None;
    }
    Some(call.arguments.iter().map(|argument| (context.evaluate(&argument.value, scope), &argument.value)).collect())
}

pub(crate) fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// The value of a call of a function that is not the user's.
pub(crate) fn call<'g>(context: &mut Context<'g>, call: &ast::Call, scope: &Scope<'g>) -> Value<'g> {
    let Some((_, count, function)) = FUNCTIONS.iter().find(|(name, ..)| *name == call.function.node) else {
        if !context.tells_more() {
            return Value::Poison;
        }
        let own: Vec<String> = context.functions.keys().cloned().collect();
        let known: Vec<&str> = names().map(|name| -> &str { name }).chain(own.iter().map(String::as_str)).collect();
        context.unknown_item(&call.function, "function", known.into_iter());
        return Value::Poison;
    };
    let Some(arguments) = arguments(context, call, *count, scope, |_| function.taken()) else {
        return Value::Poison;
    };
    if arguments.iter().any(|(value, _)| matches!(value, Value::Poison)) {
        return Value::Poison;
    }
    apply(context, *function, &call.function.node, &arguments).unwrap_or(Value::Poison)
}

fn apply<'g>(
    context: &mut Context<'g>,
    function: Function,
    name: &str,
    arguments: &[Argument<'_, 'g>],
) -> Option<Value<'g>> {
    use Dimension as D;
    let what = format_args!("the argument of `{name}`");
    let one = |context: &mut Context<'g>, wanted| context.require(&arguments[0].0, wanted, arguments[0].1.span, what);
    Some(match function {
        Function::OfAngle(op) => Value::Scalar(one(context, D::ANGLE)?.unary(op), D::NUMBER),
        Function::ToAngle(op) => Value::Scalar(as_number(context, &arguments[0], what)?.unary(op), D::ANGLE),
        Function::OfNumber(op) => Value::Scalar(as_number(context, &arguments[0], what)?.unary(op), D::NUMBER),
        Function::Involute => {
            let angle = one(context, D::ANGLE)?;
            Value::Scalar(angle.tan() - angle, D::ANGLE)
        }
        Function::ArcInvolute => {
            let (involute, dimension) = any_scalar(context, &arguments[0], what)?;
            if dimension.length != 0 {
                one(context, D::ANGLE)?;
            }
            Value::Scalar(involute.unary(Unary::Arcinv), D::ANGLE)
        }
        Function::Abs => {
            let (x, dimension) = any_scalar(context, &arguments[0], what)?;
            Value::Scalar(x.abs(), dimension)
        }
        Function::Sqrt => {
            let (x, dimension) = any_scalar(context, &arguments[0], what)?;
            let Some(root) = dimension.root().or((dimension.length == 0).then_some(D::NUMBER)) else {
                let message = format!("there is no square root of a {dimension}");
                context.report(Diagnostic::new(Code::WrongDimension, arguments[0].1.span, message));
                return None;
            };
            Value::Scalar(x.sqrt(), root)
        }
        Function::Choice(op) => {
            let (a, b, dimension) = alike(context, name, arguments)?;
            Value::Scalar(a.binary(op, b), dimension)
        }
        Function::Hypot => {
            let (a, b, dimension) = alike(context, name, arguments)?;
            Value::Scalar((a * a + b * b).sqrt(), dimension)
        }
        Function::Atan2 => {
            let (a, b, _) = alike(context, name, arguments)?;
            Value::Scalar(a.atan2(b), D::ANGLE)
        }
        Function::Poly | Function::Taylor => {
            polynomial(context, arguments, name, matches!(function, Function::Taylor))?
        }
        Function::Dot | Function::Cross => product(context, function, name, arguments)?,
        Function::Norm => {
            let (v, dimension) = vector(context, &arguments[0], name)?;
            Value::Scalar(v.norm(), dimension)
        }
    })
}

/// A number; an angle is one where a function wants a number.
fn as_number<'g>(context: &mut Context<'g>, argument: &Argument<'_, 'g>, what: impl fmt::Display) -> Option<Expr<'g>> {
    match argument.0 {
        Value::Scalar(expr, dimension) if dimension.length == 0 => Some(expr),
        _ => context.require(&argument.0, Dimension::NUMBER, argument.1.span, what),
    }
}

fn any_scalar<'g>(
    context: &mut Context<'g>,
    argument: &Argument<'_, 'g>,
    what: impl fmt::Display,
) -> Option<(Expr<'g>, Dimension)> {
    match &argument.0 {
        Value::Scalar(expr, dimension) => Some((*expr, *dimension)),
        Value::Poison => None,
        other => {
            let message = format!("{what} must be a number, a length or an angle, this is {}", other.described());
            context.report(Diagnostic::new(Code::WrongDimension, argument.1.span, message));
            None
        }
    }
}

/// Two scalars of one dimension.
fn alike<'g>(
    context: &mut Context<'g>,
    name: &str,
    arguments: &[Argument<'_, 'g>],
) -> Option<(Expr<'g>, Expr<'g>, Dimension)> {
    let what = format_args!("the argument of `{name}`");
    let (a, da) = any_scalar(context, &arguments[0], what)?;
    let (b, db) = any_scalar(context, &arguments[1], what)?;
    let Some(dimension) = da.sum(db) else {
        let message = format!("`{name}` takes two values of one dimension, not {da} and {db}");
        context.report(Diagnostic::new(Code::WrongDimension, arguments[1].1.span, message));
        return None;
    };
    Some((a, b, dimension))
}

/// By Horner's scheme; the terms must add up in dimension.
fn polynomial<'g>(
    context: &mut Context<'g>,
    arguments: &[Argument<'_, 'g>],
    name: &str,
    factorials: bool,
) -> Option<Value<'g>> {
    let (x, x_dimension) = any_scalar(context, &arguments[0], format_args!("the variable of `{name}`"))?;
    let Value::Vector(coefficients) = &arguments[1].0 else {
        let message = format!("`{name}` takes a list of coefficients `[c0, c1, …]`");
        context.report(Diagnostic::new(Code::WrongArguments, arguments[1].1.span, message));
        return None;
    };
    let mut dimension: Option<Dimension> = None;
    let mut terms = Vec::new();
    for ((k, coefficient), written) in (0i32..).zip(coefficients).zip(arguments[1].1.parts(coefficients.len())) {
        let what = format_args!("coefficient {k} of `{name}`");
        let (c, c_dimension) = any_scalar(context, &(coefficient.clone(), written), what)?;
        let term = c_dimension.times(x_dimension.power(k));
        dimension = match dimension {
            // nothing of any dimension
            _ if c.is_zero() && c_dimension == Dimension::NUMBER => dimension,
            None => Some(term),
            Some(so_far) => match so_far.sum(term) {
                Some(sum) => Some(sum),
                None => {
                    let (this, before) = (article(term), article(so_far));
                    let message =
                        format!("term {k} of `{name}` is {this} {term}, the terms before it are {before} {so_far}");
                    context.report(Diagnostic::new(Code::WrongDimension, written.span, message));
                    return None;
                }
            },
        };
        let factorial: f64 = (1..=k).map(f64::from).product();
        terms.push(if factorials { c / factorial } else { c });
    }
    let zero = context.graph.constant(0.0);
    let sum = terms.into_iter().rev().fold(zero, |sum, c| sum * x + c);
    Some(Value::Scalar(sum, dimension.unwrap_or(Dimension::NUMBER)))
}

fn vector<'g>(context: &mut Context<'g>, argument: &Argument<'_, 'g>, name: &str) -> Option<(Vector3<'g>, Dimension)> {
    let what = format_args!("the argument of `{name}`");
    let parts = match &argument.0 {
        Value::Vector(parts) if parts.len() == 3 => parts,
        Value::Poison => return None,
        other => {
            let message = format!("{what} must be a vector of 3, this is {}", other.described());
            context.report(Diagnostic::new(Code::WrongDimension, argument.1.span, message));
            return None;
        }
    };
    let mut components = Vec::new();
    let mut dimension: Option<Dimension> = None;
    for (part, written) in parts.iter().zip(argument.1.parts(3)) {
        let (expr, found) = any_scalar(context, &(part.clone(), written), what)?;
        let Some(sum) = dimension.unwrap_or(found).sum(found) else {
            let message = format!("the components of {what} have different dimensions");
            context.report(Diagnostic::new(Code::WrongDimension, written.span, message));
            return None;
        };
        dimension = Some(sum);
        components.push(expr);
    }
    Some((Vector3([components[0], components[1], components[2]]), dimension?))
}

fn product<'g>(
    context: &mut Context<'g>,
    function: Function,
    name: &str,
    arguments: &[Argument<'_, 'g>],
) -> Option<Value<'g>> {
    let (a, da) = vector(context, &arguments[0], name)?;
    let (b, db) = vector(context, &arguments[1], name)?;
    let dimension = da.times(db);
    Some(match function {
        Function::Dot => Value::Scalar(a.dot(b), dimension),
        _ => Value::Vector(a.cross(b).0.into_iter().map(|part| Value::Scalar(part, dimension)).collect()),
    })
}
