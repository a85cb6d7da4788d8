//! `flank plot`

mod comparison;
mod machine;
mod maps;
mod motion;
mod section;
mod subject;
mod tool;

use clap::ValueEnum;
use flank_chain_dsl::Job;
use flank_draw::{Picture, PictureOptions};
use flank_export::{Dataset, Header};
use flank_expr::Graph;
use serde_json::json;

use crate::arguments::{Plot, What};
use crate::failure::{self, Failure};
use crate::files::Folder;
use crate::spec::Origin;
use crate::table::{self, aligned};
use crate::{Ending, cut, deviation, eprint, print, solve, spec, travel};
pub(crate) use subject::Subject;

/// Without `--what` the first of these that fit are drawn, and no more than so many.
const DEFAULTS: [What; 6] =
    [What::Left, What::Surface, What::Section, What::ContactLines, What::Machine, What::Curvature];
const MOST_DEFAULTS: usize = 3;

/// What a deviation is of.
const SECOND: &str = "takes a second surface: --surface NAME --from OTHER";

/// A picture, and what it shows in a few words.
pub(crate) struct Drawing {
    pub(crate) picture: Picture,
    pub(crate) shows: String,
}

/// A picture with its files.
struct Written {
    what: What,
    shows: String,
    files: Vec<String>,
}

/// Why a kind of picture cannot be drawn.
pub(crate) type Unfit = String;

pub(crate) fn run(arguments: &Plot) -> Result<Ending, Failure> {
    if !arguments.of.is_empty() && !arguments.what.contains(&What::Sensitivity) {
        return Err(Failure::of_usage("--of names what `sensitivity` shows, and that is not among --what".to_string()));
    }
    match &arguments.from {
        Some(_) => comparison::check(arguments)?,
        None if arguments.what.contains(&What::Deviation) => {
            let message = format!("--what deviation {SECOND}");
            return Err(Failure::of_usage(message));
        }
        None => {}
    }
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &arguments.which)?;
    let origin = Origin::of(&compilation);
    let done = match &arguments.from {
        Some(from) => vec![comparison::plot(&jobs, from, arguments, &origin)?],
        None => plot_jobs(&jobs, arguments, &origin)?,
    };
    let mut ending = Ending::Done;
    for Drawn { shown, not_done } in done {
        print(&shown);
        eprint(&not_done);
        if !not_done.is_empty() {
            ending = Ending::Unsolved;
        }
    }
    Ok(ending)
}

/// What became of a job: what is printed of its pictures, and in words what is not on them because it could not be solved.
struct Drawn {
    shown: String,
    not_done: String,
}

fn plot_jobs(jobs: &[Job<'_>], arguments: &Plot, origin: &Origin) -> Result<Vec<Drawn>, String> {
    let named = arguments.surface.iter().map(|name| deviation::find(jobs, name)).collect::<Result<Vec<_>, _>>()?;
    if let [first, rest @ ..] = &named[..]
        && let Some(other) = rest.iter().find(|other| other.job.name != first.job.name)
    {
        let [first, other] = [first, other].map(deviation::Named::whole_name);
        return Err(format!("`{first}` and `{other}` belong to different jobs; draw them one after the other"));
    }
    let is_meant = |job: &&Job<'_>| match named.first() {
        Some(of) => of.job.name == job.name,
        None => job.surfaces.iter().any(|surface| surface.sample.is_some()),
    };
    let meant: Vec<&Job<'_>> = jobs.iter().filter(is_meant).collect();
    if meant.is_empty() {
        return Err("no job asks for points: add a `sample` for one of its surfaces".to_string());
    }
    let plot = |job: &&Job<'_>| {
        let names: Vec<&str> = named.iter().map(|of| of.surface.name.as_str()).collect();
        let header = with_origin(solve::header(&[job], &arguments.which, origin), arguments);
        let solved = |kinds: &[What]| Subject::new(job, &names, header.clone(), kinds, arguments.means);
        let subject = solved(&arguments.what)?;
        // what fits is known of what is solved with all that pictures show
        let drawings = drawings(&subject, arguments).map_err(|(what, why)| {
            solved(What::value_variants()).map_or_else(|e| e, |all| unfit(&all, what, &why, arguments))
        })?;
        let written = write(&drawings, &job.name, arguments, origin)?;
        let not_done = table::failures(job, &subject.solved)
            + &cut::unknown(&subject.solved)
            + &travel::beyond(job, &subject.solved);
        Ok(told(&job.name, &written, not_done, arguments))
    };
    meant.iter().map(plot).collect()
}

/// What is asked for.
///
/// # Errors
/// The first kind that does not fit, and why.
fn drawings(subject: &Subject<'_, '_>, arguments: &Plot) -> Result<Vec<(What, Drawing)>, (What, Unfit)> {
    let options = options(arguments);
    if arguments.what.is_empty() {
        return Ok(defaults(subject, options));
    }
    let asked = arguments.what.iter().map(|&what| {
        draw(subject, what, &arguments.of, options).map(|drawing| (what, drawing)).map_err(|why| (what, why))
    });
    asked.collect()
}

/// Those that matter for a job.
pub(crate) fn defaults(subject: &Subject<'_, '_>, options: PictureOptions) -> Vec<(What, Drawing)> {
    let fitting = DEFAULTS.into_iter().filter_map(|what| Some((what, draw(subject, what, &[], options).ok()?)));
    fitting.take(MOST_DEFAULTS).collect()
}

/// One picture; `of` names the parameters that sensitivities are to.
pub(crate) fn draw(
    subject: &Subject<'_, '_>,
    what: What,
    of: &[String],
    options: PictureOptions,
) -> Result<Drawing, Unfit> {
    match what {
        What::Surface => {
            let patches = subject.in_space.iter().map(|at| subject.dataset.patches[*at].clone()).collect();
            let shown = Dataset { header: subject.dataset.header.clone(), patches };
            let picture = flank_draw::picture(&shown, &options);
            Ok(Drawing { picture, shows: format!("{} in space", counted(shown.patches.len(), "surface")) })
        }
        What::Topography => maps::topography(subject, &options),
        What::Curvature => maps::curvature(subject, &options),
        What::Sensitivity => maps::sensitivity(subject, of, &options),
        What::Deviation => Err(SECOND.to_string()),
        What::Left => maps::left(subject, &options),
        What::Residual => maps::residual(subject, &options),
        What::ContactLines => maps::contact_lines(subject, &options),
        What::Section => section::draw(subject, &options),
        What::Machine => machine::draw(subject, &options),
        What::Motion => motion::draw(subject, &options),
    }
}

fn unfit(subject: &Subject<'_, '_>, what: What, why: &str, arguments: &Plot) -> String {
    let others =
        What::value_variants().iter().filter(|other| draw(subject, **other, &arguments.of, options(arguments)).is_ok());
    let others: Vec<String> = others.map(|other| name(*other)).collect();
    format!("--what {} does not fit job {}: {why}\nwhat fits: {}", name(what), subject.job.name, others.join(", "))
}

/// As the command line has it.
pub(crate) fn name(what: What) -> String {
    what.to_possible_value().map_or(String::new(), |value| value.get_name().to_string())
}

fn counted(count: usize, of: &str) -> String {
    let plural = if of == "axis" { "axes".to_string() } else { format!("{of}s") };
    if count == 1 { format!("1 {of}") } else { format!("{count} {plural}") }
}

/// Where pictures come from, unless they are not to say so.
fn with_origin(header: Header, arguments: &Plot) -> Header {
    if arguments.no_origin { Header { spec: String::new(), ..header } } else { header }
}

fn options(arguments: &Plot) -> PictureOptions {
    PictureOptions { width: arguments.size.0, height: arguments.size.1 }
}

fn write(drawings: &[(What, Drawing)], stem: &str, arguments: &Plot, origin: &Origin) -> Result<Vec<Written>, String> {
    let mut folder = Folder::at(&arguments.out, origin)?;
    let mut written = Vec::new();
    for (what, drawing) in drawings {
        let before = folder.written.len();
        for format in &arguments.format {
            folder.picture_as(&format!("{stem}.{}", name(*what)), &drawing.picture, *format)?;
        }
        let files = folder.written[before..].to_vec();
        written.push(Written { what: *what, shows: drawing.shows.clone(), files });
    }
    folder.finish()?;
    Ok(written)
}

/// What was written, as text or JSON, with what was not done.
fn told(job: &str, written: &[Written], not_done: String, arguments: &Plot) -> Drawn {
    let spec = spec::shown(&arguments.which.file);
    if arguments.json {
        let pictures: Vec<serde_json::Value> = written
            .iter()
            .map(|one| json!({ "what": name(one.what), "shows": one.shows, "files": one.files }))
            .collect();
        let [width, height] = [arguments.size.0, arguments.size.1];
        let table = json!({
            "schema": "flank.plot/2", "job": job, "spec": spec, "width": width, "height": height, "pictures": pictures,
            "not_done": failure::not_done(&not_done),
        });
        return Drawn { shown: format!("{table:#}\n"), not_done };
    }
    let rows: Vec<[String; 3]> =
        written.iter().map(|one| [name(one.what), one.shows.clone(), one.files.join(", ")]).collect();
    let shown = format!("job {job} ({spec})\n\n{}", aligned(&rows, ""));
    Drawn { shown, not_done }
}
