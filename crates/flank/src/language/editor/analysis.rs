//! A spec as an editor has it: its texts, what is found in them, its names.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use flank_chain_dsl::{Diagnostic, FileId, Index, NameKind, Sources, Span, SymbolId};
use flank_expr::Graph;

use crate::project::Project;
use crate::project::findings::{Finding, Findings};

/// A compiled spec with its index of names.
#[derive(Clone, Debug)]
pub struct Analysis {
    pub(in crate::language) sources: Sources,
    pub(in crate::language) diagnostics: Vec<Diagnostic>,
    pub(super) index: Index,
    pub(super) main: FileId,
}

/// A part of a text file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextSpan {
    /// The file, without links and `..`.
    pub file: PathBuf,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// A part of a text and what is written there instead.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextEdit {
    /// What is replaced; empty where something is put in.
    pub span: TextSpan,
    /// What is written there.
    pub replacement: String,
}

/// A change that mends a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextCure {
    /// What it does.
    pub title: String,
    /// The change.
    pub edit: TextEdit,
}

/// A finding with its places in bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct LocatedFinding {
    /// Code, message, help.
    pub finding: Finding,
    /// Where it is; the whole file is empty where it cannot be read.
    pub span: TextSpan,
    /// Further places, with what is there.
    pub notes: Vec<(TextSpan, String)>,
    /// Changes that mend it, the likeliest first.
    pub cures: Vec<TextCure>,
}

impl LocatedFinding {
    /// Whether it is about something that could be left out.
    pub fn is_about_unused(&self) -> bool {
        ["W0001", "W0002", "W0003"].contains(&self.finding.code)
    }
}

/// Compiles the spec of a project with the files that it uses.
pub fn analyse(project: &Project) -> Analysis {
    let graph = Graph::new();
    let compilation = project.compiled(&graph);
    let main = compilation.sources.files().map(|(id, _)| id).next().unwrap_or(FileId(0));
    Analysis { sources: compilation.sources, diagnostics: compilation.diagnostics, index: compilation.index, main }
}

impl Analysis {
    /// All that is found, with places; what is about no file has the place of the spec's first byte.
    pub fn findings(&self) -> Vec<LocatedFinding> {
        let list = Findings::new(&self.diagnostics, &self.sources).list();
        let is_windows: Vec<bool> = self.sources.files().map(|(_, file)| file.text.contains("\r\n")).collect();
        let both = list.into_iter().zip(&self.diagnostics);
        both.map(|(finding, diagnostic)| self.located(finding, diagnostic, &is_windows)).collect()
    }

    /// With the changes that mend it: each with the line ends of its text.
    fn located(&self, finding: Finding, diagnostic: &Diagnostic, is_windows: &[bool]) -> LocatedFinding {
        let start = Span { file: self.main, start: 0, end: 0 };
        let of_main = || self.text_span(start).unwrap_or_else(|| self.shown_span(start));
        let notes = diagnostic.notes.iter();
        let cures = diagnostic.cures.iter().filter_map(|cure| {
            let replacement = with_line_ends(&cure.replacement, is_windows[cure.span.file.0 as usize]);
            let edit = TextEdit { span: self.text_span(cure.span)?, replacement };
            Some(TextCure { title: cure.title.clone(), edit })
        });
        LocatedFinding {
            span: self.text_span(diagnostic.span).unwrap_or_else(of_main),
            notes: notes.filter_map(|note| Some((self.text_span(note.span)?, note.text.clone()))).collect(),
            cures: cures.collect(),
            finding,
        }
    }

    /// Tells the texts and tables that were read from others.
    pub fn texts(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        for (_, file) in self.sources.files() {
            (&file.path, &file.text).hash(&mut hasher);
        }
        hasher.finish()
    }

    /// The files that were read, without links and `..`, the spec itself first.
    pub fn files(&self) -> Vec<PathBuf> {
        self.sources.files().filter_map(|(_, file)| file.file.clone()).collect()
    }

    /// The text of one of the files.
    pub fn text_of(&self, file: &Path) -> Option<&str> {
        let found = self.sources.files().find(|(_, known)| known.file.as_deref() == Some(file));
        found.map(|(_, file)| file.text.as_str())
    }

    /// Whether a file could not be read: what it declares is not known.
    pub fn lacks_files(&self) -> bool {
        self.diagnostics.iter().any(|found| ["E0001", "E0003"].contains(&found.code.as_str()))
    }

    /// The text of the spec itself.
    pub fn text(&self) -> &str {
        &self.sources.file(self.main).text
    }

    /// A place in a file; none of a text that is no file.
    pub(super) fn text_span(&self, span: Span) -> Option<TextSpan> {
        let file = self.sources.file(span.file).file.clone()?;
        Some(TextSpan { file, start: span.start as usize, end: span.end as usize })
    }

    fn shown_span(&self, span: Span) -> TextSpan {
        TextSpan { file: self.sources.file(span.file).path.clone(), start: span.start as usize, end: span.end as usize }
    }

    pub(super) fn name(&self, id: SymbolId) -> &str {
        self.sources.text(self.index.symbol(id).name)
    }

    /// Definitions that belong to one, or to what it extends, the nearest first.
    pub(super) fn members(&self, owner: SymbolId) -> Vec<SymbolId> {
        let (mut found, mut known) = (Vec::new(), HashSet::new());
        let mut at = Some(owner);
        // as many steps as there are definitions: a circle is wrong, and ends here
        for _ in 0..self.index.symbols.len() {
            let Some(of) = at else { break };
            let own = self.index.symbols.iter().zip(0u32..).filter(|(symbol, _)| symbol.owner == Some(of));
            let own: Vec<SymbolId> = own.map(|(_, id)| SymbolId(id)).collect();
            // two of one name in one place are both told: it is an error
            found.extend(own.iter().copied().filter(|id| !known.contains(&(self.name(*id), self.kind(*id)))));
            known.extend(own.iter().map(|id| (self.name(*id), self.kind(*id))));
            at = self.index.symbol(of).definition.filter(|_| self.is_item(of));
        }
        found
    }

    pub(super) fn kind(&self, id: SymbolId) -> NameKind {
        self.index.symbol(id).kind
    }

    fn is_item(&self, id: SymbolId) -> bool {
        matches!(self.kind(id), NameKind::Machine | NameKind::Job)
    }

    /// The definitions of all files that stand by themselves.
    pub(super) fn items(&self) -> impl Iterator<Item = SymbolId> {
        let all = self.index.symbols.iter().zip(0u32..);
        all.filter(|(symbol, _)| symbol.owner.is_none() && is_item_kind(symbol.kind)).map(|(_, id)| SymbolId(id))
    }
}

fn with_line_ends(text: &str, is_windows: bool) -> String {
    if is_windows { text.replace("\r\n", "\n").replace('\n', "\r\n") } else { text.to_string() }
}

fn is_item_kind(kind: NameKind) -> bool {
    matches!(kind, NameKind::Machine | NameKind::Tool | NameKind::Job | NameKind::Function)
}
