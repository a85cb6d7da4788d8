//! What is found in the texts of a spec, as data.

use flank_chain_dsl::{Diagnostic, Sources, Span, render};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::project::shown_path;

/// Findings with the texts that they are about.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    diagnostics: Vec<Diagnostic>,
    sources: Sources,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Nothing can be derived from the text.
    Error,
    /// The text means something, but perhaps not what was meant.
    Warning,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// Such as E0301; `flank explain` has a page about each.
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// The reason, in the words of the text.
    pub message: String,
    /// Where it is.
    pub place: Place,
    /// Further places that it speaks of.
    pub notes: Vec<Note>,
    /// What to write instead.
    pub help: Option<String>,
    /// Changes of the text that mend it, the likeliest first.
    pub cures: Vec<FindingCure>,
}

/// A change of a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FindingCure {
    /// What it does.
    pub title: String,
    /// What is replaced; its text is empty where something is put in.
    pub place: Place,
    /// What is written there.
    pub replacement: String,
}

/// Another place that belongs to a finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Note {
    /// Where it is.
    pub place: Place,
    /// What is there.
    pub text: String,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Place {
    /// The file, as it was named, with forward slashes.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
    /// What stands there.
    pub text: String,
}

impl Findings {
    pub(crate) fn new(diagnostics: &[Diagnostic], sources: &Sources) -> Findings {
        Findings { diagnostics: diagnostics.to_vec(), sources: sources.clone() }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.diagnostics.is_empty()
    }

    /// All of them, in the order of their places.
    pub fn list(&self) -> Vec<Finding> {
        self.diagnostics.iter().map(|diagnostic| self.finding(diagnostic)).collect()
    }

    /// Numbers of errors and of warnings.
    pub fn counts(&self) -> [usize; 2] {
        let count = |severity| self.diagnostics.iter().filter(|finding| finding.severity() == severity).count();
        [flank_chain_dsl::Severity::Error, flank_chain_dsl::Severity::Warning].map(count)
    }

    /// As a person reads them: the source underlined, with ANSI colours or without.
    pub fn rendered(&self, colours: bool) -> String {
        render(&self.diagnostics, &self.sources, colours)
    }

    fn finding(&self, diagnostic: &Diagnostic) -> Finding {
        Finding {
            code: diagnostic.code.as_str(),
            severity: diagnostic.severity().into(),
            message: diagnostic.message.clone(),
            place: Place::of_span(&self.sources, diagnostic.span),
            notes: diagnostic
                .notes
                .iter()
                .map(|note| Note { place: Place::of_span(&self.sources, note.span), text: note.text.clone() })
                .collect(),
            help: diagnostic.help.clone(),
            cures: diagnostic
                .cures
                .iter()
                .map(|cure| FindingCure {
                    title: cure.title.clone(),
                    place: Place::of_span(&self.sources, cure.span),
                    replacement: cure.replacement.clone(),
                })
                .collect(),
        }
    }
}

impl Place {
    pub(crate) fn of_span(sources: &Sources, span: Span) -> Place {
        let (path, line, column) = sources.place(span);
        Place { file: shown_path(path), line, column, text: sources.text(span).to_string() }
    }
}

impl From<flank_chain_dsl::Severity> for Severity {
    fn from(severity: flank_chain_dsl::Severity) -> Severity {
        match severity {
            flank_chain_dsl::Severity::Error => Severity::Error,
            flank_chain_dsl::Severity::Warning => Severity::Warning,
        }
    }
}

impl Serialize for Findings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.list())
    }
}
