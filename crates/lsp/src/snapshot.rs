//! The texts at one moment, and what is known of them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use flank::{Analysis, Project, TextSpan, analyse};
use gen_lsp_types::{Location, Position, Range, Uri};

use super::Spelling;
use super::documents::{Document, Documents};
use super::position::Lines;
use super::tasks::Solves;

/// What was compiled, for as long as none of its texts changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Analyses {
    known: Arc<Mutex<Known>>,
}

#[derive(Debug, Default)]
struct Known {
    /// Of changes, the last one that was heard of.
    generation: u64,
    /// With the generation of the texts that each was compiled from.
    of: BTreeMap<PathBuf, (u64, Arc<Analysis>)>,
}

impl Analyses {
    /// Forgets whatever a file is part of; all, if it is none in particular.
    pub(super) fn forget(&self, file: Option<&Path>, generation: u64) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.generation = generation;
        known.of.retain(|_, (_, analysis)| {
            file.is_some_and(|file| !analysis.lacks_files() && !analysis.files().iter().any(|of| of == file))
        });
    }

    /// What is known of a text as it was at a generation: an answer about older texts takes nothing from newer ones.
    fn get(&self, path: &Path, generation: u64) -> Option<Arc<Analysis>> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let (made, analysis) = known.of.get(path)?;
        (*made <= generation).then(|| Arc::clone(analysis))
    }

    fn keep(&self, path: &Path, generation: u64, analysis: &Arc<Analysis>) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        // a text may have changed meanwhile
        if known.generation == generation {
            known.of.insert(path.to_path_buf(), (generation, Arc::clone(analysis)));
        }
    }
}

/// All texts at one moment.
#[derive(Clone, Debug)]
pub(super) struct Snapshot {
    pub(super) documents: Documents,
    pub(super) analyses: Analyses,
    pub(super) solves: Solves,
    pub(super) options: Options,
    pub(super) spelled: Spelling,
}

/// What the editor has set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Options {
    /// Values beside plain numbers, too.
    pub(super) literal_values: bool,
    /// Whether the editor leads through places to fill.
    pub(super) snippets: bool,
    /// Whether what is said of a name is shown as it is written, not as Markdown.
    pub(super) plain_text: bool,
}

/// A text with what is known of it.
pub(super) struct Opened<'s> {
    pub(super) path: PathBuf,
    pub(super) document: &'s Document,
    pub(super) analysis: Arc<Analysis>,
}

impl Opened<'_> {
    pub(super) fn lines(&self) -> Lines<'_> {
        Lines::of(&self.document.text)
    }

    pub(super) fn offset(&self, position: Position) -> usize {
        self.lines().offset(position)
    }
}

impl Snapshot {
    /// A text of the editor, compiled.
    pub(super) fn opened(&self, uri: &Uri) -> Option<Opened<'_>> {
        let (path, document) = self.documents.find(&uri.0)?;
        let analysis = self.analysis(&path);
        Some(Opened { path, document, analysis })
    }

    pub(super) fn analysis(&self, path: &Path) -> Arc<Analysis> {
        if let Some(known) = self.analyses.get(path, self.documents.generation) {
            return known;
        }
        let analysis = Arc::new(analyse(&self.project(path)));
        self.analyses.keep(path, self.documents.generation, &analysis);
        analysis
    }

    /// A spec over the texts of the editor.
    pub(super) fn project(&self, path: &Path) -> Project {
        Project::open(path, Arc::new(self.documents.clone()))
    }

    pub(super) fn places<'s>(&'s self, analysis: &'s Analysis) -> Places<'s> {
        Places { documents: &self.documents, analysis, lines: RefCell::default() }
    }
}

/// Places in the files of a compiled spec as the editor counts them: the lines of each text are looked for once.
pub(super) struct Places<'s> {
    documents: &'s Documents,
    analysis: &'s Analysis,
    lines: RefCell<BTreeMap<PathBuf, Lines<'s>>>,
}

impl<'s> Places<'s> {
    pub(super) fn location(&self, span: &TextSpan) -> Option<Location> {
        Some(Location { uri: Uri(self.documents.uri_of(&span.file)), range: self.range(span)? })
    }

    pub(super) fn range(&self, span: &TextSpan) -> Option<Range> {
        let mut lines = self.lines.borrow_mut();
        if !lines.contains_key(&span.file) {
            lines.insert(span.file.clone(), Lines::of(self.text(&span.file)?));
        }
        lines.get(&span.file).map(|lines| lines.range(span.start, span.end))
    }

    /// Of the library there may be texts into which no `use` leads.
    fn text(&self, file: &Path) -> Option<&'s str> {
        let shipped = || flank::ShippedFiles::text(flank::ShippedFiles::inside(file)?);
        self.analysis.text_of(file).or_else(shipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_newer_texts_mean_is_kept_from_older_ones() {
        let path = Path::new("gear.chain");
        let analysis = Arc::new(analyse(&Project::open(path, Arc::new(Documents::default()))));
        let analyses = Analyses::default();
        analyses.forget(Some(path), 2);
        analyses.keep(path, 1, &analysis);
        assert!(analyses.get(path, 1).is_none(), "the text has changed since");
        analyses.keep(path, 2, &analysis);
        assert!(analyses.get(path, 1).is_none());
        assert!(analyses.get(path, 2).is_some() && analyses.get(path, 3).is_some());
    }
}
