//! Surfaces that an equation gives: the border of where a condition on three parameters holds.

use flank_expr::Expr;
use flank_expr::geometry::{Surface, Vector3};

use crate::definitions::material_side;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::syntax::ast::{BinaryOperator, Expression, ExpressionKind};
use crate::values::context::{Context, quoted};
use crate::values::dimension::Dimension;
use crate::values::value::{Scope, Value};

/// Steel where the condition holds, with points at `at`; the names of the parameters are in the scope.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    (at, condition): (&Expression, &Expression),
    unknowns: &[RangedVariable<'g>],
    scope: &Scope<'g>,
) -> Option<Surface<'g>> {
    let position = context.vector(at, scope, Dimension::LENGTH, "the point");
    let function = function(context, condition, scope);
    let (position, function) = (Vector3(position?), function?);
    // the range of a parameter is wrong, and reported
    let [u, v, w] = unknowns else { return None };
    let variables = [u, v, w].map(|unknown| unknown.variable);
    let names = [u, v, w].map(|unknown| unknown.name.as_str());
    let is_fine = moves_in_space(context, at, (variables, names), position)
        && has_border(context, condition.span, &names, function)
        && has_normal(context, condition.span, unknowns, Surface::gradient(variables, position, function));
    is_fine.then(|| Surface::implicit(variables, position, function))
}

/// What is negative where the condition holds; nothing if it compares no two values (which is reported).
fn function<'g>(context: &mut Context<'g>, condition: &Expression, scope: &Scope<'g>) -> Option<Expr<'g>> {
    use BinaryOperator::{Greater, GreaterEqual, Less, LessEqual};
    let sides = match &condition.kind {
        ExpressionKind::Binary(operator, left, right) => match operator.node {
            Less | LessEqual => Some((left, right)),
            Greater | GreaterEqual => Some((right, left)),
            _ => None,
        },
        ExpressionKind::Error => return None,
        _ => None,
    };
    let Some((less, more)) = sides else {
        let message = "this does not say of the parameters where the steel lies";
        let help = "compare two values that depend on them, as `u^2 + v^2 < radius^2`";
        context.report(Diagnostic::new(Code::WrongKind, condition.span, message).help(help));
        return None;
    };
    let message = match (context.evaluate(less, scope), context.evaluate(more, scope)) {
        (Value::Poison, _) | (_, Value::Poison) => return None,
        (Value::Scalar(less, a), Value::Scalar(more, b)) if a.sum(b).is_some() => return Some(less - more),
        (Value::Scalar(_, less), Value::Scalar(_, more)) => format!("cannot compare {less} and {more}"),
        (less, more) => format!("cannot compare {} and {}", less.described(), more.described()),
    };
    context.report(Diagnostic::new(Code::WrongDimension, condition.span, message));
    None
}

/// Whether the parameters move the point in three directions; reported if not.
fn moves_in_space<'g>(
    context: &mut Context<'g>,
    at: &Expression,
    (variables, names): ([Expr<'g>; 3], [&str; 3]),
    position: Vector3<'g>,
) -> bool {
    let [along, across, up] = variables.map(|variable| position.derivative(variable));
    if !along.dot(across.cross(up)).is_zero() {
        return true;
    }
    let message = format!("this point does not move in three directions with {}", quoted(&names));
    let help = format!("let each of them move it, as `at = [{}]`", names.join(", "));
    context.report(Diagnostic::new(Code::SteelSide, at.span, message).help(help));
    false
}

/// Whether the function may be zero where the parameters lie in their ranges; reported if it is proven not to be.
fn has_border<'g>(context: &mut Context<'g>, condition: Span, names: &[&str], function: Expr<'g>) -> bool {
    let Ok(range) = context.enclosure(function) else { return true };
    if range.contains(0.0) || !range.continuous {
        return true;
    }
    let holds = if range.hi < 0.0 { "everywhere" } else { "nowhere" };
    let message = format!("this holds {holds} in the ranges of {}: the steel has no border there", quoted(names));
    let help = "let the ranges reach to both sides of the surface";
    context.report(Diagnostic::new(Code::SteelSide, condition, message).help(help));
    false
}

/// Whether the function has a gradient somewhere in the ranges; reported if not.
fn has_normal<'g>(
    context: &mut Context<'g>,
    condition: Span,
    unknowns: &[RangedVariable<'g>],
    gradient: Vector3<'g>,
) -> bool {
    if !context.spend(context.graph.size(&gradient.0), condition) {
        return false;
    }
    let Err(seen) = material_side::side(context, unknowns, gradient, gradient) else { return true };
    let names: Vec<&str> = unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    let (code, message, help) = if seen.is_undefined() {
        let message = format!("this cannot be computed anywhere in the ranges of {}", quoted(&names));
        (Code::NotANumber, message, "look for a root of a negative number, an `asin` of more than 1, 0 / 0")
    } else {
        let message = format!("this does not depend on {}", quoted(&names));
        (Code::SteelSide, message, "compare two values that change from point to point")
    };
    context.report(Diagnostic::new(code, condition, message).help(help));
    false
}
