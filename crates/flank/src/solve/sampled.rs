//! The points that the samples of surfaces ask for, with all that is wanted of them.

use std::sync::Arc;

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_expr::Expr;
use flank_solver::{GridReport, Outcome, Solution, SurfacePoint, SurfaceProblem};
use rayon::prelude::*;

use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::session::Session;
use crate::solve::blank;
use crate::solve::branches;
use crate::solve::certify;
use crate::solve::cut::{self, Cut};
use crate::solve::geometry;
use crate::solve::limits::Line;
use crate::solve::options::SolveOptions;
use crate::solve::reach;
use crate::solve::secondary::{self, Positions};
use crate::solve::sensitivity;
use crate::solve::solved::Solved;
use crate::solve::stream::{self, Kept, Streamed};
use crate::solve::summary::Summary;
use crate::solve::surface::{on_any_branch, problem};
use crate::solve::trims;

/// The points of one surface, if any are asked for.
pub(crate) fn solve_surface<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    wanted: SolveOptions<'j>,
) -> Option<Result<Solved<'j, 'g>, Failure>> {
    let sample = surface.sample.as_ref()?;
    match stream::is_streamed(job, surface, sample, wanted) {
        Ok(true) => return Some(in_bands(job, surface, sample, wanted)),
        Ok(false) => {}
        Err(reason) => return Some(Err(reason.into())),
    }
    let _working = match wanted.session.begin(format!("solving {}", surface.name)) {
        Ok(working) => working,
        Err(cancelled) => return Some(Err(cancelled)),
    };
    let Found { problem, points, effort, trims, positions } = points(job, surface, sample, wanted);
    let branches = problem.points(&effort.branches);
    let elsewhere = elsewhere(&problem, &effort);
    let needed = reach::needed(surface, &points);
    let radii = wanted.certificates.then(|| certify::radii(&problem, &sample.targets(), &points));
    let mut fields = Vec::new();
    if wanted.geometry {
        fields.extend(geometry::fields(job, surface, sample, &points));
    }
    fields.extend(radii.as_deref().map(certify::field));
    let cut = cut::left_by_edges(job, surface, &points, wanted.session);
    fields.extend(cut.iter().flat_map(Cut::fields));
    let sensitivity = wanted.sensitivity.then(|| sensitivity::over_points(job, surface, &points));
    let summary = Summary::of_points(surface.unknowns.len(), sample.counts, &points);
    let kept_out = kept_out(job, surface, (&effort, &summary), wanted.session);
    Some(Ok(Solved {
        surface,
        sample,
        bindings: job.bindings(),
        summary,
        points,
        lines: sample.counts.map(|count| (0..count).collect()),
        streamed: None,
        arrays: None,
        needed,
        effort,
        periodic: problem.periodic().to_vec(),
        branches,
        elsewhere,
        kept_out,
        radii,
        fields,
        sensitivity,
        trims,
        positions,
        cut,
    }))
}

/// What is kept of the points of a surface that has too many of them.
fn in_bands<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &'j Sample<'g>,
    wanted: SolveOptions<'j>,
) -> Result<Solved<'j, 'g>, Failure> {
    let mut streamed = Streamed::new(job, surface, sample, wanted);
    let Kept { summary, effort, drawn, arrays } = streamed.look(wanted.geometry && !wanted.of_shown, wanted.arrays)?;
    let is_of_drawn = wanted.geometry && wanted.of_shown;
    Ok(Solved {
        surface,
        sample,
        bindings: job.bindings(),
        needed: Vec::new(),
        lines: streamed.drawn(),
        periodic: streamed.problem().periodic().to_vec(),
        branches: streamed.problem().points(&effort.branches),
        elsewhere: elsewhere(streamed.problem(), &effort),
        kept_out: kept_out(job, surface, (&effort, &summary), wanted.session),
        summary,
        arrays,
        streamed: Some(streamed),
        effort,
        radii: None,
        fields: if is_of_drawn { geometry::fields(job, surface, sample, &drawn) } else { Vec::new() },
        sensitivity: wanted.sensitivity.then(|| sensitivity::over_points(job, surface, &drawn)),
        points: drawn,
        trims: Vec::new(),
        positions: secondary::STREAMED,
        cut: None,
    })
}

/// The points of a sample, with what it took to find them.
pub(crate) struct Found<'j, 'g> {
    problem: Arc<SurfaceProblem>,
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) effort: GridReport,
    pub(crate) trims: Vec<Line<'j, 'g>>,
    positions: Positions,
}

/// A branch of a surface, as a sample that lies on it alone shows it.
pub(crate) struct Branch<'g> {
    problem: Arc<SurfaceProblem>,
    coordinates: [Expr<'g>; 2],
    /// Unknowns of the point in the middle of the sample.
    start: Vec<f64>,
}

impl<'g> Found<'_, 'g> {
    /// The branch of a sample, where nothing but that is in question: all its points lie on it, and there is no other one.
    pub(crate) fn branch(&self, sample: &Sample<'g>) -> Option<Branch<'g>> {
        let is_whole = self.points.iter().all(|point| point.outcome == Outcome::Solved);
        let is_alone = self.effort.branches.len() == 1 && self.effort.elsewhere.is_empty();
        let middle = self.points.get(self.points.len() / 2)?;
        (is_whole && is_alone).then(|| Branch {
            problem: Arc::clone(&self.problem),
            coordinates: sample.functions(),
            start: middle.unknowns.clone(),
        })
    }

    /// The branches that qualify where nothing chooses between several, with what would select each.
    pub(crate) fn ambiguous(&self, surface: &GeneratedSurface<'g>, sample: &Sample<'g>) -> Option<NotDone> {
        ambiguous((&self.problem, &self.points, &self.effort), surface, sample)
    }
}

fn ambiguous<'g>(
    (problem, points, effort): (&SurfaceProblem, &[SurfacePoint], &GridReport),
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
) -> Option<NotDone> {
    let is_ambiguous = points.iter().any(|point| point.outcome == Outcome::Ambiguous);
    is_ambiguous.then(|| {
        let at = branches::place(&sample.coordinates, effort.anchor);
        branches::listed(surface, problem.periodic(), (&problem.points(&effort.branches), &effort.courses), &at)
    })
}

/// Solves a surface at the points of a sample, and marks those that the surfaces which trim it cut away, or its own tool in another
/// position, and those beyond the blank of its solid.
pub(crate) fn points<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &Sample<'g>,
    wanted: SolveOptions,
) -> Found<'j, 'g> {
    let (of, session) = ((job, surface), wanted.session);
    let coordinates = sample.functions();
    let solved = || as_solved(problem(job, surface, coordinates, session), sample);
    let mut trims = Vec::new();
    let found = if surface.trimmed_by.is_empty() {
        session.sample(of, sample, JUDGED, || judged(of, sample, session.sample(of, sample, SOLVED, solved)))
    } else {
        let mut found = session.sample(of, sample, SOLVED, solved);
        trims = trims::cut(job, surface, sample, &mut found.points, session);
        judged(of, sample, found)
    };
    let FoundPoints { problem, points, effort, positions } = found;
    let positions = positions.expect("what is judged has them");
    Found { problem, points, effort, trims, positions }
}

/// Solves the samples of some surfaces on all threads, for whoever asks for their points later: with what is known already, that is. Those that
/// others trim are solved, and cut when somebody asks.
pub(crate) fn solve_side_by_side<'g>(job: &Job<'g>, surfaces: &[&GeneratedSurface<'g>], session: Session<'_>) {
    let sampled = || surfaces.iter().filter_map(|surface| Some((*surface, surface.sample.as_ref()?)));
    let judged = sampled().map(|(surface, _)| surface).filter(|surface| surface.trimmed_by.is_empty());
    let mut tools = secondary::tools_of(job, &judged.collect::<Vec<_>>()).into_iter();
    // expressions stay on the thread of their graph
    let asked = sampled().map(|(surface, sample)| {
        let coordinates = sample.functions();
        let tool = if surface.trimmed_by.is_empty() { tools.next() } else { None };
        (problem(job, surface, coordinates, session), tool, (sample.targets(), sample.counts))
    });
    let found = asked.collect::<Vec<_>>().into_par_iter().map(|(problem, tool, (targets, counts))| {
        let solved = FoundPoints::new(problem, &targets, counts);
        let judged = tool.map(|tool| {
            let mut judged = solved.clone();
            judged.positions = Some(secondary::judge_by(tool, &mut judged.points, counts));
            judged
        });
        (solved, judged)
    });
    for ((surface, sample), (solved, judged)) in sampled().zip(found.collect::<Vec<_>>()) {
        session.sample((job, surface), sample, SOLVED, || solved);
        if let Some(mut judged) = judged {
            blank::cut(job, surface, &mut judged.points);
            session.sample((job, surface), sample, JUDGED, || judged);
        }
    }
}

/// The points of a sample as its equations have them alone: what is cut away is there, too.
pub(crate) fn untrimmed<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &Sample<'g>,
    session: Session<'_>,
) -> Found<'j, 'g> {
    let coordinates = sample.functions();
    let solved = || as_solved(problem(job, surface, coordinates, session), sample);
    let FoundPoints { problem, points, effort, .. } = session.sample((job, surface), sample, SOLVED, solved);
    let positions = Positions::Unseen("all other positions");
    Found { problem, points, effort, trims: Vec::new(), positions }
}

/// The points of a part of a sample, with the same middle, whose branch is known: as [`points`] has them, without another search for it. `None`
/// where not all are reached so.
pub(crate) fn points_of_branch<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    (sample, branch): (&Sample<'g>, &Branch<'g>),
    session: Session<'_>,
) -> Option<Vec<SurfacePoint>> {
    let coordinates = sample.functions();
    let problem = match coordinates == branch.coordinates {
        true => Arc::clone(&branch.problem),
        false => Arc::new(problem(job, surface, coordinates, session)),
    };
    let (points, effort) = problem.solve_points(&sample.targets(), sample.counts, Some(&branch.start), None);
    let mut points: Vec<SurfacePoint> = (0..points.len()).map(|k| points.point(k)).collect();
    if points.iter().any(|point| point.outcome != Outcome::Solved) {
        return None;
    }
    trims::cut(job, surface, sample, &mut points, session);
    let found = FoundPoints { problem, points, effort, positions: None };
    Some(judged((job, surface), sample, found).points)
}

/// What is asked of samples: their points as the equations have them, and without those that are cut away.
pub(crate) const SOLVED: &str = "solved";
const JUDGED: &str = "judged";

/// The points of a sample, and what it took to find them.
#[derive(Clone)]
pub(crate) struct FoundPoints {
    problem: Arc<SurfaceProblem>,
    pub(crate) points: Vec<SurfacePoint>,
    effort: GridReport,
    /// Of the tool, that points were checked against; none where they are as they were solved.
    positions: Option<Positions>,
}

/// The points of a sample as its equations have them.
pub(crate) fn as_solved(problem: SurfaceProblem, sample: &Sample<'_>) -> FoundPoints {
    FoundPoints::new(problem, &sample.targets(), sample.counts)
}

impl FoundPoints {
    /// The branches that qualify where nothing chooses between several, with what would select each.
    pub(crate) fn ambiguous<'g>(&self, surface: &GeneratedSurface<'g>, sample: &Sample<'g>) -> Option<NotDone> {
        ambiguous((&self.problem, &self.points, &self.effort), surface, sample)
    }

    fn new(problem: SurfaceProblem, targets: &[[f64; 2]], counts: [usize; 2]) -> FoundPoints {
        let (points, effort) = problem.solve(targets, counts);
        FoundPoints { problem: Arc::new(problem), points, effort, positions: None }
    }
}

/// The same without what tools and the blank cut away.
fn judged<'g>(
    (job, surface): (&Job<'g>, &GeneratedSurface<'g>),
    sample: &Sample<'_>,
    mut found: FoundPoints,
) -> FoundPoints {
    found.positions = Some(secondary::judge(job, surface, &mut found.points, sample.counts));
    blank::cut(job, surface, &mut found.points);
    found
}

/// Where nothing was found, the points of all branches in the ranges at the anchor that `keep` does not take.
fn kept_out<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    (effort, summary): (&GridReport, &Summary),
    session: Session,
) -> Vec<SurfacePoint> {
    let is_kept = |sample: &&Sample<'g>| !sample.keep.is_empty();
    let is_nothing = summary.solved() == 0 && effort.branches.is_empty();
    let Some(sample) = surface.sample.as_ref().filter(is_kept).filter(|_| is_nothing) else { return Vec::new() };
    let coordinates = sample.functions();
    let problem = on_any_branch(job, surface, coordinates, session);
    let found = problem.all_points(effort.anchor);
    let found: Vec<Solution> = found.isolated.into_iter().map(|root| root.solution).chain(found.unproven).collect();
    problem.points(&found)
}

/// Branches at other places, each with the point of the surface's own branch there if it has one.
fn elsewhere(problem: &SurfaceProblem, effort: &GridReport) -> Vec<(SurfacePoint, Option<SurfacePoint>)> {
    let point = |root: &Solution| problem.points(std::slice::from_ref(root)).remove(0);
    effort.elsewhere.iter().map(|other| (point(&other.root), other.beside.as_ref().map(point))).collect()
}
