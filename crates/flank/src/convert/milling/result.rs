//! What `flank mill` found.

use schemars::JsonSchema;
use serde::Serialize;

use super::clamp::Clamping;
use super::setup::MillSetup;
use super::side::SideLeft;
use crate::project::answer::{Answer, Timing};
use crate::project::quantity::Travel;
use crate::project::remark::{NotDone, Remark};

/// Passes of a cutter over a surface, what they leave, and what a machine's axes do, of `flank mill`. Lengths are mm, angles deg, heights um
/// where a name says so.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.mill/1")]
pub struct MillResult {
    /// The job.
    pub job: String,
    /// The milling.
    pub milling: String,
    /// What is milled.
    pub surface: String,
    /// The frame that it is given in, and that poses are in.
    pub frame: String,
    /// The part of the cutter that touches it.
    pub cutter: String,
    /// The coordinates that passes are counted by and that they run along.
    pub coordinates: [String; 2],
    /// With what it is milled, and how.
    pub setup: MillSetup,
    /// Passes; null where there is no plan.
    pub passes: Option<usize>,
    /// Positions on each pass.
    pub positions: Option<usize>,
    /// Neighbouring passes are at the most so far apart, mm.
    pub pass_step: Option<f64>,
    /// Neighbouring positions are at the most so far apart, mm.
    pub block_length: Option<f64>,
    /// The way of the tip over all passes, mm.
    pub path_length: Option<f64>,
    /// The highest ridge between passes.
    pub cusp: Option<HeightLeft>,
    /// What the passes leave at points of the milled part.
    pub map: Option<HeightMap>,
    /// What one pass with the side of the cutter leaves; null of other passes.
    pub side: Option<SideLeft>,
    /// What straight blocks leave at the most and at the least, beside the stock; negative where they cut too deep.
    pub blocks: Option<[HeightLeft; 2]>,
    /// Whether the tip and the rotary axes go straight in a block (tool-centre control), else all axes do.
    pub tool_centre_control: bool,
    /// The least and the largest radius across the feed of what the cutter sweeps, mm; null where that is straight, as with the side of a cone.
    pub effective_radius: Option<[f64; 2]>,
    /// Where the gap between cutter and surface bends least: negative, 1/mm, where the cutter cuts too deep beside its contact.
    pub least_gap_curvature: Option<CurvatureAt>,
    /// The largest ball that the hollow of the surface takes, mm, and where; null where it is hollow nowhere: any ball fits.
    pub largest_ball: Option<BallAt>,
    /// How near the cutter comes to what it keeps clear of.
    pub clearances: Vec<ClearanceKept>,
    /// The axes of the machine over all passes; empty where the cutter is not followed on it.
    pub axes: Vec<MilledAxis>,
    /// The least angle of the cutter's axis from where a rotary axis is free.
    pub least_from_pole: Option<f64>,
    /// How the work would be clamped for the least rates, if that is asked for.
    pub clamping: Option<Clamping>,
    /// How far the polynomials between exact points may be off, from which heights follow, mm.
    pub polynomials_off: Option<f64>,
    /// What a program leaves, if one was read back.
    pub verified: Option<VerifiedProgram>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    #[serde(skip)]
    pub(super) timing: Timing,
}

/// A place on the surface and what is left there.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HeightLeft {
    /// um.
    pub height_um: f64,
    /// The values of both coordinates, mm, deg or shares.
    pub at: [f64; 2],
    /// In words.
    pub place: String,
}

/// A place on the surface and a curvature.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CurvatureAt {
    /// 1/mm.
    pub curvature: f64,
    /// Where.
    pub place: String,
}

/// A place on the surface and the radius of a ball.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BallAt {
    /// mm.
    pub radius: f64,
    /// Where.
    pub place: String,
}

/// How near a part of the cutter comes to a surface, over all positions.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClearanceKept {
    /// The surface.
    pub surface: String,
    /// The part of the cutter.
    pub body: String,
    /// How far it is to stay away, mm.
    pub wanted: f64,
    /// How near it comes, mm; negative where it cuts in.
    pub least: f64,
    /// Where the cutter is then.
    pub place: String,
    /// The nearest place of the surface.
    pub foot: String,
    /// What is proven, if that was asked for.
    pub proven: Option<ProvenClearance>,
}

/// A proof that a part of the cutter stays clear on all blocks, between positions, too.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ProvenClearance {
    /// It comes nowhere nearer than this, mm, if it is proven.
    pub limit: f64,
    /// Blocks.
    pub blocks: usize,
    /// Blocks for which it is; after the first ones for which it is not, no more are looked at.
    pub proven: usize,
}

/// What an axis does over all passes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MilledAxis {
    /// Its name.
    pub name: String,
    /// The unit of its positions.
    pub unit: String,
    /// Lowest and highest position, as the frames of the machine count.
    pub extent: [f64; 2],
    /// Its travel.
    pub travel: Option<Travel>,
    /// At the most per mm of the contact's way.
    pub rate_per_mm: f64,
}

/// What a program leaves on the surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct VerifiedProgram {
    /// The program.
    pub file: String,
    /// Its blocks that cut.
    pub blocks: usize,
    /// Whether its words are of the cutter in the work (tool-centre control), else of the axes.
    pub tool_centre_control: bool,
    /// Spaces of the work that are measured, counted from one.
    pub spaces: Vec<u32>,
    /// At points of the milled part in the first of them; but the most is that of all points of all of them, and the least is solved: where a
    /// block of the program is deepest, between points, too.
    #[serde(flatten)]
    pub map: HeightMap,
}

/// What is left at points of the milled part of a surface: the middles of equal cells.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HeightMap {
    /// Rows of cells, by the coordinate that passes are counted by.
    pub rows: usize,
    /// Columns of cells, by the coordinate that passes run along.
    pub columns: usize,
    /// The most and the least that is left at the points, beside the stock; null where the cutter passes none of them.
    pub left: Option<[HeightLeft; 2]>,
    /// Points that the cutter does not pass over.
    pub untouched: usize,
    /// Points.
    pub points: usize,
    /// What is left beside the stock at each, row by row, um; null where the cutter does not pass.
    pub heights_um: Vec<Option<f64>>,
}

impl Answer for MillResult {
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
