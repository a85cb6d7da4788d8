//! `flank solve --limits`: the lines at which a surface, or the tool's contact with it, ends.

use flank_chain_dsl::{GeneratedSurface, Job, Sample, spaced};
use flank_export::{Axis, Patch};
use flank_expr::Expr;
use flank_solver::{GridReport, Outcome, SurfacePoint, SurfaceProblem};
use rayon::prelude::*;

use crate::project::failure::Failure;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::session::Session;
use crate::solve::points::patch;
use crate::solve::reasons;
use crate::solve::summary::Summary;
use crate::solve::surface::{bound, followed, kept};

/// A line on a surface.
pub(crate) struct Line<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    /// `flank.singular_line`, `flank.contact_limit`, `flank.trimmed_by_fillet`.
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    /// The surface that it is shared with, if the line is where that trims.
    pub(crate) trimmed_by: Option<String>,
    /// What changes along it.
    pub(crate) along: String,
    pub(crate) summary: Summary,
    pub(crate) points: Vec<SurfacePoint>,
    /// Lines of this kind that cross the place at which they were looked for; `points` are those of the longest.
    pub(crate) several: usize,
    /// No point of it was found within the ranges, but it is not excluded there either: the search was given up, or left a part of
    /// them undecided.
    pub(crate) is_open: bool,
}

/// What the lines do not show.
pub(crate) fn untold(lines: &[&Line<'_, '_>]) -> Vec<Remark> {
    let remark =
        |kind: RemarkKind, line: &Line<'_, '_>, message: String| Remark::new(kind, &line.surface.name, message);
    let several = lines.iter().filter(|line| line.several > 1).map(|line| {
        let message = format!(
            "{} has {} of its kind beside each other within the ranges; the longest is shown, narrower ranges show the others",
            line.name, line.several
        );
        remark(RemarkKind::SeveralLines, line, message)
    });
    // of a line without any point within the ranges the table says as much
    let partly = lines.iter().filter(|line| line.summary.solved() > 0).filter_map(|line| {
        let [_, outside] = line.found();
        let by = reasons::outside(line.surface, &line.summary)?;
        let message = format!("{} of {} points of {} are outside, {by}", outside, line.summary.asked, line.name);
        Some(remark(RemarkKind::LineOutside, line, message))
    });
    let open = lines.iter().filter(|line| line.is_open).map(|line| {
        let message = format!(
            "{} is not found within the ranges, and not excluded: not all of them could be looked at; narrower ranges show more",
            line.name
        );
        remark(RemarkKind::LineNotExcluded, line, message)
    });
    several.chain(partly).chain(open).collect()
}

/// Both lines of each surface that points are asked of; none of a surface without an equation of meshing. All threads look for them,
/// each for one line.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn lines<'j, 'g: 'j>(
    job: &Job<'g>,
    surfaces: impl IntoIterator<Item = &'j GeneratedSurface<'g>>,
    session: Session,
) -> Result<Vec<Line<'j, 'g>>, Failure> {
    let sought: Vec<Sought<'j, 'g>> = surfaces.into_iter().flat_map(sought).collect();
    let Some(one) = sought.first() else { return Ok(Vec::new()) };
    let others = sought.iter().any(|other| other.surface.name != one.surface.name);
    let _working =
        session.begin(format!("looking for the limits of {}{}", one.surface.name, if others { ", …" } else { "" }))?;
    // along the coordinate that follows the line farther: it may run across the other one
    let mut lines = look(job, &sought, 0, session);
    let is_open = |line: &Line<'_, '_>| line.summary.solved() < line.points.len();
    session.check()?;
    let open: Vec<usize> = (0..lines.len()).filter(|at| is_open(&lines[*at])).collect();
    let again: Vec<Sought<'j, 'g>> = open.iter().map(|at| sought[*at]).collect();
    for (at, second) in open.into_iter().zip(look(job, &again, 1, session)) {
        if second.found() > lines[at].found() {
            lines[at] = second;
        }
    }
    Ok(lines)
}

/// A line that is looked for: where a quantity is zero.
#[derive(Clone, Copy)]
pub(crate) struct Sought<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    pub(crate) sample: &'j Sample<'g>,
    pub(crate) kind: &'static str,
    pub(crate) quantity: Expr<'g>,
}

/// The lines of a surface: that at which it turns back, and that at which the tool's contact ends.
pub(crate) fn sought<'j, 'g>(surface: &'j GeneratedSurface<'g>) -> Vec<Sought<'j, 'g>> {
    let Some(sample) = &surface.sample else { return Vec::new() };
    let singular = surface.surface.clearance_minors().pop();
    let kinds = [("singular line", singular), ("contact limit", surface.surface.contact_limit())];
    let of = |(kind, quantity): (&'static str, Option<Expr<'g>>)| {
        Some(Sought { surface, sample, kind, quantity: quantity? })
    };
    kinds.into_iter().filter_map(of).collect()
}

/// How many points of a line there are, and how many outside the ranges.
pub(crate) fn reach(points: &[SurfacePoint]) -> [usize; 2] {
    let count = |is: fn(Outcome) -> bool| points.iter().filter(|point| is(point.outcome)).count();
    [count(|outcome| outcome == Outcome::Solved), count(|outcome| matches!(outcome, Outcome::Outside { .. }))]
}

/// Lines at values of one of the coordinates of their surfaces' samples, in the order in which they are sought.
fn look<'j, 'g>(job: &Job<'g>, sought: &[Sought<'j, 'g>], k: usize, session: Session) -> Vec<Line<'j, 'g>> {
    let problems: Vec<(SurfaceProblem, Vec<[f64; 2]>)> =
        sought.iter().map(|sought| (sought.problem(job, k, session), sought.targets(k))).collect();
    let found: Vec<(Vec<SurfacePoint>, GridReport)> =
        problems.par_iter().map(|(problem, targets)| problem.solve(targets, [1, targets.len()])).collect();
    sought.iter().zip(found).map(|(sought, found)| sought.line(k, found)).collect()
}

impl<'j, 'g> Sought<'j, 'g> {
    /// Values of one of the sample's coordinates at which points of the line are looked for.
    pub(crate) fn targets(&self, k: usize) -> Vec<[f64; 2]> {
        let ends = self.sample.each_target().map(|target| target[k]);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let count = self.sample.counts.into_iter().max().unwrap_or(1).max(2);
        spaced((low, high), count).into_iter().map(|value| [0.0, value]).collect()
    }

    fn problem(&self, job: &Job<'g>, k: usize, session: Session) -> SurfaceProblem {
        let (surface, along) = (self.surface, &self.sample.coordinates[k]);
        let bound = bound(job, surface);
        let line = SurfaceProblem::line(&bound, self.quantity, along.value)
            .map(|problem| problem.following_beyond(followed(surface)).with_instruction_set(session.instructions()));
        // the line of the branch that is sampled
        let kept = line.and_then(|problem| problem.keeping(&bound, &kept(surface)));
        kept.expect("a job without errors leaves nothing unbound")
    }

    fn line(&self, k: usize, (points, effort): (Vec<SurfacePoint>, GridReport)) -> Line<'j, 'g> {
        let surface = self.surface;
        let name = format!("{}.{}", surface.name, self.kind.replace(' ', "_"));
        let summary = Summary::of_points(surface.unknowns.len(), [1, points.len()], &points);
        let is_open = summary.solved() == 0 && (effort.is_given_up || !effort.undecided.is_empty());
        let along = self.sample.coordinates[k].name.clone();
        Line {
            surface,
            name,
            kind: self.kind,
            trimmed_by: None,
            along,
            summary,
            points,
            several: effort.branches.len(),
            is_open,
        }
    }
}

impl Line<'_, '_> {
    /// How many points there are, and how many outside the ranges.
    fn found(&self) -> [usize; 2] {
        reach(&self.points)
    }

    /// The line as a grid of one row, for files and pictures; `None` if no point of it was found, be it outside the ranges.
    pub(crate) fn patch(&self, job: &Job<'_>) -> Option<Patch> {
        let rows = Axis { label: self.kind.to_string(), count: 1 };
        let columns = Axis { label: self.along.clone(), count: self.points.len() };
        (self.found() != [0; 2]).then(|| patch(job, &self.name, self.surface, [rows, columns], &self.points))
    }
}
