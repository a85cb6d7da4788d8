//! What `flank solve` found.

use std::collections::BTreeMap;
use std::fmt;

use flank_export::fixed;
use flank_expr::InstructionSet;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::{Answer, Timing};
use crate::project::columns::aligned;
use crate::project::quantity::{Extent, NamedValue, UnitSymbol};
use crate::project::remark::{NotDone, Remark};
use crate::solve::arrays::PointGrid;
use crate::solve::status::Status;

/// Solved surfaces of one job, in numbers, of `flank solve`; the points are in the files. Lengths are mm, angles degrees.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.solve/3")]
pub struct SolveResult {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// Surfaces with a sample, in the order of the spec.
    pub surfaces: Vec<SurfaceResult>,
    /// On surfaces: where one turns back, where contact ends, where one trims another.
    pub lines: Vec<LineResult>,
    /// Smooth faces of the STEP file, if one was asked for.
    pub faces: Vec<SmoothFace>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What the points were computed by.
    pub instructions: Instructions,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    #[serde(skip)]
    pub(super) timing: Timing,
}

/// What many points are computed by at once. It changes no bit of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Instructions {
    /// Machine code made from the equations, eight points in a register.
    Avx512,
    /// Machine code made from the equations, four points in a register.
    Avx2,
    /// Operations gone through one by one, each for a block of points: without machine code, or on another kind of processor.
    Interpreted,
}

impl Instructions {
    pub(super) fn of(set: InstructionSet) -> Instructions {
        match set.machine_code() {
            Some(8) => Instructions::Avx512,
            Some(_) => Instructions::Avx2,
            None => Instructions::Interpreted,
        }
    }
}

/// The points of a surface or of a line, counted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PointSummary {
    /// Of the surface; of a line with what it is.
    pub name: String,
    /// Of the positions.
    pub frame: String,
    /// Points asked for.
    pub asked: usize,
    /// Points solved.
    pub solved: usize,
    /// Number of points by their status, `solved` or why not.
    pub outcomes: BTreeMap<&'static str, usize>,
    /// Largest absolute residual of a solved point; null where none was solved.
    pub worst_residual: Option<f64>,
    /// Distance from z (rho), z, and each unknown over the solved points.
    pub ranges_reached: Vec<Extent>,
    /// By how much points are outside the ranges, in words; `None` if none is.
    #[serde(skip)]
    pub(super) outside: Option<String>,
}

/// What was solved of a surface.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SurfaceResult {
    /// What was asked for and found.
    #[serde(flatten)]
    pub summary: PointSummary,
    /// Of the equations with their Jacobian.
    pub evaluations: u64,
    /// What more is known of the points, numbers only.
    pub fields: Vec<FieldExtent>,
    /// What single edges leave; null where the job does not ask for it.
    pub cut: Option<CutHeights>,
    /// How far parameters move it; null without the option `sensitivity`.
    pub sensitivity: Option<SensitivityTable>,
    /// The roots at the place at which all of them were looked for.
    pub branches: BranchSearch,
    /// Whether the tool cuts points away in another position than the one that generates them.
    #[serde(rename = "positions")]
    pub tool_positions: ToolPositions,
    /// What its sample requires and points do not keep.
    pub not_as_required: Vec<MissedRequirement>,
    /// How many points are proven; `None` if that was not asked for.
    #[serde(skip)]
    pub certified: Option<Certified>,
    #[serde(skip)]
    pub(super) points: PointGrid,
}

/// A line on a surface.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LineResult {
    /// What was asked for and found.
    #[serde(flatten)]
    pub summary: PointSummary,
    #[serde(skip)]
    pub(super) points: PointGrid,
}

/// The values of one field of numbers over the solved points of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FieldExtent {
    /// As files have it.
    pub name: String,
    /// Such as `1/mm`; `1` for a plain number.
    pub unit: String,
    /// Smallest value over the solved points.
    pub low: Option<f64>,
    /// Largest.
    pub high: Option<f64>,
    /// Points at which it is not defined.
    pub undefined: usize,
    /// Whether all values are whole, as those of a number of a tooth are.
    #[serde(skip)]
    pub(super) is_whole: bool,
}

/// At how many points it is known what single edges leave.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CutHeights {
    /// The surface of the single edges.
    pub by: String,
    /// Points of which it is known what they leave.
    pub known: usize,
    /// Points over which no edge passes.
    pub unreached: usize,
    /// Points at which it is not certain which edge is the lowest.
    pub undecided: usize,
}

/// What moves a surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SensitivityTable {
    /// That all influences are known at.
    pub points: usize,
    /// Those that move the surface, the one whose usual change does most first.
    pub parameters: Vec<ParameterInfluence>,
    /// Parameters that move no point.
    pub no_influence: Vec<String>,
    /// Parameters that count and have no derivative.
    pub counts: Vec<String>,
}

/// How far a parameter moves a surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ParameterInfluence {
    /// Of the parameter.
    pub name: String,
    /// Of rms and largest, such as `um/mm`, `um/arcmin`.
    pub unit: String,
    /// Of the normal displacement over the points.
    pub rms: f64,
    /// Absolute.
    pub largest: f64,
    /// The change that parameters are ranked by: 0.01 mm, one arcminute, of all others a thousandth of the value.
    pub usual_change: UsualChange,
}

/// What the usual change of a parameter does.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct UsualChange {
    /// To three digits.
    pub size: f64,
    /// Empty for a plain number.
    pub unit: String,
    /// Normal displacement by it, root of the mean square.
    pub rms_um: f64,
    /// Absolute.
    pub largest_um: f64,
}

/// The roots of a surface's equations at one place of its sample.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BranchSearch {
    /// Looked at in the search for all roots.
    pub boxes: u64,
    /// At the place at which branches were looked for.
    pub found: Vec<BranchPoint>,
    /// Parts of the ranges in which further branches are not excluded.
    pub undecided: Vec<OpenRanges>,
    /// Branches that have points in the ranges at other places of the sample and are not among its points.
    pub elsewhere: Vec<BranchPoint>,
}

/// A branch of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BranchPoint {
    /// Where it is.
    pub unknowns: Vec<NamedValue>,
    /// In the surface's frame, mm.
    pub position: [f64; 3],
    /// What in a sample selects this branch; null where there is no other, or no single range distinguishes it.
    pub keep: Option<Extent>,
}

/// A part of the ranges in which branches are not excluded.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OpenRanges {
    /// Of each unknown.
    pub ranges: Vec<Extent>,
    /// Why they are not.
    pub why: &'static str,
}

/// Which positions of the tool points were checked against.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ToolPositions {
    /// Positions that points were not checked against; null if all were looked at.
    pub not_looked_at: Option<&'static str>,
    /// How deep in the tool's steel the deepest point that is cut away was seen, mm.
    pub deepest: Option<f64>,
}

/// A requirement that does not hold at some points.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MissedRequirement {
    /// As the spec has it.
    pub message: String,
    /// Of what is required to keep limits.
    pub name: String,
    /// Of its values.
    pub unit: UnitSymbol,
    /// At which it does not.
    pub points: usize,
    /// Smallest value at them; null where it is no number.
    pub low: Option<f64>,
    /// Largest.
    pub high: Option<f64>,
}

/// Proofs of points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Certified {
    /// Proven.
    pub points: usize,
    /// Within which exactly one root is proven, mm: the largest.
    pub radius: Option<f64>,
}

/// A surface as a smooth face of a STEP file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SmoothFace {
    /// Its name.
    pub surface: String,
    /// Rows and columns of points that it goes through; null where it has no face.
    pub counts: Option<[usize; 2]>,
    /// Points beyond the face.
    pub left_out: Option<usize>,
    /// Largest distance from exact points between those, mm.
    pub deviation: Option<f64>,
    /// Such points.
    pub measured: Option<usize>,
    /// Such points that were not solved or do not meet the face.
    pub not_measured: Option<usize>,
    /// For the tolerance that was asked for.
    pub is_exact_enough: bool,
}

impl SurfaceResult {
    /// Rows and columns of the points; zero where they are not kept.
    pub fn counts(&self) -> [usize; 2] {
        self.points.counts
    }

    /// Whether there were too many points to keep: they stand in the files alone, and all arrays here are empty.
    pub fn is_streamed(&self) -> bool {
        self.points.statuses.is_empty() && self.summary.asked > 0
    }

    /// Positions in the surface's frame, mm, row by row. NaN where the generated surface has no point: those that are `solved`,
    /// `undercut`, `trimmed` or `undecided` have one.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.points.positions
    }

    /// Unit normals out of the material, as [`positions`](Self::positions).
    pub fn normals(&self) -> &[[f64; 3]] {
        &self.points.normals
    }

    /// The names of the unknowns.
    pub fn unknown_names(&self) -> impl Iterator<Item = &str> {
        // distance from z, and z, come first
        self.summary.ranges_reached.iter().skip(2).map(|extent| extent.name.as_str())
    }

    /// The unknowns at each point, one point after the other, mm and radians; NaN as [`positions`](Self::positions).
    pub fn unknowns(&self) -> &[f64] {
        &self.points.unknowns
    }

    /// What became of each point.
    pub fn statuses(&self) -> &[Status] {
        &self.points.statuses
    }

    /// The largest absolute residual at each point.
    pub fn residuals(&self) -> &[f64] {
        &self.points.residuals
    }

    /// All that is known of its points.
    pub fn grid(&self) -> &PointGrid {
        &self.points
    }

    /// Takes all that is known of its points out of the result, whose arrays are empty afterwards.
    pub fn take_grid(&mut self) -> PointGrid {
        std::mem::take(&mut self.points)
    }
}

impl LineResult {
    /// Positions in the surface's frame, mm, along the line; NaN where no point of it was found.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.points.positions
    }

    /// What became of each point.
    pub fn statuses(&self) -> &[Status] {
        &self.points.statuses
    }

    /// Takes all that is known of its points out of the result, whose arrays are empty afterwards.
    pub fn take_grid(&mut self) -> PointGrid {
        std::mem::take(&mut self.points)
    }
}

impl Answer for SolveResult {
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

impl fmt::Display for SolveResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "job {} ({})\n", self.job, self.spec)?;
        let head = ["surface", "asked", "solved", "worst residual", "ranges reached"].map(String::from);
        let surfaces = self.surfaces.iter().map(|surface| &surface.summary);
        let all = surfaces.chain(self.lines.iter().map(|line| &line.summary));
        let rows: Vec<[String; 5]> = [head].into_iter().chain(all.flat_map(PointSummary::cells)).collect();
        f.write_str(&aligned(&rows, "<>>>"))?;
        let fields: Vec<[String; 5]> = self.surfaces.iter().flat_map(SurfaceResult::field_rows).collect();
        if !fields.is_empty() {
            write!(f, "\n{}", aligned(&fields, ""))?;
        }
        for surface in &self.surfaces {
            let Some(table) = &surface.sensitivity else { continue };
            table.write(&surface.summary.name, f)?;
        }
        let certified = |surface: &SurfaceResult| Some((surface.summary.name.clone(), surface.certified?));
        for (at, (name, Certified { points, radius })) in self.surfaces.iter().filter_map(certified).enumerate() {
            let blank = if at == 0 { "\n" } else { "" };
            let largest = radius.map_or(String::new(), |radius| format!(", each within {radius:.1e} mm"));
            writeln!(f, "{blank}certified: {points} points of {name}{largest}")?;
        }
        writeln!(f, "\nwrote {}", self.files.join(", "))
    }
}

impl PointSummary {
    /// Cells of the table, two ranges to a line.
    fn cells(&self) -> Vec<[String; 5]> {
        let residual = self.worst_residual.map_or("-".to_string(), |worst| format!("{worst:.1e}"));
        let mut first = [self.name.clone(), self.asked.to_string(), self.solved.to_string(), residual];
        if self.solved == 0 {
            let [name, asked, found, worst] = first;
            return vec![[name, asked, found, worst, self.none()]];
        }
        let lines = self.ranges_reached.chunks(2).map(|pair| {
            let reached: Vec<String> = pair.iter().map(extent_text).collect();
            let [name, asked, found, worst] = std::mem::take(&mut first);
            [name, asked, found, worst, reached.join("   ")]
        });
        lines.collect()
    }

    /// What has become of points none of which is solved.
    fn none(&self) -> String {
        let outcomes: Vec<(&&str, &usize)> = self.outcomes.iter().collect();
        let by = &self.outside;
        match outcomes[..] {
            [] | [(&"out_of_range", _)] => {
                let by = by.as_ref().map_or(String::new(), |by| format!(": outside, {by}"));
                format!("none within the ranges{by}")
            }
            [(word, _)] => format!("none: {word}"),
            _ => {
                let each: Vec<String> = outcomes.iter().map(|(word, count)| format!("{count} {word}")).collect();
                let by = by.as_ref().map_or(String::new(), |by| format!("; {by}"));
                format!("none: {}{by}", each.join(", "))
            }
        }
    }
}

fn extent_text(extent: &Extent) -> String {
    match extent.ends() {
        Some((low, high)) => {
            let [low, high] = [low, high].map(|x| fixed(x, 4));
            format!("{} {low} .. {high} {}", extent.name, extent.unit.symbol()).trim_end().to_string()
        }
        None => extent.name.clone(),
    }
}

impl SurfaceResult {
    /// A line for each field; the first has the name of the surface.
    fn field_rows(&self) -> Vec<[String; 5]> {
        let mut name = self.summary.name.clone();
        let row = |of: &FieldExtent| {
            let shown = |x: f64| if of.is_whole && of.unit == "1" { fixed(x, 0) } else { six_digits(x) };
            let ends = of.low.zip(of.high).map(|(low, high)| format!("{} .. {}", shown(low), shown(high)));
            let unit = if of.unit == "1" { "" } else { &of.unit };
            let open = match of.undefined {
                0 => String::new(),
                count => format!("not defined at {count} points"),
            };
            [std::mem::take(&mut name), of.name.clone(), ends.unwrap_or("-".to_string()), unit.to_string(), open]
        };
        self.fields.iter().map(row).collect()
    }
}

/// Six digits behind the point; what is small, but more than rounding, is no zero.
fn six_digits(x: f64) -> String {
    if (1e-14..1e-6).contains(&x.abs()) { format!("{x:.1e}") } else { fixed(x, 6) }
}

impl SensitivityTable {
    fn write(&self, name: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.points == 0 {
            return writeln!(f, "\n{name}: no point is solved, so what moves it is unknown");
        }
        let head = ["parameter", "rms", "largest", "normal displacement in", "usual change", "rms um", "largest um"];
        let rows = self.parameters.iter().map(ParameterInfluence::cells);
        let rows: Vec<[String; 7]> = [head.map(String::from)].into_iter().chain(rows).collect();
        write!(f, "\n{name} moves, over {} points, with\n{}", self.points, aligned(&rows, "<>><<>>"))?;
        let idle = &self.no_influence;
        if !idle.is_empty() {
            let of = self.parameters.len() + idle.len();
            writeln!(f, "  no influence, {} of {of}: {}", idle.len(), idle.join(", "))?;
        }
        if !self.counts.is_empty() {
            writeln!(f, "  integers, which have no derivative: {}", self.counts.join(", "))?;
        }
        Ok(())
    }
}

impl ParameterInfluence {
    /// Its name, root of the mean square and largest normal displacement, the unit of these; its usual change, and how far that moves
    /// the surface, in um: root of the mean square, and largest.
    pub(crate) fn cells(&self) -> [String; 7] {
        let UsualChange { size, unit, rms_um, largest_um } = &self.usual_change;
        let [rms, largest] = [self.rms, self.largest].map(micrometres);
        let [by_rms, by_largest] = [*rms_um, *largest_um].map(micrometres);
        let change = format!("{size} {unit}").trim_end().to_string();
        [self.name.clone(), rms, largest, self.unit.clone(), change, by_rms, by_largest]
    }
}

/// Four digits behind the point, fewer where there would be only zeros.
fn micrometres(um: f64) -> String {
    if um < 1e-3 { format!("{um:.1e}") } else { format!("{um:.4}") }
}
