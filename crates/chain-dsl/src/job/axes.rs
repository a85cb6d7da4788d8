//! Every axis of a job gets exactly one law.

use flank_expr::Expr;

use crate::codes::Code;
use crate::context::{Context, quoted};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::machine::LawKind;
use crate::model::{Axis, LawSource, Machine};
use crate::syntax::ast;

use super::Builder;

impl<'g> Builder<'_, 'g> {
    pub(super) fn drive(&mut self, context: &mut Context<'g>, drive: &ast::Assignment) {
        let Some((machine, member)) = self.machine_member(context, &drive.target, "an axis") else {
            return;
        };
        let (instance, _, built) = &self.machines[machine];
        let Some(axis) = built.axes.iter().find(|axis| axis.name.node == member.node) else {
            context.unknown(member, "axis", built.axes.iter().map(|axis| axis.name.node.as_str()));
            return;
        };
        let what = format!("axis `{}.{}`", instance.node, member.node);
        if let Some((_, kind, span)) = &axis.law {
            let how = if *kind == LawKind::Fix { "fixed" } else { "coupled" };
            let message = format!("{what} is {how} by its machine and cannot be driven");
            context.report(
                Diagnostic::new(Code::DrivenTwice, drive.target.span, message).note(*span, format!("{how} here")),
            );
            return;
        }
        let value = context.scalar(&drive.value, &self.scope, axis.dimension, &what);
        let key = (machine, member.node.clone());
        if let Some((_, first)) = self.drives.get(&key) {
            let message = format!("{what} is driven twice");
            let diagnostic =
                Diagnostic::new(Code::DrivenTwice, drive.target.span, message).note(*first, "first driven here");
            context.report(diagnostic);
            return;
        }
        self.drives.insert(key, (value, drive.target.span));
    }

    /// Every axis has exactly one law; what follows other axes is written in motions.
    pub(super) fn settle_axes(&mut self, context: &mut Context<'g>) -> Vec<Machine<'g>> {
        let mut machines = Vec::new();
        for (index, (name, definition, built)) in self.machines.iter().enumerate() {
            let mut axes = Vec::new();
            let mut idle = Vec::new();
            for axis in &built.axes {
                let (law, source) = match (&axis.law, self.drives.get(&(index, axis.name.node.clone()))) {
                    (Some((law, LawKind::Fix, _)), _) => (*law, LawSource::Fixed),
                    (Some((law, LawKind::Couple, _)), _) => (*law, LawSource::Coupled),
                    (None, Some((law, _))) => (*law, LawSource::Driven),
                    (None, None) => {
                        idle.push(axis.name.node.as_str());
                        (None, LawSource::Driven)
                    }
                };
                // a broken law has been reported: the axis stays a variable of its own
                let law = law.unwrap_or(axis.variable);
                axes.push(Axis {
                    name: axis.name.node.clone(),
                    variable: axis.variable,
                    dimension: axis.dimension,
                    law,
                    source,
                    travel: axis.travel,
                });
            }
            if !idle.is_empty() {
                let (noun, verb) = if idle.len() == 1 { ("axis", "is") } else { ("axes", "are") };
                let message = format!("{noun} {} of `{}` {verb} not driven", quoted(&idle), name.node);
                let zero = built
                    .axes
                    .iter()
                    .find(|axis| axis.name.node == idle[0])
                    .map_or("0 mm", |axis| if axis.dimension == Dimension::ANGLE { "0 deg" } else { "0 mm" });
                let help = format!("if it stands still: `drive {}.{} = {zero}`", name.node, idle[0]);
                context.report(Diagnostic::new(Code::UndrivenAxis, name.span, message).help(help));
            }
            let frames = built.frames.clone();
            machines.push(Machine { name: name.node.clone(), definition: definition.clone(), axes, frames });
        }
        self.write_laws_in_motions(context, &mut machines);
        machines
    }

    fn write_laws_in_motions(&mut self, context: &mut Context<'g>, machines: &mut [Machine<'g>]) {
        let graph = context.graph;
        let laws: Vec<(Expr<'g>, Expr<'g>)> = machines
            .iter()
            .flat_map(|machine| &machine.axes)
            .filter(|axis| axis.law != axis.variable)
            .map(|axis| (axis.variable, axis.law))
            .collect();
        let variables: Vec<_> = laws.iter().map(|(variable, _)| variable.as_variable()).collect();
        for (machine, (name, ..)) in machines.iter_mut().zip(&self.machines) {
            for axis in &mut machine.axes {
                if axis.law == axis.variable {
                    continue;
                }
                let mut law = axis.law;
                let follows = |law: Expr<'g>| {
                    let inside = graph.variables_of(&[law]);
                    inside.iter().any(|variable| variables.contains(&Some(*variable)))
                };
                let mut rounds = 0;
                while follows(law) && rounds <= laws.len() {
                    law = graph.substitute(&[law], &laws)[0];
                    rounds += 1;
                }
                if follows(law) {
                    let message = format!("axis `{}.{}` follows itself", name.node, axis.name);
                    context.report(Diagnostic::new(Code::CyclicCouple, name.span, message));
                    law = axis.variable;
                }
                axis.law = law;
            }
        }
        self.laws = machines
            .iter()
            .flat_map(|machine| &machine.axes)
            .filter(|axis| axis.law != axis.variable)
            .map(|axis| (axis.variable, axis.law))
            .collect();
    }
}
