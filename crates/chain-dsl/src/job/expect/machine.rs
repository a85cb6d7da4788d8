//! What machines expect: in each job that uses them, and by themselves.

use std::path::Path;

use crate::definitions::instance::Overrides;
use crate::diagnostics::source::Name;
use crate::job::{Builder, Definitions, posed, standing};
use crate::model::Job;
use crate::syntax::ast::{self, Argument, MachineStatement};
use crate::values::context::Context;
use crate::values::dimension::Dimension;
use crate::values::value::Scope;

use super::model::{Expectation, Expected};
use super::never_fails;
use super::pose::Pose;

impl<'g> Builder<'_, 'g> {
    /// Another machine by itself, with constants for its settings.
    pub(super) fn standing(
        &self,
        context: &mut Context<'g>,
        definition: &Name,
        settings: &[Argument],
    ) -> Option<Job<'g>> {
        let machines = self.definitions.machines;
        let Some(machine) = machines.get(&definition.node) else {
            context.unknown_item(definition, "machine", machines.keys().map(String::as_str));
            return None;
        };
        let own = overrides(machine, settings);
        let definitions = Definitions { overrides: &own, ..*self.definitions };
        Some(standing(context, machine, &definitions, Path::new("")))
    }

    /// What the machines of the job expect of all that use them.
    pub(super) fn of_machines(&self, context: &mut Context<'g>) -> Vec<Expectation<'g>> {
        let mut found = Vec::new();
        for (name, _, built) in &self.machines {
            for written in &built.expectations {
                let machine = Some(name.node.clone());
                let what = match &written.what {
                    ast::Expected::Travel => Some(Expected::Travel { machine }),
                    ast::Expected::On { machine: onto, within } => {
                        let onto = self.standing(context, &onto.definition, &onto.settings);
                        let within = constant(context, within, Dimension::LENGTH, "the tolerance");
                        onto.zip(within).map(|(onto, within)| Expected::On { onto: Box::new(onto), machine, within })
                    }
                    _ => None,
                };
                found.extend(what.map(|what| Expectation { what, written: written.span }));
            }
        }
        found
    }
}

/// What settings of a machine override, by their whole names.
pub(super) fn overrides(machine: &ast::Machine, settings: &[Argument]) -> Overrides {
    let given = settings.iter().filter_map(|setting| Some((setting.name.as_ref()?, setting.value.clone())));
    given.map(|(name, value)| (format!("{}.{}", machine.name.node, name.node), value)).collect()
}

/// The poses that a machine expects, by itself.
pub(crate) fn of_machine<'g>(
    context: &mut Context<'g>,
    machine: &ast::Machine,
    definitions: &Definitions<'_>,
) -> Vec<Expectation<'g>> {
    let mut found = Vec::new();
    let mut plain = None;
    for statement in &machine.statements {
        let MachineStatement::Expect(written) = statement else { continue };
        match &written.what {
            ast::Expected::Pose { frames, transforms, at, within } => {
                let pose = Pose { machine, frames, transforms, at, within };
                let plain = plain.get_or_insert_with(|| posed(context, machine, definitions, None));
                let what = pose.expected(context, (definitions, plain));
                found.extend(what.map(|what| Expectation { what, written: written.span }));
            }
            ast::Expected::Travel => {
                let ends = machine
                    .statements
                    .iter()
                    .any(|statement| matches!(statement, MachineStatement::Axis(axis) if axis.range.is_some()));
                if !ends && machine.extends.is_none() {
                    never_fails(context, written.span, "no axis has a travel");
                }
            }
            _ => {}
        }
    }
    found
}

/// A number that stands still, of expressions without names.
pub(super) fn constant(
    context: &mut Context<'_>,
    written: &ast::Expression,
    dimension: Dimension,
    what: &str,
) -> Option<f64> {
    let value = context.scalar(written, &Scope::new(), dimension, what)?;
    context.require_constant(value, written.span, what)
}
