//! What `flank solve` tells of its work.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Sample};
use flank_export::Field;
use flank_expr::Expr;
use flank_solver::{GridReport, SurfacePoint};

use crate::project::quantity::Extent;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::solve::branches;
use crate::solve::certify;
use crate::solve::cut::Cut;
use crate::solve::fields;
use crate::solve::limits::Line;
use crate::solve::reach::Needed;
use crate::solve::reasons;
use crate::solve::required;
use crate::solve::result::{PointArrays, PointSummary, SurfaceResult};
use crate::solve::secondary::Positions;
use crate::solve::sensitivity::Sensitivity;
use crate::solve::stream::Streamed;
use crate::solve::summary::{Ends, Summary};

/// One surface with its points.
pub(crate) struct Solved<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    pub(crate) sample: &'j Sample<'g>,
    /// The job's parameters with their values.
    pub(crate) bindings: Vec<(Expr<'g>, Expr<'g>)>,
    /// Ranges that would reach the points that are outside.
    pub(crate) needed: Vec<Needed>,
    /// What is told of its points.
    pub(crate) summary: Summary,
    /// All of them; some for a picture if there are too many to keep.
    pub(crate) points: Vec<SurfacePoint>,
    /// The sample's rows and columns that these points stand in.
    pub(crate) lines: [Vec<usize>; 2],
    /// What hands over the points if they are too many to keep.
    pub(crate) streamed: Option<Streamed<'j, 'g>>,
    pub(crate) effort: GridReport,
    /// Where it meets the surfaces that trim it, in their order.
    pub(crate) trims: Vec<Line<'j, 'g>>,
    /// Which positions of its tool its points were held against.
    pub(crate) positions: Positions,
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

impl<'g> Solved<'_, 'g> {
    /// Rows and columns of its points.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [0, 1].map(|k| self.lines[k].len())
    }

    /// Where one of its points stands in the sample: row and column.
    pub(crate) fn place(&self, at: usize) -> [usize; 2] {
        let columns = self.lines[1].len();
        [self.lines[0][at / columns], self.lines[1][at % columns]]
    }

    /// Its points, counted.
    pub(crate) fn told(&self) -> PointSummary {
        summary(&self.surface.name, self.surface, &self.summary)
    }

    /// What is told of it, without its points.
    pub(crate) fn result(&self) -> SurfaceResult {
        SurfaceResult {
            summary: self.told(),
            evaluations: self.effort.evaluations,
            fields: fields::extents(self),
            cut: self.cut.as_ref().map(Cut::heights),
            sensitivity: self.sensitivity.as_ref().map(Sensitivity::table),
            branches: branches::search(self),
            tool_positions: self.positions.told(),
            not_as_required: required::told(self),
            certified: certify::proven(self),
            points: PointArrays::default(),
        }
    }

    /// The same with all points, unless there are too many to keep.
    pub(crate) fn result_with_points(&self) -> SurfaceResult {
        let points = match &self.streamed {
            Some(_) => PointArrays::default(),
            None => PointArrays::new(self.counts(), self.surface.unknowns.len(), &self.points),
        };
        SurfaceResult { points, ..self.result() }
    }
}

impl Line<'_, '_> {
    /// Its points, counted.
    pub(crate) fn told(&self) -> PointSummary {
        summary(&self.name, self.surface, &self.summary)
    }
}

/// Radius and z in the work's frame, then the unknowns.
fn summary(name: &str, surface: &GeneratedSurface<'_>, of: &Summary) -> PointSummary {
    let length = |name: &str, ends: Ends| Extent::new(name, Dimension::LENGTH, ends.0);
    let unknowns = surface.unknowns.iter().zip(&of.unknowns);
    let unknowns = unknowns.map(|(unknown, ends)| Extent::new(&unknown.name, unknown.dimension, ends.0));
    PointSummary {
        name: name.to_string(),
        frame: surface.frame.clone(),
        asked: of.asked,
        solved: of.solved(),
        outcomes: of.outcomes.clone(),
        worst_residual: of.worst_residual,
        ranges_reached: [length("rho", of.rho), length("z", of.z)].into_iter().chain(unknowns).collect(),
        outside: reasons::outside(surface, of),
    }
}

/// What was not done of points: branches that nothing chooses between, requirements that do not hold, points that are not solved.
pub(crate) fn failures(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let unsolved = solved.iter().filter_map(|solved| unsolved(job, solved));
    branches::ambiguous(solved).into_iter().chain(required::missed(solved)).chain(unsolved).collect()
}

/// How many points of a surface were asked for and not solved, and why.
fn unsolved(job: &Job<'_>, solved: &Solved<'_, '_>) -> Option<NotDone> {
    let (asked, name) = (solved.summary.asked, &solved.surface.name);
    let missing = asked - solved.summary.solved();
    (missing > 0).then(|| {
        let message = format!("not solved: {missing} of {asked} points of {name}");
        NotDone::new(NotDoneKind::NotSolved, name, message).with(reasons::counted(job, solved))
    })
}

/// Rows with their cells below each other, all to the left but those whose place in `sides` holds a `>`.
pub(crate) fn aligned<const N: usize>(rows: &[[String; N]], sides: &str) -> String {
    let widths: [usize; N] = std::array::from_fn(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0));
    let cell = |k: usize, text: &str| match sides.as_bytes().get(k) {
        Some(b'>') => format!("  {text:>0$}", widths[k]),
        _ => format!("  {text:<0$}", widths[k]),
    };
    let line = |row: &[String; N]| (0..N).map(|k| cell(k, &row[k])).collect::<String>();
    rows.iter().map(|row| line(row).trim_end().to_string() + "\n").collect()
}
