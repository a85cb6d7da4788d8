//! The codes of findings, and the pages about them.

use flank_chain_dsl::Code;
use serde::Serialize;

use crate::project::findings::Severity;

/// A code of findings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorCode {
    /// `E0301`
    pub code: &'static str,
    /// What findings with it are.
    pub severity: Severity,
    /// What it means, in a few words.
    pub title: &'static str,
}

/// All codes.
pub fn error_codes() -> Vec<ErrorCode> {
    Code::ALL.iter().copied().map(ErrorCode::from).collect()
}

/// The page about a code: what it means, a wrong and a right text, in Markdown.
pub fn error_page(code: Code) -> &'static str {
    code.page()
}

impl From<Code> for ErrorCode {
    fn from(code: Code) -> ErrorCode {
        ErrorCode { code: code.as_str(), severity: code.severity().into(), title: code.title() }
    }
}
