//! What `flank view` wrote.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::remark::{NotDone, Remark};

/// The page of one job, of `flank view`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.view/2")]
pub struct ViewResult {
    /// The job of the spec.
    pub job: String,
    /// Points.
    pub asked: usize,
    /// Points.
    pub solved: usize,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// Size of the page; null where there is no point to show.
    pub bytes: Option<u64>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

impl Answer for ViewResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}

impl fmt::Display for ViewResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ViewResult { job, asked, solved, files, bytes, .. } = self;
        let Some(bytes) = bytes else { return Ok(()) };
        writeln!(f, "job {job}: {solved} of {asked} points")?;
        writeln!(f, "wrote {}, {} kB", files.join(", "), bytes.div_ceil(1000))
    }
}
