//! `flank plot`

mod comparison;
pub(crate) mod contacts;
pub(crate) mod gear;
mod machine;
mod maps;
pub(crate) mod millings;
mod motion;
pub(crate) mod result;
mod section;
mod subject;
mod tool;
pub(crate) mod traces;

use flank_chain_dsl::Job;
use flank_draw::{Picture, PictureOptions};
use flank_export::{Dataset, Header};
use flank_expr::Graph;

use crate::compare::map::{Named, find};
use crate::project::choices::{Choice, PlotKind};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::NotDone;
use crate::project::requests::PlotRequest;
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::solve;
use crate::solve::cut;
use crate::solve::solved::Solved;
use crate::solve::table;
use crate::solve::travel;
use result::{PlotResult, WrittenPicture};
pub(crate) use subject::Subject;

/// Unless kinds are named, the first of these that fit are drawn, and no more than so many.
const DEFAULTS: [PlotKind; 7] = [
    PlotKind::Gear,
    PlotKind::Left,
    PlotKind::Surface,
    PlotKind::Section,
    PlotKind::ContactLines,
    PlotKind::Machine,
    PlotKind::Curvature,
];
const MOST_DEFAULTS: usize = 3;

/// What a deviation is of.
const SECOND: &str = "takes a second surface: option `surface NAME` option `reference OTHER`";

/// A picture, and what it shows in a few words.
pub(crate) struct Drawing {
    pub(crate) picture: Picture,
    pub(crate) shows: String,
}

/// Why a kind of picture cannot be drawn.
pub(crate) type Unfit = String;

/// Draws pictures of jobs, and gives `each` their results when all are drawn.
///
/// # Errors
/// What is wrong with the spec; what does not go together, or does not fit the job; that a file cannot be written.
pub fn plot(request: &PlotRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(PlotResult)) -> Result<(), Failure> {
    if !request.of.is_empty() && !request.what.contains(&PlotKind::Sensitivity) {
        return Err(Failure::Request(
            "option `of` names what `sensitivity` shows, and that is not among option `what`".to_string(),
        ));
    }
    contacts::check(request)?;
    millings::check(request)?;
    match &request.reference {
        Some(_) => comparison::check(request)?,
        None if request.what.contains(&PlotKind::Deviation) => {
            let message = format!("option `what deviation` {SECOND}");
            return Err(Failure::Request(message));
        }
        None => {}
    }
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor);
    let done = match &request.reference {
        Some(from) => vec![comparison::plot(&jobs, from, (request, session), &origin)?],
        None => plot_jobs(&jobs, (request, session), &origin)?,
    };
    done.into_iter().for_each(each);
    Ok(())
}

fn plot_jobs(
    jobs: &[Job<'_>],
    (request, session): (&PlotRequest, Session<'_>),
    origin: &Origin,
) -> Result<Vec<PlotResult>, Failure> {
    contacts::check_names(jobs, request)?;
    let named = request.surface.iter().map(|name| find(jobs, name)).collect::<Result<Vec<_>, _>>()?;
    if let [first, rest @ ..] = &named[..]
        && let Some(other) = rest.iter().find(|other| other.job.name != first.job.name)
    {
        let [first, other] = [first, other].map(Named::whole_name);
        return Err(format!("`{first}` and `{other}` belong to different jobs; draw them one after the other").into());
    }
    let shows_contacts = request.what.iter().any(|what| contacts::KINDS.contains(what));
    // without any contact each job says what fits instead
    let without = jobs.iter().all(|job| job.contacts.is_empty());
    let is_meant = |job: &&Job<'_>| match named.first() {
        Some(of) => of.job.name == job.name,
        None if shows_contacts && !without => !contacts::of_job(job, request).is_empty(),
        None => job.surfaces.iter().any(|surface| surface.sample.is_some()),
    };
    let meant: Vec<&Job<'_>> = jobs.iter().filter(is_meant).collect();
    if meant.is_empty() {
        return Err("no job asks for points: add a `sample` for one of its surfaces".to_string().into());
    }
    let is_of_surfaces = |what: &PlotKind| !contacts::KINDS.contains(what) && *what != PlotKind::Milling;
    let of_surfaces: Vec<PlotKind> = request.what.iter().copied().filter(is_of_surfaces).collect();
    let plot = |job: &&Job<'_>| -> Result<PlotResult, Failure> {
        let names: Vec<&str> = named.iter().map(|of| of.surface.name.as_str()).collect();
        let header = with_origin(solve::header(&[job], &request.jobs, origin), request);
        let solved = |kinds: &[PlotKind]| Subject::new(job, &names, header.clone(), kinds, session);
        // what fits is known of what is solved with all that pictures show
        let refused = |(what, why): (PlotKind, Unfit)| -> Failure {
            solved(PlotKind::ALL).map_or_else(|e| e, |all| unfit(&all, what, &why, request).into())
        };
        let (mut drawn, mut not_done) = (Vec::new(), Vec::new());
        if !of_surfaces.is_empty() || request.what.is_empty() {
            let subject = solved(&of_surfaces)?;
            session.check()?;
            drawn.extend(drawings(&subject, &of_surfaces, request).map_err(refused)?);
            not_done.extend(table::failures((job, Some(origin)), &subject.solved));
            not_done.extend(cut::unknown(subject.solved.iter().map(Solved::left)));
            not_done.extend(travel::beyond(job, &subject.solved));
        }
        if shows_contacts {
            let found = contacts::solved(job, request, session)?;
            drawn.extend(contacts::drawings(job, &found, request, &header).map_err(refused)?);
            not_done.extend(found.not_done);
        }
        if request.what.contains(&PlotKind::Milling) {
            let milling = millings::of_job(job, request)?;
            let milling = milling.ok_or_else(|| refused((PlotKind::Milling, millings::NONE.to_string())))?;
            let (drawing, missing) = millings::drawing(job, milling, request, (header.clone(), session))?;
            drawn.extend(drawing.map(|drawing| (PlotKind::Milling, drawing)));
            not_done.extend(missing);
        }
        drawn.sort_by_key(|(what, _)| request.what.iter().position(|asked| asked == what));
        let written = write(&drawn, &job.name, (request, session), origin)?;
        Ok(told(&job.name, written, origin.located(&[job], not_done), request))
    };
    meant.iter().map(plot).collect()
}

/// What is asked for of surfaces.
///
/// # Errors
/// The first kind that does not fit, and why.
fn drawings(
    subject: &Subject<'_, '_>,
    kinds: &[PlotKind],
    request: &PlotRequest,
) -> Result<Vec<(PlotKind, Drawing)>, (PlotKind, Unfit)> {
    let options = options(request);
    if kinds.is_empty() {
        return Ok(defaults(subject, options));
    }
    let asked = kinds.iter().map(|&what| {
        draw(subject, what, &request.of, options).map(|drawing| (what, drawing)).map_err(|why| (what, why))
    });
    asked.collect()
}

/// Those that matter for a job.
pub(crate) fn defaults(subject: &Subject<'_, '_>, options: PictureOptions) -> Vec<(PlotKind, Drawing)> {
    let mut drawn: Vec<(PlotKind, Drawing)> = Vec::new();
    for what in DEFAULTS {
        // the gear shows its surfaces too
        let is_shown = what == PlotKind::Surface && drawn.iter().any(|(other, _)| *other == PlotKind::Gear);
        if drawn.len() < MOST_DEFAULTS && !is_shown {
            drawn.extend(draw(subject, what, &[], options).ok().map(|drawing| (what, drawing)));
        }
    }
    drawn
}

/// One picture; `of` names the parameters that sensitivities are to.
pub(crate) fn draw(
    subject: &Subject<'_, '_>,
    what: PlotKind,
    of: &[String],
    options: PictureOptions,
) -> Result<Drawing, Unfit> {
    match what {
        PlotKind::Gear => gear::draw(subject, &options),
        PlotKind::Surface => {
            let patches = subject.in_space.iter().map(|at| subject.dataset.patches[*at].clone()).collect();
            let shown = Dataset { header: subject.dataset.header.clone(), patches };
            let picture = flank_draw::picture(&shown, &options);
            Ok(Drawing { picture, shows: format!("{} in space", counted(shown.patches.len(), "surface")) })
        }
        PlotKind::Topography => maps::topography(subject, &options),
        PlotKind::Traces => traces::draw(subject, &options),
        PlotKind::Curvature => maps::curvature(subject, &options),
        PlotKind::Sensitivity => maps::sensitivity(subject, of, &options),
        PlotKind::Deviation => Err(SECOND.to_string()),
        PlotKind::Left => maps::left(subject, &options),
        PlotKind::Residual => maps::residual(subject, &options),
        PlotKind::ContactLines => maps::contact_lines(subject, &options),
        PlotKind::Section => section::draw(subject, &options),
        PlotKind::Machine => machine::draw(subject, &options),
        PlotKind::Motion => motion::draw(subject, &options),
        PlotKind::Pattern | PlotKind::Error | PlotKind::Gap | PlotKind::Path => Err(contacts::NONE.to_string()),
        PlotKind::Milling => Err(millings::NONE.to_string()),
    }
}

fn unfit(subject: &Subject<'_, '_>, what: PlotKind, why: &str, request: &PlotRequest) -> String {
    let fits = |other: PlotKind| match other {
        PlotKind::Milling => !subject.job.millings.is_empty(),
        _ if contacts::KINDS.contains(&other) => !subject.job.contacts.is_empty(),
        _ => draw(subject, other, &request.of, options(request)).is_ok(),
    };
    let others = PlotKind::ALL.iter().filter(|other| fits(**other));
    let others: Vec<String> = others.map(|other| other.name().to_string()).collect();
    format!(
        "option `what {}` does not fit job {}: {why}\nwhat fits: {}",
        what.name(),
        subject.job.name,
        others.join(", ")
    )
}

fn counted(count: usize, of: &str) -> String {
    let plural = match of {
        "axis" => "axes".to_string(),
        "tooth" => "teeth".to_string(),
        _ => format!("{of}s"),
    };
    if count == 1 { format!("1 {of}") } else { format!("{count} {plural}") }
}

/// Where pictures come from, unless they are not to say so.
fn with_origin(header: Header, request: &PlotRequest) -> Header {
    if request.no_origin { Header { spec: String::new(), ..header } } else { header }
}

fn options(request: &PlotRequest) -> PictureOptions {
    PictureOptions { width: request.size.0, height: request.size.1 }
}

fn write(
    drawings: &[(PlotKind, Drawing)],
    stem: &str,
    (request, session): (&PlotRequest, Session<'_>),
    origin: &Origin,
) -> Result<Vec<WrittenPicture>, Failure> {
    let mut folder = Folder::at(&request.out, origin, session.monitor());
    let mut written = Vec::new();
    for (what, drawing) in drawings {
        let before = folder.written.len();
        folder.picture_as(&format!("{stem}.{}", what.name()), &drawing.picture, &request.format)?;
        let files = folder.written[before..].to_vec();
        written.push(WrittenPicture { what: *what, shows: drawing.shows.clone(), files });
    }
    folder.finish()?;
    Ok(written)
}

/// What was written, with what was not done.
fn told(job: &str, pictures: Vec<WrittenPicture>, not_done: Vec<NotDone>, request: &PlotRequest) -> PlotResult {
    let (width, height) = request.size;
    PlotResult { job: job.to_string(), spec: shown_path(request.jobs.file()), width, height, pictures, not_done }
}
