//! What `flank plot` drew.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::choices::{Choice, PlotKind};
use crate::project::columns::aligned;
use crate::project::remark::NotDone;

/// Pictures of one job, of `flank plot`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.plot/2")]
pub struct PlotResult {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// In the order in which they were asked for.
    pub pictures: Vec<WrittenPicture>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// A picture with its files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct WrittenPicture {
    /// What kind of picture it is.
    pub what: PlotKind,
    /// What is on it, in a few words.
    pub shows: String,
    /// Files written, in their order.
    pub files: Vec<String>,
}

impl Answer for PlotResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }
}

impl fmt::Display for PlotResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |one: &WrittenPicture| [one.what.name().to_string(), one.shows.clone(), one.files.join(", ")];
        let rows: Vec<[String; 3]> = self.pictures.iter().map(row).collect();
        write!(f, "job {} ({})\n\n{}", self.job, self.spec, aligned(&rows, ""))
    }
}
