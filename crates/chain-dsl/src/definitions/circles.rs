//! Axes that follow each other in a circle.

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::values::context::Context;

/// An axis with the law that was written for it, if there is one, and where.
pub(crate) struct Following<'g> {
    pub(crate) name: String,
    pub(crate) variable: Expr<'g>,
    pub(crate) law: Option<Expr<'g>>,
    pub(crate) place: Span,
}

/// Axes whose laws lead back to themselves; each circle once, at the law of its first axis.
pub(crate) fn report_circles<'g>(context: &mut Context<'g>, axes: &[Following<'g>]) {
    let leads_to: Vec<Vec<usize>> = axes.iter().map(|axis| followed(context, axes, axis)).collect();
    let mut told = vec![false; axes.len()];
    for start in 0..axes.len() {
        let Some(circle) = circle_through(start, &leads_to) else { continue };
        if circle.iter().any(|&k| std::mem::replace(&mut told[k], true)) {
            continue;
        }
        let names: Vec<String> = circle.iter().chain([&start]).map(|&k| format!("`{}`", axes[k].name)).collect();
        let (message, help) = match circle.len() {
            1 => (format!("axis {} follows itself", names[0]), "let it follow a motion, or stand still"),
            _ => {
                let message = format!("axes follow each other in a circle: {}", names.join(" → "));
                (message, "one of them must follow a motion, or stand still")
            }
        };
        context.report(Diagnostic::new(Code::CyclicCouple, axes[start].place, message).help(help));
    }
}

/// Those of some axes that the law of one depends on.
fn followed<'g>(context: &Context<'g>, axes: &[Following<'g>], of: &Following<'g>) -> Vec<usize> {
    let Some(law) = of.law else { return Vec::new() };
    let inside = context.graph.variables_of(&[law]);
    let is_inside = |axis: &Following<'g>| axis.variable.as_variable().is_some_and(|own| inside.contains(&own));
    (0..axes.len()).filter(|&k| is_inside(&axes[k])).collect()
}

/// The shortest way from a node back to itself, beginning with it.
fn circle_through(start: usize, leads_to: &[Vec<usize>]) -> Option<Vec<usize>> {
    let mut before: Vec<Option<usize>> = vec![None; leads_to.len()];
    let mut queue = std::collections::VecDeque::from([start]);
    while let Some(at) = queue.pop_front() {
        for &next in &leads_to[at] {
            if next == start {
                let back = std::iter::successors(Some(at), |&k| if k == start { None } else { before[k] });
                let mut circle: Vec<usize> = back.collect();
                circle.reverse();
                return Some(circle);
            }
            if before[next].is_none() {
                before[next] = Some(at);
                queue.push_back(next);
            }
        }
    }
    None
}
