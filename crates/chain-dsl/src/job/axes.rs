//! Every axis of a job gets exactly one law.

use flank_expr::{Expr, Interval};

use crate::definitions::circles::{Following, report_circles};
use crate::definitions::machine::LawKind;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::Span;
use crate::model::{Axis, LawSource, Machine};
use crate::syntax::ast::{self, ExpressionKind};
use crate::values::context::{Context, quoted};
use crate::values::dimension::Dimension;
use crate::values::value::Constant;

use super::{Builder, are_even};

/// An axis with a law that may be wrong (and that is reported), where it is named, and what is said of it alone.
pub(super) struct Driven<'g> {
    pub(super) law: Option<Expr<'g>>,
    pub(super) place: Span,
    pub(super) whole: Option<Span>,
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn drive(&mut self, context: &mut Context<'g>, drive: &ast::Drive) {
        let axes = (["axis", "axes"], drive.targets.iter().map(|target| target.span).collect());
        let laws = (["law", "laws"], drive.values.iter().map(|value| value.span).collect());
        let is_broken = drive.values.iter().any(|value| value.kind == ExpressionKind::Error);
        let help = "write as many laws as axes: `drive m.X, m.Z = 20 mm, feed`";
        // of an uneven list it is not known which law is meant for which axis
        let is_known = !is_broken && are_even(context, axes, laws, help);
        let whole = match (drive.targets.as_slice(), drive.values.as_slice()) {
            ([target], [value]) => Some(target.span.to(value.span)),
            _ => None,
        };
        for (k, target) in drive.targets.iter().enumerate() {
            self.drive_axis(context, target, (drive.values.get(k), is_known), whole);
        }
    }

    /// Gives an axis its law, which may be missing or another's (and that is reported); with what is said of it, where of it alone.
    fn drive_axis(
        &mut self,
        context: &mut Context<'g>,
        target: &ast::Path,
        (law, is_known): (Option<&ast::Expression>, bool),
        whole: Option<Span>,
    ) {
        let Some((machine, member)) = self.machine_member(context, target, "an axis") else {
            (0..self.machines.len()).for_each(|machine| self.lose_law(machine));
            return;
        };
        let (instance, _, built) = &self.machines[machine];
        let Some(axis) = built.axes.iter().find(|axis| axis.name.node == member.node) else {
            context.unknown(member, "axis", built.axes.iter().map(|axis| axis.name.node.as_str()));
            self.lose_law(machine);
            return;
        };
        let what = format!("axis `{}.{}`", instance.node, member.node);
        if let Some((_, kind, span)) = &axis.law {
            let how = if *kind == LawKind::Fix { "fixed" } else { "coupled" };
            let message = format!("{what} is {how} by its machine and cannot be driven");
            context.report(Diagnostic::new(Code::DrivenTwice, target.span, message).note(*span, format!("{how} here")));
            self.lose_law(machine);
            return;
        }
        if axis.is_unknown {
            let message = format!("{what} is unknown to its machine, whose loops give its motion: it cannot be driven");
            context
                .report(Diagnostic::new(Code::DrivenTwice, target.span, message).note(axis.name.span, "unknown here"));
            self.lose_law(machine);
            return;
        }
        let value =
            axis.dimension.zip(law).and_then(|(dimension, law)| context.scalar(law, &self.scope, dimension, &what));
        if let Some(law) = law.filter(|_| value.is_none()) {
            help_with_leads(context, law.span, axis.dimension);
        }
        let value = value.filter(|_| is_known);
        let key = (machine, member.node.clone());
        if let Some(first) = self.drives.get(&key) {
            let message = format!("{what} is driven twice");
            let mut diagnostic =
                Diagnostic::new(Code::DrivenTwice, target.span, message).note(first.place, "first driven here");
            for said in [whole, first.whole].into_iter().flatten() {
                diagnostic = diagnostic.rewriting(Rewriting::Statement(said, said));
            }
            context.report(diagnostic.help("an axis has one law: take one away, or drive it with the sum of both"));
            self.lose_law(machine);
            return;
        }
        self.drives.insert(key, Driven { law: value, place: target.span, whole });
    }

    /// A law that gives no axis its motion: an axis without one was perhaps meant, and is no second mistake.
    fn lose_law(&mut self, machine: usize) {
        *self.lost_laws.entry(machine).or_default() += 1;
    }

    /// Says where axes stand.
    pub(super) fn place_axes(&self, context: &mut Context<'g>, values: &[(&str, f64)]) {
        let axes = self.machines.iter().flat_map(|(_, _, built)| &built.axes);
        for axis in axes.filter(|axis| axis.law.is_none() && !axis.is_unknown) {
            if let Some((_, value)) = values.iter().find(|(name, _)| *name == axis.name.node) {
                context.set_range(axis.variable, Interval::point(*value));
            }
        }
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
                    (None, _) if axis.is_unknown => (Some(axis.variable), LawSource::Closed),
                    (None, Some(driven)) => (driven.law, LawSource::Driven),
                    (None, None) if self.stands_alone || self.mills.contains(&name.node) => {
                        (Some(axis.variable), LawSource::Free)
                    }
                    (None, None) => {
                        idle.push(axis.name.node.as_str());
                        (None, LawSource::Driven)
                    }
                };
                // what is broken has been reported: the axis stays a variable of its own
                if law.is_none() || axis.dimension.is_none() {
                    self.unsettled.insert(index);
                }
                let law = law.unwrap_or(axis.variable);
                axes.push(Axis {
                    name: axis.name.node.clone(),
                    variable: axis.variable,
                    dimension: axis.dimension.unwrap_or(Dimension::LENGTH),
                    law,
                    source,
                    travel: axis.travel,
                    travel_unit: axis.travel_unit.clone(),
                    word: axis.word.clone(),
                });
            }
            let lost = self.lost_laws.get(&index).copied().unwrap_or(0);
            if lost > 0 {
                self.unsettled.insert(index);
            }
            if idle.len() > lost {
                let (noun, verb) = if idle.len() == 1 { ("axis", "is") } else { ("axes", "are") };
                let message = format!("{noun} {} of `{}` {verb} not driven", quoted(&idle), name.node);
                let zero = built
                    .axes
                    .iter()
                    .find(|axis| axis.name.node == idle[0])
                    .map_or("0 mm", |axis| if axis.dimension == Some(Dimension::ANGLE) { "0 deg" } else { "0 mm" });
                let drive = format!("drive {}.{} = {zero}", name.node, idle[0]);
                let mut diagnostic = Diagnostic::new(Code::UndrivenAxis, name.span, message)
                    .help(format!("if it stands still: `{drive}`"));
                if let Some(end) = self.end {
                    diagnostic = diagnostic.cure(format!("add `{drive}`"), end, format!("    {drive}\n"));
                }
                context.report(diagnostic);
            }
            let frames = built.frames.clone();
            machines.push(Machine { name: name.node.clone(), definition: definition.clone(), axes, frames });
        }
        self.report_circles(context, &machines);
        self.write_laws_in_motions(context, &mut machines);
        self.check_laws(context, &machines);
        self.close_loops(context, &mut machines);
        machines
    }

    /// Laws of the job's axes that lead back to where they begin.
    fn report_circles(&self, context: &mut Context<'g>, machines: &[Machine<'g>]) {
        let each = machines.iter().enumerate().flat_map(|(index, machine)| {
            machine.axes.iter().map(move |axis| Following {
                name: format!("{}.{}", machine.name, axis.name),
                variable: axis.variable,
                law: self.written_law(index, &axis.name),
                place: self.place_of_law(index, &axis.name),
            })
        });
        report_circles(context, &each.collect::<Vec<_>>());
    }

    /// The law that was written for an axis.
    fn written_law(&self, machine: usize, axis: &str) -> Option<Expr<'g>> {
        let built = self.machines[machine].2.axes.iter().find(|built| built.name.node == axis);
        let own = built.and_then(|built| built.law.as_ref()).and_then(|(law, ..)| *law);
        own.or_else(|| self.drives.get(&(machine, axis.to_string())).and_then(|driven| driven.law))
    }

    /// Where an axis gets its law; the machine's name if nowhere.
    fn place_of_law(&self, machine: usize, axis: &str) -> Span {
        let (name, _, built) = &self.machines[machine];
        let own = built.axes.iter().find(|built| built.name.node == axis).and_then(|axis| axis.law.as_ref());
        let driven = self.drives.get(&(machine, axis.to_string())).map(|driven| driven.place);
        own.map(|(_, _, span)| *span).or(driven).unwrap_or(name.span)
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
        for (index, machine) in machines.iter_mut().enumerate() {
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
                // a circle, which has been reported: the axis stays a variable of its own
                if follows(law) {
                    self.unsettled.insert(index);
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

/// Says how lengths and angles become each other where a law is the one for the other.
fn help_with_leads(context: &mut Context<'_>, law: Span, dimension: Option<Dimension>) {
    let help = match dimension {
        Some(Dimension::LENGTH) => {
            "an angle becomes a length as a factor of a radius, or of a lead such as `10 mm/rev`"
        }
        Some(Dimension::ANGLE) => "a length becomes an angle divided by a radius, or by a lead such as `10 mm/rev`",
        _ => return,
    };
    context.help_on((Code::WrongDimension, law), help);
}

impl<'g> Builder<'_, 'g> {
    /// Reports laws that have no value, wherever the motions are in their ranges.
    fn check_laws(&mut self, context: &mut Context<'g>, machines: &[Machine<'g>]) {
        for (index, machine) in machines.iter().enumerate() {
            for axis in machine.axes.iter().filter(|axis| axis.law != axis.variable) {
                let value = match context.constant_kept(axis.law) {
                    Constant::Known(value) => value,
                    Constant::Moves(_) => match context.nowhere(axis.law) {
                        Some(value) => value,
                        None => continue,
                    },
                    Constant::Unknown => continue,
                };
                if !value.is_finite() {
                    let what = format!("the law of `{}.{}`", machine.name, axis.name);
                    let place = self.place_of_law(index, &axis.name);
                    context.not_finite(value, Some(axis.law), place, &what);
                    self.unsettled.insert(index);
                }
            }
        }
    }
}
