//! What can be asked of a study.

use std::path::PathBuf;
use std::time::Duration;

use crate::project::requests::{JobSelection, ToleratedAmount};
use crate::project::session::EvaluatorOptions;

/// Many cases of a job.
#[derive(Clone, Debug)]
pub struct SweepRequest {
    /// One job, with the values that all cases have in common.
    pub jobs: JobSelection,
    /// What differs from case to case.
    pub cases: CaseSource,
    /// What becomes of each case: `points`, `limits`, `ease_off:SURFACE`, `width:SURFACE,SURFACE`, `curvature:SURFACE`, `at:SURFACE[row,column]`,
    /// `requirements`, `contact:CONTACT`.
    pub collect: Vec<String>,
    /// Whether the points of all samples are kept, in a file for each case.
    pub keep_points: bool,
    /// The folder of the study; made if it is not there.
    pub out: PathBuf,
    /// How long a case may take.
    pub limit: Option<Duration>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

/// Where the cases come from.
#[derive(Clone, Debug)]
pub enum CaseSource {
    /// A table: a column for each parameter, setting or axis of a contact, with its unit, as `m.radial_distance [mm]`; a row for each case.
    Table(PathBuf),
    /// All combinations of some values of each; the first changes slowest.
    Ranges(Vec<VariedRange>),
    /// Random values about those of the spec.
    Scatter {
        /// What scatters.
        settings: Vec<(String, Distribution)>,
        /// How many cases.
        count: u64,
        /// Another number gives other cases.
        seed: u64,
        /// Points of Sobol's sequence instead of independent ones.
        sobol: bool,
    },
}

/// Values of one parameter between two ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariedRange {
    /// The parameter or setting.
    pub name: String,
    /// The first value and the last one, with their units.
    pub ends: [String; 2],
    /// How many.
    pub count: u32,
}

/// How a value scatters about that of the spec.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// With this standard deviation.
    Normal(ToleratedAmount),
    /// By so much at the most to both sides.
    Uniform(ToleratedAmount),
}

/// Chunks of a study, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StudyChunks {
    /// All of them.
    All,
    /// From the first to the last of these.
    Between(usize, usize),
    /// One of so many parts that are as even as can be: which, counted from 0, and of how many. A part may be empty.
    Part(usize, usize),
}

/// Work on a study.
#[derive(Clone, Debug)]
pub struct RunRequest {
    /// The folder of the study.
    pub study: PathBuf,
    /// Which chunks.
    pub chunks: StudyChunks,
    /// Verdicts of cases that are computed anew: `crashed`, `limit`.
    pub again: Vec<String>,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}
