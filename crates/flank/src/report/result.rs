//! What `flank report` wrote.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use crate::compare::trace_result::FlankTraces;
use crate::contact::result::ContactResult;
use crate::convert::milling::result::MillResult;
use crate::project::answer::Answer;
use crate::project::quantity::{NamedValue, Travel, UnitSymbol};
use crate::project::remark::NotDone;
use crate::solve::body::result::GaugeNumbers;
use crate::solve::result::{Certified, PointSummary, SmoothFace, SurfaceResult};

/// What stands on the page of `flank report`: inputs, machines, results of one job. Lengths are mm, angles degrees.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.report/3")]
pub struct ReportResult {
    /// The job of the spec.
    pub job: String,
    /// Its doc comment, line by line.
    pub doc: Vec<String>,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// Of all texts that were read.
    pub spec_hash: String,
    /// With its version.
    pub program: String,
    /// What makes the page again.
    pub command: String,
    /// As it was given.
    pub date: Option<String>,
    /// Largest residual of a solved point, mm.
    pub tolerance: f64,
    /// Points of all surfaces.
    pub asked: usize,
    /// Points of all surfaces.
    pub solved: usize,
    /// Points that their own tool cuts away.
    pub undercut: usize,
    /// Parameters and settings.
    pub inputs: Vec<Input>,
    /// Over which the surfaces are made.
    pub motions: Vec<PassedMotion>,
    /// As they were built.
    pub machines: Vec<BuiltMachine>,
    /// Bodies whose outlines say where teeth end.
    pub solids: Vec<BuiltSolid>,
    /// Of the flanks of cylindrical gears, against an involute helicoid.
    pub traces: Vec<FlankTraces>,
    /// As in flank.contact/2.
    pub contacts: Vec<ContactResult>,
    /// What is milled.
    pub millings: Vec<MillResult>,
    /// Surfaces with a sample: as in flank.solve/3, and more.
    pub surfaces: Vec<ReportedSurface>,
    /// Where surfaces turn back, contact ends, one trims another; also those that were not found.
    pub lines: Vec<ReportedLine>,
    /// Smooth faces of the STEP file, if one was asked for.
    pub faces: Vec<SmoothFace>,
    /// In the order of the page.
    pub pictures: Vec<ReportedPicture>,
    /// What nobody should take for checked.
    pub not_checked: NotChecked,
    /// Sentences.
    pub conventions: Vec<String>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// A parameter or a setting with its value.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Input {
    /// Its name, with that of its machine or tool.
    pub name: String,
    /// Its value's text.
    pub written: String,
    /// In its unit.
    pub value: f64,
    /// `mm`, `deg`, products of mm and rad; empty for a plain number.
    pub unit: String,
    /// Of the range that is allowed.
    pub low: Option<f64>,
    /// Of the range that is allowed.
    pub high: Option<f64>,
    /// Whether it is a whole number.
    pub is_count: bool,
    /// Whether it says how a machine differs from the nominal one, in which it is zero.
    pub is_error: bool,
    /// Who says so.
    pub given_by: InputSource,
    /// The machine or tool whose default it is.
    pub definition: Option<String>,
    /// Its doc comment.
    pub meaning: String,
}

/// Who gives a parameter its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum InputSource {
    /// The machine or the tool, as a default.
    Definition,
    /// The job.
    Job,
    /// Who asks for the report.
    Caller,
}

/// A motion and what the solved points need of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PassedMotion {
    /// Its name.
    pub name: String,
    /// Of its values.
    pub unit: UnitSymbol,
    /// Whether it is a whole number.
    pub is_count: bool,
    /// Lower end of its range.
    pub low: f64,
    /// Upper end of its range.
    pub high: f64,
    /// Smallest value over the solved points.
    pub passed_low: Option<f64>,
    /// Largest value over the solved points.
    pub passed_high: Option<f64>,
}

/// A solid of the job.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BuiltSolid {
    /// As the job calls it.
    pub name: String,
    /// The frame about whose z axis it is turned.
    pub frame: String,
    /// How many tooth spaces it has.
    pub teeth: u32,
    /// The surfaces of one space, from one side to the other.
    pub space: Vec<String>,
    /// Closed, the material on the left.
    pub outline: Vec<SolidEdge>,
    /// Of the body; null where none could be built.
    pub volume_mm3: Option<f64>,
    /// What gauges find on the body, as in flank.solid/2; null where none could be built.
    pub gauges: Option<GaugeNumbers>,
    /// Why there is no body.
    pub no_body: Option<String>,
}

/// A segment of a solid's outline in its axial section: points are `[z, rho]`, mm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SolidEdge {
    /// Tip, toe, heel.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// Of an arc, mm; null for a line.
    pub radius: Option<f64>,
}

/// A machine of the job.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BuiltMachine {
    /// As the job calls it.
    pub name: String,
    /// What it is made of.
    pub definition: String,
    /// The root first.
    pub frames: Vec<BuiltFrame>,
    /// In the order of the machine.
    pub axes: Vec<BuiltAxis>,
}

/// A frame of a machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct BuiltFrame {
    /// Its name.
    pub name: String,
    /// The frame that it hangs on; null for the root.
    pub parent: Option<String>,
    /// From parent to child.
    pub transforms: Vec<String>,
}

/// An axis of a machine.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BuiltAxis {
    /// Its name.
    pub name: String,
    /// In NC programs.
    pub address: String,
    /// How it moves.
    pub kind: AxisKind,
    /// What moves it.
    pub source: AxisSource,
    /// In motions and parameters, mm and rad.
    pub law: String,
    /// With the job's numbers.
    pub law_with_values: String,
    /// Of its positions.
    pub unit: UnitSymbol,
    /// Smallest position over the motions that the solved points pass over; null where no point says.
    pub low: Option<f64>,
    /// Largest.
    pub high: Option<f64>,
    /// What the axis can do, in its unit; null where it is not limited.
    pub travel: Option<Travel>,
    /// Whether it leaves its travel.
    pub beyond: Option<bool>,
}

/// How an axis moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AxisKind {
    /// Along a line.
    Linear,
    /// About a line.
    Rotary,
}

/// What moves an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AxisSource {
    /// A motion of the job.
    Driven,
    /// Nothing.
    Fixed,
    /// Other axes.
    Coupled,
    /// A closed loop.
    Closed,
    /// Nothing yet: it can be moved.
    Free,
}

/// What was solved of a surface, and how it was made.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ReportedSurface {
    /// As `flank solve` reports it.
    #[serde(flatten)]
    pub solved: SurfaceResult,
    /// How it is made.
    pub process: GeneratingProcess,
    /// The tool's surface or edge.
    pub tool: String,
    /// Frames from work to tool.
    pub chain: Vec<String>,
    /// Rows, then columns.
    pub grid: SampledGrid,
    /// The point at which all roots were looked for.
    pub anchor: Vec<NamedValue>,
    /// Why points were not solved, with their numbers.
    pub reasons: Vec<String>,
    /// Null where no proofs were asked for.
    pub certified: Option<Certified>,
    /// Extremes of the principal curvatures.
    pub curvature: Vec<ExtremeCurvature>,
}

/// How a tool makes a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum GeneratingProcess {
    /// The envelope of the tool's surface.
    Envelope,
    /// What an edge sweeps over.
    Sweep,
    /// The tool's surface itself.
    Copy,
}

/// The grid of a sample.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SampledGrid {
    /// How many there are.
    pub counts: [usize; 2],
    /// From where to where they run.
    pub labels: [String; 2],
}

/// The largest k1, or the smallest k2.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ExtremeCurvature {
    /// `k1` or `k2`.
    pub name: &'static str,
    /// `1/mm`.
    pub unit: &'static str,
    /// The largest k1, the smallest k2; positive where the body is convex.
    pub value: f64,
    /// Row, from 0.
    pub i: usize,
    /// Column, from 0.
    pub j: usize,
    /// In the surface's frame, mm.
    pub position: [f64; 3],
}

/// A line on a surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ReportedLine {
    /// What was asked for and found.
    #[serde(flatten)]
    pub summary: PointSummary,
    /// The surface that it lies on.
    pub surface: String,
    /// `singular line`, `contact limit` or `intersection`.
    pub kind: &'static str,
    /// What changes along it.
    pub along: String,
    /// Lines of this kind beside each other; the longest is given.
    pub several: usize,
}

/// A picture of a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ReportedPicture {
    /// Of its file beside Markdown, without .svg.
    pub name: String,
    /// What is on it.
    pub shows: String,
}

/// What was not checked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NotChecked {
    /// Sentences.
    pub of_this_job: Vec<String>,
    /// Sentences.
    pub by_no_report: Vec<String>,
}

impl Answer for ReportResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }
}

impl fmt::Display for ReportResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "job {}: {} of {} points", self.job, self.solved, self.asked)?;
        writeln!(f, "wrote {}", self.files.join(", "))
    }
}
