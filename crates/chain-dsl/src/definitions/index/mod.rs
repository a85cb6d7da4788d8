//! The index of names: for every name in the texts its place, what it is, and where it is defined.
//!
//! Names are looked up in the trees, without values: a wrong text has an index as well. What names amount to is noted while the
//! texts are evaluated ([`KnownValue`]).

mod declare;
mod expression;
mod job;
mod members;
mod statements;

use std::sync::Arc;

use crate::diagnostics::source::{FileId, Span};
use crate::syntax::ast;
use crate::values::dimension::Dimension;

pub(crate) use expression::{OUTLINE, functions};
use members::Names;

/// Index of a [`Symbol`] in [`Index::symbols`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SymbolId(pub u32);

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)] // each is its name
pub enum NameKind {
    Machine,
    Tool,
    Job,
    Function,
    Argument,
    Parameter,
    /// An error of a machine.
    MachineError,
    /// A `let`.
    Value,
    Axis,
    Frame,
    NcWord,
    Profile,
    Segment,
    /// A surface of a tool.
    ToolSurface,
    SurfaceParameter,
    Motion,
    Unknown,
    /// A machine of a job.
    MachineInstance,
    /// A tool of a job.
    ToolInstance,
    /// A surface that a job makes.
    Surface,
    Solid,
    Contact,
    Want,
    Milling,
    /// A sample with a name of its own.
    Sample,
    /// A coordinate that a sample defines.
    Coordinate,
}

impl NameKind {
    /// In the words of the language.
    pub fn described(self) -> &'static str {
        match self {
            NameKind::Machine | NameKind::MachineInstance => "machine",
            NameKind::Tool | NameKind::ToolInstance => "tool",
            NameKind::Job => "job",
            NameKind::Function => "function",
            NameKind::Argument => "argument",
            NameKind::Parameter => "parameter",
            NameKind::MachineError => "error of a machine",
            NameKind::Value => "value",
            NameKind::Axis => "axis",
            NameKind::Frame => "frame",
            NameKind::NcWord => "NC word",
            NameKind::Profile => "profile",
            NameKind::Segment => "segment",
            NameKind::ToolSurface | NameKind::Surface => "surface",
            NameKind::SurfaceParameter => "surface parameter",
            NameKind::Motion => "motion",
            NameKind::Unknown => "unknown",
            NameKind::Solid => "solid",
            NameKind::Contact => "contact",
            NameKind::Want => "wanted contact",
            NameKind::Milling => "milling",
            NameKind::Sample => "sample",
            NameKind::Coordinate => "coordinate",
        }
    }
}

/// Something that a text gives a name to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// What it is.
    pub kind: NameKind,
    /// Its name, where it is defined.
    pub name: Span,
    /// The whole definition.
    pub extent: Span,
    /// The machine, tool, job, function, profile or surface that it belongs to.
    pub owner: Option<SymbolId>,
    /// What it takes the place of: a variant states it again.
    pub restates: Option<SymbolId>,
    /// The dimension as written.
    pub dimension: Option<Span>,
    /// The range as written.
    pub range: Option<Span>,
    /// What it is, as written: a default, a formula, a law.
    pub value: Option<Span>,
    /// The machine or tool of an instance, the machine that another one extends, the job that another one is made from.
    pub definition: Option<SymbolId>,
}

/// What a word of the language is that may also be a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum WordKind {
    /// A function, a transform, a way to make a surface.
    Function,
    /// The name of an argument.
    Argument,
    /// `pi`
    Constant,
    /// A coordinate of points.
    Coordinate,
    /// What is known of a contact, a solid or a surface once it is solved; the end of a segment.
    Number,
    /// What may become of a point.
    Status,
    /// The code of an error.
    ErrorCode,
    /// A unit.
    Unit,
    /// A dimension.
    Dimension,
    /// A column of a table.
    Column,
}

/// What a name in a text leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// Something with a definition.
    Symbol(SymbolId),
    /// Another file.
    File(FileId),
    /// A word of the language.
    Word(WordKind),
    /// Nothing: there is no such thing, or it is not known because another one is wrong.
    Missing(NameKind),
}

/// One name in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Where it stands.
    pub span: Span,
    /// What it leads to.
    pub target: Target,
    /// Whether it is defined here.
    pub is_definition: bool,
}

/// What a name amounts to somewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownValue {
    /// The name where it is defined.
    pub name: Span,
    /// What gives the value: a setting, a default, a formula.
    pub written: Span,
    /// Whose value it is, `job.m`; the job, the machine or the tool itself.
    pub of: String,
    /// In mm and radians.
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

/// All names of a compilation, in the order of their places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Index {
    /// What the texts define.
    pub symbols: Vec<Symbol>,
    /// Names, sorted by place.
    pub entries: Vec<Entry>,
    /// What names amount to, sorted by the place of their definition.
    pub values: Vec<KnownValue>,
    /// The dimensions of names that amount to no one number, as a `let` of a motion, sorted by the place of their definition.
    pub dimensions: Vec<(Span, Dimension)>,
}

impl Index {
    /// What the names of parsed files are.
    pub(crate) fn of_files(files: &[(FileId, Arc<ast::File>)], used: &[(Span, FileId)]) -> Index {
        let mut names = Names::default();
        names.declare(files);
        names.resolve(files);
        let mut index = names.index;
        index.entries.extend(used.iter().map(|(span, file)| Entry {
            span: *span,
            target: Target::File(*file),
            is_definition: false,
        }));
        // they come in runs that are in order
        index.entries.sort_by_key(|entry| (u64::from(entry.span.file.0) << 32) | u64::from(entry.span.start));
        // a name in a list is met once for each of its statement's parts
        index.entries.dedup_by_key(|entry| entry.span);
        index
    }

    /// The definition behind an index of this collection.
    pub fn symbol(&self, id: SymbolId) -> &Symbol {
        &self.symbols[id.0 as usize]
    }

    /// The name at a byte of a file, also right behind it.
    pub fn at(&self, file: FileId, offset: u32) -> Option<&Entry> {
        let end = self.entries.partition_point(|entry| (entry.span.file, entry.span.start) <= (file, offset));
        let near = self.entries[..end].iter().rev().take(2);
        near.filter(|entry| entry.span.file == file).find(|entry| offset <= entry.span.end)
    }

    /// What a definition restates in the end: the same for all that a name stands for in a machine and its variants.
    pub fn root(&self, mut id: SymbolId) -> SymbolId {
        // as many steps as there are definitions: variants that extend each other in a circle are wrong, and end here
        for _ in 0..self.symbols.len() {
            match self.symbol(id).restates {
                Some(earlier) => id = earlier,
                None => break,
            }
        }
        id
    }

    /// All names that lead to a definition, to what it restates, or to what restates it.
    pub fn uses(&self, id: SymbolId) -> impl Iterator<Item = &Entry> {
        let root = self.root(id);
        self.entries
            .iter()
            .filter(move |entry| matches!(entry.target, Target::Symbol(other) if self.root(other) == root))
    }

    /// The dimension of a definition whose value is no one number.
    pub fn dimension_of(&self, symbol: &Symbol) -> Option<Dimension> {
        let found = self.dimensions.binary_search_by_key(&symbol.name, |(name, _)| *name).ok()?;
        Some(self.dimensions[found].1)
    }

    /// What a definition amounts to, for each that has a value.
    pub fn values_of(&self, symbol: &Symbol) -> &[KnownValue] {
        let from = self.values.partition_point(|value| value.name < symbol.name);
        let to = self.values.partition_point(|value| value.name <= symbol.name);
        &self.values[from..to]
    }
}
