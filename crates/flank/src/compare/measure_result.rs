//! What `flank measure` wrote.

use std::fmt;

use flank_chain_dsl::Dimension;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::columns::aligned;
use crate::project::remark::{NotDone, Remark};
use crate::project::units;
use crate::solve::arrays::PointGrid;

/// What was written for a measuring machine, of `flank measure`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.measure/1")]
pub struct MeasureResult {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// Shares of the sampled area that are left out at each end: from root to tip, along the tooth; below 0.5.
    pub margins: [f64; 2],
    /// In the order of the spec.
    pub flanks: Vec<MeasuredFlank>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// Which surfaces are not measured, and why.
    pub remarks: Vec<Remark>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// The nominal points of each part of each flank, in their order.
    #[serde(skip)]
    pub grids: Vec<PointGrid>,
}

/// One flank for a measuring machine.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredFlank {
    /// Its name.
    pub surface: String,
    /// Of the points.
    pub frame: String,
    /// Flank of a tooth, seen along it from the first column on, the tip up; null where the points do not tell.
    pub flank: Option<FlankHand>,
    /// What the first and the last row lie at.
    pub rows: [String; 2],
    /// What the first and the last column lie at.
    pub columns: [String; 2],
    /// The grid comes first.
    pub parts: Vec<MeasuredPart>,
    /// Where pitch and tooth thickness are measured; null where it is not solved.
    pub middle: Option<MiddlePoint>,
}

/// A flank of a tooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FlankHand {
    /// Its normal, out of the material, points to the left.
    Left,
    /// Its normal, out of the material, points to the right.
    Right,
}

/// What is measured at a flank.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct MeasuredPart {
    /// The flank, its middle column, its middle row, its middle.
    pub part: FlankPart,
    /// How many there are.
    pub rows: usize,
    /// How many there are.
    pub columns: usize,
    /// Points.
    pub asked: usize,
    /// Points.
    pub solved: usize,
}

/// A part of a flank that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FlankPart {
    /// The whole flank.
    Grid,
    /// The line from root to tip in the middle of the tooth's length.
    Profile,
    /// The line along the tooth at the middle of its depth.
    Lead,
    /// The one point in the middle of both.
    Middle,
}

/// The middle of a flank.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MiddlePoint {
    /// Distance from the axis.
    pub rho_mm: f64,
    /// Along the axis.
    pub z_mm: f64,
    /// About the axis, from x towards y.
    pub angle_deg: f64,
}

impl From<flank_export::Hand> for FlankHand {
    fn from(hand: flank_export::Hand) -> FlankHand {
        match hand {
            flank_export::Hand::Left => FlankHand::Left,
            flank_export::Hand::Right => FlankHand::Right,
        }
    }
}

impl FlankHand {
    /// As files have it.
    pub fn word(self) -> &'static str {
        match self {
            FlankHand::Left => "left",
            FlankHand::Right => "right",
        }
    }
}

impl From<flank_export::NominalPart> for FlankPart {
    fn from(part: flank_export::NominalPart) -> FlankPart {
        match part {
            flank_export::NominalPart::Grid => FlankPart::Grid,
            flank_export::NominalPart::Profile => FlankPart::Profile,
            flank_export::NominalPart::Lead => FlankPart::Lead,
            flank_export::NominalPart::Middle => FlankPart::Middle,
        }
    }
}

impl Answer for MeasureResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}

impl fmt::Display for MeasureResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = ["surface", "flank", "rows", "columns", "solved", "in the middle: rho mm, z mm, angle deg"];
        let rows = self.flanks.iter().filter_map(MeasuredFlank::cells);
        let rows: Vec<[String; 6]> = [head.map(String::from)].into_iter().chain(rows).collect();
        write!(f, "job {} ({})\n\n{}", self.job, self.spec, aligned(&rows, ""))?;
        writeln!(f, "\nwrote {}", self.files.join(", "))
    }
}

impl MeasuredFlank {
    fn cells(&self) -> Option<[String; 6]> {
        let grid = self.parts.first()?;
        let side = |count: usize, [from, to]: &[String; 2]| format!("{count}, {from} to {to}");
        let middle = self.middle.map(|MiddlePoint { rho_mm, z_mm, angle_deg }| {
            [rho_mm, z_mm, angle_deg].map(|number| units::text(Dimension::NUMBER, number, 6)).join("  ")
        });
        Some([
            self.surface.clone(),
            self.flank.map_or("-", FlankHand::word).to_string(),
            side(grid.rows, &self.rows),
            side(grid.columns, &self.columns),
            format!("{} of {}", grid.solved, grid.asked),
            middle.unwrap_or("-".to_string()),
        ])
    }
}
