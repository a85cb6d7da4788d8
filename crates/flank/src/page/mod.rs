//! `flank view`

mod bodies;
mod contacts;
mod functions;
mod machines;
mod millings;
mod parameters;
pub(crate) mod result;
mod surfaces;
mod thin;
mod tools;

use flank_chain_dsl::{Job, RangedVariable};
pub use flank_draw::PageParts;
use flank_draw::{PageBody, PageMotion, Scene, write_waiting_page};
use flank_export::{Dataset, Field, Patch, Tally, Values};
use flank_expr::Graph;

use crate::page::result::ViewResult;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::{JobSelection, ViewRequest};
use crate::project::session::{EvaluatorOptions, Session};
use crate::project::spec;
use crate::project::spec::Origin;
use crate::solve::limits::Line;
use crate::solve::solved::Solved;
use crate::solve::stream;
use crate::solve::table;
use crate::solve::{self, SolveOptions};
use functions::Functions;

/// What a surface can be coloured by and what a click shows of a point.
fn wanted(session: Session<'_>) -> SolveOptions<'_> {
    SolveOptions {
        geometry: true,
        sensitivity: true,
        certificates: false,
        together: None,
        arrays: false,
        of_shown: true,
        session,
    }
}

/// Share of what a motion passes over that its slider goes beyond.
const BEYOND: f64 = 0.15;

/// Writes a page in 3-D of each job, and gives `each` its result.
///
/// # Errors
/// What is wrong with the spec, that no job asks for points, that there are too many to keep, or that a file cannot be written.
pub fn view(request: &ViewRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(ViewResult)) -> Result<(), Failure> {
    let put = |name: &str, origin: &Origin, dataset: &Dataset, scene: &Scene| {
        let mut folder = Folder::at(&request.out, origin, monitor);
        folder.page(name, dataset, scene)?;
        let file = folder.finish()?.remove(0);
        let path = request.out.join(format!("{name}.html"));
        let bytes = std::fs::metadata(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))?.len();
        Ok(Written { files: vec![file], bytes })
    };
    pages((&request.jobs, request.evaluator), monitor, put, each)
}

/// What the same pages have of their jobs alone, which is given to `take` by the name of the job before its result is:
/// for [`waiting_page`].
///
/// # Errors
/// What is wrong with the spec, that no job asks for points, that there are too many to keep.
pub fn page_parts(
    jobs: &JobSelection,
    evaluator: EvaluatorOptions,
    monitor: &dyn Monitor,
    take: &mut dyn FnMut(&str, PageParts),
    each: &mut dyn FnMut(ViewResult),
) -> Result<(), Failure> {
    let put = |name: &str, _: &Origin, dataset: &Dataset, scene: &Scene| {
        let parts = PageParts::of_scene(dataset, scene).map_err(|error| error.to_string())?;
        let bytes = (parts.data.len() + parts.functions.len()) as u64;
        take(name, parts);
        Ok(Written { files: Vec::new(), bytes })
    };
    pages((jobs, evaluator), monitor, put, each)
}

/// A page of HTML that waits for its job: the function `begin` of its window shows one, from the addresses of the two
/// parts that [`page_parts`] gives.
#[must_use]
pub fn waiting_page() -> String {
    let mut text = Vec::new();
    write_waiting_page(&mut text).expect("a vector takes all");
    String::from_utf8(text).expect("the parts of the page are texts")
}

fn pages(
    (selection, evaluator): (&JobSelection, EvaluatorOptions),
    monitor: &dyn Monitor,
    mut put: impl FnMut(&str, &Origin, &Dataset, &Scene) -> Result<Written, Failure>,
    each: &mut dyn FnMut(ViewResult),
) -> Result<(), Failure> {
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, selection, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    for job in solve::asked((&jobs, &origin), monitor)? {
        let wanted = wanted(Session::new(evaluator, monitor));
        stream::check_kept(job, &job.surfaces, wanted)?;
        let solved = job.surfaces.iter().filter_map(|surface| solve::solve_surface(job, surface, wanted));
        let solved: Vec<Solved<'_, '_>> = solved.collect::<Result<_, _>>()?;
        let trims = solved.iter().flat_map(|solved| &solved.trims);
        let lines: Vec<&Line<'_, '_>> = trims.filter(|line| !line.points.is_empty()).collect();
        let mut dataset = solve::dataset(job, &solved, &lines, solve::header(&[job], selection, &origin));
        dataset.patches.iter_mut().for_each(|patch| patch.fields.retain(is_something));
        let tally = tally(&solved, &mut dataset.patches);
        let mut not_done = table::failures((job, Some(&origin)), &solved);
        let contacts = contacts::rolled(job, selection, wanted.session)?;
        contacts::add_gaps(&contacts, &solved, &mut dataset.patches);
        not_done.extend(contacts.iter().flat_map(contacts::Shown::refused));
        let of_mills = (selection, wanted.session);
        let (millings, missing) = millings::add_left(job, &solved, &mut dataset.patches, of_mills)?;
        not_done.extend(missing);
        let mut remarks = Vec::new();
        let written = if tally.solved == 0 {
            let message = format!("no page: job `{}` has no point to show", job.name);
            not_done.push(NotDone::new(NotDoneKind::NoPage, &job.name, message));
            None
        } else {
            let bodies = bodies::page_bodies(job, &solved, wanted.session)?;
            let (shown, scene, part) = prepared(&graph, job, (&solved, &contacts, bodies), &dataset);
            let scene = Scene { millings, ..scene };
            remarks.extend(part.iter().map(|text| Remark::new(RemarkKind::ShownInPart, &job.name, text)));
            Some(put(&job.name, &origin, &shown, &scene)?)
        };
        each(ViewResult {
            job: job.name.clone(),
            asked: tally.asked,
            solved: tally.solved,
            bytes: written.as_ref().map(|page| page.bytes),
            files: written.map_or(Vec::new(), |page| page.files),
            remarks,
            not_done: origin.located(&[job], not_done),
        });
    }
    Ok(())
}

/// Of all points of the surfaces, however few of them the page shows, and of the lines on them; the patches of surfaces come first and
/// get their plain names.
fn tally(solved: &[Solved<'_, '_>], patches: &mut [Patch]) -> Tally {
    let (surfaces, lines) = patches.split_at_mut(solved.len());
    let mut tally = Tally::of_patches(&*lines);
    for (solved, patch) in solved.iter().zip(surfaces) {
        patch.name.clone_from(&solved.surface.name);
        tally.asked += solved.summary.asked;
        tally.solved += solved.summary.solved();
    }
    tally
}

/// Whether a field is not zero everywhere, as is that of a parameter without influence.
fn is_something(field: &Field) -> bool {
    match &field.values {
        Values::Scalars(values) => values.iter().flatten().any(|value| value != 0.0),
        Values::Vectors(_) => true,
    }
}

/// A page that is where it belongs.
struct Written {
    /// None of a text.
    files: Vec<String>,
    bytes: u64,
}

/// The points that a page shows, what it shows beside them, and which of the points it shows, if not all.
fn prepared<'g>(
    graph: &'g Graph,
    job: &Job<'g>,
    (solved, contacts, bodies): (&[Solved<'_, 'g>], &[contacts::Shown<'_, 'g>], Vec<PageBody>),
    dataset: &Dataset,
) -> (Dataset, Scene, Option<String>) {
    let (surfaces, lines) = dataset.patches.split_at(solved.len());
    let step = thin::step(surfaces);
    let mut scene = Scene { bodies, ..scene(graph, job, solved, contacts) };
    let is_part = solved.iter().any(|solved| solved.streamed.is_some());
    let shown_in_part = if is_part {
        let asked: usize = solved.iter().map(|solved| solved.summary.asked).sum();
        let shown: usize = surfaces.iter().map(|patch| thin::kept(patch, step).len()).sum();
        Some(format!(
            "the page shows {shown} of the {asked} points that the job samples, in some of their rows and columns; what moves \
             surfaces, and by how much, is given for some of them"
        ))
    } else {
        (step > 1).then(|| {
            format!("the page shows one of {step} rows and columns of what the job samples, and the last ones")
        })
    };
    scene.notes.extend(shown_in_part.clone());
    if step > 1 {
        for (surface, patch) in scene.surfaces.iter_mut().zip(surfaces) {
            surface.targets = thin::kept(patch, step).into_iter().map(|at| surface.targets[at]).collect();
            for shares in &mut surface.shares {
                *shares = thin::taken(shares.len(), step).into_iter().map(|at| shares[at]).collect();
            }
        }
    }
    let patches = surfaces.iter().map(|patch| thin::thinned(patch, step)).chain(lines.iter().cloned()).collect();
    (Dataset { header: dataset.header.clone(), patches }, scene, shown_in_part)
}

/// What the page shows beside the points.
fn scene<'g>(
    graph: &'g Graph,
    job: &Job<'g>,
    solved: &[Solved<'_, 'g>],
    contacts: &[contacts::Shown<'_, 'g>],
) -> Scene {
    let mut functions = Functions::of_job(job);
    let surfaces: Vec<_> =
        solved.iter().map(|solved| surfaces::page_surface(graph, job, solved, &mut functions)).collect();
    Scene {
        doc: job.doc.clone(),
        motions: job.motions.iter().map(|motion| page_motion(motion, solved, contacts)).collect(),
        parameters: parameters::page_parameters(job, solved),
        machines: job
            .machines
            .iter()
            .enumerate()
            .map(|(k, m)| machines::page_machine(graph, job, (k, m), &mut functions))
            .collect(),
        tools: tools::page_tools(job, solved, &mut functions),
        surfaces,
        bodies: Vec::new(),
        contacts: contacts.iter().filter_map(|contact| contact.page(job, solved)).collect(),
        millings: Vec::new(),
        definitions: parameters::definitions(job, &mut functions),
        notes: Vec::new(),
        functions: functions.text,
        function_names: functions.names,
    }
}

/// Over what the solved points pass, and a little beyond; it starts where the middle of the first surface is generated. A motion by which a
/// pair rolls goes over the roll of its contacts, and starts in the middle of the first.
fn page_motion<'g>(
    motion: &RangedVariable<'g>,
    solved: &[Solved<'_, 'g>],
    contacts: &[contacts::Shown<'_, 'g>],
) -> PageMotion {
    let values = |solved: &Solved<'_, '_>| -> Vec<f64> {
        let place = solved.surface.unknowns.iter().position(|unknown| unknown.variable == motion.variable);
        let of_points = solved.points.iter().filter(|point| point.outcome == flank_solver::Outcome::Solved);
        place.map_or(Vec::new(), |k| of_points.map(|point| point.unknowns[k]).collect())
    };
    let all: Vec<Vec<f64>> = solved.iter().map(values).collect();
    let rolls: Vec<[f64; 3]> = contacts.iter().filter_map(|contact| contact.rolls(motion)).collect();
    let passed = all.iter().flatten();
    let low = passed.clone().copied().reduce(f64::min).unwrap_or(motion.low);
    let high = passed.copied().reduce(f64::max).unwrap_or(motion.high);
    let margin = BEYOND * (high - low);
    let (low, high) = match &rolls[..] {
        [] if low < high => (low - margin, high + margin),
        [] => (motion.low, motion.high),
        [[low, high, _], others @ ..] => {
            others.iter().fold((*low, *high), |(low, high), other| (low.min(other[0]), high.max(other[1])))
        }
    };
    let generated = all.iter().find(|values| !values.is_empty()).map(|values| values[values.len() / 2]);
    let start = rolls.first().map(|roll| roll[2]).or(generated);
    PageMotion {
        name: motion.name.clone(),
        unit: solve::unit(motion.dimension),
        low: low.max(motion.low),
        high: high.min(motion.high),
        limits: [motion.low, motion.high],
        start: start.unwrap_or(0.5 * (motion.low + motion.high)),
        is_count: motion.is_count,
    }
}
