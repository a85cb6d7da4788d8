//! Findings as the editor shows them, for each text: those of all open specs that read it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use flank::{Analysis, LocatedFinding, Severity};
use gen_lsp_types::{
    Code, CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Message,
    PublishDiagnosticsParams, Uri,
};

use super::snapshot::Snapshot;
use super::uri::ERRORS;

/// What was found in open specs, and what the editor has been told.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// By the spec that was compiled, then by the file that it is about.
    of: BTreeMap<PathBuf, BTreeMap<PathBuf, Vec<Diagnostic>>>,
    /// The files that each spec reads; nothing of one that lacks files.
    reads: BTreeMap<PathBuf, Option<BTreeSet<PathBuf>>>,
}

impl Findings {
    /// The open specs that a change of a file may matter to.
    pub(super) fn readers(&self, file: &Path) -> Vec<PathBuf> {
        let reads = |files: &Option<BTreeSet<PathBuf>>| files.as_ref().is_none_or(|files| files.contains(file));
        self.reads.iter().filter(|(_, files)| reads(files)).map(|(spec, _)| spec.clone()).collect()
    }

    /// Takes what is found in a spec now; gives what the editor has to be told.
    pub(super) fn put(
        &mut self,
        spec: &Path,
        analysis: &Analysis,
        snapshot: &Snapshot,
    ) -> Vec<PublishDiagnosticsParams> {
        let mut new: BTreeMap<PathBuf, Vec<Diagnostic>> = BTreeMap::new();
        new.entry(spec.to_path_buf()).or_default();
        for found in analysis.findings() {
            let Some(diagnostic) = diagnostic(&found, analysis, snapshot) else { continue };
            new.entry(found.span.file.clone()).or_default().push(diagnostic);
        }
        let files = analysis.files().into_iter().collect();
        self.reads.insert(spec.to_path_buf(), (!analysis.lacks_files()).then_some(files));
        let old = self.of.insert(spec.to_path_buf(), new).unwrap_or_default();
        let about: BTreeSet<PathBuf> = old.into_keys().chain(self.of[spec].keys().cloned()).collect();
        about.iter().map(|file| self.told(file, snapshot)).collect()
    }

    /// Forgets a spec that is closed.
    pub(super) fn remove(&mut self, spec: &Path, snapshot: &Snapshot) -> Vec<PublishDiagnosticsParams> {
        self.reads.remove(spec);
        let old = self.of.remove(spec).unwrap_or_default();
        let mut about: BTreeSet<PathBuf> = old.into_keys().collect();
        about.insert(spec.to_path_buf());
        about.iter().map(|file| self.told(file, snapshot)).collect()
    }

    /// All that is found in a file, each finding once.
    fn told(&self, file: &Path, snapshot: &Snapshot) -> PublishDiagnosticsParams {
        let mut all: Vec<Diagnostic> = Vec::new();
        for found in self.of.values().filter_map(|files| files.get(file)).flatten() {
            if !all.contains(found) {
                all.push(found.clone());
            }
        }
        all.sort_by_key(|found| (found.range.start.line, found.range.start.character));
        PublishDiagnosticsParams {
            uri: Uri(snapshot.documents.uri_of(file)),
            version: snapshot.documents.get(file).map(|document| document.version),
            diagnostics: all,
        }
    }
}

/// A finding with the same code, place and words as on the command line.
pub(super) fn diagnostic(found: &LocatedFinding, analysis: &Analysis, snapshot: &Snapshot) -> Option<Diagnostic> {
    let (finding, spelled) = (&found.finding, snapshot.spelled);
    let message = match &finding.help {
        Some(help) => format!("{}\nhelp: {}", spelled(&finding.message), spelled(help)),
        None => spelled(&finding.message),
    };
    let related = found.notes.iter().filter_map(|(span, text)| {
        Some(DiagnosticRelatedInformation { location: snapshot.location(analysis, span)?, message: spelled(text) })
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    let is_error = finding.severity == Severity::Error;
    Some(Diagnostic {
        range: snapshot.range(analysis, &found.span).unwrap_or_default(),
        severity: Some(if is_error { DiagnosticSeverity::Error } else { DiagnosticSeverity::Warning }),
        code: Some(Code::String(finding.code.to_string())),
        code_description: Some(CodeDescription { href: Uri(format!("{ERRORS}:/{}.md", finding.code)) }),
        source: Some("flank".to_string()),
        message: Message::String(message),
        tags: found.is_about_unused().then(|| vec![DiagnosticTag::Unnecessary]),
        related_information: (!related.is_empty()).then_some(related),
        data: None,
    })
}
