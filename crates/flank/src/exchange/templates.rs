//! A job of the library becomes one of the user's, with the machines and tools that it uses; so does a machine or a tool by itself.

use std::collections::BTreeMap;
use std::path::Path;

use flank_chain_dsl::syntax::ast::{Item, Job, JobStatement, Param};
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, closest};
use schemars::JsonSchema;
use serde::Serialize;

use crate::exchange::changes::{Changes, Given, Words};
use crate::exchange::library::{texts, used_by};
use crate::exchange::made::{Made, MadeKind, NewJob};
use crate::exchange::parts;
use crate::project::failure::Failure;
use crate::project::shown_path;

/// The jobs of the library that one can start from, of `flank new` without a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.templates/3")]
pub struct TemplateList {
    /// The jobs that stand alone in their file, by name.
    pub templates: Vec<Template>,
    /// Files whose jobs belong together, or vary others: none of them is made into a file of its own.
    pub together: Vec<Together>,
    /// The machines of the library, by name.
    pub machines: Vec<Template>,
    /// Its tools.
    pub tools: Vec<Template>,
}

/// Something to start from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Template {
    /// Its name.
    pub name: String,
    /// The first sentence about it.
    pub about: String,
}

/// A file of the library with several jobs, or with variants of others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Together {
    /// Its path in the repository.
    pub file: String,
    /// The names of its jobs.
    pub jobs: Vec<String>,
}

/// A parameter of a job to start from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemplateParameter {
    /// Its name.
    pub name: String,
    /// The first line about it; may be empty.
    pub about: String,
    /// The value that the job gives it, as it is written.
    pub default: String,
}

/// What `flank new` made of something in the library.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.new/3")]
pub struct FromLibrary {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: MadeKind,
    /// Its file.
    pub spec: String,
    /// Files written, in their order: its own first.
    pub files: Vec<String>,
}

/// What the library has to start from.
pub fn templates() -> TemplateList {
    let Offer { templates, together } = offer();
    let of = |kind: MadeKind| {
        let parts = parts::all().into_iter().filter(move |part| part.kind == kind);
        parts.map(|part| Template { name: part.name, about: first_sentence(&part.doc) }).collect()
    };
    let templates = templates.into_iter().map(|(name, source)| Template { name, about: source.doc });
    let together = together.into_iter().map(|(path, jobs)| Together { file: in_library(path), jobs });
    TemplateList {
        templates: templates.collect(),
        together: together.collect(),
        machines: of(MadeKind::Machine),
        tools: of(MadeKind::Tool),
    }
}

/// The parameters of a job to start from that have a value.
///
/// # Errors
/// Why there is nothing to start from under that name.
pub fn template_parameters(template: &str) -> Result<Vec<TemplateParameter>, Failure> {
    if parts::find(template).is_some() {
        return Ok(Vec::new());
    }
    let source = find(template)?;
    let parameter = |parameter: &&Param| {
        let span = parameter.default.as_ref()?.span;
        Some(TemplateParameter {
            name: parameter.name.node.clone(),
            about: parameter.doc.first().map_or(String::new(), |line| line.trim().to_string()),
            default: source.text[span.start as usize..span.end as usize].to_string(),
        })
    };
    Ok(source.parameters().iter().filter_map(parameter).collect())
}

/// Writes a job of the library under a new name, with other values, and all that it uses, as far as it compiles; or a machine or a tool
/// as it is, or a variant of a machine to go on with. Nothing that stands in the folder is changed.
///
/// # Errors
/// Why there is nothing to start from under that name; what is wrong with what was given; what stands in the way.
pub fn new_job(request: &NewJob) -> Result<FromLibrary, Failure> {
    let name = request.name.as_ref().map_or(&request.template, |name| &name.text);
    let (kind, made) = match parts::find(&request.template) {
        Some(part) => (part.kind, part.made(request)?),
        None => (MadeKind::Job, find(&request.template)?.named(request)?),
    };
    let files = made.write(&request.folder)?;
    Ok(FromLibrary { name: name.clone(), kind, spec: files[0].clone(), files })
}

/// A job of the library.
struct Source {
    /// Its file within the library.
    path: &'static Path,
    text: &'static str,
    doc: String,
    job: Job,
}

/// The same with its texts.
struct Offer {
    /// The jobs that stand alone in their file, by name.
    templates: BTreeMap<String, Source>,
    /// Files whose jobs belong together, or vary others, with their names: none of them is made into a file of its own.
    together: BTreeMap<&'static Path, Vec<String>>,
}

fn offer() -> Offer {
    let mut offer = Offer { templates: BTreeMap::new(), together: BTreeMap::new() };
    for (path, text) in texts() {
        let (file, _) = parse(text, FileId(0));
        let (mut jobs, mut variants) = (Vec::new(), Vec::new());
        for item in file.items {
            match item {
                Item::Job(job) => jobs.push(job),
                Item::Variant(variant) => variants.push(variant.name.node),
                _ => {}
            }
        }
        if jobs.len() + variants.len() == 0 {
            continue;
        }
        if jobs.len() == 1 && variants.is_empty() {
            let (job, doc) = (jobs.remove(0), first_sentence(&file.doc));
            offer.templates.insert(job.name.node.clone(), Source { path, text, doc, job });
        } else {
            let names = jobs.into_iter().map(|job| job.name.node).chain(variants);
            offer.together.insert(path, names.collect());
        }
    }
    offer
}

/// The lines up to the first that ends with a full stop, as one.
fn first_sentence(lines: &[String]) -> String {
    let end = lines.iter().position(|line| line.trim_end().ends_with('.')).map_or(lines.len(), |at| at + 1);
    lines[..end].iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ")
}

fn in_library(path: &Path) -> String {
    format!("specs/{}", shown_path(path))
}

/// # Errors
/// Why there is nothing to start from under that name.
fn find(name: &str) -> Result<Source, Failure> {
    let Offer { mut templates, together } = offer();
    templates.remove(name).ok_or_else(|| {
        let beside = together.iter().find(|(_, jobs)| jobs.iter().any(|job| job == name));
        Failure::Request(match beside {
            Some((path, jobs)) => {
                let others: Vec<&str> = jobs.iter().map(String::as_str).filter(|job| *job != name).collect();
                format!(
                    "`{name}` is not made into a file of its own, since it belongs together with {} in {}: copy that file",
                    others.join(", "),
                    in_library(path)
                )
            }
            None => {
                // a job is also meant by its file
                let stem = Path::new(name).file_stem().map_or(name.into(), |stem| stem.to_string_lossy());
                let of_file = templates.iter().find(|(_, job)| job.path.file_stem().is_some_and(|own| *own == *stem));
                let parts = parts::all();
                let known = templates.keys().chain(together.values().flatten()).map(String::as_str);
                let known = known.chain(parts.iter().map(|part| part.name.as_str()));
                let near = of_file.map(|(job, _)| job.as_str()).or_else(|| closest(&stem, known));
                let near = near.map_or(String::new(), |near| format!(", did you mean `{near}`?"));
                format!("the library has no job, machine or tool `{name}`{near}; `flank new` lists them")
            }
        })
    })
}

impl Source {
    fn parameters(&self) -> Vec<&Param> {
        let statements = self.job.statements.iter();
        statements.filter_map(|one| if let JobStatement::Param(param) = one { Some(param) } else { None }).collect()
    }

    /// The job with its new name and values, and what it uses.
    fn named(self, request: &NewJob) -> Result<Made, Failure> {
        let own = Words { text: self.job.name.node.clone(), origin: String::new() };
        let name = request.name.as_ref().unwrap_or(&own);
        let parameters = self.parameters();
        let mut values = Vec::new();
        for (known, value) in &request.values {
            let parameter = parameters.iter().find(|parameter| parameter.name.node == *known).ok_or_else(|| {
                let all: Vec<String> = parameters.iter().map(|known| format!("`{}`", known.name.node)).collect();
                let all = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
                Failure::Input(format!("`{}` has no parameter `{known}`; it has: {all}", self.job.name.node))
            })?;
            // of several values for one parameter the last one counts
            values.retain(|(earlier, _): &(&&Param, Given)| earlier.name.node != *known);
            values.push((parameter, Given::value(known, value)));
        }
        values.iter().try_for_each(|(_, value)| value.check())?;
        let places =
            values.into_iter().filter_map(|(parameter, value)| Some((parameter.default.as_ref()?.span, value)));
        let changes = Changes::new(places.chain([(self.job.name.span, Given::name(name))]).collect());
        let mut files = vec![(self.path.with_file_name(format!("{}.chain", name.text)), changes.applied(self.text))];
        used_by(self.path, self.text, &mut files).map_err(Failure::Input)?;
        Ok(Made { files, changes })
    }
}
