//! What a user gives goes into a template's text, and what is found there is shown where the user gave it.

use std::ops::Range;

use flank_chain_dsl::syntax::parse_expression;
use flank_chain_dsl::{Diagnostic, FileId, Sources, Span};

use crate::project::failure::Failure;
use crate::project::findings::Findings;

/// Words that a user gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// The words.
    pub text: String,
    /// What findings call the place where they were given.
    pub origin: String,
}

/// Something that a user gives, as it was given.
#[derive(Clone)]
pub(super) struct Given {
    /// What findings call the place where it was given.
    origin: String,
    text: String,
    /// Where in that text the words begin that go into the template.
    start: usize,
}

impl Given {
    pub(super) fn name(name: &Words) -> Given {
        Given { origin: name.origin.clone(), text: name.text.clone(), start: 0 }
    }

    pub(super) fn value(parameter: &str, value: &Words) -> Given {
        Given { origin: value.origin.clone(), text: format!("{parameter}={}", value.text), start: parameter.len() + 1 }
    }

    fn words(&self) -> &str {
        &self.text[self.start..]
    }

    /// # Errors
    /// If a value is no expression by itself.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let mut sources = Sources::default();
        let file = sources.add(&self.origin, self.text.as_str());
        match parse_expression(&self.text, file, self.start as u32).1 {
            found if found.is_empty() => Ok(()),
            found => Err(Failure::Findings(Findings::new(&found, &sources))),
        }
    }
}

/// What goes into a template's text, and where in it, in the order of the places.
pub(super) struct Changes(Vec<(Span, Given)>);

impl Changes {
    pub(super) fn new(mut changes: Vec<(Span, Given)>) -> Changes {
        changes.sort_by_key(|(place, _)| place.start);
        Changes(changes)
    }

    /// The text with the changes.
    pub(super) fn applied(&self, text: &str) -> String {
        let mut out = text.to_owned();
        for (place, given) in self.0.iter().rev() {
            out.replace_range(place.start as usize..place.end as usize, given.words());
        }
        out
    }

    /// Where the changes are in the changed text.
    fn places(&self) -> impl Iterator<Item = (Range<usize>, &Given)> {
        let mut moved = 0;
        self.0.iter().map(move |(place, given)| {
            let start = (place.start as usize).wrapping_add(moved);
            let range = start..start + given.words().len();
            moved = range.end.wrapping_sub(place.end as usize);
            (range, given)
        })
    }

    /// Moves findings in what was given from the changed text to where it was given.
    pub(super) fn shown_as_given(&self, findings: &mut [Diagnostic], changed: FileId, sources: &mut Sources) {
        for (range, given) in self.places() {
            let file = sources.add(&given.origin, given.text.as_str());
            let moved = |span: &mut Span| {
                let (start, end) = (span.start as usize, span.end as usize);
                if span.file == changed && range.start <= start && end <= range.end {
                    let at = |place: usize| (place - range.start + given.start) as u32;
                    *span = Span { file, start: at(start), end: at(end) };
                }
            };
            for finding in findings.iter_mut() {
                moved(&mut finding.span);
                finding.notes.iter_mut().for_each(|note| moved(&mut note.span));
            }
        }
    }
}
