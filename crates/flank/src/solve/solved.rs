//! A surface with its points and all that is known of them.

use flank_chain_dsl::{GeneratedSurface, Sample};
use flank_export::Field;
use flank_expr::Expr;
use flank_solver::{GridReport, SurfacePoint};

use crate::solve::arrays::PointGrid;
use crate::solve::cut::Cut;
use crate::solve::limits::Line;
use crate::solve::reach::Needed;
use crate::solve::secondary::Positions;
use crate::solve::sensitivity::Sensitivity;
use crate::solve::stream::Streamed;
use crate::solve::summary::Summary;

/// One surface with its points.
pub(crate) struct Solved<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    pub(crate) sample: &'j Sample<'g>,
    /// The job's parameters with their values.
    pub(crate) bindings: Vec<(Expr<'g>, Expr<'g>)>,
    /// Ranges that would reach the points that are outside.
    pub(crate) needed: Vec<Needed>,
    /// Its points, counted.
    pub(crate) summary: Summary,
    /// All of them; some for a picture if there are too many to keep.
    pub(crate) points: Vec<SurfacePoint>,
    /// The sample's rows and columns that these points stand in.
    pub(crate) lines: [Vec<usize>; 2],
    /// What hands over the points if they are too many to keep.
    pub(crate) streamed: Option<Streamed<'j, 'g>>,
    /// All points of a streamed surface, if arrays are wanted.
    pub(crate) arrays: Option<PointGrid>,
    pub(crate) effort: GridReport,
    /// Where it meets the surfaces that trim it, in their order.
    pub(crate) trims: Vec<Line<'j, 'g>>,
    /// Which positions of its tool its points were checked against.
    pub(crate) positions: Positions,
    /// Which unknowns mean the same after a turn.
    pub(crate) periodic: Vec<bool>,
    /// Where each of the branches at the anchor is.
    pub(crate) branches: Vec<SurfacePoint>,
    /// Branches that have points at other places, each with the point of its own branch there if that has one.
    pub(crate) elsewhere: Vec<(SurfacePoint, Option<SurfacePoint>)>,
    /// Where nothing was found: the branches there that the sample's `keep` does not take.
    pub(crate) kept_out: Vec<SurfacePoint>,
    /// How near exactly one root is proven to each point, mm, if that was asked for.
    pub(crate) radii: Option<Vec<Option<f64>>>,
    /// What more is known of these points; files show it after the status. What is known of each point of a streamed surface it has itself.
    pub(crate) fields: Vec<Field>,
    pub(crate) sensitivity: Option<Sensitivity>,
    /// What the single edges leave, if the job says which.
    pub(crate) cut: Option<Cut>,
}

impl Solved<'_, '_> {
    /// Its name, with what the single edges leave.
    pub(crate) fn left(&self) -> (&str, Option<&Cut>) {
        (&self.surface.name, self.cut.as_ref())
    }

    /// Its name, with which positions of its tool its points were checked against.
    pub(crate) fn positions_tried(&self) -> (&str, &Positions) {
        (&self.surface.name, &self.positions)
    }

    /// Rows and columns of its points.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.lines[k].len())
    }

    /// Where one of its points stands in the sample: row and column.
    pub(crate) fn place(&self, at: usize) -> [usize; 2] {
        let columns = self.lines[1].len();
        [self.lines[0][at / columns], self.lines[1][at % columns]]
    }
}
