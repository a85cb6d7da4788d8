//! What `flank tolerance` found.

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};

/// How the ease-off of a surface, and the contacts that it takes part in, scatter with settings and mounting errors, of `flank tolerance`: to
/// first order, from exact derivatives.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.tolerance/1")]
pub struct ToleranceResult {
    /// The job.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// The surface.
    pub surface: String,
    /// Of its points.
    pub frame: String,
    /// The grid over its sample, rows from root to tip.
    pub counts: [usize; 2],
    /// Points at which the surface is known.
    pub known: usize,
    /// Contacts of which numbers are told.
    pub contacts: Vec<String>,
    /// In the worst case each setting is off by so many standard deviations.
    pub limits: f64,
    /// What scatters, in the order of the job, axes of contacts after the settings.
    pub causes: Vec<ScatteringCause>,
    /// What scatters by it, those of the ease-off first.
    pub results: Vec<ToleratedResult>,
    /// The random cases; null where none were asked for.
    pub sweep: Option<SweptCases>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    #[serde(skip)]
    pub(super) timing: Timing,
}

/// What causes scatter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    /// A setting of a machine, a tool or the job; what is defined by it follows.
    Setting,
    /// An error of a machine, zero in the nominal one.
    Error,
    /// An axis of the machine of a contact.
    Mounting,
}

/// A setting or an axis that scatters.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ScatteringCause {
    /// Its name, as it is set from outside.
    pub name: String,
    /// What it is.
    pub kind: CauseKind,
    /// mm, deg, products of mm and rad; empty for a plain number.
    pub unit: String,
    /// Its value; 0 for an axis, whose error it is.
    pub now: f64,
    /// Its standard deviation.
    pub scatter: f64,
    /// The standard deviation that it may have so that all that was wanted is met, if all that take part have the same share in it; null where
    /// nothing was wanted or it takes no part.
    pub may_scatter: Option<f64>,
}

/// A number that scatters.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ToleratedResult {
    /// `slope_profilewise`, `bias`, `position`; of a contact `drive_side.lengthwise`.
    pub name: String,
    /// `um`, `mm` or `urad`.
    pub unit: String,
    /// One standard deviation.
    pub standard_deviation: f64,
    /// The most that it changes in the worst case.
    pub worst_case: f64,
    /// The standard deviation that it may have, if that was said.
    pub wanted: Option<f64>,
    /// For each cause in their order: what one standard deviation of it alone changes.
    pub changes: Vec<f64>,
    /// For each cause its share of the variance, with half of what correlated pairs add; their sum is 1. All are 0 where nothing
    /// moves the number beyond what points are solved to.
    pub shares: Vec<f64>,
    /// What random cases showed; null where none were asked for.
    pub swept: Option<SweptResult>,
}

/// A number over random cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SweptResult {
    /// Of its change.
    pub mean: f64,
    /// One standard deviation.
    pub standard_deviation: f64,
    /// The smallest change.
    pub lowest: f64,
    /// The largest change.
    pub highest: f64,
}

/// Random cases: all settings are drawn, and the surface and the contacts solved anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SweptCases {
    /// How many were drawn.
    pub drawn: usize,
    /// Those in which all was solved.
    pub solved: usize,
    /// Those in which a setting lies beyond its range, solved or not: the spec refuses its value.
    pub beyond: usize,
}

impl Answer for ToleranceResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    fn timing(&self) -> Option<Timing> {
        Some(self.timing)
    }
}
