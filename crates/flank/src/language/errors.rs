//! The codes of findings, and the pages about them.

use flank_chain_dsl::Code;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::findings::Severity;

/// A code of findings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ErrorCode {
    /// Such as E0301.
    pub code: &'static str,
    /// What findings with it are.
    pub severity: Severity,
    /// What it means, in a few words.
    pub title: &'static str,
}

/// Codes of errors and warnings, of `flank explain`: one with its page, or all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.explain/1")]
#[schemars(extend("oneOf" = [
    { "required": ["codes"], "maxProperties": 2 },
    { "required": ["code", "severity", "title", "page"], "maxProperties": 5 },
]))]
pub struct Explanation {
    /// Such as E0301.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "&str")]
    pub code: Option<&'static str>,
    /// What findings with it are.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Severity")]
    pub severity: Option<Severity>,
    /// What it means, in a few words.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "&str")]
    pub title: Option<&'static str>,
    /// Markdown.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "&str")]
    pub page: Option<&'static str>,
    /// All of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<ErrorCode>")]
    pub codes: Option<Vec<ErrorCode>>,
}

impl Explanation {
    /// Of one code, with its page.
    pub fn of_code(code: Code) -> Explanation {
        let ErrorCode { code: name, severity, title } = code.into();
        Explanation {
            code: Some(name),
            severity: Some(severity),
            title: Some(title),
            page: Some(error_page(code)),
            codes: None,
        }
    }

    /// Of all codes, without their pages.
    pub fn of_all() -> Explanation {
        Explanation { codes: Some(error_codes()), ..Explanation::default() }
    }
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
