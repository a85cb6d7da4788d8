//! What all results of operations have in common.

use std::fmt::Display;

use serde::Serialize;

use crate::project::not_done::{self, NotDone};

/// The result of an operation on jobs. Its [`Display`] is the text for people, its serialisation a document with its `schema`
/// ([`schema_of`](crate::schema_of) has what it says).
pub trait Answer: Display + Serialize + Send + Sync + 'static {
    /// What was asked for and not done; empty if everything was.
    fn not_done(&self) -> &[NotDone];

    /// What is to be known beside it, in whole lines.
    fn notes(&self) -> &str {
        ""
    }

    /// Whether everything was done that was asked for.
    fn is_complete(&self) -> bool {
        self.not_done().is_empty()
    }

    /// What was not done as people read it, in whole lines.
    fn not_done_text(&self) -> String {
        not_done::lines(self.not_done())
    }
}
