//! `flank solve`

pub(crate) mod arrays;
pub(crate) mod blank;
pub(crate) mod body;
pub(crate) mod branches;
pub(crate) mod centre;
pub(crate) mod certify;
pub(crate) mod cut;
pub(crate) mod dataset;
pub(crate) mod fields;
pub(crate) mod geometry;
pub(crate) mod keep;
pub(crate) mod limits;
pub(crate) mod options;
pub(crate) mod pictures;
pub(crate) mod points;
pub(crate) mod reach;
pub(crate) mod reasons;
pub(crate) mod required;
pub(crate) mod result;
pub(crate) mod sampled;
pub(crate) mod secondary;
pub(crate) mod sensitivity;
pub(crate) mod solved;
pub(crate) mod starts;
pub(crate) mod status;
pub(crate) mod step;
pub(crate) mod stream;
pub(crate) mod summary;
pub(crate) mod surface;
pub(crate) mod table;
pub(crate) mod touching;
pub(crate) mod travel;
pub(crate) mod trims;
pub(crate) mod unsolved;

use std::time::Instant;

use flank_chain_dsl::Job;
use flank_draw::{PictureOptions, picture};
use flank_export::{Banded, Dataset, Face, Patch, Surfaces};
use flank_expr::Graph;

pub(crate) use self::dataset::{dataset, header};
use self::limits::Line;
pub(crate) use self::options::SolveOptions;
pub(crate) use self::points::{patch, unit};
use self::result::{Instructions, SolveResult};
pub(crate) use self::sampled::{Branch, points, points_of_branch, solve_side_by_side, solve_surface, untrimmed};
use self::solved::Solved;
use self::step::Smooth;
pub(crate) use self::surface::{bound, family, followed, kept, problem, ranges};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::requests::SolveRequest;
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;

/// Solves the surfaces of jobs, and writes their points and a picture. `each` is given the result of each job.
///
/// # Errors
/// What is wrong with the spec, that no job asks for points, that there are too many to keep, or that a file cannot be written.
pub fn solve(request: &SolveRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(SolveResult)) -> Result<(), Failure> {
    let start = Instant::now();
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let wanted = SolveOptions {
        geometry: request.geometry,
        sensitivity: request.sensitivity,
        certificates: request.certify,
        together: None,
        arrays: request.arrays,
        of_shown: false,
        session: Session::new(request.evaluator, monitor),
    };
    for job in asked((&jobs, &origin), monitor)? {
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
    let mut not_done = table::failures((job, Some(origin)), &solved);
    not_done.extend(cut::unknown(solved.iter().map(Solved::left)));
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
        secondary::given_up(solved.iter().map(Solved::positions_tried)),
    ];
    let lines = lines.iter().map(|line| line.result()).collect();
    Ok(SolveResult {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        surfaces: solved.into_iter().map(Solved::into_result).collect(),
        lines,
        faces: step::results(&faces),
        files,
        instructions: Instructions::of(wanted.session.instructions()),
        remarks: origin.located(&[job], remarks.concat()),
        not_done: origin.located(&[job], not_done),
        timing: Timing { points, elapsed: start.elapsed(), ..Timing::default() },
    })
}

/// The jobs that ask for points; a remark names the others.
///
/// # Errors
/// If none does.
pub(crate) fn asked<'j, 'g>(
    (jobs, origin): (&'j [Job<'g>], &Origin),
    monitor: &dyn Monitor,
) -> Result<Vec<&'j Job<'g>>, Failure> {
    let (asked, idle): (Vec<&Job<'g>>, Vec<&Job<'g>>) =
        jobs.iter().partition(|job| job.surfaces.iter().any(|surface| surface.sample.is_some()));
    let told = |job: &Job<'_>| format!("job `{}` asks for no points: add a `sample` for one of its surfaces", job.name);
    if asked.is_empty() {
        return Err(origin.findings(&idle.iter().map(|job| job.asks_for_nothing()).collect::<Vec<_>>()));
    }
    idle.iter().for_each(|job| monitor.remark(&Remark::new(RemarkKind::NoSample, &job.name, told(job))));
    Ok(asked)
}

/// Writes the files that are asked for and names them: lines outside their ranges stand in tables and meshes only.
fn write_files(
    (dataset, outside): (&Dataset, &[Patch]),
    solved: &[Solved<'_, '_>],
    faces: &[Smooth],
    (name, session): (&str, Session<'_>),
    (request, origin): (&SolveRequest, &Origin),
) -> Result<Vec<String>, Failure> {
    let mut folder = Folder::at(&request.out, origin, session.monitor());
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
        for (surface, drawn) in pictures::sensitivities(solved, dataset) {
            folder.picture(&format!("{name}.{surface}.sensitivity"), &drawn)?;
        }
        for (surface, drawn) in pictures::left(solved, dataset) {
            folder.picture(&format!("{name}.{surface}.left"), &drawn)?;
        }
    }
    folder.finish()
}
