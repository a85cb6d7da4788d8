//! What machines, tools and jobs demand of their values.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::syntax::ast::{Expression, ExpressionKind, Path, Requirement};
use crate::values::context::Context;
use crate::values::dimension::shown;
use crate::values::value::{Constant, Scope, Value};

/// Reports a requirement that does not hold, at the place of the one who gives the values: that of the machine or tool in its
/// job, else the condition itself. Without values nothing is asked.
pub(crate) fn check<'g>(context: &mut Context<'g>, required: &Requirement, scope: &Scope<'g>, user: Option<Span>) {
    let condition = &required.condition;
    if context.truth(condition, scope) != Some(Some(false)) {
        return;
    }
    let why = match values(context, condition, scope).as_slice() {
        [] => "this does not hold".to_owned(),
        values => format!("this does not hold: {}", values.join(", ")),
    };
    let diagnostic = Diagnostic::new(Code::Unmet, user.unwrap_or(condition.span), required.message.clone());
    context.report(diagnostic.note(condition.span, why));
}

/// The names of an expression with their values, each once, in the order in which they are written.
fn values<'g>(context: &mut Context<'g>, expression: &Expression, scope: &Scope<'g>) -> Vec<String> {
    let mut paths: Vec<&Path> = Vec::new();
    expression.each(&mut |part| {
        if let ExpressionKind::Path(path) = &part.kind {
            paths.push(path);
        }
    });
    let mut found: Vec<String> = Vec::new();
    for path in paths {
        let written = Expression { kind: ExpressionKind::Path(path.clone()), span: path.span };
        let names: Vec<&str> = path.segments.iter().map(|segment| segment.node.as_str()).collect();
        // what a sum runs over has no single value
        if !scope.contains_key(&names.join(".")) {
            continue;
        }
        if let Value::Scalar(value, dimension) = context.evaluate(&written, scope)
            && let Constant::Known(value) = context.constant(value)
        {
            let said = format!("`{}` is {}", names.join("."), shown(value, dimension));
            if !found.contains(&said) {
                found.push(said);
            }
        }
    }
    found
}
