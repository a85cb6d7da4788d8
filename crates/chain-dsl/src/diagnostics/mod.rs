//! Diagnostics are data: a code, a place, a reason, a way out.

pub(crate) mod codes;
pub(crate) mod explain;
pub(crate) mod render;
pub(crate) mod rewriting;
pub(crate) mod source;
pub(crate) mod spelling;

use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Sources, Span};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Nothing can be derived from the text.
    Error,
    /// The text means something, but perhaps not what was meant.
    Warning,
}

/// A second place that belongs to the same finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// Where.
    pub span: Span,
    /// What is there: "first driven here".
    pub text: String,
}

/// A change of the text that mends a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cure {
    /// What it does: "write `hob`".
    pub title: String,
    /// What is replaced; nothing, where something is put in.
    pub span: Span,
    /// What is written there.
    pub replacement: String,
}

/// One finding about a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Stable code.
    pub code: Code,
    /// The smallest wrong place.
    pub span: Span,
    /// The reason, in the user's words, lower case, no full stop.
    pub message: String,
    /// Other places that belong to it.
    pub notes: Vec<Note>,
    /// What to write instead.
    pub help: Option<String>,
    /// Changes that mend it, the likeliest first.
    pub cures: Vec<Cure>,
    /// Changes that mend it, whose words stand in the text.
    pub(crate) rewritings: Vec<Rewriting>,
}

impl Diagnostic {
    /// A finding without further places and without help.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        let message = message.into();
        Diagnostic { code, span, message, notes: Vec::new(), help: None, cures: Vec::new(), rewritings: Vec::new() }
    }

    /// Adds a way out.
    pub fn help(mut self, help: impl Into<String>) -> Diagnostic {
        self.help = Some(help.into());
        self
    }

    /// Adds a second place.
    pub fn note(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.notes.push(Note { span, text: text.into() });
        self
    }

    /// Adds a change of the text that mends it.
    pub fn cure(mut self, title: impl Into<String>, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.cures.push(Cure { title: title.into(), span, replacement: replacement.into() });
        self
    }

    /// Says what to write, and writes it.
    pub(crate) fn writing(self, span: Span, text: &str) -> Diagnostic {
        self.help(format!("write `{text}`")).cure(format!("write `{text}`"), span, text)
    }

    /// Adds a change that mends it, whose words stand in the text.
    pub(crate) fn rewriting(mut self, by: Rewriting) -> Diagnostic {
        self.rewritings.push(by);
        self
    }

    /// With what its changes write.
    pub(crate) fn written_out(mut self, sources: &Sources) -> Diagnostic {
        self.cures.extend(self.rewritings.drain(..).filter_map(|by| by.cure(sources)));
        self
    }

    /// Error or warning: a property of the code.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }
}
