//! What may be written at a place.

use std::collections::HashSet;

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{Dimension, NameKind, SymbolId, unit_size};

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::builtins::function_about;
use crate::language::editor::cursor::{Call, Cursor};

/// What a proposal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CompletionKind {
    /// Something that a text defines.
    Name(NameKind),
    /// A word of the language.
    Keyword,
    /// A function of the language.
    Function,
    /// A unit or a dimension.
    Unit,
    /// A setting of a machine or a tool, with its colon.
    Setting,
    /// Several lines with places to fill.
    Snippet,
}

/// A proposal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// As it is listed.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// Of one line.
    pub detail: String,
    /// What is written; `${1:name}` and `$0` are places to fill, where it is a snippet.
    pub text: String,
    /// Whether `text` has such places.
    pub is_snippet: bool,
    /// What it takes the place of.
    pub replaces: TextSpan,
    /// Those with a smaller number come first.
    pub rank: u8,
}

/// Blocks to start from: word, what it is, text.
const SNIPPETS: [(&str, &str, &str); 3] = [
    (
        "machine",
        "a machine: axes and frames",
        "machine ${1:name} {\n    axis ${2:C} : ${3|rotary,linear|}\n\n    frame ${4:bed}\n    frame ${5:work} in ${4:bed} = rotate_z(${2:C})\n    $0\n}\n",
    ),
    (
        "tool",
        "a tool: parameters and surfaces",
        "tool ${1:name} {\n    param ${2:radius} : length = ${3:5 mm}\n\n    surface ${4:face}(${5:u}: angle in ${6:-80 deg} .. ${7:80 deg}, ${8:v}: length in ${9:0 mm} .. ${10:10 mm}) {\n        at = [${11:x}, ${12:y}, ${13:z}]\n        body ${14|inside,outside|}\n    }\n    $0\n}\n",
    ),
    (
        "job",
        "a job: machine, tool, motion, surface, sample",
        "job ${1:name} {\n    machine m = ${2:machine}\n    tool c = ${3:tool}\n    mount c on m.${4:frame}\n\n    motion ${5:roll} : angle in ${6:-20 deg} .. ${7:20 deg}\n    drive m.${8:axis} = ${5:roll}\n\n    surface ${9:flank} in m.${10:work} = envelope(c.${11:surface}, over: ${5:roll})\n    sample ${9:flank} { ${12:z: 0 mm .. 10 mm by 5, rho: 40 mm .. 50 mm by 5} }\n    $0\n}\n",
    ),
];

struct List<'a> {
    of: &'a Analysis,
    replaces: TextSpan,
    found: Vec<Completion>,
    /// Labels and texts of those.
    known: HashSet<(String, String)>,
}

impl List<'_> {
    fn add(&mut self, label: &str, kind: CompletionKind, detail: impl Into<String>, rank: u8) {
        self.add_text(label, kind, detail, label.to_string(), rank);
    }

    fn add_text(&mut self, label: &str, kind: CompletionKind, detail: impl Into<String>, text: String, rank: u8) {
        if label.is_empty() || !self.known.insert((label.to_string(), text.clone())) {
            return;
        }
        self.found.push(Completion {
            label: label.to_string(),
            kind,
            detail: detail.into(),
            is_snippet: kind == CompletionKind::Snippet,
            text,
            replaces: self.replaces.clone(),
            rank,
        });
    }

    fn symbol(&mut self, id: SymbolId, rank: u8) {
        let (name, kind, detail) = (self.of.name(id).to_string(), self.of.kind(id), self.of.signature(id));
        self.add(&name, CompletionKind::Name(kind), detail, rank);
    }

    fn symbols(&mut self, all: impl IntoIterator<Item = SymbolId>, kinds: &[NameKind], rank: u8) {
        for id in all {
            if kinds.contains(&self.of.kind(id)) {
                self.symbol(id, rank);
            }
        }
    }

    fn words(&mut self, words: &[&str], kind: CompletionKind, detail: &str, rank: u8) {
        words.iter().for_each(|word| self.add(word, kind, detail, rank));
    }
}

impl Analysis {
    /// What may be written at a byte of the spec, in the order of use.
    pub fn completions(&self, offset: usize) -> Vec<Completion> {
        // of a file that is too large to be read there is no text
        if !self.text().is_char_boundary(offset) {
            return Vec::new();
        }
        let cursor = Cursor::at(self.text(), offset);
        let Some(file) = self.files().into_iter().next() else { return Vec::new() };
        if cursor.is_quiet {
            return Vec::new();
        }
        let replaces = TextSpan { file, start: cursor.word, end: offset };
        let mut list = List { of: self, replaces, found: Vec::new(), known: HashSet::new() };
        self.fill(&cursor, &mut list);
        let mut found = list.found;
        found.sort_by(|a, b| (a.rank, &a.label).cmp(&(b.rank, &b.label)));
        found
    }

    fn fill(&self, cursor: &Cursor<'_>, list: &mut List<'_>) {
        let item = self.item_around(cursor);
        let last = cursor.before.last().copied().unwrap_or_default();
        let word = cursor.statement.first().copied().unwrap_or_default();
        if last == "." {
            return self.members_at(cursor, item, list);
        }
        if cursor.is_after_number || is_unit_ratio(cursor) {
            return self.units(cursor, item, list);
        }
        if cursor.is_beginning {
            return statements(cursor, list);
        }
        let calls = cursor.call.as_ref();
        if last == ":" && calls.is_none_or(|call| call.name.is_empty()) && is_declaration(word) {
            let words = vocabulary();
            let is_axis =
                word == "axis" || (word == "unknown" && cursor.blocks.last().is_some_and(|of| of.0 == "machine"));
            let (choices, detail) =
                if is_axis { (&words.choices[..2], "kind of axis") } else { (words.dimensions, "dimension") };
            return list.words(choices, CompletionKind::Unit, detail, 0);
        }
        if let Some(call) = calls
            && self.arguments(cursor, call, item, list)
        {
            return;
        }
        self.names_for(cursor, (word, last), item, list);
    }

    /// The machine, tool or job around a place.
    fn item_around(&self, cursor: &Cursor<'_>) -> Option<SymbolId> {
        let (_, name) = cursor.blocks.first()?;
        self.items().filter(|id| self.index.symbol(*id).name.file == self.main).find(|id| self.name(*id) == *name)
    }

    fn named(&self, item: Option<SymbolId>, name: &str) -> Option<SymbolId> {
        self.members(item?).into_iter().find(|id| self.name(*id) == name)
    }

    /// What stands behind a dot.
    fn members_at(&self, cursor: &Cursor<'_>, item: Option<SymbolId>, list: &mut List<'_>) {
        let words: Vec<&str> = cursor.before.iter().rev().skip(1).step_by(2).copied().collect();
        let dots = cursor.before.iter().rev().step_by(2).take_while(|sign| **sign == ".").count();
        let mut path: Vec<&str> = words.into_iter().take(dots).collect();
        path.reverse();
        let Some((first, rest)) = path.split_first() else { return };
        let mut at = self.named(item, first);
        for name in rest {
            let of = at.map(|id| self.index.symbol(id).definition.unwrap_or(id));
            at = self.named(of, name);
        }
        let Some(id) = at else { return };
        let of = self.index.symbol(id).definition.filter(|_| is_instance(self.kind(id))).unwrap_or(id);
        let members = self.members(of);
        let before_path = cursor.before.len().checked_sub(2 * dots + 1).and_then(|at| cursor.before.get(at)).copied();
        let word = cursor.statement.first().copied().unwrap_or_default();
        let is_driven = word == "drive" && !cursor.statement.contains(&"=");
        match self.kind(id) {
            NameKind::MachineInstance if is_driven => {
                let free = self.free_axes(item, first, of, cursor.word);
                list.symbols(free, &[NameKind::Axis], 0);
            }
            NameKind::MachineInstance if matches!(before_path, Some("on" | "in")) => {
                list.symbols(members, &[NameKind::Frame], 0);
            }
            NameKind::ToolInstance => {
                list.symbols(members.iter().copied(), &[NameKind::ToolSurface], 0);
                list.symbols(members, &[NameKind::Parameter, NameKind::Value, NameKind::Profile], 1);
            }
            NameKind::MachineInstance => {
                let values = [NameKind::Parameter, NameKind::MachineError, NameKind::Value, NameKind::Axis];
                list.symbols(members.iter().copied(), &values, 0);
                list.symbols(members, &[NameKind::Frame], 1);
            }
            _ => list.symbols(members, &[NameKind::Segment, NameKind::Surface, NameKind::Parameter], 0),
        }
    }

    /// The axes of a machine that nothing drives, fixes or couples yet.
    fn free_axes(&self, job: Option<SymbolId>, instance: &str, machine: SymbolId, word: usize) -> Vec<SymbolId> {
        let axes = self.members(machine).into_iter().filter(|id| self.kind(*id) == NameKind::Axis);
        let job = job.map(|job| self.index.symbol(job).extent);
        let is_free = |axis: &SymbolId| {
            let symbol = self.index.symbol(*axis);
            let of_unknown = self.before(symbol.name).ends_with("unknown");
            // the one that is being written drives nothing yet
            let written = self
                .index
                .uses(*axis)
                .filter(|entry| entry.span.file != self.main || entry.span.start as usize != word);
            let is_bound = { written }.any(|entry| {
                let before = self.before(entry.span);
                let in_machine = before.ends_with("fix") || before.ends_with("couple");
                let in_job = job
                    .is_some_and(|job| entry.span.file == job.file && (job.start..job.end).contains(&entry.span.start));
                let line = before.rsplit(['\n', '\r']).next().unwrap_or_default().trim_start();
                let is_driven =
                    line.starts_with("drive") && !line.contains('=') && before.ends_with(&format!("{instance}."));
                in_machine || (in_job && is_driven)
            });
            !of_unknown && !is_bound
        };
        axes.filter(is_free).collect()
    }

    /// The text before a place, without blanks at its end.
    fn before(&self, span: flank_chain_dsl::Span) -> &str {
        self.sources.file(span.file).text[..span.start as usize].trim_end()
    }

    /// Units behind a number: those of the dimension that is wanted.
    fn units(&self, cursor: &Cursor<'_>, item: Option<SymbolId>, list: &mut List<'_>) {
        let wanted = self.wanted_dimension(cursor, item);
        for unit in vocabulary().units {
            let Some((_, dimension)) = unit_size(unit) else { continue };
            let fits = match wanted.as_deref() {
                Some("length") => dimension == Dimension::LENGTH,
                Some("angle") => dimension == Dimension::ANGLE,
                Some("number" | "count") => false,
                _ => true,
            };
            if fits {
                list.add(unit, CompletionKind::Unit, format!("unit of {dimension}"), 0);
            }
        }
    }

    fn wanted_dimension(&self, cursor: &Cursor<'_>, item: Option<SymbolId>) -> Option<String> {
        if let Some(call) = &cursor.call
            && let Some(argument) = call.argument
            && let Some(definition) = self.definition_named(item, call.name)
        {
            let parameter = self.named(Some(definition), argument)?;
            return self.index.symbol(parameter).dimension.map(|span| self.sources.text(span).to_string());
        }
        let word = cursor.statement.first().copied()?;
        if word == "drive" {
            let axis =
                cursor.statement.iter().position(|said| *said == "=").and_then(|at| cursor.statement.get(at - 1))?;
            let machine = cursor.statement.get(1).and_then(|name| self.named(item, name))?;
            let axis = self.named(self.index.symbol(machine).definition, axis)?;
            let extent = self.sources.text(self.index.symbol(axis).extent);
            return Some(if extent.contains("rotary") { "angle" } else { "length" }.to_string());
        }
        if !is_declaration(word) {
            return None;
        }
        let colon = cursor.statement.iter().position(|said| *said == ":")?;
        let said: Vec<&str> = cursor.statement[colon + 1..]
            .iter()
            .take_while(|said| !matches!(**said, "in" | "=" | "step"))
            .copied()
            .collect();
        match said.as_slice() {
            ["linear"] => Some("length".to_string()),
            ["rotary"] => Some("angle".to_string()),
            [one] => Some((*one).to_string()),
            _ => None,
        }
    }

    /// The machine or tool that a name stands for, itself or by an instance.
    fn definition_named(&self, item: Option<SymbolId>, name: &str) -> Option<SymbolId> {
        let of_items = self
            .items()
            .find(|id| self.name(*id) == name && matches!(self.kind(*id), NameKind::Machine | NameKind::Tool));
        of_items.or_else(|| self.named(item, name).and_then(|id| self.index.symbol(id).definition))
    }

    /// Settings and arguments; whether nothing else may stand there.
    fn arguments(&self, cursor: &Cursor<'_>, call: &Call<'_>, item: Option<SymbolId>, list: &mut List<'_>) -> bool {
        let last = cursor.before.last().copied().unwrap_or_default();
        if let Some(definition) = self.definition_named(item, call.name) {
            if call.argument.is_some() {
                return false;
            }
            for id in self.members(definition) {
                let is_setting = matches!(self.kind(id), NameKind::Parameter | NameKind::MachineError);
                let name = self.name(id);
                if is_setting && !call.given.contains(&name) {
                    // what has no value yet comes first
                    let rank =
                        u8::from(self.index.symbol(id).value.is_some() || self.kind(id) == NameKind::MachineError);
                    list.add_text(name, CompletionKind::Setting, self.signature(id), format!("{name}: "), rank);
                }
            }
            return true;
        }
        if call.argument == Some("over")
            || (call.name.is_empty() && cursor.statement.windows(2).any(|two| two == ["over", ":"]))
        {
            list.symbols(item.into_iter().flat_map(|item| self.members(item)), &[NameKind::Motion], 0);
            return true;
        }
        if ["envelope", "sweep", "move"].contains(&call.name) && matches!(last, "(" | ",") {
            let members: Vec<SymbolId> = item.into_iter().flat_map(|item| self.members(item)).collect();
            for id in &members {
                let Some(tool) = self.index.symbol(*id).definition.filter(|_| self.kind(*id) == NameKind::ToolInstance)
                else {
                    continue;
                };
                for surface in self.members(tool).into_iter().filter(|id| self.kind(*id) == NameKind::ToolSurface) {
                    let path = format!("{}.{}", self.name(*id), self.name(surface));
                    list.add(&path, CompletionKind::Name(NameKind::ToolSurface), self.signature(surface), 0);
                }
            }
            list.symbols(members, &[NameKind::Surface], 1);
            if last == "," {
                list.add_text("over", CompletionKind::Setting, "the motions", "over: ".to_string(), 1);
            }
            return true;
        }
        false
    }

    /// Names by what the statement wants, else all of an expression.
    fn names_for(&self, cursor: &Cursor<'_>, (word, last): (&str, &str), item: Option<SymbolId>, list: &mut List<'_>) {
        let members: Vec<SymbolId> = item.into_iter().flat_map(|item| self.members(item)).collect();
        let is_in = |block: &str| cursor.blocks.last().is_some_and(|of| of.0 == block);
        let has_equals = cursor.statement.contains(&"=");
        match (word, last) {
            ("machine" | "job", "extends") => {
                let kind = if word == "machine" { NameKind::Machine } else { NameKind::Job };
                list.symbols(self.items(), &[kind], 0);
            }
            ("machine" | "tool", "=") if is_in("job") => {
                let kind = if word == "machine" { NameKind::Machine } else { NameKind::Tool };
                list.symbols(self.items(), &[kind], 0);
            }
            ("mount", "mount" | ",") => list.symbols(members, &[NameKind::ToolInstance, NameKind::Surface], 0),
            ("mount" | "surface" | "solid" | "mill", "on" | "in") => {
                for id in members.iter().copied().filter(|id| self.kind(*id) == NameKind::MachineInstance) {
                    let Some(machine) = self.index.symbol(id).definition else { continue };
                    for frame in self.members(machine).into_iter().filter(|id| self.kind(*id) == NameKind::Frame) {
                        let path = format!("{}.{}", self.name(id), self.name(frame));
                        list.add(&path, CompletionKind::Name(NameKind::Frame), self.signature(frame), 0);
                    }
                }
            }
            ("drive", "drive" | ",") if !has_equals => {
                for id in members.iter().copied().filter(|id| self.kind(*id) == NameKind::MachineInstance) {
                    let Some(machine) = self.index.symbol(id).definition else { continue };
                    for axis in self.free_axes(item, self.name(id), machine, cursor.word) {
                        let path = format!("{}.{}", self.name(id), self.name(axis));
                        list.add(&path, CompletionKind::Name(NameKind::Axis), self.signature(axis), 0);
                    }
                }
            }
            ("fix" | "couple", "fix" | "couple") => list.symbols(members, &[NameKind::Axis], 0),
            ("frame" | "insert", "in") if !has_equals => list.symbols(members, &[NameKind::Frame], 0),
            ("close", "close" | "=") => list.symbols(members, &[NameKind::Frame], 0),
            ("frame" | "insert", _) if has_equals && cursor.call.is_none() => {
                let transforms = vocabulary().functions;
                for name in transforms {
                    if let Some((signature, about)) = function_about(name)
                        && (about.contains("the child") || ["matrix", "screw"].contains(&name))
                    {
                        list.add_text(name, CompletionKind::Function, signature, format!("{name}("), 0);
                    }
                }
            }
            ("trim" | "cut" | "sample" | "contact", "trim" | "cut" | "by" | "sample" | "," | "=" | "with") => {
                list.symbols(members, &[NameKind::Surface], 0);
            }
            ("want", "in") => list.symbols(members, &[NameKind::Contact], 0),
            ("body", "body") => {
                list.words(&["inside", "outside", "towards", "where"], CompletionKind::Keyword, "side of the steel", 0)
            }
            ("surface" | "solid", "=") => {
                let ways: &[&str] =
                    if word == "solid" { &["turned", "extruded"] } else { &["envelope", "sweep", "move"] };
                for name in ways {
                    let detail = function_about(name).map_or("", |(signature, _)| signature);
                    list.add_text(name, CompletionKind::Function, detail, format!("{name}("), 0);
                }
            }
            _ => self.expression(&members, list),
        }
    }

    fn expression(&self, members: &[SymbolId], list: &mut List<'_>) {
        let others = [
            NameKind::Frame,
            NameKind::NcWord,
            NameKind::ToolSurface,
            NameKind::Want,
            NameKind::Milling,
            NameKind::Segment,
        ];
        for id in members.iter().copied().filter(|id| !others.contains(&self.kind(*id))) {
            list.symbol(id, 0);
        }
        for id in self.items().filter(|id| self.kind(*id) == NameKind::Function) {
            let name = self.name(id).to_string();
            list.add_text(&name, CompletionKind::Name(NameKind::Function), self.signature(id), format!("{name}("), 1);
        }
        for name in vocabulary().functions {
            let detail = function_about(name).map_or("", |(signature, _)| signature);
            list.add_text(name, CompletionKind::Function, detail, format!("{name}("), 2);
        }
        list.add("pi", CompletionKind::Keyword, "number", 2);
    }
}

fn statements(cursor: &Cursor<'_>, list: &mut List<'_>) {
    let words = vocabulary();
    let (own, what): (&[&str], &str) = match cursor.blocks.last() {
        None => (words.items, "item"),
        Some(("machine", _)) => (words.in_machine, "statement of a machine"),
        Some(("tool", _)) => (words.in_tool, "statement of a tool"),
        Some(("job", _)) => (words.in_job, "statement of a job"),
        Some(("surface", _)) => (words.in_surface, "statement of a surface"),
        Some(_) => (&["keep", "require"], "of a sample"),
    };
    for word in own {
        list.add_text(word, CompletionKind::Keyword, what, format!("{word} "), 1);
    }
    if cursor.blocks.is_empty() {
        for (word, detail, text) in SNIPPETS {
            list.add_text(word, CompletionKind::Snippet, detail, text.to_string(), 0);
        }
    }
}

fn is_declaration(word: &str) -> bool {
    ["param", "error", "motion", "unknown", "axis", "surface", "fn"].contains(&word)
}

fn is_instance(kind: NameKind) -> bool {
    matches!(kind, NameKind::MachineInstance | NameKind::ToolInstance)
}

/// `2 mm/`: the unit below the line.
fn is_unit_ratio(cursor: &Cursor<'_>) -> bool {
    match cursor.before.as_slice() {
        [.., number, unit, "/"] => {
            number.starts_with(|letter: char| letter.is_ascii_digit()) && unit_size(unit).is_some()
        }
        _ => false,
    }
}
