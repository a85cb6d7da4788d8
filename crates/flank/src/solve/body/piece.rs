//! A surface of a tooth space, and the lines on which it ends.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_expr::Expr;
use flank_solver::{Blank, BoundSurface, Outcome, SurfacePoint, SurfacePoints};

use crate::project::failure::Failure;
use crate::project::requests::Session;
use crate::solve::surface::{bound, problem};

/// Rows and columns of a sample that are enough to know where a surface lies.
const MOST_LINES: usize = 9;
/// Boxes that a search for a point of a line looks at: where Newton's method does not reach it there is mostly none.
const BOXES: u64 = 200;

/// A surface of a tooth space with some of its points.
pub(crate) struct Piece<'j, 'g> {
    job: &'j Job<'g>,
    pub(crate) surface: &'j GeneratedSurface<'g>,
    session: Session<'j>,
    pub(crate) known: Vec<SurfacePoint>,
}

/// A line of a surface on which one of its unknowns is at an end of its range.
#[derive(Clone, Debug)]
pub(crate) struct EndLine {
    /// The unknown, by its place.
    pub(crate) unknown: usize,
    pub(crate) value: f64,
    /// Points at the shares along that were asked for.
    pub(crate) points: Vec<[f64; 3]>,
}

impl<'j, 'g> Piece<'j, 'g> {
    /// # Errors
    /// If the surface is not sampled, or no point of its sample is solved.
    pub(crate) fn new(
        job: &'j Job<'g>,
        surface: &'j GeneratedSurface<'g>,
        session: Session<'j>,
    ) -> Result<Piece<'j, 'g>, Failure> {
        let name = &surface.name;
        let sample = surface.sample.as_ref().ok_or(format!(
            "`{name}` bounds the spaces of a solid and is not sampled: its sample says which branch is meant; add `sample {name} {{ … }}`"
        ))?;
        let sample = thinned(sample);
        let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
        let (points, _) = problem(job, surface, coordinates, session).solve(&sample.targets(), sample.counts);
        let known: Vec<SurfacePoint> = points.into_iter().filter(|point| point.outcome == Outcome::Solved).collect();
        if known.is_empty() {
            return Err(format!("`{name}` bounds the spaces of a solid, and no point of its sample is solved").into());
        }
        Ok(Piece { job, surface, session, known })
    }

    /// The two coordinates of the axial section.
    pub(crate) fn section(&self) -> [Expr<'g>; 2] {
        let [x, y, z] = self.surface.surface.position.0;
        [z, (x * x + y * y).sqrt()]
    }

    /// The surface with the values of the job's parameters.
    pub(crate) fn bound(&self) -> BoundSurface<'g> {
        bound(self.job, self.surface)
    }

    /// The unknown that the tool's profile runs over.
    pub(crate) fn across_tool(&self) -> Option<usize> {
        let made = self.surface;
        let of_profile = made.unknowns.iter().position(|unknown| unknown.piece.is_some());
        of_profile.or_else(|| self.of_tool().next())
    }

    /// Its unknowns that are no motions.
    fn of_tool(&self) -> impl Iterator<Item = usize> + use<'j, 'g> {
        let made = self.surface;
        (0..made.unknowns.len()).filter(|k| !made.generation.motions.contains(&made.unknowns[*k].variable))
    }

    /// An unknown, and how far along the space a point lies.
    pub(crate) fn across(&self, unknown: usize, blank: &Blank) -> [Expr<'g>; 2] {
        [self.surface.surface.unknowns[unknown], blank.share_of(self.section())]
    }

    /// Points at values of two coordinates; the branch is that of the known point for which `far` is least.
    pub(crate) fn solved(
        &self,
        coordinates: [Expr<'g>; 2],
        (targets, counts): (&[[f64; 2]], [usize; 2]),
        far: impl Fn(&SurfacePoint) -> f64,
    ) -> SurfacePoints {
        let near = self.known.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        let problem = problem(self.job, self.surface, coordinates, self.session).boxes(BOXES);
        problem.solve_points(targets, counts, near.map(|point| &point.unknowns[..]), None).0
    }

    /// The lines on which an unknown of the tool is at an end of its range, as far as they run along the space.
    pub(crate) fn end_lines(&self, blank: &Blank, along: &[f64]) -> Vec<EndLine> {
        let made = self.surface;
        let ends = self.of_tool().flat_map(|k| [(k, made.unknowns[k].low), (k, made.unknowns[k].high)]);
        ends.filter(|(_, value)| value.is_finite())
            .filter_map(|(unknown, value)| {
                let targets: Vec<[f64; 2]> = along.iter().map(|share| [value, *share]).collect();
                let width = made.unknowns[unknown].high - made.unknowns[unknown].low;
                let far = |point: &SurfacePoint| {
                    ((point.unknowns[unknown] - value) / width).abs() + (along_of(blank, point) - 0.5).abs()
                };
                let points = self.solved(self.across(unknown, blank), (&targets, [1, along.len()]), far);
                let is_whole = points.solved() == along.len();
                is_whole.then(|| EndLine { unknown, value, points: positions(&points) })
            })
            .collect()
    }
}

/// How far along a space a point lies.
pub(crate) fn along_of(blank: &Blank, point: &SurfacePoint) -> f64 {
    let [x, y, z] = point.position;
    Blank::share(blank.bounds(), [z, x.hypot(y)])
}

pub(crate) fn positions(points: &SurfacePoints) -> Vec<[f64; 3]> {
    (0..points.len()).map(|k| points.position_and_normal(k)).map(|[x, y, z, ..]| [x, y, z]).collect()
}

/// A few rows and columns of a sample, the outermost among them.
fn thinned<'g>(sample: &Sample<'g>) -> Sample<'g> {
    let lines = sample.counts.map(|count| {
        let parts = MOST_LINES.min(count) - 1;
        (0..=parts).map(|part| part * (count - 1) / parts.max(1)).collect::<Vec<usize>>()
    });
    let counts = lines.each_ref().map(Vec::len);
    Sample { counts, grid: sample.grid.picked(&lines), ..sample.clone() }
}
