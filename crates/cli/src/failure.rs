//! Why a command did not do what it was asked for, in words and as data.

use flank::{Finding, Findings, NotDone};

use crate::document::{self, FailureDocument};
use crate::spelling::with_flags;
use crate::{Ending, eprint, print};

/// What ends a command early.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    ending: Ending,
    /// As stderr shows it.
    text: String,
    /// The same without colours and source.
    message: String,
    findings: Vec<Finding>,
    not_done: Vec<NotDone>,
}

impl From<String> for Failure {
    fn from(reason: String) -> Failure {
        let text = format!("error: {reason}\n");
        Failure { ending: Ending::Wrong, text, message: reason, findings: Vec::new(), not_done: Vec::new() }
    }
}

impl Failure {
    /// A command line that the argument parser refuses.
    pub(crate) fn of_parser(error: &clap::Error) -> Failure {
        let message = error.to_string().trim().trim_start_matches("error: ").to_string();
        Failure { ending: Ending::Usage, text: error.render().ansi().to_string(), ..Failure::from(message) }
    }

    /// A command line whose parts do not go together, or with a name that the program does not know.
    pub(crate) fn of_usage(reason: String) -> Failure {
        Failure { ending: Ending::Usage, ..Failure::from(reason) }
    }

    /// Shows it on stderr, and as a document on stdout where documents are asked for.
    pub(crate) fn tell(&self, as_document: bool) -> Ending {
        eprint(&self.text);
        if as_document {
            let Failure { message, findings, not_done, .. } = self.clone();
            print(&document::text(&FailureDocument { exit_code: self.ending.code(), message, findings, not_done }));
        }
        self.ending
    }

    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    pub(crate) fn findings(&self) -> &[Finding] {
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
                findings: findings.list().into_iter().map(spelled).collect(),
                not_done: Vec::new(),
            },
            flank::Failure::Request(reason) => Failure::of_usage(with_flags(&reason)),
            flank::Failure::Unsolved(reason) => {
                Failure { ending: Ending::Unsolved, ..Failure::from(with_flags(&reason)) }
            }
            flank::Failure::TooLarge(reason) => {
                Failure { ending: Ending::OutOfMemory, ..Failure::from(with_flags(&reason)) }
            }
            flank::Failure::NotDone(not_done) => {
                let each: Vec<String> = not_done.iter().map(|missing| with_flags(&missing.to_string())).collect();
                Failure { ending: Ending::Unsolved, not_done, ..Failure::from(each.join("\n")) }
            }
            flank::Failure::Folder(error) => format!("{error}; name another folder with --out").into(),
            other => with_flags(&other.to_string()).into(),
        }
    }
}

/// With flags for the library's options, in words and in the names of what was given with one.
fn spelled(mut finding: Finding) -> Finding {
    let places = finding.notes.iter_mut().map(|note| &mut note.place).chain([&mut finding.place]);
    places.for_each(|place| place.file = with_flags(&place.file));
    finding.message = with_flags(&finding.message);
    finding.help = finding.help.map(|help| with_flags(&help));
    finding
}

/// Findings with the source underlined, their number, and where to read more about the first error; empty without any.
pub(crate) fn findings_in_full(findings: &Findings) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let mut out = format!("{}{}\n", with_flags(&findings.rendered(true)), counted(findings.counts()));
    if let Some(first) = findings.list().iter().find(|finding| finding.severity == flank::Severity::Error) {
        out += &format!("for more about this error: `flank explain {}`\n", first.code);
    }
    out
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
