//! What a job has to choose from where one of it is meant, and members of its machines.

use crate::definitions::machine::Built;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::syntax::ast;
use crate::values::context::{Context, READABLE, quoted};

use super::Builder;

/// Offers each of a few things that may be meant at a place.
pub(super) fn choosing(diagnostic: Diagnostic, span: Span, choices: &[&str]) -> Diagnostic {
    let few = choices.iter().take_while(|_| choices.len() <= READABLE);
    few.fold(diagnostic, |diagnostic, choice| diagnostic.cure(format!("write `{choice}`"), span, *choice))
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn instance_names(&self) -> Vec<String> {
        self.machines.iter().map(|(name, ..)| name.node.clone()).collect()
    }

    /// A machine of the job and the name behind the dot.
    pub(super) fn machine_member<'p>(
        &self,
        context: &mut Context<'g>,
        path: &'p ast::Path,
        what: &str,
    ) -> Option<(usize, &'p Name)> {
        // the parser has reported a missing name
        if path.segments.iter().any(|segment| segment.node.is_empty()) {
            return None;
        }
        let [machine, member] = path.segments.as_slice() else {
            let names = self.instance_names();
            let message = format!("{what} is named together with its machine");
            let diagnostic = Diagnostic::new(Code::WrongKind, path.span, message);
            context.report(match path.segments.as_slice() {
                [machine, member, ..] => diagnostic.writing(path.span, &format!("{}.{}", machine.node, member.node)),
                [own] if !self.names.contains_key(&own.node) && !names.is_empty() => {
                    diagnostic.writing(path.span, &format!("{}.{}", names[0], own.node))
                }
                own => self.choosing_member(diagnostic, path.span, (own.first(), what)),
            });
            return None;
        };
        match self.machines.iter().position(|(name, ..)| name.node == machine.node) {
            Some(index) => Some((index, member)),
            None if self.names.contains_key(&machine.node) && self.is_broken_machine(machine) => None,
            None => {
                let names = self.instance_names();
                context.unknown(machine, "machine", names.iter().map(String::as_str));
                None
            }
        }
    }

    /// Offers what machines have, one machine where that is all that is said.
    fn choosing_member(&self, diagnostic: Diagnostic, place: Span, (said, what): (Option<&Name>, &str)) -> Diagnostic {
        let mut choices = match what {
            "an axis" => self.axes_to_choose_from(),
            _ => self.frames_to_choose_from(),
        };
        if let Some((machine, ..)) =
            self.machines.iter().find(|(name, ..)| said.is_some_and(|said| said.node == name.node))
        {
            choices.retain(|choice| choice.strip_prefix(&machine.node).is_some_and(|rest| rest.starts_with('.')));
        }
        if choices.is_empty() || choices.len() > READABLE {
            let machine = self.machines.first().map_or("…", |(name, ..)| &name.node);
            return diagnostic.help(format!("write `{machine}.…` with the name of {what}"));
        }
        let choices: Vec<&str> = choices.iter().map(String::as_str).collect();
        choosing(diagnostic.help(format!("there is: {}", quoted(&choices))), place, &choices)
    }

    fn axes_to_choose_from(&self) -> Vec<String> {
        let of = |(name, _, built): &(Name, String, Built<'g>)| -> Vec<String> {
            built.axes.iter().map(|axis| format!("{}.{}", name.node, axis.name.node)).collect()
        };
        self.machines.iter().flat_map(of).take(READABLE + 1).collect()
    }

    /// The frames that a tool may sit on; none where they are too many to read.
    pub(super) fn frames_to_choose_from(&self) -> Vec<String> {
        let all = (0..self.machines.len()).flat_map(|m| (0..self.machines[m].2.frames.len()).map(move |k| (m, k)));
        let names: Vec<String> = all.map(|frame| self.frame_name(frame)).take(READABLE + 1).collect();
        if names.len() > READABLE { Vec::new() } else { names }
    }
}
