//! The strict grammar, and what it says where it fails.

use std::num::NonZeroUsize;

use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};
use pest::iterators::Pairs;

#[derive(pest_derive::Parser)]
#[grammar = "syntax/grammar.pest"]
struct Grammar;

/// Far above what a text of the greatest allowed length needs, about 70 million: a net under the grammar, which has no rule
/// that goes back over more than a word.
const CALL_LIMIT: NonZeroUsize = NonZeroUsize::new(1 << 27).expect("not zero");

/// Where the grammar gave up.
pub(super) struct Failure {
    /// The furthest place that it came to.
    pub(super) place: usize,
    /// What could have stood there.
    pub(super) expected: Vec<Rule>,
}

/// Parses the whole of a text by a rule that asks for its end.
pub(super) fn strict(rule: Rule, text: &str) -> Result<Pairs<'_, Rule>, Failure> {
    pest::set_call_limit(Some(CALL_LIMIT));
    Grammar::parse(rule, text).map_err(|error| Failure {
        place: match error.location {
            InputLocation::Pos(place) | InputLocation::Span((place, _)) => place,
        },
        expected: match error.variant {
            ErrorVariant::ParsingError { positives, .. } => positives,
            ErrorVariant::CustomError { .. } => Vec::new(),
        },
    })
}
