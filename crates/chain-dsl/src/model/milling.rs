//! What cutters of revolution mill along passes.

use flank_expr::Expr;
use flank_expr::geometry::Chain;

use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::model::sample::{Coordinate, between};
use crate::model::surface::ToolShape;
use crate::values::dimension::Dimension;

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
