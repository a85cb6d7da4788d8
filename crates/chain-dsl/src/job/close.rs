//! The axes that closed loops give.

use flank_expr::{Expr, Interval, NoRoot, Unknown};

use crate::definitions::closure::Linkage;
use crate::definitions::machine::{Built, BuiltAxis};
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::model::Machine;
use crate::values::context::{Context, quoted};
use crate::values::dimension::{Dimension, shown};
use crate::values::implicit::{Branch, Unsolved, listed, shown_briefly};

use super::Builder;

impl<'g> Builder<'_, 'g> {
    /// Gives the unknown axes of each machine their laws, in motions.
    pub(super) fn close_loops(&mut self, context: &mut Context<'g>, machines: &mut [Machine<'g>]) {
        let mut found: Vec<(Expr<'g>, Expr<'g>)> = Vec::new();
        let mut unsettled: Vec<usize> = Vec::new();
        for (index, machine) in machines.iter().enumerate() {
            let (name, _, built) = &self.machines[index];
            if self.unsettled.contains(&index) || built.lacks_transforms {
                continue;
            }
            let lacks_loops = built.axes.iter().filter(|axis| axis.is_unknown).count()
                > built.linkages.iter().map(|linkage| linkage.axes.len()).sum();
            // which has been reported
            if lacks_loops {
                unsettled.push(index);
            }
            for linkage in &built.linkages {
                match self.closed(context, linkage, built, name) {
                    Some(laws) => {
                        let variables = linkage.axes.iter().map(|axis| machine.axes[*axis].variable);
                        found.extend(variables.zip(laws));
                    }
                    None => unsettled.push(index),
                }
            }
        }
        self.unsettled.extend(unsettled);
        if found.is_empty() {
            return;
        }
        // what one loop gives may drive another one
        for _ in 0..machines.iter().map(|machine| machine.axes.len()).sum() {
            let laws: Vec<Expr<'g>> = machines.iter().flat_map(|machine| &machine.axes).map(|axis| axis.law).collect();
            let new = context.graph.substitute(&laws, &found);
            let is_done = new == laws;
            let axes = machines.iter_mut().flat_map(|machine| &mut machine.axes);
            axes.zip(new).for_each(|(axis, law)| axis.law = law);
            if is_done {
                break;
            }
        }
        self.laws = machines
            .iter()
            .flat_map(|machine| &machine.axes)
            .filter(|axis| axis.law != axis.variable)
            .map(|axis| (axis.variable, axis.law))
            .collect();
    }

    fn closed(
        &self,
        context: &mut Context<'g>,
        linkage: &Linkage<'g>,
        built: &Built<'g>,
        machine: &Name,
    ) -> Option<Vec<Expr<'g>>> {
        let axes = linkage.axes.iter().map(|axis| &built.axes[*axis]);
        let dimensions: Vec<Dimension> = axes.clone().map(|axis| axis.dimension.unwrap_or(Dimension::LENGTH)).collect();
        let unknown = |(axis, range): (&BuiltAxis<'g>, &Interval)| Unknown { variable: axis.variable, range: *range };
        let unknowns: Vec<Unknown<'g>> = axes.zip(&linkage.ranges).map(unknown).collect();
        let (residuals, spans): (Vec<Expr<'g>>, Vec<Span>) = linkage.residuals.iter().copied().unzip();
        let residuals = context.graph.substitute(&residuals, &self.laws);
        let names = linkage.names(&built.axes);
        let mut keeps = Vec::new();
        let (why, help) = match context.solved(&residuals, &unknowns, &dimensions, &self.scope, spans[0]) {
            Ok(laws) => return Some(laws),
            // a machine whose parameters have no values yet
            Err(Unsolved::Unknown) => return None,
            Err(Unsolved::Endless(what)) => (
                format!("it follows from all places of {what}, which has no range"),
                if self.stands_alone {
                    "say where it stands, as in `at (crank: 30 deg)`".to_owned()
                } else {
                    "give it one: `axis crank : rotary in 0 deg .. 360 deg`".to_owned()
                },
            ),
            Err(Unsolved::Several(place, branches)) => {
                let all = quoted(&names);
                let why = format!("in the ranges of {all}, it closes in more than one way{place}");
                keeps.extend(branches.iter().filter_map(|branch| kept(branch, &names, &dimensions)));
                let told = branches.iter().map(|branch| told(branch, &names, &dimensions));
                (why, format!("say behind `close` which branch is meant{}", listed(told.collect())))
            }
            Err(Unsolved::Not(why, place)) => {
                let all = quoted(&names);
                match why {
                    NoRoot::None(_) => (
                        format!("nowhere in the ranges of {all} does it close{place}"),
                        "widen their ranges, narrow what drives the loop, or change the lengths of its links"
                            .to_owned(),
                    ),
                    NoRoot::Several(_) | NoRoot::Unproven(_) => (
                        format!("whether it closes in one way in the ranges of {all} is not decided{place}"),
                        "keep dead centres out of what drives the loop, and other branches out of the ranges"
                            .to_owned(),
                    ),
                    NoRoot::TooFast => (
                        format!("no polynomial comes near {all}, so fast do they change"),
                        "narrow what drives the loop, or drive it with fewer motions".to_owned(),
                    ),
                }
            }
        };
        let message = format!("a loop of `{}` cannot be closed: {why}", machine.node);
        let open = Diagnostic::new(Code::OpenLoop, machine.span, message).note(spans[0], "this one");
        let keeps = keeps.into_iter().map(|keep| Rewriting::Closing(spans[0], keep));
        context.report(keeps.fold(open.help(help), Diagnostic::rewriting));
        None
    }
}

/// A branch: where its axes are, and what selects it.
fn told(branch: &Branch, names: &[&str], dimensions: &[Dimension]) -> String {
    let value = |(k, value): (usize, &f64)| format!("`{}` = {}", names[k], shown_briefly(*value, dimensions[k]));
    let values: Vec<String> = branch.values.iter().enumerate().map(value).collect();
    let by = kept(branch, names, dimensions).map(|keep| format!(" by `{keep}`"));
    format!("{}{}", values.join(", "), by.unwrap_or_default())
}

/// What says that a branch is meant.
fn kept(branch: &Branch, names: &[&str], dimensions: &[Dimension]) -> Option<String> {
    let (k, ends) = branch.keep?;
    let [low, high] = ends.map(|end| shown(end, dimensions[k]));
    Some(format!("keep {}: {low} .. {high}", names[k]))
}
