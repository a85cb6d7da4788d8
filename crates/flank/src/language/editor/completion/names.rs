//! Names by what the statement wants.

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{NameKind, SymbolId};

use super::scope::is_transform;
use super::{Around, CompletionKind, List};
use crate::language::editor::analysis::Analysis;
use crate::language::editor::cursor::Cursor;

impl Analysis {
    /// Names by what the statement wants, else all of an expression.
    pub(super) fn names_for(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        if is_new(cursor) {
            return self.restated(cursor, around, list);
        }
        let found = match around.item.map(|item| self.kind(item)) {
            Some(NameKind::Machine) => self.in_machine(cursor, around, list),
            Some(NameKind::Job) => self.in_job(cursor, around, list),
            _ => self.in_items(cursor, around, list),
        };
        if !found {
            self.expression(cursor, around, list);
        }
    }

    /// `machine a extends b`, `job a = b`; profiles that a surface of a tool runs along.
    fn in_items(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        match (cursor.opening(), cursor.last()) {
            ("machine", "extends") => self.others(cursor, NameKind::Machine, list),
            ("job", "extends" | "=") => self.others(cursor, NameKind::Job, list),
            ("surface", "along") => {
                list.symbols(around.members.iter().copied(), &[NameKind::Profile, NameKind::Parameter], 0);
            }
            ("body", "body") => {}
            _ if cursor.block() == "profile" && cursor.last() == "=" => list.functions(&["line", "arc", "spline"], 0),
            _ => return false,
        }
        true
    }

    /// Items of a kind, but for the one that is being written.
    fn others(&self, cursor: &Cursor<'_>, kind: NameKind, list: &mut List<'_>) {
        let own = cursor.statement.get(1).copied().unwrap_or_default();
        let items: Vec<SymbolId> = self.items().filter(|id| self.name(*id) != own).collect();
        list.symbols(items, &[kind], 0);
    }

    fn in_machine(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        let members = || around.members.iter().copied();
        let has_equals = cursor.statement.contains(&"=");
        match (cursor.opening(), cursor.last()) {
            ("fix" | "couple", "fix" | "couple") => {
                let item = around.item.expect("it is a machine");
                let free = self.free_axes(None, "", item, cursor.word);
                list.symbols(free, &[NameKind::Axis], 0);
            }
            ("nc", "nc") => list.symbols(members(), &[NameKind::Axis], 0),
            ("frame" | "insert", "in") if !has_equals => {
                let own = cursor.statement.get(1).copied().unwrap_or_default();
                list.symbols(members().filter(|id| self.name(*id) != own), &[NameKind::Frame], 0);
            }
            ("frame" | "insert", _) if has_equals && cursor.calls.is_empty() => transforms(list),
            ("close", "along" | "about") | ("close", ",") => {
                list.words(&["x", "y", "z"], CompletionKind::Keyword, "axis of the frame that both hang on", 0);
            }
            ("close", "keep") => list.symbols(members(), &[NameKind::Axis], 0),
            ("close", "close" | "=") => list.symbols(members(), &[NameKind::Frame], 0),
            ("expect", "expect" | "in") => list.symbols(members(), &[NameKind::Frame], 0),
            ("expect", "near" | ")") if cursor.calls.is_empty() => transforms(list),
            ("expect", "on") => list.symbols(self.items(), &[NameKind::Machine], 0),
            ("expect", "(" | ",") if cursor.statement.contains(&"at") => self.axes_as_settings(around, list),
            _ => return false,
        }
        true
    }

    fn axes_as_settings(&self, around: &Around, list: &mut List<'_>) {
        let kinds = [NameKind::Axis, NameKind::Parameter, NameKind::MachineError];
        for id in around.members.iter().copied().filter(|id| kinds.contains(&self.kind(*id))) {
            let name = self.name(id);
            list.add_text(name, CompletionKind::Setting, self.signature(id), format!("{name}: "), 0);
        }
    }

    fn in_job(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        if ["sample", "mill", "profile"].contains(&cursor.block()) {
            return self.in_block_of_job(cursor, around, list);
        }
        let members = || around.members.iter().copied();
        let has_equals = cursor.statement.contains(&"=");
        match (cursor.opening(), cursor.last()) {
            ("machine" | "tool", "=") => {
                let kind = if cursor.opening() == "machine" { NameKind::Machine } else { NameKind::Tool };
                let instance =
                    if kind == NameKind::Machine { NameKind::MachineInstance } else { NameKind::ToolInstance };
                list.symbols(self.items(), &[kind], 0);
                list.symbols(self.earlier(cursor, around), &[instance], 1);
            }
            ("mount", "mount" | ",") => list.symbols(members(), &[NameKind::ToolInstance, NameKind::Surface], 0),
            ("mount" | "surface" | "solid" | "mill", "on" | "in") => {
                self.paths(around, NameKind::MachineInstance, &[NameKind::Frame], 0, list);
            }
            ("drive", "drive" | ",") if !has_equals => self.free_paths(cursor, around, list),
            ("trim" | "cut" | "sample", "trim" | "cut" | "by" | "sample" | ",")
            | ("contact", "=" | "with")
            | ("mill", "of") => {
                let own: Vec<&str> = cursor.statement.clone();
                list.symbols(members().filter(|id| !own.contains(&self.name(*id))), &[NameKind::Surface], 0);
            }
            ("mill", "with") => self.paths(around, NameKind::ToolInstance, &[NameKind::ToolSurface], 0, list),
            ("want", "in") => list.symbols(members(), &[NameKind::Contact], 0),
            ("want", "=") => list.functions(&["vertex"], 0),
            ("surface", "=") => list.functions(&["envelope", "sweep", "move"], 0),
            ("solid", "=") => list.functions(&["turned", "extruded"], 0),
            ("expect", "on") => list.symbols(self.items(), &[NameKind::Machine], 0),
            ("expect", "expect") => {
                list.words(&["all"], CompletionKind::Keyword, "all samples", 0);
                self.expression(cursor, around, list);
            }
            ("expect", "near" | "(" | ",") => {
                let jobs: Vec<SymbolId> = self.items().filter(|id| Some(*id) != around.item).collect();
                list.symbols(jobs, &[NameKind::Job], 2);
                return false;
            }
            _ => return false,
        }
        true
    }

    /// Coordinates of a sample or of passes, segments of a profile.
    fn in_block_of_job(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) -> bool {
        if cursor.block() == "profile" && cursor.last() == "=" {
            list.functions(&["line", "arc", "spline"], 0);
            return true;
        }
        if cursor.block() == "mill" && ["of", "with"].contains(&cursor.last()) {
            list.symbols(around.members.iter().copied(), &[NameKind::Solid, NameKind::Surface], 0);
            self.paths(around, NameKind::ToolInstance, &[NameKind::ToolSurface], 1, list);
            return true;
        }
        let is_entry = cursor.calls.is_empty()
            && (cursor.statement.is_empty()
                || ["{", ",", "keep", "require", "passes", "along", "side"].contains(&cursor.last()));
        if cursor.block() == "profile" || !(is_entry || cursor.is_beginning || self.begins_entry(cursor)) {
            return false;
        }
        list.symbols(self.sampled_unknowns(cursor, around), &[NameKind::SurfaceParameter, NameKind::Motion], 0);
        let words = vocabulary();
        list.words(words.coordinates, CompletionKind::Keyword, "coordinate of a point", 0);
        if !["keep", "require"].contains(&cursor.last()) {
            list.words(words.of_outlines, CompletionKind::Keyword, "of the flank of a blank", 0);
            list.words(&["points"], CompletionKind::Keyword, "of a table", 0);
        }
        true
    }

    /// Whether a new entry of a sample begins on a line of its own.
    fn begins_entry(&self, cursor: &Cursor<'_>) -> bool {
        let end = cursor.starts.last().map_or(0, |start| start + cursor.last().len());
        cursor.calls.is_empty() && self.text()[end..cursor.word].contains(['\n', '\r'])
    }

    /// Where a new name is written: in a variant what its parent has by such names.
    fn restated(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        let kind = match cursor.opening() {
            "param" => NameKind::Parameter,
            "error" => NameKind::MachineError,
            "let" => NameKind::Value,
            "axis" => NameKind::Axis,
            "frame" => NameKind::Frame,
            "motion" => NameKind::Motion,
            "unknown" => NameKind::Unknown,
            "surface" => NameKind::Surface,
            "machine" => NameKind::MachineInstance,
            "tool" => NameKind::ToolInstance,
            _ => return,
        };
        let of_parents = around.members.iter().copied().filter(|id| self.index.symbol(*id).owner != around.item);
        let kinds = if kind == NameKind::Parameter { vec![kind, NameKind::MachineError] } else { vec![kind] };
        list.symbols(of_parents, &kinds, 0);
    }
}

/// Whether a name is written that means nothing yet.
fn is_new(cursor: &Cursor<'_>) -> bool {
    const DEFINING: [&str; 17] = [
        "fn", "machine", "tool", "job", "param", "let", "axis", "error", "frame", "insert", "profile", "surface",
        "motion", "unknown", "solid", "contact", "want",
    ];
    let (word, last) = (cursor.opening(), cursor.last());
    if ["sample", "mill"].contains(&cursor.block()) {
        return false;
    }
    let is_first = cursor.statement.len() == 1 && (DEFINING.contains(&word) || word == "mill");
    let is_parameter = ["fn", "surface"].contains(&word)
        && cursor.block() != "job"
        && cursor.calls.len() == 1
        && ["(", ","].contains(&last)
        && !cursor.statement.contains(&"=");
    let is_next = word == "surface" && last == "," && cursor.calls.is_empty() && !cursor.statement.contains(&"in");
    let is_named = ["as", "for"].contains(&last) && ["sample", "surface"].contains(&word);
    let is_segment = cursor.block() == "profile" && cursor.statement.is_empty();
    is_first || is_parameter || is_next || is_named || is_segment
}

fn transforms(list: &mut List<'_>) {
    let all: Vec<&str> = vocabulary().functions.into_iter().filter(|name| is_transform(name)).collect();
    list.functions(&all, 0);
}
