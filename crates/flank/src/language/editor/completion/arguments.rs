//! Settings and arguments of the call that is being written.

use flank_chain_dsl::{NameKind, SymbolId};

use super::{Around, CompletionKind, List};
use crate::language::editor::analysis::Analysis;
use crate::language::editor::cursor::{Call, Cursor};

/// Arguments with names, of what the language brings along.
const NAMED: [(&str, &[&str]); 8] = [
    ("line", &["from", "to"]),
    ("arc", &["center", "radius", "from", "to"]),
    ("envelope", &["over"]),
    ("sweep", &["over"]),
    ("turned", &["spaces", "of", "each"]),
    ("extruded", &["spaces", "pitch", "of", "each"]),
    ("contact", &["over", "for", "every"]),
    ("vertex", &["z", "rho", "lengthwise", "profilewise", "path", "ellipse", "transmission_error", "film"]),
];

/// Of these, those that take a surface first.
const OF_SURFACES: [&str; 3] = ["envelope", "sweep", "move"];

impl Analysis {
    /// Settings and arguments; whether nothing else may stand there.
    pub(super) fn arguments(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        let Some(call) = cursor.call() else { return self.of_contact(cursor, around, list) };
        if let Some(definition) = self.definition_named(around, call.name).filter(|_| !call.name.is_empty()) {
            return self.settings(definition, call, list);
        }
        if let Some(argument) = argument_around(cursor) {
            return self.values_of_argument(argument, cursor, around, list);
        }
        if OF_SURFACES.contains(&call.name) {
            self.surfaces_to_generate(cursor, around, list);
        }
        let is_named = NAMED.iter().find(|(name, _)| *name == call.name);
        if let Some((_, arguments)) = is_named {
            self.named_arguments(arguments, call, list);
        }
        if ["turned", "extruded"].contains(&call.name) && call.number == 0 {
            list.symbols(around.members.iter().copied(), &[NameKind::Profile], 0);
        }
        is_named.is_some() || call.name == "move"
    }

    fn settings(&self, definition: SymbolId, call: &Call<'_>, list: &mut List<'_>) -> bool {
        if call.argument.is_some() {
            return false;
        }
        let is_job = self.kind(definition) == NameKind::Job;
        for id in self.members(definition) {
            let is_instance = matches!(self.kind(id), NameKind::MachineInstance | NameKind::ToolInstance);
            let is_setting = matches!(self.kind(id), NameKind::Parameter | NameKind::MachineError);
            let name = self.name(id);
            if (is_setting || (is_job && is_instance)) && !call.given.contains(&name) {
                // what has no value yet comes first
                let rank = u8::from(self.index.symbol(id).value.is_some() || self.kind(id) != NameKind::Parameter);
                list.add_text(name, CompletionKind::Setting, self.signature(id), format!("{name}: "), rank);
            }
            for setting in self
                .index
                .symbol(id)
                .definition
                .filter(|_| is_job && is_instance)
                .map(|of| self.members(of))
                .into_iter()
                .flatten()
            {
                if matches!(self.kind(setting), NameKind::Parameter | NameKind::MachineError) {
                    let path = format!("{name}.{}", self.name(setting));
                    list.add_text(&path, CompletionKind::Setting, self.signature(setting), format!("{path}: "), 2);
                }
            }
        }
        true
    }

    fn named_arguments(&self, arguments: &[&str], call: &Call<'_>, list: &mut List<'_>) {
        for name in arguments.iter().filter(|name| !call.given.contains(name)) {
            list.add_text(name, CompletionKind::Setting, "argument", format!("{name}: "), 1);
        }
    }

    /// `contact a = b with c, over: turn`: arguments without a parenthesis.
    fn of_contact(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        if cursor.opening() != "contact" || !cursor.statement.contains(&"with") || cursor.last() == "with" {
            return false;
        }
        if cursor.last() == ":" {
            let argument = cursor.statement.iter().rev().nth(1).copied().unwrap_or_default();
            return self.values_of_argument(argument, cursor, around, list);
        }
        let given = cursor.statement.windows(2).filter(|two| two[1] == ":").map(|two| two[0]).collect();
        let call = Call { name: "contact", given, ..Call::default() };
        self.named_arguments(NAMED[6].1, &call, list);
        true
    }

    /// What an argument of the language takes.
    fn values_of_argument(&self, argument: &str, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        let members = around.members.iter().copied();
        match argument {
            "over" => list.symbols(members, &[NameKind::Motion], 0),
            "for" => list.symbols(members, &[NameKind::Unknown], 0),
            "of" => list.symbols(members, &[NameKind::Surface], 0),
            "each" => list.symbols(members, &[NameKind::Parameter], 0),
            _ => return false,
        }
        // what is generated already is not made again
        list.found.retain(|one| !cursor.statement.contains(&one.label.as_str()));
        true
    }

    /// Surfaces of tools, and of the job but those that the statement makes.
    fn surfaces_to_generate(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        self.paths(around, NameKind::ToolInstance, &[NameKind::ToolSurface], 0, list);
        list.symbols(self.earlier(cursor, around), &[NameKind::Surface], 1);
    }

    /// The machine, the tool or the job that a name stands for, itself or by an instance.
    pub(super) fn definition_named(&self, around: &Around, name: &str) -> Option<SymbolId> {
        let kinds = [NameKind::Machine, NameKind::Tool, NameKind::Job];
        let of_items = self.items().find(|id| self.name(*id) == name && kinds.contains(&self.kind(*id)));
        let is_instance = |id: &SymbolId| matches!(self.kind(*id), NameKind::MachineInstance | NameKind::ToolInstance);
        let own = || self.named(around.item, name).filter(is_instance);
        of_items.or_else(|| own().and_then(|id| self.index.symbol(id).definition))
    }
}

/// The argument of a function of the language whose value is being written, also where that is a list.
fn argument_around<'t>(cursor: &Cursor<'t>) -> Option<&'t str> {
    let calls = cursor.calls.iter().rev();
    let list = calls.clone().take_while(|call| call.name.is_empty()).count();
    let call = { calls }.nth(list)?;
    call.argument.filter(|_| NAMED.iter().any(|(name, _)| *name == call.name))
}
