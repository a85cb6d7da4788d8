//! A job of the library becomes one of the user's, with the machines and tools that it uses; so does a machine or a tool by itself.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::ast::{Item, Job, JobStatement, Param};
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, closest, compile_file};
use flank_export::{FileSet, WriteError, make_folder};
use flank_expr::Graph;
use include_dir::{Dir, include_dir};
use schemars::JsonSchema;
use serde::Serialize;

use crate::exchange::changes::{Changes, Given, Words};
use crate::exchange::parts;
use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::shown_path;

/// The library as it was when the program was built.
static LIBRARY: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../specs");

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

/// A job to be made of one of the library, or a machine or tool of it.
#[derive(Clone, Debug)]
pub struct NewJob {
    /// The job, machine or tool to start from.
    pub template: String,
    /// What the new job is called, as the template without it; of a machine the name of a variant.
    pub name: Option<Words>,
    /// Other values for parameters; of several for one the last one counts.
    pub values: Vec<(String, Words)>,
    /// The folder for the files; made if it is not there.
    pub folder: PathBuf,
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

/// What can be made of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MadeKind {
    /// A job.
    Job,
    /// A machine, or a variant of one.
    Machine,
    /// A tool.
    Tool,
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
    for (path, text) in library() {
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

/// Whether a file of the library defines something of a name.
pub(crate) fn defines(path: &str, name: &str) -> bool {
    let text = LIBRARY.get_file(path).and_then(|file| file.contents_utf8()).unwrap_or_default();
    parse(text, FileId(0)).0.items.iter().filter_map(Item::name).any(|known| known.node == name)
}

pub(super) fn library() -> impl Iterator<Item = (&'static Path, &'static str)> {
    files(&LIBRARY)
}

fn files(folder: &'static Dir<'static>) -> impl Iterator<Item = (&'static Path, &'static str)> {
    let inner = folder.dirs().flat_map(|inner| files(inner).collect::<Vec<_>>());
    folder.files().filter_map(|file| Some((file.path(), file.contents_utf8()?))).chain(inner)
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

/// Adds what a file of the library uses, and what that uses.
pub(super) fn used_by(path: &Path, text: &str, all: &mut Vec<(PathBuf, String)>) -> Result<(), String> {
    let (file, _) = parse(text, FileId(0));
    for item in file.items {
        let Item::Use(used) = item else { continue };
        let path = plain(&path.with_file_name(used.node));
        if all.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let text = LIBRARY.get_file(&path).and_then(|file| file.contents_utf8());
        let text = text.ok_or_else(|| format!("the library lacks {}", shown_path(&path)))?;
        all.push((path.clone(), text.to_owned()));
        used_by(&path, text, all)?;
    }
    Ok(())
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut out, part| {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
        out
    })
}

/// Something new.
pub(super) struct Made {
    /// By their path in the user's folder: its own file first, then those that it uses.
    pub(super) files: Vec<(PathBuf, String)>,
    /// What was changed of the template.
    pub(super) changes: Changes,
}

impl Made {
    /// Writes what compiles, and names it: the job's own file first. Nothing that stands there is changed.
    fn write(mut self, out: &Path) -> Result<Vec<String>, Failure> {
        self.compiled(out)?;
        self.check_that_nothing_stands_there(out)?;
        if !is_in_project(out) {
            self.files.push((PathBuf::from(MARKER), MARK.to_owned()));
        }
        put(out, &self.files)?;
        Ok(self.files.iter().map(|(path, _)| shown_path(&out.join(path))).collect())
    }

    /// # Errors
    /// What is wrong with what was given, shown there, or with the files as they would stand in `out`.
    fn compiled(&self, out: &Path) -> Result<(), Failure> {
        let no_folder = |error| Failure::Input(format!("no temporary folder: {}", WriteError::from(error)));
        let trial = tempfile::tempdir().map_err(no_folder)?;
        put(trial.path(), &self.files)?;
        let file = trial.path().join(&self.files[0].0);
        let graph = Graph::new();
        let mut compilation = compile_file(&graph, &file, &[]);
        if !compilation.has_errors() {
            return Ok(());
        }
        let (sources, findings) = (&mut compilation.sources, &mut compilation.diagnostics);
        let own = sources.files().find(|(_, source)| source.path == file).map(|(id, _)| id);
        if let Some(own) = own {
            self.changes.shown_as_given(findings, own, sources);
        }
        sources.show_below(trial.path(), out);
        Err(Failure::Findings(Findings::new(findings, sources)))
    }

    fn check_that_nothing_stands_there(&self, out: &Path) -> Result<(), Failure> {
        for (number, (path, text)) in self.files.iter().enumerate() {
            let path = out.join(path);
            let shown = shown_path(&path);
            let why = match std::fs::read(&path) {
                Ok(there) if there == text.as_bytes() => continue,
                Ok(_) => "says something else",
                Err(error) if is_absent(&error) => continue,
                Err(error) => &format!("cannot be read ({error})"),
            };
            let way = match number {
                0 => "take another folder, or another name",
                _ => "what is new is made with the library's: take another folder",
            };
            return Err(Failure::Input(format!("{shown} is there already and {why}; {way}")));
        }
        Ok(())
    }
}

/// The file that marks the top folder of a project: files use each other below it, from wherever the program is called.
const MARKER: &str = "flank.toml";
const MARK: &str = "# The top folder of a project of flank: its files may use each other.\n";

/// Whether files in a folder, which may not be there yet, are in a project already.
fn is_in_project(out: &Path) -> bool {
    let Ok(out) = std::path::absolute(out) else { return false };
    let real = out.ancestors().find_map(|folder| std::fs::canonicalize(folder).ok());
    let folders = real.iter().flat_map(|folder| folder.ancestors()).chain([out.as_path()]);
    folders.into_iter().any(|folder| [".git", MARKER].iter().any(|mark| folder.join(mark).exists()))
}

/// Whether a file cannot be read because there is none: `NotADirectory` is what stands where its folder should be, which is told
/// when the folder is made.
fn is_absent(error: &std::io::Error) -> bool {
    matches!(error.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory)
}

fn put(folder: &Path, files: &[(PathBuf, String)]) -> Result<(), Failure> {
    let mut set = FileSet::default();
    for (path, text) in files {
        let path = folder.join(path);
        make_folder(path.parent().unwrap_or(folder))?;
        set.write(&path, |out| Ok(out.write_all(text.as_bytes())?))?;
    }
    Ok(set.finish()?)
}
