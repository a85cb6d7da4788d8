//! What a spec is tested by, checked and symbolic.

use flank_expr::Expr;

use crate::diagnostics::source::Span;
use crate::model::{Coordinate, Job};
use crate::values::dimension::Dimension;

/// An error that a file is to have: `expect error E0307`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpectedError {
    /// The job that says so.
    pub job: String,
    /// The code of the error.
    pub code: String,
    /// Where that is said.
    pub place: Span,
}

/// Something that a job, or a machine, is to be like.
#[derive(Clone, Debug)]
pub struct Expectation<'g> {
    /// What is expected.
    pub what: Expected<'g>,
    /// From `expect` to its end.
    pub written: Span,
}

/// What is expected. Surfaces, contacts and solids are indices into those of the job.
#[derive(Clone, Debug)]
pub enum Expected<'g> {
    /// What becomes of points.
    Status {
        /// The sampled surfaces.
        surfaces: Vec<usize>,
        /// As tables have it: `solved`, `undercut`.
        status: String,
        /// Values of the two coordinates of the sample; all of the sample if it is empty.
        at: Vec<[f64; 2]>,
    },
    /// Values at points that a table lists.
    Table {
        /// The surface.
        surface: usize,
        /// What the table has of each point: two coordinates by which it is found, then what is compared.
        columns: Vec<PointColumn<'g>>,
        /// The numbers, mm and radians, row by row.
        rows: Vec<Vec<f64>>,
        /// By how much they may differ.
        within: f64,
    },
    /// How far a surface lies off another one, along its normals, without a turn.
    Surface {
        /// The surface.
        surface: usize,
        /// The other one with its job, `gear.flank`, of the same file.
        other: String,
        /// mm
        within: f64,
    },
    /// A function of the points of a surface.
    AtPoints {
        /// The surface.
        surface: usize,
        /// The function of its unknowns, and of what follows.
        value: Expr<'g>,
        /// What is known of points beside their unknowns: curvatures, and what edges leave, by their names in tables.
        known: Vec<(&'static str, Expr<'g>)>,
        /// Of the value.
        dimension: Dimension,
        /// Between which ends it lies.
        ends: [f64; 2],
        /// Whether it is how far a value lies from the one that is expected.
        is_difference: bool,
    },
    /// A number.
    Value {
        /// In quantities and parameters.
        value: Expr<'g>,
        /// Between which ends it lies, in the same.
        ends: [Expr<'g>; 2],
        /// What all of these are made of beside parameters.
        quantities: Vec<(Expr<'g>, Quantity<'g>)>,
        /// Of the value.
        dimension: Dimension,
    },
    /// No axis leaves its travel.
    Travel {
        /// Of one machine; of all otherwise.
        machine: Option<String>,
    },
    /// Another machine does the same.
    On {
        /// It, by itself.
        onto: Box<Job<'g>>,
        /// The machine of the job whose motions it makes; any otherwise.
        machine: Option<String>,
        /// How far the tool may be off, mm.
        within: f64,
    },
    /// A frame of a machine stands where it should.
    Pose {
        /// How far it is off.
        off: PoseDifference,
        /// How far it may be off.
        within: PoseTolerance,
    },
}

/// How a frame lies to where it should stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseDifference {
    /// Between both origins, mm.
    pub distance: f64,
    /// Of the one rotation that takes one frame into the other, radians from 0 to π; nothing where one is a mirror image of the other.
    pub angle: Option<f64>,
}

/// How far a frame may be off. Where no tolerance is written, the difference may be that of rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseTolerance {
    /// Between both origins, mm.
    pub distance: Option<f64>,
    /// Of the rotation, radians.
    pub angle: Option<f64>,
}

impl PoseTolerance {
    /// What counts as rounding between origins, mm: far above that of numbers of 100 m, far below what is made.
    pub const EXACT_DISTANCE: f64 = 1e-6;
    /// What counts as rounding of a rotation, radians: 0.001 arcsec moves a point 200 mm away by 1 nm.
    pub const EXACT_ANGLE: f64 = std::f64::consts::PI / 648e6;

    /// Whether a frame is off by no more.
    pub fn allows(self, off: PoseDifference) -> bool {
        off.distance <= self.distance.unwrap_or(PoseTolerance::EXACT_DISTANCE)
            && off.angle.is_some_and(|angle| angle <= self.angle.unwrap_or(PoseTolerance::EXACT_ANGLE))
    }
}

/// A column of a table of points.
#[derive(Clone, Debug)]
pub enum PointColumn<'g> {
    /// A coordinate of points, or an unknown.
    Coordinate(Coordinate<'g>),
    /// What is known of points beside their unknowns, by its name in tables: a curvature, or what edges leave.
    Known(&'static str, Dimension),
}

/// What is known of a job once it is solved.
#[derive(Clone, Debug)]
pub enum Quantity<'g> {
    /// Of a contact.
    Contact {
        /// Which.
        contact: usize,
        /// The number.
        number: ContactNumber,
    },
    /// Of a body.
    Solid {
        /// Which.
        solid: usize,
        /// The number.
        number: SolidNumber,
    },
    /// How two surfaces lie to each other.
    Deviation {
        /// Both, each with its job, `gear.flank`; the second is the one whose normals are followed.
        surfaces: [String; 2],
        /// The number.
        number: DeviationNumber,
    },
    /// The least or the largest value of a function over points.
    Extreme {
        /// The surface.
        surface: usize,
        /// Which points.
        over: PointSet,
        /// The function of its unknowns, and of what follows.
        value: Expr<'g>,
        /// What is known of points beside their unknowns, by its names in tables.
        known: Vec<(&'static str, Expr<'g>)>,
        /// Whether the largest is meant.
        is_highest: bool,
    },
    /// The position of an axis of another machine that does the same.
    Position {
        /// It, by itself.
        onto: Box<Job<'g>>,
        /// The axis.
        axis: String,
        /// Values of the job's motions, in its order; the middle where nothing is said.
        at: Vec<Option<f64>>,
    },
}

impl Quantity<'_> {
    /// Whether it says how a surface lies to itself.
    pub(super) fn is_of_itself(&self) -> bool {
        matches!(self, Quantity::Deviation { surfaces: [one, other], .. } if one == other)
    }
}

/// Points of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointSet {
    /// Those of its sample that are solved.
    Sample,
    /// Those of the line at which it turns back.
    SingularLine,
    /// Those of the line at which the tool's contact ends.
    ContactLimit,
    /// Those of the lines at which other surfaces cut it.
    Trim,
}

/// A number of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names in specs, in `CONTACT_NUMBERS`
pub enum ContactNumber {
    Ratio,
    PeakToPeak,
    Turn,
    Lag,
    Parabola,
    Backlash,
    NormalBacklash,
    Clearance,
    HalfLength,
    HalfWidth,
    GapHigh,
    GapLow,
    Pairs,
    Z(usize),
    Rho(usize),
}

/// A number of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names in specs, in `SOLID_NUMBERS` and `SOLID_FUNCTIONS`
pub enum SolidNumber {
    Volume,
    Area,
    TipDiameter,
    RootDiameter,
    FormDiameter,
    /// On a circle of this diameter, mm.
    Thickness(f64),
    /// Over so many teeth.
    Span(u32),
    /// Balls of this diameter, mm.
    OverBalls(f64),
}

/// A number of two surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names in specs, in `DEVIATION_FUNCTIONS`
pub enum DeviationNumber {
    /// The turn about z that brings both to meet in the middle of the grid.
    Turn,
    Rms,
    Lowest,
    Highest,
    /// Along the rows (0) or the columns (1) of the grid.
    Slope(usize),
    /// The same.
    Crowning(usize),
    Bias,
}
