//! What was asked for and not done, as data.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

/// Something that was asked for and not done. Documents hold its message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotDone {
    /// What kind of thing it is.
    pub kind: NotDoneKind,
    /// The surface, axis or setting that it is about, if it is about one.
    pub of: Option<String>,
    /// The reason in words, with a way out if there is one. Lines after the first are indented.
    pub message: String,
}

/// Kinds of what was not done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotDoneKind {
    /// The ranges of a surface hold several branches, and nothing says which one is meant.
    Ambiguous,
    /// Points are not solved.
    NotSolved,
    /// Points do not keep what their sample requires.
    NotAsRequired,
    /// Points are solved, but no proof of them was found.
    NotCertified,
    /// What single edges leave is not known at some points.
    HeightUnknown,
    /// An axis goes beyond its travel.
    BeyondTravel,
    /// A smooth face is not there, or not shown to be as exact as asked for.
    FaceInexact,
    /// The deviation is not known at some points.
    NoDeviation,
    /// Places of a grid were not measured.
    NotMeasured,
    /// Another machine does not do what it should.
    NotReached,
    /// A page has nothing to show.
    NoPage,
}

impl NotDone {
    pub(crate) fn new(kind: NotDoneKind, of: &str, message: impl Into<String>) -> NotDone {
        let message: String = message.into();
        NotDone { kind, of: Some(of.to_string()), message: message.trim_end().to_string() }
    }

    /// The first line of its message.
    pub(crate) fn headline(&self) -> &str {
        self.message.lines().next().unwrap_or_default()
    }
}

/// The message.
impl fmt::Display for NotDone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Serialize for NotDone {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.message)
    }
}

impl JsonSchema for NotDone {
    fn schema_name() -> Cow<'static, str> {
        "NotDone".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string" })
    }
}

/// All messages, each in lines of its own; empty without any.
pub(crate) fn lines(all: &[NotDone]) -> String {
    all.iter().map(|one| format!("{one}\n")).collect()
}
