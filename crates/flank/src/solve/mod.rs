//! `flank solve`

pub(crate) mod branches;
pub(crate) mod certify;
pub(crate) mod cut;
pub(crate) mod fields;
pub(crate) mod geometry;
pub(crate) mod keep;
pub(crate) mod limits;
pub(crate) mod reach;
pub(crate) mod reasons;
pub(crate) mod required;
pub(crate) mod result;
pub(crate) mod secondary;
pub(crate) mod sensitivity;
pub(crate) mod starts;
pub(crate) mod step;
pub(crate) mod stream;
pub(crate) mod summary;
pub(crate) mod table;
pub(crate) mod travel;
pub(crate) mod trims;

use std::time::Instant;

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Sample};
use flank_draw::{PictureOptions, picture};
use flank_export::{Axis, Banded, Dataset, Face, Header, Outcome, Patch, Point, Surfaces, Unit, Unknown};
use flank_expr::{Expr, Graph};
use flank_solver::{BoundSurface, CutBy, GridReport, Range, Solution, SurfacePoint, SurfaceProblem};

use self::cut::Cut;
use self::limits::Line;
use self::result::{LineResult, SolveResult};
use self::secondary::Positions;
use self::sensitivity::Sensitivity;
use self::step::Smooth;
use self::stream::{Kept, Streamed};
use self::summary::Summary;
use self::table::Solved;
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, Remark, RemarkKind};
use crate::project::requests::{JobSelection, Session, SolveRequest};
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;

/// Solves the surfaces of jobs, and writes their points and a picture. `each` is given what is to be said of each job.
///
/// # Errors
/// What is wrong with the spec, that no job asks for points, that there are too many to keep, or that a file cannot be written.
pub fn solve(request: &SolveRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(SolveResult)) -> Result<(), Failure> {
    let start = Instant::now();
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of(&compilation);
    let wanted = SolveOptions {
        geometry: request.geometry,
        sensitivity: request.sensitivity,
        certificates: request.certify,
        together: None,
        of_shown: false,
        session: Session::new(request.evaluator, monitor),
    };
    for job in asked(&jobs, monitor)? {
        each(solved_job(job, (request, &origin), wanted, start)?);
    }
    Ok(())
}

fn solved_job(
    job: &Job<'_>,
    (request, origin): (&SolveRequest, &Origin),
    wanted: SolveOptions<'_>,
    start: Instant,
) -> Result<SolveResult, Failure> {
    stream::check_kept(job, &job.surfaces, wanted)?;
    let solved = job.surfaces.iter().filter_map(|surface| solve_surface(job, surface, wanted));
    let solved: Vec<Solved<'_, '_>> = solved.collect::<Result<_, _>>()?;
    let limited = job.surfaces.iter().filter(|_| request.limits);
    let limits = limits::lines(job, limited, wanted.session)?;
    // a trim that takes nothing has no line
    let trims = solved.iter().flat_map(|solved| &solved.trims).filter(|line| !line.points.is_empty());
    let lines: Vec<&Line<'_, '_>> = limits.iter().chain(trims).collect();
    let dataset = dataset(job, &solved, &lines, header(&[job], &request.jobs, origin));
    let tolerance = request.step.iter();
    let faces: Vec<Smooth> = tolerance
        .flat_map(|tolerance| solved.iter().map(|solved| step::smooth(job, solved, *tolerance, wanted)))
        .collect::<Result<_, Failure>>()?;
    // pictures have nothing to show of these
    let outside = lines.iter().filter(|line| line.summary.solved() == 0);
    let outside: Vec<Patch> = outside.filter_map(|line| line.patch(job)).collect();
    let files = write_files((&dataset, &outside), &solved, &faces, (&job.name, wanted.session), (request, origin))?;
    drop(outside);
    drop(dataset);
    let mut not_done = table::failures(job, &solved);
    not_done.extend(cut::unknown(&solved));
    not_done.extend(certify::failed(&solved));
    not_done.extend(travel::beyond(job, &solved));
    not_done.extend(step::missed(&faces, request.step.unwrap_or_default()));
    let points: usize = solved.iter().map(|solved| solved.summary.asked).sum();
    let remarks = [
        branches::begun(&solved),
        branches::undecided(&solved),
        branches::elsewhere(&solved),
        limits::untold(&lines),
        step::told(&faces),
        secondary::given_up(&solved),
    ];
    Ok(SolveResult {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        surfaces: solved.iter().map(Solved::result_with_points).collect(),
        lines: lines.iter().map(|line| LineResult::new(line)).collect(),
        faces: step::results(&faces),
        files,
        remarks: origin.located(&[job], remarks.concat()),
        not_done: origin.located(&[job], not_done),
        timing: Timing { points, elapsed: start.elapsed() },
    })
}

/// The jobs that ask for points; of the others it is told that they do not.
///
/// # Errors
/// If none does.
pub(crate) fn asked<'j, 'g>(jobs: &'j [Job<'g>], monitor: &dyn Monitor) -> Result<Vec<&'j Job<'g>>, Failure> {
    let (asked, idle): (Vec<&Job<'g>>, Vec<&Job<'g>>) =
        jobs.iter().partition(|job| job.surfaces.iter().any(|surface| surface.sample.is_some()));
    let told = |job: &Job<'_>| format!("job `{}` asks for no points: add a `sample` for one of its surfaces", job.name);
    if asked.is_empty() {
        return Err(idle.iter().map(|job| told(job)).collect::<Vec<String>>().join("\n").into());
    }
    idle.iter().for_each(|job| monitor.remark(&Remark::new(RemarkKind::NoSample, &job.name, told(job))));
    Ok(asked)
}

/// What is wanted of a surface beside its points.
#[derive(Clone, Copy)]
pub(crate) struct SolveOptions<'m> {
    pub(crate) geometry: bool,
    pub(crate) sensitivity: bool,
    pub(crate) certificates: bool,
    /// What else needs all points together, if something does.
    pub(crate) together: Option<&'static str>,
    /// Whether geometry and sensitivity are wanted of the points that are shown alone, where a surface has too many to keep.
    pub(crate) of_shown: bool,
    pub(crate) session: Session<'m>,
}

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
    let cut = cut::of(job, surface, &points, wanted.session);
    fields.extend(cut.iter().flat_map(Cut::fields));
    let sensitivity = wanted.sensitivity.then(|| sensitivity::of(job, surface, &points));
    let summary = Summary::of(surface.unknowns.len(), sample.counts, &points);
    let kept_out = kept_out(job, surface, (&effort, &summary), wanted.session);
    Some(Ok(Solved {
        surface,
        sample,
        bindings: job.bindings(),
        summary,
        points,
        lines: sample.counts.map(|count| (0..count).collect()),
        streamed: None,
        needed,
        effort,
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
    let Kept { summary, effort, drawn } = streamed.look(wanted.geometry && !wanted.of_shown)?;
    let is_of_drawn = wanted.geometry && wanted.of_shown;
    Ok(Solved {
        surface,
        sample,
        bindings: job.bindings(),
        needed: Vec::new(),
        lines: streamed.drawn(),
        branches: streamed.problem().points(&effort.branches),
        elsewhere: elsewhere(streamed.problem(), &effort),
        kept_out: kept_out(job, surface, (&effort, &summary), wanted.session),
        summary,
        streamed: Some(streamed),
        effort,
        radii: None,
        fields: if is_of_drawn { geometry::fields(job, surface, sample, &drawn) } else { Vec::new() },
        sensitivity: wanted.sensitivity.then(|| sensitivity::of(job, surface, &drawn)),
        points: drawn,
        trims: Vec::new(),
        positions: secondary::STREAMED,
        cut: None,
    })
}

/// The points of a sample, with what it took to find them.
pub(crate) struct Found<'j, 'g> {
    problem: SurfaceProblem,
    pub(crate) points: Vec<SurfacePoint>,
    effort: GridReport,
    trims: Vec<Line<'j, 'g>>,
    positions: Positions,
}

impl<'g> Found<'_, 'g> {
    /// The branches that qualify where nothing chooses between several, with what would select each.
    pub(crate) fn ambiguous(&self, surface: &GeneratedSurface<'g>, sample: &Sample<'g>) -> Option<NotDone> {
        let is_ambiguous = self.points.iter().any(|point| point.outcome == flank_solver::Outcome::Ambiguous);
        is_ambiguous.then(|| {
            let at = branches::place(&sample.coordinates, self.effort.anchor);
            branches::listed(surface, &self.problem.points(&self.effort.branches), &at)
        })
    }
}

/// Solves a surface at the points of a sample, and marks those that the surfaces which trim it cut away, or its own tool in another
/// position.
pub(crate) fn points<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &Sample<'g>,
    wanted: SolveOptions,
) -> Found<'j, 'g> {
    let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
    let problem = problem(job, surface, coordinates, wanted.session);
    let (mut points, effort) = problem.solve(&sample.targets(), sample.counts);
    let trims = surface.trimmed_by.iter().enumerate();
    let trims = trims.map(|(number, &by)| {
        trims::cut(job, [surface, &job.surfaces[by]], sample, &mut points, (number, wanted.session))
    });
    let trims = trims.collect();
    secondary::judge_trims(job, surface, &mut points, sample.counts);
    let positions = secondary::judge(job, surface, &mut points, sample.counts);
    Found { problem, points, effort, trims, positions }
}

/// Points of a surface at values of two coordinates, on the branch that its sample keeps.
pub(crate) fn problem<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    coordinates: [Expr<'g>; 2],
    session: Session,
) -> SurfaceProblem {
    let kept = surface.sample.iter().flat_map(|sample| &sample.keep);
    let keep: Vec<_> = kept.map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
    on_any_branch(job, surface, coordinates, session)
        .keeping(&bound(job, surface), &keep)
        .expect("a job without errors leaves nothing unbound")
}

/// The same, whatever its sample keeps.
fn on_any_branch<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    coordinates: [Expr<'g>; 2],
    session: Session,
) -> SurfaceProblem {
    SurfaceProblem::new(&bound(job, surface), coordinates)
        .expect("a job without errors leaves nothing unbound")
        .following_beyond(reach::followed(surface))
        .with_instruction_set(session.instructions())
        .boxes(session.boxes())
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
    let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
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

/// A surface with the values of the job's parameters.
pub(crate) fn bound<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>) -> BoundSurface<'g> {
    BoundSurface::new(&surface.surface, ranges(surface), &job.bindings())
}

/// Where the unknowns of a surface are looked for.
pub(crate) fn ranges(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    surface.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect()
}

/// The points of all surfaces, with all that is known of them, and lines on them.
pub(crate) fn dataset(job: &Job<'_>, solved: &[Solved<'_, '_>], lines: &[&Line<'_, '_>], header: Header) -> Dataset {
    let surfaces = solved.iter().map(|solved| {
        let axis = |k: usize| Axis { label: solved.sample.labels[k].clone(), count: solved.counts()[k] };
        let asked = solved.summary.asked;
        let name = match solved.streamed {
            Some(_) => format!("{} ({} of {asked} points drawn)", solved.surface.name, solved.points.len()),
            None => solved.surface.name.clone(),
        };
        let patch = patch(job, &name, solved.surface, [axis(0), axis(1)], &solved.points);
        let moved = solved.sensitivity.iter().flat_map(Sensitivity::fields);
        Patch { fields: solved.fields.iter().cloned().chain(moved).collect(), ..patch }
    });
    let lines = lines.iter().filter(|line| line.summary.solved() > 0).filter_map(|line| line.patch(job));
    Dataset { header, patches: surfaces.chain(lines).collect() }
}

/// Where the data of a job comes from; of further jobs it is said what was set by hand.
pub(crate) fn header(jobs: &[&Job<'_>], which: &JobSelection, origin: &Origin) -> Header {
    let settings = which.set_in(jobs).into_iter().map(|(name, value)| format!("set by hand: {name} = {value}"));
    Header {
        program: concat!("flank ", env!("CARGO_PKG_VERSION")).to_string(),
        spec: shown_path(which.file()),
        spec_hash: format!("sha256:{}", origin.hash),
        job: jobs.first().map_or(String::new(), |job| job.name.clone()),
        conventions: settings.collect(),
    }
}

/// A grid of points of a surface, without further fields.
pub(crate) fn patch(
    job: &Job<'_>,
    name: &str,
    surface: &GeneratedSurface<'_>,
    [rows, columns]: [Axis; 2],
    points: &[SurfacePoint],
) -> Patch {
    let unknowns = surface.unknowns.iter();
    Patch {
        name: name.to_string(),
        frame: surface.frame.clone(),
        rows,
        columns,
        unknowns: unknowns.map(|u| Unknown { name: u.name.clone(), unit: unit(u.dimension) }).collect(),
        points: points.iter().map(|solved| point(job, surface, solved)).collect(),
        fields: Vec::new(),
    }
}

pub(crate) fn unit(dimension: Dimension) -> Unit {
    match dimension {
        Dimension::LENGTH => Unit::Millimetre,
        Dimension::ANGLE => Unit::Degree,
        _ => Unit::One,
    }
}

pub(crate) fn point(job: &Job<'_>, surface: &GeneratedSurface<'_>, solved: &SurfacePoint) -> Point {
    let reason = reasons::of_point(job, surface, solved.outcome);
    // a point that is cut away may be one where the surface has no normal
    let has_numbers = || solved.position.iter().chain(&solved.normal).all(|number| number.is_finite());
    let outcome = match solved.outcome {
        flank_solver::Outcome::Solved => Outcome::Solved,
        flank_solver::Outcome::CutAway(CutBy::Other(_)) if has_numbers() => Outcome::Trimmed,
        flank_solver::Outcome::CutAway(_) if has_numbers() => Outcome::Undercut,
        flank_solver::Outcome::Undecided if has_numbers() => Outcome::Undecided,
        other => return Point::unsolved(other.word(), solved.residual, reason),
    };
    let SurfacePoint { position, normal, unknowns, residual, .. } = solved;
    Point { outcome, position: *position, normal: *normal, unknowns: unknowns.clone(), residual: *residual, reason }
}

/// Writes the files that are asked for and names them: lines outside their ranges stand in tables and meshes only.
fn write_files(
    (dataset, outside): (&Dataset, &[Patch]),
    solved: &[Solved<'_, '_>],
    faces: &[Smooth],
    (name, session): (&str, Session<'_>),
    (request, origin): (&SolveRequest, &Origin),
) -> Result<Vec<String>, Failure> {
    let mut folder = Folder::at(&request.out, origin, session.monitor())?;
    // the surfaces come first among the patches; of those with too many points a patch holds some
    let streamed = solved.iter().map(|solved| solved.streamed.as_ref().map(|streamed| streamed as &dyn Banded));
    let patches = dataset.patches.iter().chain(outside).zip(streamed.chain(std::iter::repeat(None)));
    let list = patches.map(|(patch, streamed)| streamed.unwrap_or(patch)).collect();
    let surfaces = Surfaces { header: &dataset.header, list };
    let faces: Vec<&Face> = faces.iter().filter_map(|smooth| smooth.face.as_ref()).collect();
    let drawn = (!request.no_picture).then(|| picture(dataset, &PictureOptions::default()));
    folder.picture_after(name, drawn.as_ref(), |folder| {
        folder.data(name, &surfaces, &request.format)?;
        if faces.is_empty() { Ok(()) } else { folder.step(name, &dataset.header, &faces) }
    })?;
    if !request.no_picture {
        for (surface, drawn) in sensitivity::pictures(solved, dataset) {
            folder.picture(&format!("{name}.{surface}.sensitivity"), &drawn)?;
        }
        for (surface, drawn) in cut::pictures(solved, dataset) {
            folder.picture(&format!("{name}.{surface}.left"), &drawn)?;
        }
    }
    folder.finish()
}
