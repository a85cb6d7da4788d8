//! What `flank fit` found.

use schemars::JsonSchema;
use serde::Serialize;

use crate::compare::deviation_result::GridPlace;
use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};

/// Settings with which a flank comes nearest to what was measured or is wanted, of `flank fit`. Deviations are um along the normal, plus is
/// material.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.fit/2")]
pub struct FitResult {
    /// The job whose settings are changed.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// The surfaces, each with the points that it shall go through.
    pub flanks: Vec<FittedFlank>,
    /// By which the points are turned about z so that they lie nearest to the surfaces as they are; null where they are not turned, and of a
    /// rack.
    pub turn_deg: Option<f64>,
    /// The same on the circle through the middle of the points.
    pub turn_mm: Option<f64>,
    /// Of a rack, whose spaces lie beside each other, along y instead of the turn; null of all else.
    pub shift_mm: Option<f64>,
    /// By how much the tooth that was measured is thicker than the nominal one on that circle, where its thickness does not count; null where
    /// it does, or one flank is fitted.
    pub thicker_mm: Option<f64>,
    /// Root of the mean square of the deviations before anything is changed.
    pub before_um: f64,
    /// The settings that made the measured flank: identification. Null where a wanted ease-off is fitted.
    pub identification: Option<AdjustedSettings>,
    /// The settings that take the share of the deviation away, or give the wanted ease-off: correction.
    pub correction: AdjustedSettings,
    /// The ease-off that was wanted, with the one that the corrected settings give; null where a measured flank is fitted.
    pub ease_off: Option<FittedEaseOff>,
    /// The share of the deviation that the correction takes away.
    pub share: f64,
    /// 1 where only slopes are fitted, 2 where slopes, crownings and bias are; null where all of the deviations is.
    pub order: Option<u8>,
    /// Root of the mean square of the deviations that are to be expected after the correction.
    pub predicted_um: f64,
    /// What a flank may be off to be as it was wanted, root of the mean square.
    pub within_um: f64,
    /// What the settings do together, the strongest direction first.
    pub directions: Vec<SettingsDirection>,
    /// What the points do not tell of the settings, in words.
    pub untold: Vec<String>,
    /// How the settings were chosen; null where they were named.
    pub choice: Option<SettingsChoice>,
    /// What the deviations scatter by that the settings leave, as one standard deviation; null with no more points than unknowns.
    pub scatter_um: Option<f64>,
    /// Root of the mean square of the error with which each row and each column is predicted from the others; null where they are too few.
    pub leave_out_um: Option<f64>,
    /// Surfaces that the correction leaves where they are.
    pub kept: Vec<KeptSurface>,
    /// Points that lie more than four standard deviations off what all points that are not among them predict. They are not left out.
    pub outliers: Vec<OutlyingPoint>,
    /// Root of the mean square of what the settings would leave of the points that are not outliers, by derivatives; null where there are no outliers,
    /// and where `order` is fitted alone.
    pub without_outliers_um: Option<f64>,
    /// The spec with the corrected settings, if it was asked for and not written.
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

/// A surface and the points that it shall go through.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FittedFlank {
    /// Its name.
    pub surface: String,
    /// Of the points.
    pub frame: String,
    /// The file of measured points, or the surface that the ease-off is one from.
    pub wanted: String,
    /// Rows and columns of the grid.
    pub counts: [usize; 2],
    /// Points with a deviation.
    pub known: usize,
    /// How far the points lie off the surface as it is, row by row; null where that is not known.
    pub before_um: Vec<Option<f64>>,
    /// The same with the settings of the identification, of the correction for a wanted ease-off.
    pub left_um: Vec<Option<f64>>,
    /// The deviations that are to be expected after the correction.
    pub predicted_um: Vec<Option<f64>>,
}

/// How far a surface lies off another one: the parabola in both directions that fits best, um.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FittedEaseOff {
    /// As it was wanted.
    pub wanted: EaseOffNumbers,
    /// With the corrected settings; null where the points do not tell it.
    pub reached: Option<EaseOffNumbers>,
}

/// A parabola in both directions of a grid, as `flank deviation` has it, um: first from root to tip, then along the tooth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EaseOffNumbers {
    /// Rise from end to end.
    pub slopes_um: [f64; 2],
    /// Drop from the middle to both ends.
    pub crownings_um: [f64; 2],
    /// Rise along the tip, less that along the root.
    pub bias_um: f64,
}

/// Settings with the least sum of squares.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AdjustedSettings {
    /// In the order of the job.
    pub settings: Vec<AdjustedSetting>,
    /// What is left of what is fitted between the flank of these settings and what it shall be, root of the mean square.
    pub left_um: f64,
    /// Steps that it took.
    pub steps: usize,
    /// Whether no further step made it less.
    pub is_settled: bool,
    /// Of the settings in their order and units, from what is left; empty where nothing tells how the points scatter.
    #[serde(skip)]
    pub covariance: Vec<Vec<f64>>,
}

/// A setting that is changed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AdjustedSetting {
    /// Its name, as it is set from outside.
    pub name: String,
    /// Whether it is an error of the machine, which is identified and not set.
    pub is_error: bool,
    /// The step that a correction is rounded to, if that was said.
    pub step: Option<f64>,
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
    /// Whether the value was brought onto its step, and stands there exactly.
    pub is_rounded: bool,
    /// What the change moves the flank by, root of the mean square.
    pub moves_um: f64,
    /// One standard deviation, from what is left; null where the points do not determine the setting, an end of its range holds it, it
    /// is rounded to its step, or the search came to no end.
    pub uncertain_by: Option<f64>,
}

/// An end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RangeBound {
    /// The lower one.
    Low,
    /// The upper one.
    High,
}

/// Changes of the settings together, and what they do: a singular direction of the flank's sensitivity.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SettingsDirection {
    /// What the changes move the flank by, root of the mean square.
    pub moves_um: f64,
    /// Whether the fit uses it: the points tell it.
    pub is_used: bool,
    /// The settings, and the turn about z or the shift along y, that take part.
    pub changes: Vec<SettingChange>,
}

/// A change of one setting.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SettingChange {
    /// Of a setting; or `turn about z`, `shift along y`.
    pub name: String,
    /// Of the change.
    pub unit: String,
    /// In its unit.
    pub by: f64,
    /// The same by the change that is usual for the setting, without its sign: of all together the squares have the sum 1.
    pub share: f64,
}

/// Settings that were chosen among those that the job gives a value.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SettingsChoice {
    /// Those that move the flank, of which the settings were chosen.
    pub candidates: Vec<String>,
    /// What a point was taken to scatter by: as it was said, or as all of them leave it; 0 for a wish.
    pub noise_um: f64,
    /// What all of them together would leave, by the linear model, root of the mean square.
    pub all_leave_um: f64,
}

/// A surface that the corrected settings leave where it is.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct KeptSurface {
    /// Its name.
    pub surface: String,
    /// Whether it is kept at both ends of its row through the middle, and not in the middle alone.
    pub is_line: bool,
    /// The point that stands for its middle: half-way along a list. Null where it is kept at the mean point, or at both ends of a row.
    pub at: Option<GridPlace>,
    /// The largest distance by which it is off there.
    pub off_um: f64,
}

/// A measured point that does not go with the others.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OutlyingPoint {
    /// Whose point it is.
    pub surface: String,
    /// From 1.
    pub row: usize,
    /// From 1.
    pub column: usize,
    /// How far it lies off what the points that are no outliers predict.
    pub off_um: f64,
    /// The same in standard deviations.
    pub sigmas: f64,
}

impl Answer for FitResult {
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
