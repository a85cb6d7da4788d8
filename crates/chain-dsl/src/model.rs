//! What a checked text means, all symbolic.

use std::ops::{Add, Mul, Sub};
use std::path::PathBuf;

use flank_expr::geometry::{Chain, Edge, Step, Surface, Vector3};
use flank_expr::{Expr, Graph};

use crate::diagnostics::source::Span;
use crate::job::expect::model::Expectation;
use crate::values::dimension::Dimension;
use crate::values::steel_side::SteelSide;

/// One job, ready to be solved: its parameters are variables with values beside them.
#[derive(Clone, Debug)]
pub struct Job<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The file that it stands in.
    pub file: PathBuf,
    /// Job parameters and settings of its machines and tools, each after those that its value depends on.
    pub parameters: Vec<Parameter<'g>>,
    /// All settings of a machine that stands by itself ([`compile_with_machine`](crate::compile_with_machine)), with the ranges that
    /// they may have, endless where none is stated. Those without a value are not among the parameters.
    pub settings: Vec<RangedVariable<'g>>,
    /// What moves.
    pub motions: Vec<RangedVariable<'g>>,
    /// Its machines.
    pub machines: Vec<Machine<'g>>,
    /// Its surfaces, in order.
    pub surfaces: Vec<GeneratedSurface<'g>>,
    /// Those of its motions that a contact determines.
    pub unknowns: Vec<Expr<'g>>,
    /// Bodies that its surfaces bound.
    pub solids: Vec<Solid>,
    /// Flanks that roll on each other.
    pub contacts: Vec<Contact<'g>>,
    /// What contacts shall be like.
    pub wants: Vec<WantedContact>,
    /// Surfaces that are milled.
    pub millings: Vec<Milling<'g>>,
    /// What it is tested by, if that was asked for ([`Request::whole`](crate::Request::whole)).
    pub expectations: Vec<Expectation<'g>>,
    /// Of its parameters those from whose values numbers of it follow that it does not hold as functions of them, also by way of what they
    /// are given to: ends of ranges, points that are asked for or that a spline goes through, which branch of an `if` counts. With other
    /// values of the others it is the same job, as long as steel stays on its side.
    pub decisive: Vec<Expr<'g>>,
    /// On which side of each surface of its tools the steel lies.
    pub steel_sides: Vec<SteelSide<'g>>,
}

/// What a contact shall be like at its vertex, where the error is extreme. Places and directions are on the second flank.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedContact {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The contact, as an index into those of the job.
    pub contact: usize,
    /// In the order in which they are written.
    pub conditions: Vec<ContactCondition>,
    /// Thickness of the film that the ellipse is of, mm.
    pub film: f64,
    /// Where its name is written.
    pub written: Span,
}

/// What one number of a contact shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactCondition {
    /// Which number.
    pub of: ContactQuantity,
    /// mm or radians.
    pub value: f64,
    /// How far it may be off, as least squares weigh it; a condition without one holds exactly.
    pub within: Option<f64>,
    /// Where it is written.
    pub written: Span,
}

/// A number of a contact at its vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactQuantity {
    /// Along the axis of the second member.
    Z,
    /// Distance from that axis.
    Rho,
    /// Share of the way from toe to heel of the sample of the second flank.
    Lengthwise,
    /// Share of the way from root to tip.
    Profilewise,
    /// Angle of the path against the rows of that sample: positive where it comes nearer to the tip on its way to the heel.
    Path,
    /// Length of the ellipse within the film: its longer axis.
    Ellipse,
    /// Height of the error's parabola over a pitch.
    TransmissionError,
}

/// Two flanks on a pair of shafts that roll on each other.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The flanks, as indices into the surfaces of the job.
    pub surfaces: [usize; 2],
    /// The frames that they are mounted on, as `m.pinion`.
    pub frames: [String; 2],
    /// From the root of the pair's machine to each flank, in the roll, the unknown, mounting errors and parameters.
    pub placements: [Chain<'g>; 2],
    /// What is added to the laws of the axes on the way: zero, unless the pair is mounted wrong.
    pub errors: Vec<MountingAxis<'g>>,
    /// The motion that the pair rolls by.
    pub roll: RangedVariable<'g>,
    /// The unknown that the contact determines.
    pub lag: RangedVariable<'g>,
    /// How far it rolls from one pair of teeth to the next, mm or radians, if that is said.
    pub every: Option<f64>,
    /// Where its name is written.
    pub written: Span,
}

/// A surface that a cutter of revolution mills along passes.
#[derive(Clone, Debug)]
pub struct Milling<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// What is milled, as an index into the surfaces of the job.
    pub surface: usize,
    /// The surface of the cutter that touches it, as `e.cutting`.
    pub cutter_name: String,
    /// Its smooth pieces in the tool's frame: about its z axis, which points out of the spindle.
    pub cutter: Vec<CutterPiece<'g>>,
    /// The machine, as an index into those of the job.
    pub machine: usize,
    /// The frames of that machine in which the work is clamped and on which the cutter sits, as `m.work`.
    pub frames: [String; 2],
    /// From the one to the other, in axis variables; the law of an axis without one is its own variable.
    pub t_work_tool: Chain<'g>,
    /// Where the passes lie on the surface.
    pub area: MilledArea<'g>,
    /// How far apart passes are.
    pub spacing: PassSpacing,
    /// How long the blocks of a pass are.
    pub blocks: BlockLength,
    /// By how much the spindle leans forward in the feed, and about the feed: in the two values of `area.variables`.
    pub lean: [Expr<'g>; 2],
    /// What is left on the surface, mm.
    pub stock: f64,
    /// Whether every other pass runs backwards.
    pub both_ways: bool,
    /// What the cutter keeps clear of.
    pub clearances: Vec<MillingClearance<'g>>,
    /// Where its name is written.
    pub written: Span,
}

/// A smooth piece of a cutter.
#[derive(Clone, Debug)]
pub struct CutterPiece<'g> {
    /// As `e.cutting.corner`.
    pub name: String,
    /// The surface, or an edge.
    pub shape: ToolShape<'g>,
    /// Its parameters with their ranges.
    pub unknowns: Vec<RangedVariable<'g>>,
}

/// A part of a surface between values of two coordinates: of the passes, and along them.
#[derive(Clone, Debug)]
pub struct MilledArea<'g> {
    /// The functions of the surface's unknowns that points are asked for by.
    pub coordinates: [Coordinate<'g>; 2],
    /// What a pass is counted by, and what runs along it: `profilewise`, `z`.
    pub names: [String; 2],
    /// Their dimensions.
    pub dimensions: [Dimension; 2],
    /// Both between their ends.
    pub ranges: [(f64, f64); 2],
    /// Of shares: both coordinates at toe root, heel root, toe tip, heel tip, and whether the passes are counted from toe to heel.
    pub shares: Option<([[f64; 2]; 4], bool)>,
    /// What stands for both values in expressions.
    pub variables: [Expr<'g>; 2],
}

impl MilledArea<'_> {
    /// The values of the coordinates at a pass and a place along it.
    pub fn at(&self, pass: f64, along: f64) -> [f64; 2] {
        match self.shares {
            None => [pass, along],
            Some((corners, false)) => between(corners, [pass, along]),
            Some((corners, true)) => between(corners, [along, pass]),
        }
    }
}

/// How far apart passes are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PassSpacing {
    /// So that no cusp between two of them is higher, mm.
    Scallop(f64),
    /// At most so far, mm.
    Step(f64),
    /// So many passes.
    Count(usize),
    /// One pass, with the straight side of the cutter, whose axis is free at so many places along it.
    Side(usize),
}

/// How long the blocks of a pass are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockLength {
    /// So that the cutter on a straight block is no farther from where it should be, mm.
    Chord(f64),
    /// At most so long, mm.
    Step(f64),
    /// So many positions on a pass.
    Count(usize),
}

/// What a part of a cutter keeps clear of.
#[derive(Clone, Debug)]
pub enum MillingObstacle<'g> {
    /// A surface of the job, as an index.
    Surface(usize),
    /// A surface of a tool that stands still against the work: a jaw, an arbor, a part of the machine.
    Fixture {
        /// Its smooth pieces in the frame that it sits on.
        pieces: Vec<CutterPiece<'g>>,
        /// From the work to that frame.
        t_work_fixture: Chain<'g>,
    },
}

/// A surface that a part of the cutter keeps clear of.
#[derive(Clone, Debug)]
pub struct MillingClearance<'g> {
    /// What is kept clear of.
    pub obstacle: MillingObstacle<'g>,
    /// How far, mm.
    pub distance: f64,
    /// The part of the cutter, as `e.whole`.
    pub body_name: String,
    /// Its smooth pieces in the tool's frame.
    pub body: Vec<CutterPiece<'g>>,
    /// Where it is written.
    pub written: Span,
}

/// An axis of a pair's machine that may be mounted wrong.
#[derive(Clone, Debug)]
pub struct MountingAxis<'g> {
    /// Its name, as `m.E`.
    pub name: String,
    /// What is added to its law.
    pub variable: Expr<'g>,
    /// A length or an angle.
    pub dimension: Dimension,
    /// Whether a motion or an unknown drives it: the pair turns by it.
    pub is_driven: bool,
}

/// How the tooth spaces of a body follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidForm {
    /// About the z axis of its frame, all around: the outline is in `[z, rho]`.
    Turned,
    /// Beside each other along the y axis of its frame: the outline is in `[z, x]`.
    Extruded {
        /// From one space to the next, mm.
        pitch: f64,
    },
}

/// A blank with tooth spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// Its frame, as `m.work`.
    pub frame: String,
    /// How its spaces follow each other.
    pub form: SolidForm,
    /// Its outline in the section that the form says, mm: closed, the material on the left.
    pub outline: Vec<OutlineSegment>,
    /// How many tooth spaces it has.
    pub teeth: u32,
    /// The surfaces of one space from one side to the other, as indices into the surfaces of the job.
    pub space: Vec<usize>,
    /// Where spaces differ, the name of the parameter that says of which of them the surfaces are, from 0 on.
    pub each: Option<String>,
    /// Where its name is written.
    pub written: Span,
}

/// A segment of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineSegment {
    /// Its name: tip, toe, heel.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// What it runs along.
    pub curve: OutlineCurve,
}

/// What a segment of an outline runs along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineCurve {
    /// A straight line.
    Line,
    /// An arc of less than half a turn.
    Arc {
        /// Its centre.
        center: [f64; 2],
    },
}

/// A named constant of a job.
#[derive(Clone, Debug)]
pub struct Parameter<'g> {
    /// `ratio`, `m.radial_distance`.
    pub name: String,
    /// The variable that stands for it.
    pub variable: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its value as an expression in earlier parameters.
    pub definition: Expr<'g>,
    /// Its value, mm or radians.
    pub value: f64,
    /// The value that the text gives it, with those of the others as they are: the same, unless the caller gives it another one. NaN where the
    /// text gives it none.
    pub value_in_text: f64,
    /// Whether it counts something: then it is a whole number and has no derivative.
    pub is_count: bool,
    /// Whether it says how a machine differs from the nominal one, in which it is zero.
    pub is_error: bool,
    /// Between which values it must lie, if that is stated.
    pub range: Option<(f64, f64)>,
    /// What it is set in multiples of, mm or radians, if that is stated.
    pub step: Option<f64>,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// Who gives it its value.
    pub given_by: ValueSource,
    /// Where that value is written.
    pub written: Span,
}

/// Who gives a parameter its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ValueSource {
    /// The machine or tool of this name, whose own value it is where nobody gives another one.
    Definition(String),
    /// The job.
    Job,
    /// The caller, from outside the text.
    Caller,
}

/// A variable that is looked for in a range.
#[derive(Clone, Debug)]
pub struct RangedVariable<'g> {
    /// Its name.
    pub name: String,
    /// The variable.
    pub variable: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
    /// Lower end, mm or radians.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it counts something: on the machine it takes whole numbers only.
    pub is_count: bool,
    /// Of the run over a piece of a tool's profile: what the profile goes on with beyond.
    pub piece: Option<PieceEnds>,
}

/// A piece of a profile between the two that it neighbours.
#[derive(Clone, Debug)]
pub struct PieceEnds {
    /// Its name.
    pub name: String,
    /// The pieces before and behind it; `None` where the profile ends.
    pub beside: [Option<String>; 2],
}

/// A machine of a job: a tree of frames moved by axes.
#[derive(Clone, Debug)]
pub struct Machine<'g> {
    /// Its name in the job.
    pub name: String,
    /// The machine that it is one of.
    pub definition: String,
    /// Its axes.
    pub axes: Vec<Axis<'g>>,
    /// Its frames, parents before children; the first is the root.
    pub frames: Vec<Frame<'g>>,
}

/// An axis and its law.
#[derive(Clone, Debug)]
pub struct Axis<'g> {
    /// Its name.
    pub name: String,
    /// The variable in the frames' transforms.
    pub variable: Expr<'g>,
    /// A length or an angle.
    pub dimension: Dimension,
    /// Its value as a function of motions and parameters.
    pub law: Expr<'g>,
    /// How the law was given.
    pub source: LawSource,
    /// Travel, mm or radians.
    pub travel: Option<(f64, f64)>,
    /// What NC programs say of it.
    pub word: NcWord,
}

/// How NC programs name and count an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct NcWord {
    /// Its letter, perhaps with a number behind.
    pub address: String,
    /// Whether the control counts against the axis of the machine's frames.
    pub reversed: bool,
    /// What the control shows where the axis stands at zero, mm or radians.
    pub offset: f64,
    /// Decimals in which positions are written, in mm or degrees, where the machine says so.
    pub decimals: Option<u8>,
}

impl NcWord {
    /// The word of an axis that nothing is said of: its own name and count.
    pub(crate) fn of_axis(name: &str) -> NcWord {
        NcWord { address: name.to_string(), reversed: false, offset: 0.0, decimals: None }
    }
}

/// Where an axis has its law from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawSource {
    /// `drive` in the job.
    Driven,
    /// `fix` in the machine.
    Fixed,
    /// `couple` in the machine.
    Coupled,
    /// `close` in the machine: a closed loop gives it.
    Closed,
    /// Nowhere: it stands where it is put ([`compile_with_machine`](crate::compile_with_machine)); its law is its own variable.
    Free,
}

/// A frame in its machine.
#[derive(Clone, Debug)]
pub struct Frame<'g> {
    /// Its name.
    pub name: String,
    /// Index of the frame it hangs on; `None` for the root.
    pub parent: Option<usize>,
    /// From the parent to it, in axis variables.
    pub steps: Vec<Step<'g>>,
}

/// A surface of a job in the frame it is asked for in.
#[derive(Clone, Debug)]
pub struct GeneratedSurface<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The frame, as `m.table`.
    pub frame: String,
    /// How it came about.
    pub generation: Generation<'g>,
    /// The surface, in motions and parameters.
    pub surface: Surface<'g>,
    /// Ranges of its unknowns, in the order of `surface.unknowns`.
    pub unknowns: Vec<RangedVariable<'g>>,
    /// The surfaces of the job that cut points of it away, as indices into its surfaces.
    pub trimmed_by: Vec<usize>,
    /// The sweep of the numbered edges that really cut it, as an index into the surfaces of the job: over the same motions, one
    /// and counts.
    pub cut_by: Option<usize>,
    /// Of one more sample of a surface, with a name of its own: that surface, as an index into the surfaces of the job.
    pub sample_of: Option<usize>,
    /// The points that are asked for.
    pub sample: Option<Sample<'g>>,
    /// Where its name is written.
    pub written: Span,
}

/// What a tool is, in its own frame.
#[derive(Clone, Debug)]
pub enum ToolShape<'g> {
    /// A surface: an envelope takes it.
    Surface(Surface<'g>),
    /// A cutting edge: a sweep takes it.
    Edge(Edge<'g>),
}

/// How a surface came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// The envelope of a tool's surface.
    Envelope,
    /// The sweep of a cutting edge.
    Sweep,
    /// The tool's surface itself, seen from another frame.
    Move,
}

/// The envelope that made a surface.
#[derive(Clone, Debug)]
pub struct Generation<'g> {
    /// The tool's surface, as `c.flank`.
    pub tool_name: String,
    /// How the surface came about.
    pub process: Process,
    /// The tool in its own frame.
    pub tool: ToolShape<'g>,
    /// The frames from work to tool, as `m.table`, with the steps between each and the one before it.
    pub path: Vec<(String, Vec<Step<'g>>)>,
    /// The pose of the tool in the work, in axis variables.
    pub t_work_tool: Chain<'g>,
    /// The same with each axis replaced by its law.
    pub driven: Chain<'g>,
    /// The motions that it is an envelope over.
    pub motions: Vec<Expr<'g>>,
}

/// A grid of points that is asked for: two coordinates and their values.
#[derive(Clone, Debug)]
pub struct Sample<'g> {
    /// The two functions of the unknowns that are given values.
    pub coordinates: [Coordinate<'g>; 2],
    /// What a row and a column of the grid are.
    pub labels: [String; 2],
    /// Number of rows and of columns.
    pub counts: [usize; 2],
    /// Where its points are.
    pub grid: SampleGrid,
    /// The same where its points end, as the spec has it: in the parameters of the job.
    pub ends: SampleEnds<'g>,
    /// Functions of the unknowns, and the ends between which they lie on the branch that is meant.
    pub keep: Vec<(Coordinate<'g>, (f64, f64))>,
    /// What every point must fulfil.
    pub limits: Vec<PointRequirement<'g>>,
}

/// A function of the unknowns that must lie between two ends at every point of a sample.
#[derive(Clone, Debug)]
pub struct PointRequirement<'g> {
    /// The function.
    pub of: Coordinate<'g>,
    /// Lower and upper end.
    pub ends: (f64, f64),
    /// The message where it does not, in the words of the spec.
    pub message: String,
    /// Where its name stands.
    pub place: Span,
}

/// Values of two coordinates in rows and columns, told one by one: there may be millions.
#[derive(Clone, Debug)]
pub enum SampleGrid {
    /// Those of the first coordinate in the rows, and of the second in the columns.
    Values([Vec<f64>; 2]),
    /// Shares of the way from root to tip, and from toe to heel.
    Shares {
        /// Of the rows, and of the columns.
        shares: [Vec<f64>; 2],
        /// Both coordinates at toe root, heel root, toe tip, heel tip.
        corners: [[f64; 2]; 4],
    },
    /// Points that are listed one by one, in one row.
    Points(Vec<[f64; 2]>),
}

/// Where a [`SampleGrid`] ends, in the parameters of the job.
#[derive(Clone, Debug)]
pub struct SampleEnds<'g> {
    /// The first and the last value, or share, of the rows, and of the columns.
    pub values: [[Expr<'g>; 2]; 2],
    /// Of shares the corners, as [`SampleGrid::Shares`] has them.
    pub corners: Option<[[Expr<'g>; 2]; 4]>,
}

impl<'g> SampleEnds<'g> {
    /// Both coordinates at the first row's first and last point, and at the last row's.
    pub fn corners(&self) -> [[Expr<'g>; 2]; 4] {
        let [rows, columns] = self.values;
        let places = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, column)| [rows[row], columns[column]]);
        let Some(corners) = self.corners else { return places };
        places.map(|shares| between(corners, shares))
    }
}

/// The point at shares of the way from root to tip, and from toe to heel, between toe root, heel root, toe tip, heel tip.
fn between<T>([toe_root, heel_root, toe_tip, heel_tip]: [[T; 2]; 4], [v, u]: [T; 2]) -> [T; 2]
where
    T: Copy + Add<Output = T> + Mul<Output = T>,
    f64: Sub<T, Output = T>,
{
    [0, 1].map(|k| {
        (1.0 - v) * ((1.0 - u) * toe_root[k] + u * heel_root[k]) + v * ((1.0 - u) * toe_tip[k] + u * heel_tip[k])
    })
}

impl SampleGrid {
    /// The values of the coordinates in a row and a column.
    ///
    /// # Panics
    /// If there is no such row or column.
    pub fn at(&self, row: usize, column: usize) -> [f64; 2] {
        match self {
            SampleGrid::Values([rows, columns]) => [rows[row], columns[column]],
            SampleGrid::Shares { shares: [rows, columns], corners } => between(*corners, [rows[row], columns[column]]),
            SampleGrid::Points(points) => points[column],
        }
    }

    /// Half-way between the coordinates of the first and of the last point of so many rows and columns.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn middle(&self, [rows, columns]: [usize; 2]) -> [f64; 2] {
        let (first, last) = (self.at(0, 0), self.at(rows - 1, columns - 1));
        std::array::from_fn(|k| 0.5 * (first[k] + last[k]))
    }

    /// With these rows and these columns only.
    ///
    /// # Panics
    /// If one of them is not there.
    pub fn picked(&self, lines: &[Vec<usize>; 2]) -> SampleGrid {
        let pick = |values: &[Vec<f64>; 2]| [0, 1].map(|k| lines[k].iter().map(|at| values[k][*at]).collect());
        match self {
            SampleGrid::Values(values) => SampleGrid::Values(pick(values)),
            SampleGrid::Shares { shares, corners } => SampleGrid::Shares { shares: pick(shares), corners: *corners },
            SampleGrid::Points(points) => SampleGrid::Points(lines[1].iter().map(|at| points[*at]).collect()),
        }
    }

    /// With one more row between any two and one more column between any two, half-way.
    pub fn halved(&self) -> SampleGrid {
        let halved = |values: &[f64]| {
            (1..2 * values.len()).map(|at| 0.5 * (values[(at - 1) / 2] + values[at / 2])).collect::<Vec<f64>>()
        };
        match self {
            SampleGrid::Values(values) => SampleGrid::Values(values.each_ref().map(|values| halved(values))),
            SampleGrid::Shares { shares, corners } => {
                SampleGrid::Shares { shares: shares.each_ref().map(|shares| halved(shares)), corners: *corners }
            }
            SampleGrid::Points(points) => {
                let half = |at: usize| [0, 1].map(|k| 0.5 * (points[(at - 1) / 2][k] + points[at / 2][k]));
                SampleGrid::Points((1..2 * points.len()).map(half).collect())
            }
        }
    }
}

impl<'g> Sample<'g> {
    /// A value of the rows (0) or columns (1) that lies beyond two ends.
    pub(crate) fn beyond(&self, axis: usize, (low, high): (f64, f64)) -> Option<f64> {
        let SampleGrid::Values(values) = &self.grid else { return None };
        let slack = ON_END * (high - low);
        values[axis].iter().copied().find(|value| *value < low - slack || *value > high + slack)
    }

    /// The rows (0) or columns (1) whose values lie between two ends, with these; `None` if there are none.
    pub(crate) fn within(mut self, graph: &'g Graph, axis: usize, (low, high): (f64, f64)) -> Option<Sample<'g>> {
        let SampleGrid::Values(values) = &mut self.grid else { return None };
        let slack = ON_END * (high - low);
        values[axis].retain(|value| *value >= low - slack && *value <= high + slack);
        values[axis].iter_mut().for_each(|value| *value = value.clamp(low, high));
        let ends = [*values[axis].first()?, *values[axis].last()?];
        self.counts[axis] = values[axis].len();
        self.ends.values[axis] = ends.map(|end| graph.constant(end));
        Some(self)
    }
}

/// A value this near to an end, as a share of the way between both, is the end: rounding.
const ON_END: f64 = 1e-12;

impl Sample<'_> {
    /// Values of the coordinates at all points, row by row.
    pub fn targets(&self) -> Vec<[f64; 2]> {
        self.each_target().collect()
    }

    /// The same one by one.
    pub fn each_target(&self) -> impl Iterator<Item = [f64; 2]> {
        let [rows, columns] = self.counts;
        (0..rows).flat_map(move |row| (0..columns).map(move |column| self.grid.at(row, column)))
    }
}

/// A function of the unknowns that a sample gives values to.
#[derive(Clone, Debug)]
pub struct Coordinate<'g> {
    /// `z`, `rho`, or the name of an unknown.
    pub name: String,
    /// Its expression.
    pub value: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
}

impl<'g> Machine<'g> {
    /// The pose of frame `to` in frame `from`, in axis variables; `None` if the machine has no such frame.
    pub fn chain(&self, graph: &'g Graph, from: &str, to: &str) -> Option<Chain<'g>> {
        let place = |name: &str| self.frames.iter().position(|frame| frame.name == name);
        let hops = path(&self.frames, place(from)?, place(to)?);
        Some(Chain::new(graph, hops.into_iter().flat_map(|(_, steps)| steps).collect()))
    }
}

/// The steps from one frame of a machine to another: up to the frame that both hang on, then down. Each hop is named by
/// the frame that it arrives in.
pub(crate) fn path<'g>(frames: &[Frame<'g>], from: usize, to: usize) -> Vec<(usize, Vec<Step<'g>>)> {
    let line = |start: usize| std::iter::successors(Some(start), |&k| frames[k].parent).collect::<Vec<_>>();
    let (mut up, mut down) = (line(from), line(to));
    // frames above the meeting point belong to neither way
    while up.len() > 1 && down.len() > 1 && up[up.len() - 2] == down[down.len() - 2] {
        up.pop();
        down.pop();
    }
    let mut hops = vec![(from, Vec::new())];
    for pair in up.windows(2) {
        let steps = frames[pair[0]].steps.iter().rev().map(|step| step.inverse()).collect();
        hops.push((pair[1], steps));
    }
    for pair in down.windows(2).rev() {
        hops.push((pair[0], frames[pair[0]].steps.clone()));
    }
    hops
}

impl<'g> Generation<'g> {
    /// A point of the tool in its own frame.
    pub fn position(&self) -> Vector3<'g> {
        match &self.tool {
            ToolShape::Surface(surface) => surface.position,
            ToolShape::Edge(edge) => edge.position,
        }
    }

    /// The frame that the tool is given in.
    pub fn tool_frame(&self) -> &str {
        self.path.last().map_or("", |(name, _)| name)
    }
}

/// What a name from outside says behind the name of a job: `m.swivel` of `gear.m.swivel`.
pub(crate) fn within<'n>(name: &'n str, job: &str) -> Option<&'n str> {
    name.strip_prefix(job)?.strip_prefix('.')
}

impl<'g> Job<'g> {
    /// Whether it has a parameter or setting that is given from outside by such a name: `m.swivel`, or with the job's own name before
    /// it.
    pub fn has_parameter(&self, name: &str) -> bool {
        let has = |name: &str| self.parameters.iter().any(|parameter| parameter.name == name);
        has(name) || within(name, &self.name).is_some_and(has)
    }

    /// Each parameter's variable with its value as a number: what to substitute before solving.
    pub fn bindings(&self) -> Vec<(Expr<'g>, Expr<'g>)> {
        self.parameters
            .iter()
            .map(|parameter| (parameter.variable, parameter.variable.graph().constant(parameter.value)))
            .collect()
    }

    /// The same while some parameters are open: what depends on them is what it is in terms of them.
    pub fn bindings_beside(&self, open: &[Expr<'g>]) -> Vec<(Expr<'g>, Expr<'g>)> {
        let mut bindings: Vec<(Expr<'g>, Expr<'g>)> = Vec::new();
        for parameter in self.parameters.iter().filter(|parameter| !open.contains(&parameter.variable)) {
            let value = parameter.variable.graph().substitute(&[parameter.definition], &bindings)[0];
            bindings.push((parameter.variable, value));
        }
        bindings
    }
}
