//! What becomes of an operation.

use serde_json::Value;

/// What an operation has to say of one job, or of all that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// For people.
    pub text: String,
    /// For programs: a document with its `schema`, what was not done among it.
    pub document: Value,
    /// What is to be known beside it, in whole lines.
    pub notes: String,
    /// What was asked for and not done, and why, in whole lines; empty if everything was.
    pub not_done: String,
}

impl Answer {
    /// Whether everything was done that was asked for.
    pub fn is_complete(&self) -> bool {
        self.not_done.is_empty()
    }
}
