//! A job of the library becomes one of the user's, with the machines and tools that it uses; so does a machine or a tool by itself.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use flank_chain_dsl::syntax::ast::{Change, Item, Job, JobStatement};
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, Span, closest};
use schemars::JsonSchema;
use serde::Serialize;

use crate::exchange::changes::{Changes, Given, Words};
use crate::exchange::expectations::{Expecting, Jobs, anew, inherited, own};
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
#[serde(tag = "schema", rename = "flank.new/4")]
pub struct FromLibrary {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: MadeKind,
    /// Its file.
    pub spec: String,
    /// Files written, in their order: its own first.
    pub files: Vec<String>,
    /// What the library expects of it that does not hold with other values, as it is written there: left out.
    pub left_out: Vec<String>,
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
    Ok(find(template)?.parameters)
}

/// Writes a job of the library under a new name, with other values, and all that it uses, as far as it compiles; or a machine or a tool
/// as it is, or a variant of a machine to go on with. Nothing that stands in the folder is changed.
///
/// # Errors
/// Why there is nothing to start from under that name; what is wrong with what was given; what stands in the way.
pub fn new_job(request: &NewJob) -> Result<FromLibrary, Failure> {
    let name = request.name.as_ref().map_or(&request.template, |name| &name.text);
    let (kind, made, left_out) = match parts::find(&request.template) {
        Some(part) => (part.kind, part.made(request)?, Vec::new()),
        None => {
            let (made, left_out) = find(&request.template)?.named(request)?;
            (MadeKind::Job, made, left_out)
        }
    };
    let files = made.write(&request.folder)?;
    Ok(FromLibrary { name: name.clone(), kind, spec: files[0].clone(), files, left_out })
}

/// A job of the library.
struct Source {
    /// Its file within the library.
    path: &'static Path,
    text: &'static str,
    doc: String,
    job: Job,
    /// Those with a value: of the jobs that it extends, then its own.
    parameters: Vec<TemplateParameter>,
    /// What it takes from the jobs that it extends.
    inherited: Vec<Expecting>,
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
    let files: Vec<_> = texts().map(|(path, text)| (path, text, parse(text, FileId(0)).0)).collect();
    let jobs = files.iter().flat_map(|(path, text, file)| {
        file.items.iter().filter_map(move |item| match item {
            Item::Job(job) => Some((job.name.node.clone(), (*path, *text, job.clone()))),
            _ => None,
        })
    });
    let known: Jobs = jobs.collect();
    for (path, text, file) in files {
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
            let (parameters, inherited) = (parameters(text, &job, &known), inherited(&job, &known));
            offer.templates.insert(job.name.node.clone(), Source { path, text, doc, job, parameters, inherited });
        } else {
            let names = jobs.into_iter().map(|job| job.name.node).chain(variants);
            offer.together.insert(path, names.collect());
        }
    }
    offer
}

/// The parameters of a job that have a value, as it says them or as it takes them from the job that it extends.
fn parameters(text: &str, job: &Job, known: &Jobs) -> Vec<TemplateParameter> {
    let written = |span: Span| text[span.start as usize..span.end as usize].to_string();
    let parent = job.extends.as_ref().and_then(|parent| known.get(&parent.node));
    let mut all = parent.map_or_else(Vec::new, |(_, text, parent)| parameters(text, parent, known));
    for parameter in &mut all {
        if let Some(change) = change(job, &parameter.name) {
            parameter.default = written(change.value.span);
        }
    }
    for statement in &job.statements {
        let JobStatement::Param(param) = statement else { continue };
        all.retain(|inherited| inherited.name != param.name.node);
        all.extend(param.default.as_ref().map(|value| TemplateParameter {
            name: param.name.node.clone(),
            about: param.doc.first().map_or(String::new(), |line| line.trim().to_string()),
            default: written(value.span),
        }));
    }
    all
}

/// What a job changes of a parameter of the one that it extends.
fn change<'j>(job: &'j Job, parameter: &str) -> Option<&'j Change> {
    job.changes.iter().find(|change| matches!(change.target.segments.as_slice(), [name] if name.node == parameter))
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
    /// The job with its new name and values, and what it uses; and what is left out of what it is expected to be like.
    fn named(self, request: &NewJob) -> Result<(Made, Vec<String>), Failure> {
        let own = Words { text: self.job.name.node.clone(), origin: String::new() };
        let name = request.name.as_ref().unwrap_or(&own);
        let mut values: Vec<(&str, Given)> = Vec::new();
        for (known, value) in &request.values {
            if !self.parameters.iter().any(|parameter| parameter.name == *known) {
                let all: Vec<String> = self.parameters.iter().map(|known| format!("`{}`", known.name)).collect();
                let all = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
                let message = format!("`{}` has no parameter `{known}`; it has: {all}", self.job.name.node);
                return Err(Failure::Input(message));
            }
            // of several values for one parameter the last one counts
            values.retain(|(earlier, _)| earlier != known);
            values.push((known, Given::value(known, value)));
        }
        values.iter().try_for_each(|(_, value)| value.check())?;
        let whole = self.made((name, &values), &[])?;
        let lost = if values.is_empty() { Vec::new() } else { self.lost(&whole, &name.text)? };
        let made = if lost.is_empty() { whole } else { self.made((name, &values), &lost)? };
        Ok((made, lost.into_iter().map(str::to_owned).collect()))
    }

    /// The expectations that are meant for the library's values, and do not hold with others.
    fn lost(&self, made: &Made, name: &str) -> Result<Vec<&'static str>, Failure> {
        let own = own(self.path, self.text, &self.job);
        let all: Vec<&Expecting> = self.inherited.iter().chain(&own).collect();
        let of_values: Vec<&str> =
            all.into_iter().filter(|one| one.expected.is_of_values()).map(|one| one.text).collect();
        if of_values.is_empty() {
            return Ok(of_values);
        }
        let failed = made.failed(name)?;
        Ok(of_values.into_iter().filter(|text| failed.iter().any(|other| other == text)).collect())
    }

    /// The job without expectations that are lost.
    fn made(&self, (name, values): (&Words, &[(&str, Given)]), lost: &[&str]) -> Result<Made, Failure> {
        let (text, job) = self.with_places(&values.iter().map(|(name, _)| *name).collect::<Vec<_>>(), lost);
        let places = values.iter().cloned().filter_map(|(parameter, value)| Some((place(&job, parameter)?, value)));
        let changes = Changes::new(places.chain([(job.name.span, Given::name(name))]).collect());
        let text = changes.applied(&text);
        let mut files = vec![(self.path.with_file_name(format!("{}.chain", name.text)), text.clone())];
        used_by(self.path, &text, &mut files).map_err(Failure::Input)?;
        Ok(Made { files, changes })
    }

    /// The job with the values of these parameters written in it, also where it takes them from the one that it extends.
    fn with_places(&self, parameters: &[&str], lost: &[&str]) -> (Cow<'static, str>, Job) {
        let (text, job) = self.without(lost);
        let lacking = parameters.iter().filter(|name| place(&job, name).is_none());
        let lacking = self.parameters.iter().filter(|known| lacking.clone().any(|name| *name == known.name));
        let changes: Vec<String> = lacking.map(|known| format!("{}: {}", known.name, known.default)).collect();
        let (Some(parent), [_, ..]) = (&job.extends, &changes[..]) else {
            return (text, job);
        };
        let (end, changes) = match job.changes.last() {
            Some(last) => (last.value.span.end, format!(", {}", changes.join(", "))),
            None => (parent.span.end, format!("({})", changes.join(", "))),
        };
        let mut text = text.into_owned();
        text.insert_str(end as usize, &changes);
        self.parsed(text)
    }

    /// The job without these expectations: of those that it inherits it says the others itself.
    fn without(&self, lost: &[&str]) -> (Cow<'static, str>, Job) {
        if lost.is_empty() {
            return (Cow::Borrowed(self.text), self.job.clone());
        }
        let is_lost = |one: &&Expecting| lost.contains(&one.text);
        let mut text = self.text.to_owned();
        if self.inherited.iter().any(|one| is_lost(&one)) {
            let kept: Vec<&Expecting> = self.inherited.iter().filter(|one| !is_lost(one)).collect();
            let folder = self.path.parent().unwrap_or(Path::new(""));
            // before the brace that ends the job
            text.insert_str(self.job.span.end as usize - 1, &anew(&kept, folder));
        }
        for one in own(self.path, self.text, &self.job).iter().filter(is_lost).rev() {
            let place = one.expected.span;
            let (start, end) = (place.start as usize, place.end as usize);
            // with the line that it stands on
            let start = text[..start]
                .rfind('\n')
                .map_or(start, |at| if text[at..start].trim().is_empty() { at } else { start });
            text.replace_range(start..end, "");
        }
        self.parsed(text)
    }

    fn parsed(&self, text: String) -> (Cow<'static, str>, Job) {
        let jobs = parse(&text, FileId(0)).0.items.into_iter();
        let job = jobs.filter_map(|item| if let Item::Job(job) = item { Some(job) } else { None }).next();
        (Cow::Owned(text), job.unwrap_or_else(|| self.job.clone()))
    }
}

/// Where the value of a parameter stands in a job.
fn place(job: &Job, parameter: &str) -> Option<Span> {
    let own = job.statements.iter().find_map(|statement| match statement {
        JobStatement::Param(param) if param.name.node == parameter => Some(param.default.as_ref()?.span),
        _ => None,
    });
    own.or_else(|| Some(change(job, parameter)?.value.span))
}
