//! Diagnostics are data: a code, a place, a reason, a way out.

pub(crate) mod codes;
pub(crate) mod explain;
pub(crate) mod render;
pub(crate) mod source;
pub(crate) mod spelling;

use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;

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
}

impl Diagnostic {
    /// A finding without further places and without help.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic { code, span, message: message.into(), notes: Vec::new(), help: None }
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

    /// Error or warning: a property of the code.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }
}
