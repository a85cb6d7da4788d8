//! Profile and helix traces with their evaluation.

use schemars::JsonSchema;
use serde::Serialize;

/// The traces of a flank of a cylindrical gear against an involute helicoid: um in the transverse plane along the tangent to the base
/// circle, plus is material, zero in the middle of the flank.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FlankTraces {
    /// The surface.
    pub surface: String,
    /// Of its points.
    pub frame: String,
    /// What it is held against.
    pub involute: InvoluteNumbers,
    /// Over the length of roll, half-way along the face.
    pub profile: TraceNumbers,
    /// Over the face, half-way up the length of roll.
    pub helix: TraceNumbers,
}

/// An involute helicoid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct InvoluteNumbers {
    /// Of the base cylinder.
    pub base_diameter_mm: f64,
    /// Of its helix; positive for a right-hand one.
    pub base_helix_angle_deg: f64,
    /// Who gives it.
    pub source: InvoluteSource,
}

/// Who says what a flank is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum InvoluteSource {
    /// Module, number of teeth, pressure angle and helix angle of the job.
    Job,
    /// The same, where the job leaves module or pressure angle to the tool: as the text has that, whatever is set from outside.
    Tool,
    /// The flank's normal in its middle: there it has no slopes.
    Flank,
}

/// A trace and its evaluation as in ISO 1328-1:2013, with a straight design.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TraceNumbers {
    /// Points that were asked for.
    pub asked: usize,
    /// Where the evaluation range begins, on the same scale as the lengths.
    pub evaluated_from_mm: f64,
    /// Where it ends.
    pub evaluated_to_mm: f64,
    /// Total deviation, Fα or Fβ.
    pub total_um: f64,
    /// Form deviation, ffα or ffβ.
    pub form_um: f64,
    /// Slope deviation, fHα or fHβ: the rise of the mean line over the whole trace.
    pub slope_um: f64,
    /// Crowning, Cα or Cβ: of the parabola that fits best over the evaluation range.
    pub crowning_um: f64,
    /// The mean line: its value in the middle of the evaluation range, um, and its rise, um per mm.
    pub mean: [f64; 2],
    /// Lengths of roll, or heights.
    pub lengths_mm: Vec<f64>,
    /// One for each length.
    pub deviations_um: Vec<f64>,
}

impl TraceNumbers {
    /// The four numbers with the names that they have in a profile trace (`α`) or a helix trace (`β`).
    pub(crate) fn named(&self, of: char) -> [(String, f64); 4] {
        [("F", self.total_um), ("ff", self.form_um), ("fH", self.slope_um), ("C", self.crowning_um)]
            .map(|(name, value)| (format!("{name}{of}"), value))
    }
}
