//! Why a command did not do what it was asked for, in words and as data.

use flank::Findings;
use flank_chain_dsl::{Diagnostic, Severity, Sources, render};
use serde_json::{Value, json};

use crate::spec::shown;
use crate::{Ending, eprint, print};

/// What ends a command early.
#[derive(Debug)]
pub(crate) struct Failure {
    ending: Ending,
    /// As stderr shows it.
    text: String,
    /// The same without colours and source.
    message: String,
    findings: Vec<Value>,
}

impl From<String> for Failure {
    fn from(reason: String) -> Failure {
        Failure { ending: Ending::Wrong, text: format!("error: {reason}\n"), message: reason, findings: Vec::new() }
    }
}

impl Failure {
    /// What is wrong with a spec.
    pub(crate) fn of_spec(diagnostics: &[Diagnostic], sources: &Sources) -> Failure {
        Failure {
            ending: Ending::Wrong,
            text: in_full(diagnostics, sources),
            message: counted(counts(diagnostics)),
            findings: diagnostics.iter().map(|finding| as_json(finding, sources)).collect(),
        }
    }

    /// A command line that the argument parser refuses.
    pub(crate) fn of_parser(error: &clap::Error) -> Failure {
        let message = error.to_string().trim().trim_start_matches("error: ").to_string();
        Failure { ending: Ending::Usage, text: error.render().ansi().to_string(), message, findings: Vec::new() }
    }

    /// A command line whose parts do not go together, or with a name that the program does not know.
    pub(crate) fn of_usage(reason: String) -> Failure {
        Failure { ending: Ending::Usage, ..Failure::from(reason) }
    }

    /// The same for something that cannot be solved.
    pub(crate) fn unsolved(self) -> Failure {
        Failure { ending: Ending::Unsolved, ..self }
    }

    /// Shows it on stderr, and as a document on stdout where documents are asked for.
    pub(crate) fn tell(&self, as_document: bool) -> Ending {
        eprint(&self.text);
        if as_document {
            print(&format!(
                "{:#}\n",
                json!({
                    "schema": "flank.failure/1", "exit_code": self.ending.code(),
                    "message": self.message, "findings": self.findings,
                })
            ));
        }
        self.ending
    }

    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    pub(crate) fn findings(&self) -> &[Value] {
        &self.findings
    }
}

impl From<flank::Failure> for Failure {
    fn from(failure: flank::Failure) -> Failure {
        match failure {
            flank::Failure::Findings(findings) => Failure {
                ending: Ending::Wrong,
                text: findings_in_full(&findings),
                message: counted(findings.counts()),
                findings: findings.list().iter().map(|finding| json!(finding)).collect(),
            },
            flank::Failure::Request(reason) => Failure::of_usage(reason),
            flank::Failure::Folder(error) => format!("{error}; name another folder with --out").into(),
            other => other.to_string().into(),
        }
    }
}

/// Findings with the source underlined, their number, and where to read more about the first error; empty without any.
pub(crate) fn findings_in_full(findings: &Findings) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let mut out = format!("{}{}\n", findings.rendered(true), counted(findings.counts()));
    if let Some(first) = findings.list().iter().find(|finding| finding.severity == flank::Severity::Error) {
        out += &format!("`flank explain {}` tells more\n", first.code);
    }
    out
}

/// The same of what a compilation found.
pub(crate) fn in_full(diagnostics: &[Diagnostic], sources: &Sources) -> String {
    if diagnostics.is_empty() {
        return String::new();
    }
    let mut out = format!("{}{}\n", render(diagnostics, sources, true), counted(counts(diagnostics)));
    if let Some(first) = diagnostics.iter().find(|finding| finding.severity() == Severity::Error) {
        out += &format!("`flank explain {}` tells more\n", first.code.as_str());
    }
    out
}

fn counts(diagnostics: &[Diagnostic]) -> [usize; 2] {
    let count = |severity| diagnostics.iter().filter(|finding| finding.severity() == severity).count();
    [Severity::Error, Severity::Warning].map(count)
}

/// How many errors and warnings there are.
fn counted([errors, warnings]: [usize; 2]) -> String {
    let of = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    match (errors, warnings) {
        (0, warnings) => of(warnings, "warning"),
        (errors, 0) => of(errors, "error"),
        (errors, warnings) => format!("{}, {}", of(errors, "error"), of(warnings, "warning")),
    }
}

/// A finding with its places.
pub(crate) fn as_json(finding: &Diagnostic, sources: &Sources) -> Value {
    let place = |span| {
        let (path, line, column) = sources.place(span);
        json!({ "file": shown(path), "line": line, "column": column, "text": sources.text(span) })
    };
    let notes: Vec<Value> =
        finding.notes.iter().map(|note| json!({ "place": place(note.span), "text": note.text })).collect();
    json!({
        "code": finding.code.as_str(),
        "severity": if finding.severity() == Severity::Error { "error" } else { "warning" },
        "message": finding.message,
        "place": place(finding.span),
        "notes": notes,
        "help": finding.help,
    })
}

/// What was asked for and not done, as told on stderr: a message for each line that is not indented.
pub(crate) fn not_done(told: &str) -> Value {
    let mut messages: Vec<String> = Vec::new();
    for line in told.lines() {
        match messages.last_mut() {
            Some(last) if line.starts_with(' ') => *last += &format!("\n{line}"),
            _ => messages.push(line.to_string()),
        }
    }
    json!(messages)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indented_lines_belong_to_their_message() {
        assert_eq!(not_done("a: 1\n  of b\n  of c\nd\n"), json!(["a: 1\n  of b\n  of c", "d"]));
        assert_eq!(not_done(""), json!([]));
    }
}
