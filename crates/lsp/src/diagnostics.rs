//! Findings as the editor shows them, for each text: those of all open specs that read it.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use flank::{Analysis, LocatedFinding, Severity};
use gen_lsp_types::{
    Code, CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Message,
    PublishDiagnosticsParams, Uri,
};

use super::Spelling;
use super::documents::Documents;
use super::snapshot::{Places, Snapshot};
use super::uri::ERRORS;

/// What is found in a spec, as it was at one moment.
#[derive(Debug)]
pub(super) struct Found {
    /// Of the texts.
    pub(super) generation: u64,
    /// By the file that it is about.
    of: BTreeMap<PathBuf, Vec<Diagnostic>>,
    /// The files that the spec reads; nothing of one that lacks files.
    reads: Option<BTreeSet<PathBuf>>,
    pub(super) has_jobs: bool,
    /// Tells the texts from others.
    pub(super) texts: u64,
}

impl Found {
    pub(super) fn of(spec: &Path, analysis: &Analysis, snapshot: &Snapshot) -> Found {
        let mut of: BTreeMap<PathBuf, Vec<Diagnostic>> = BTreeMap::new();
        of.entry(spec.to_path_buf()).or_default();
        let places = snapshot.places(analysis);
        for found in analysis.findings() {
            let diagnostic = diagnostic(&found, &places, snapshot.spelled);
            of.entry(found.span.file).or_default().push(diagnostic);
        }
        Found {
            generation: snapshot.documents.generation,
            of,
            reads: (!analysis.lacks_files()).then(|| analysis.files().into_iter().collect()),
            has_jobs: !analysis.jobs().is_empty(),
            texts: analysis.texts(),
        }
    }
}

/// What was found in open specs, and what they read.
#[derive(Debug, Default)]
pub(super) struct Findings {
    of: BTreeMap<PathBuf, Found>,
    /// Also of specs that were open: the page may show one of them.
    reads: BTreeMap<PathBuf, Option<BTreeSet<PathBuf>>>,
    /// What the editor was told last of each file, as far as it shows something or is open.
    told: BTreeMap<PathBuf, PublishDiagnosticsParams>,
}

impl Findings {
    /// The specs that a change of a file may matter to.
    pub(super) fn readers(&self, file: &Path) -> Vec<PathBuf> {
        let reads = |files: &Option<BTreeSet<PathBuf>>| files.as_ref().is_none_or(|files| files.contains(file));
        self.reads.iter().filter(|(_, files)| reads(files)).map(|(spec, _)| spec.clone()).collect()
    }

    /// Whether an open spec has a job, as far as it is known.
    pub(super) fn has_jobs(&self, spec: &Path) -> Option<bool> {
        self.of.get(spec).map(|found| found.has_jobs)
    }

    /// Takes what is found in a spec now; gives what the editor has to be told.
    pub(super) fn put(
        &mut self,
        spec: &Path,
        mut found: Found,
        documents: &Documents,
    ) -> Vec<PublishDiagnosticsParams> {
        self.reads.insert(spec.to_path_buf(), found.reads.take());
        let mut about: BTreeSet<PathBuf> = found.of.keys().cloned().collect();
        let old = self.of.insert(spec.to_path_buf(), found);
        about.extend(old.into_iter().flat_map(|old| old.of.into_keys()));
        about.iter().flat_map(|file| self.news(file, documents)).collect()
    }

    /// Forgets a spec that is closed.
    pub(super) fn remove(&mut self, spec: &Path, documents: &Documents) -> Vec<PublishDiagnosticsParams> {
        let old = self.of.remove(spec);
        let mut about: BTreeSet<PathBuf> = old.into_iter().flat_map(|old| old.of.into_keys()).collect();
        about.insert(spec.to_path_buf());
        about.iter().flat_map(|file| self.news(file, documents)).collect()
    }

    /// What the editor does not know yet of a file. Of each version of an open text it is told once, also that nothing has changed.
    fn news(&mut self, file: &Path, documents: &Documents) -> Vec<PublishDiagnosticsParams> {
        let Some(now) = self.found_in(file, documents) else { return Vec::new() };
        let before = self.told.remove(file);
        if now.version.is_some() || !now.diagnostics.is_empty() {
            self.told.insert(file.to_path_buf(), now.clone());
        }
        // a text may have been open under another address, behind a link
        let is_left = |before: &PublishDiagnosticsParams| before.uri != now.uri && !before.diagnostics.is_empty();
        let nothing = |before: PublishDiagnosticsParams| PublishDiagnosticsParams {
            uri: before.uri,
            version: None,
            diagnostics: Vec::new(),
        };
        let is_known = match &before {
            Some(before) => {
                *before == now
                    || (now.version.is_none() && before.uri == now.uri && before.diagnostics == now.diagnostics)
            }
            None => now.version.is_none() && now.diagnostics.is_empty(),
        };
        let left = before.filter(is_left).map(nothing);
        left.into_iter().chain((!is_known).then_some(now)).collect()
    }

    /// All that is found in a file as it is now, each finding once. What a spec that uses it found in an older text has no place in a newer one,
    /// and of an open text nothing is told before its own findings are known.
    fn found_in(&self, file: &Path, documents: &Documents) -> Option<PublishDiagnosticsParams> {
        let document = documents.get(file);
        let is_now = |found: &&Found| document.is_none_or(|document| document.since <= found.generation);
        let own = self.of.get(file).filter(is_now);
        if document.is_some() && own.is_none() {
            return None;
        }
        let others = self.of.iter().filter(|(spec, _)| *spec != file).map(|(_, found)| found).filter(is_now);
        let mut all: Vec<&Diagnostic> =
            own.into_iter().chain(others).filter_map(|found| found.of.get(file)).flatten().collect();
        let mut seen = HashSet::new();
        all.retain(|found| seen.insert(*found));
        all.sort_by_key(|found| (found.range.start.line, found.range.start.character));
        Some(PublishDiagnosticsParams {
            uri: Uri(documents.uri_of(file)),
            version: document.map(|document| document.version),
            diagnostics: all.into_iter().cloned().collect(),
        })
    }
}

/// A finding with the same code, place and words as on the command line.
pub(super) fn diagnostic(found: &LocatedFinding, places: &Places<'_>, spelled: Spelling) -> Diagnostic {
    let finding = &found.finding;
    let message = match &finding.help {
        Some(help) => format!("{}\nhelp: {}", spelled(&finding.message), spelled(help)),
        None => spelled(&finding.message),
    };
    let related = found.notes.iter().filter_map(|(span, text)| {
        Some(DiagnosticRelatedInformation { location: places.location(span)?, message: spelled(text) })
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    let is_error = finding.severity == Severity::Error;
    Diagnostic {
        range: places.range(&found.span).unwrap_or_default(),
        severity: Some(if is_error { DiagnosticSeverity::Error } else { DiagnosticSeverity::Warning }),
        code: Some(Code::String(finding.code.to_string())),
        code_description: Some(CodeDescription { href: Uri(format!("{ERRORS}:/{}.md", finding.code)) }),
        source: Some("flank".to_string()),
        message: Message::String(message),
        tags: found.is_about_unused().then(|| vec![DiagnosticTag::Unnecessary]),
        related_information: (!related.is_empty()).then_some(related),
        data: None,
    }
}
