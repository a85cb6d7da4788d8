//! What the synthesis of a contact found.

use schemars::JsonSchema;
use serde::Serialize;

use crate::compare::fit::result::RangeBound;
use crate::contact::result::{ContactKind, LeadingEdge};
use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};

/// Settings with which a contact is at its vertex what was wanted, of `flank fit`; checked by the whole contact.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.synthesis/1")]
pub struct SynthesisResult {
    /// The job whose settings are changed.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// What is wanted, as the job names it.
    pub want: String,
    /// The contact.
    pub contact: String,
    /// The flank that places and directions are on: the second one.
    pub surface: String,
    /// Thickness of the film that the ellipse is of, um; its length is that of the longer axis.
    pub film_um: f64,
    /// What was wanted of it, in the order of the spec.
    pub conditions: Vec<ReachedCondition>,
    /// In the order of the job.
    pub settings: Vec<SynthesizedSetting>,
    /// Of how many the settings were chosen; null where they were named.
    pub chosen_of: Option<usize>,
    /// Steps that it took.
    pub steps: usize,
    /// Whether no further step came nearer.
    pub is_settled: bool,
    /// The whole contact with these settings; null where the flanks do not touch.
    pub checked: Option<CheckedContact>,
    /// The spec with the settings, if it was asked for and not written.
    pub corrected: Option<String>,
    /// Files written.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    #[serde(skip)]
    pub(super) timing: Timing,
}

/// A number of a contact that was wanted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ReachedCondition {
    /// `z`, `rho`, `lengthwise`, `profilewise`, `path`, `ellipse`, `transmission_error`.
    pub name: String,
    /// mm, deg, urad or um; empty for a share.
    pub unit: String,
    /// With the settings of the job; null where the contact has no such number.
    pub now: Option<f64>,
    /// As it is wanted.
    pub wanted: f64,
    /// How far it may be off, where it need not hold exactly.
    pub within: Option<f64>,
    /// With the settings that were found.
    pub reached: Option<f64>,
    /// The same of the whole contact, which was solved anew.
    pub checked: Option<f64>,
    /// Whether it is what was wanted: to 1e-6 mm or rad, or as far off as it may be.
    pub is_met: bool,
}

/// A setting that is changed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SynthesizedSetting {
    /// Its name, as it is set from outside.
    pub name: String,
    /// mm, deg, products of mm and rad; empty for a plain number.
    pub unit: String,
    /// As the job has it.
    pub now: f64,
    /// What is added.
    pub change: f64,
    /// With the change.
    pub new: f64,
    /// The end of its range that holds it, if one does.
    pub at_bound: Option<RangeBound>,
    /// The step that it is rounded to, if that was said.
    pub step: Option<f64>,
}

/// The whole contact with the settings that were found, as `flank contact` solves it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CheckedContact {
    /// What the flanks are to each other.
    pub kind: Option<ContactKind>,
    /// Whether the pattern stays off the ends of both flanks, and no edge carries.
    pub is_free: bool,
    /// The sides that the pattern reaches, `tip of gear_convex`.
    pub touches: Vec<String>,
    /// Edges that carry over the pitch about the middle.
    pub edges: Vec<LeadingEdge>,
    /// The error over a pitch from peak to peak, urad or um.
    pub peak_to_peak: Option<f64>,
    /// The least gap over both flanks, um; negative where they reach into each other.
    pub least_um: Option<f64>,
}

impl Answer for SynthesisResult {
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
