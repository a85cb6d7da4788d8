//! What may be written at a place.

mod arguments;
mod locals;
mod members;
mod names;
mod paths;
mod scope;
mod statements;
mod units;

use std::collections::HashSet;

pub use paths::PathCompletions;

use flank_chain_dsl::syntax::{Piece, Possible, possible_behind, vocabulary};
use flank_chain_dsl::{NameKind, SymbolId};

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::builtins::function_about;
use crate::language::editor::cursor::Cursor;

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
    /// A spec that may be used.
    File,
    /// A folder with its slash.
    Folder,
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

impl Completion {
    /// What is written by an editor that knows no places to fill: each has its example, or the first of its choices.
    pub fn plain_text(&self) -> String {
        if !self.is_snippet {
            return self.text.clone();
        }
        let mut parts = self.text.split("${");
        let mut plain = parts.next().unwrap_or_default().to_string();
        for part in parts {
            let (place, behind) = part.split_once('}').unwrap_or((part, ""));
            let example = place.split_once([':', '|']).map_or("", |(_, example)| example);
            plain += example.split([',', '|']).next().unwrap_or_default();
            plain += behind;
        }
        plain.split_inclusive('\n').filter(|line| line.trim() != "$0").collect()
    }
}

struct List<'a> {
    of: &'a Analysis,
    replaces: TextSpan,
    found: Vec<Completion>,
    /// The label and the text of each that is found.
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

    /// Functions of the language with their opening parenthesis.
    fn functions(&mut self, names: &[&str], rank: u8) {
        for name in names {
            let detail = function_about(name).map_or("", |(signature, _)| signature);
            self.add_text(name, CompletionKind::Function, detail, format!("{name}("), rank);
        }
    }

    fn words(&mut self, words: &[&str], kind: CompletionKind, detail: &str, rank: u8) {
        words.iter().for_each(|word| self.add(word, kind, detail, rank));
    }
}

/// Functions that read columns, each with its dimension.
const TABLES: [&str; 4] = ["table", "curve", "grid", "spline"];

/// The machine, tool or job around a place, and what belongs to it.
struct Around {
    item: Option<SymbolId>,
    members: Vec<SymbolId>,
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
        let around = self.around(cursor);
        if cursor.last() == "." {
            return self.members_at(cursor, &around, list);
        }
        let possible = self.possible(cursor);
        if cursor.is_after_number || units::is_ratio(cursor) {
            self.units(cursor, &around, list);
        }
        // a number that stands by itself may be followed by words; behind `2 mm/` stands a unit, behind `2 mm / ` anything
        let is_tight = self.text()[..cursor.word].ends_with('/') && !list.found.is_empty();
        if cursor.is_after_number || is_tight {
            return words(&possible, cursor, list);
        }
        if cursor.is_beginning && statements::statements(cursor, list) {
            // the statement before may go on, too
            return words(&possible.filter(|_| !cursor.statement.is_empty()), cursor, list);
        }
        let Some(possible) = possible else {
            // what is wrong further up says nothing about this place
            return self.values(cursor, &around, list);
        };
        // of arguments with a name only columns of tables have dimensions
        let is_column = cursor.call().is_some_and(|call| TABLES.contains(&call.name));
        if possible.dimension && (is_column || !possible.name) {
            list.words(vocabulary().dimensions, CompletionKind::Unit, "dimension", 0);
        }
        if possible.status {
            list.words(vocabulary().statuses, CompletionKind::Keyword, "what becomes of points", 0);
        }
        if possible.name {
            self.values(cursor, &around, list);
        }
        words(&Some(possible), cursor, list);
    }

    /// What the grammar takes at a place.
    fn possible(&self, cursor: &Cursor<'_>) -> Option<Possible> {
        let (piece, from) = match cursor.blocks.last() {
            None => (Piece::Item, cursor.first),
            Some(block) => match block.word {
                "machine" => (Piece::InMachine, cursor.first),
                "tool" => (Piece::InTool, cursor.first),
                "job" => (Piece::InJob, cursor.first),
                "surface" => (Piece::InSurface, cursor.first),
                "profile" => (Piece::InProfile, cursor.first),
                "fn" => (Piece::Item, block.first),
                "sample" | "mill" => (Piece::InJob, block.first),
                _ => return None,
            },
        };
        let start = cursor.starts.get(from).copied().unwrap_or(cursor.word);
        possible_behind(&self.text()[start..cursor.word], piece)
    }

    /// Arguments, or names.
    fn values(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        if !self.arguments(cursor, around, list) {
            self.names_for(cursor, around, list);
        }
    }

    fn around(&self, cursor: &Cursor<'_>) -> Around {
        let name = cursor.blocks.first().map(|block| block.name);
        let own = || self.items().filter(|id| self.index.symbol(*id).name.file == self.main);
        let item = name.and_then(|name| own().find(|id| self.name(*id) == name));
        Around { item, members: item.map(|item| self.members(item)).unwrap_or_default() }
    }

    fn named(&self, item: Option<SymbolId>, name: &str) -> Option<SymbolId> {
        self.members(item?).into_iter().find(|id| self.name(*id) == name)
    }
}

/// Words of the language; those that join conditions where there is one.
fn words(possible: &Option<Possible>, cursor: &Cursor<'_>, list: &mut List<'_>) {
    const OF_CONDITIONS: [&str; 9] = ["if", "require", "where", "<", ">", "<=", ">=", "==", "!="];
    let is_condition = cursor.statement.iter().any(|said| OF_CONDITIONS.contains(said));
    for word in possible.iter().flat_map(|possible| &possible.words) {
        if is_condition || !["and", "or", "not"].contains(word) {
            list.add(word, CompletionKind::Keyword, "", 1);
        }
    }
}
