//! `flank plot`

mod comparison;
mod machine;
mod maps;
mod motion;
mod section;
mod subject;
mod tool;

use std::fmt::Write;

use clap::ValueEnum;
use flank_chain_dsl::Job;
use flank_export::{Header, Picture, PictureOptions};
use flank_expr::Graph;
use serde_json::json;

use crate::arguments::{Plot, What};
use crate::failure::Failure;
use crate::files::Folder;
use crate::table::aligned;
use crate::{Ending, deviation, print, solve, spec};
pub(crate) use subject::{Subject, first_sampled};

/// Without `--what` the first of these that fit are drawn, and no more than so many.
const DEFAULTS: [What; 6] =
    [What::Left, What::Surface, What::Section, What::ContactLines, What::Machine, What::Curvature];
const MOST_DEFAULTS: usize = 3;

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
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &arguments.which)?;
    let hash = spec::hash(&compilation);
    let told = match &arguments.from {
        Some(from) => vec![comparison::plot(&jobs, from, arguments, &hash)?],
        None => plot_jobs(&jobs, arguments, &hash)?,
    };
    told.iter().for_each(|text| print(text));
    Ok(Ending::Done)
}

fn plot_jobs(jobs: &[Job<'_>], arguments: &Plot, hash: &str) -> Result<Vec<String>, String> {
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
        let header = with_origin(solve::header(&job.name, &arguments.which, hash), arguments);
        let subject = Subject::new(job, &names, header, arguments)?;
        let written = write(&drawings(&subject, arguments)?, &job.name, arguments)?;
        Ok(told(&job.name, &written, arguments))
    };
    meant.iter().map(plot).collect()
}

/// What is asked for.
fn drawings(subject: &Subject<'_, '_>, arguments: &Plot) -> Result<Vec<(What, Drawing)>, String> {
    let options = options(arguments);
    if arguments.what.is_empty() {
        return Ok(defaults(subject, options));
    }
    let asked = arguments.what.iter().map(|&what| {
        draw(subject, what, &arguments.of, options)
            .map(|drawing| (what, drawing))
            .map_err(|why| unfit(subject, what, &why, arguments))
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
        What::Surface => Ok(Drawing {
            picture: flank_export::picture(&subject.dataset, &options),
            shows: format!("{} in space", counted(subject.solved.len(), "surface")),
        }),
        What::Topography => maps::topography(subject, &options),
        What::Curvature => maps::curvature(subject, &options),
        What::Sensitivity => maps::sensitivity(subject, of, &options),
        What::Deviation => Err("it takes a second surface: --surface NAME --from OTHER".to_string()),
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

fn write(drawings: &[(What, Drawing)], stem: &str, arguments: &Plot) -> Result<Vec<Written>, String> {
    let mut folder = Folder::at(&arguments.out)?;
    let mut written = Vec::new();
    for (what, drawing) in drawings {
        let before = folder.written.len();
        for format in &arguments.format {
            folder.picture_as(&format!("{stem}.{}", name(*what)), &drawing.picture, *format)?;
        }
        let files = folder.written[before..].to_vec();
        written.push(Written { what: *what, shows: drawing.shows.clone(), files });
    }
    Ok(written)
}

/// What was written, as text or JSON.
fn told(job: &str, written: &[Written], arguments: &Plot) -> String {
    let spec = spec::shown(&arguments.which.file);
    if arguments.json {
        let pictures: Vec<serde_json::Value> = written
            .iter()
            .map(|one| json!({ "what": name(one.what), "shows": one.shows, "files": one.files }))
            .collect();
        let [width, height] = [arguments.size.0, arguments.size.1];
        let table = json!({
            "schema": "flank.plot/1", "job": job, "spec": spec, "width": width, "height": height, "pictures": pictures,
        });
        return format!("{table:#}\n");
    }
    let rows: Vec<[String; 3]> =
        written.iter().map(|one| [name(one.what), one.shows.clone(), one.files.join(", ")]).collect();
    let mut out = format!("job {job} ({spec})\n\n");
    let _ = write!(out, "{}", aligned(&rows, ""));
    out
}
