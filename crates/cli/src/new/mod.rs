//! `flank new`: a job of the library becomes one of the user's, with the machines and tools that it uses.

mod changes;

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::ast::{Item, Job, JobStatement, Param};
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, closest, compile_file};
use flank_export::{FileSet, WriteError};
use flank_expr::Graph;
use include_dir::{Dir, include_dir};
use serde_json::{Value, json};

use crate::arguments::New;
use crate::failure::Failure;
use crate::{Ending, eprint, files, print, spec};
use changes::{Changes, Given};

/// The library as it was when the program was built.
static LIBRARY: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../specs");

pub(crate) fn run(arguments: &New) -> Result<Ending, Failure> {
    let Some(template) = &arguments.template else {
        print(&if arguments.json { list_as_json() } else { list() });
        return Ok(Ending::Done);
    };
    let name = arguments.name.as_ref().unwrap_or(template);
    let made = find(template)?.named(arguments)?;
    let written = made.write(&arguments.out)?;
    print(&if arguments.json {
        format!("{:#}\n", json!({ "schema": "flank.new/2", "job": name, "spec": written[0], "files": written }))
    } else {
        format!("wrote {}\n\nnow: flank solve {}\n", written.join(", "), written[0])
    });
    Ok(Ending::Done)
}

/// A job of the library.
struct Template {
    /// Its file within the library.
    path: &'static Path,
    text: &'static str,
    doc: String,
    job: Job,
}

/// What the library has to start from.
struct Offer {
    /// The jobs that stand alone in their file, by name.
    templates: BTreeMap<String, Template>,
    /// Files whose jobs belong together, with their names: none of them is made into a file of its own.
    together: BTreeMap<&'static Path, Vec<String>>,
}

fn offer() -> Offer {
    let mut offer = Offer { templates: BTreeMap::new(), together: BTreeMap::new() };
    for (path, text) in files(&LIBRARY) {
        let (file, _) = parse(text, FileId(0));
        let jobs = file.items.into_iter().filter_map(|item| if let Item::Job(job) = item { Some(job) } else { None });
        let mut jobs: Vec<Job> = jobs.collect();
        match jobs.len() {
            0 => {}
            1 => {
                let (job, doc) = (jobs.remove(0), first_sentence(&file.doc));
                offer.templates.insert(job.name.node.clone(), Template { path, text, doc, job });
            }
            _ => {
                offer.together.insert(path, jobs.into_iter().map(|job| job.name.node).collect());
            }
        }
    }
    offer
}

/// Whether a file of the library defines something of a name.
pub(crate) fn defines(path: &str, name: &str) -> bool {
    let text = LIBRARY.get_file(path).and_then(|file| file.contents_utf8()).unwrap_or_default();
    parse(text, FileId(0)).0.items.iter().filter_map(Item::name).any(|known| known.node == name)
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

fn list() -> String {
    let Offer { templates, together } = offer();
    let width = templates.keys().map(String::len).max().unwrap_or(0);
    let mut out = "Jobs to start from, as in `flank new helical_gear --name my_gear`:\n".to_string();
    templates.iter().for_each(|(name, template)| out += &format!("  {name:width$}  {}\n", template.doc));
    out += "\nJobs that belong together in one file are not made into files of their own; to start from them copy theirs:\n";
    together.iter().for_each(|(path, jobs)| out += &format!("  {}: {}\n", in_library(path), jobs.join(", ")));
    out
}

fn in_library(path: &Path) -> String {
    format!("specs/{}", spec::shown(path))
}

fn list_as_json() -> String {
    let Offer { templates, together } = offer();
    let all: Vec<Value> =
        templates.iter().map(|(name, template)| json!({ "name": name, "about": template.doc })).collect();
    let together: Vec<Value> =
        together.iter().map(|(path, jobs)| json!({ "file": in_library(path), "jobs": jobs })).collect();
    format!("{:#}\n", json!({ "schema": "flank.templates/2", "templates": all, "together": together }))
}

/// # Errors
/// Why there is nothing to start from under that name.
fn find(name: &str) -> Result<Template, Failure> {
    let Offer { mut templates, together } = offer();
    templates.remove(name).ok_or_else(|| {
        let beside = together.iter().find(|(_, jobs)| jobs.iter().any(|job| job == name));
        Failure::of_usage(match beside {
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
                let known = templates.keys().chain(together.values().flatten()).map(String::as_str);
                let near = of_file.map(|(job, _)| job.as_str()).or_else(|| closest(&stem, known));
                let near = near.map_or(String::new(), |near| format!(", did you mean `{near}`?"));
                format!("the library has no job `{name}`{near}; `flank new` lists them")
            }
        })
    })
}

impl Template {
    /// The job with its new name and values, and what it uses.
    fn named(self, arguments: &New) -> Result<Made, Failure> {
        let name = arguments.name.as_deref().unwrap_or(&self.job.name.node);
        let parameters: Vec<&Param> = self
            .job
            .statements
            .iter()
            .filter_map(|statement| if let JobStatement::Param(param) = statement { Some(param) } else { None })
            .collect();
        let mut values = Vec::new();
        for (known, value) in &arguments.set {
            let parameter = parameters.iter().find(|parameter| parameter.name.node == *known).ok_or_else(|| {
                let all: Vec<String> = parameters.iter().map(|known| format!("`{}`", known.name.node)).collect();
                let all = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
                format!("`{}` has no parameter `{known}`; it has: {all}", self.job.name.node)
            })?;
            // of several values for one parameter the last one counts
            values.retain(|(earlier, _): &(&&Param, Given)| earlier.name.node != *known);
            values.push((parameter, Given::value("--set", known, value)));
        }
        if arguments.ask {
            let open =
                parameters.iter().filter(|known| !values.iter().any(|(set, _)| set.name.node == known.name.node));
            values.extend(self.asked(&open.collect::<Vec<_>>()));
        }
        values.iter().try_for_each(|(_, value)| value.check())?;
        let places =
            values.into_iter().filter_map(|(parameter, value)| Some((parameter.default.as_ref()?.span, value)));
        let changes = Changes::new(places.chain([(self.job.name.span, Given::name(name))]).collect());
        let mut files = vec![(self.path.with_file_name(format!("{name}.chain")), changes.applied(self.text))];
        used_by(self.path, self.text, &mut files)?;
        Ok(Made { files, changes })
    }

    /// The values that the user gives parameters when asked; the others stay as they are.
    fn asked<'p, 'a>(&self, parameters: &[&'p &'a Param]) -> Vec<(&'p &'a Param, Given)> {
        let mut values = Vec::new();
        for (at, parameter) in parameters.iter().enumerate() {
            let Some(default) = &parameter.default else { continue };
            let (name, default) =
                (&parameter.name.node, &self.text[default.span.start as usize..default.span.end as usize]);
            let about = parameter.doc.first().map_or(String::new(), |line| format!(" ({})", line.trim()));
            eprint(&format!("{name}{about} [{default}]: "));
            let mut answer = String::new();
            if !matches!(std::io::stdin().lock().read_line(&mut answer), Ok(1..)) {
                let open: Vec<&str> = parameters[at..].iter().map(|open| open.name.node.as_str()).collect();
                eprint(&format!("\nnote: nobody answers any more; {} keep their values\n", open.join(", ")));
                break;
            }
            match answer.trim() {
                "" => {}
                answer => values.push((*parameter, Given::value("--ask", name, answer))),
            }
        }
        values
    }
}

/// Adds what a file of the library uses, and what that uses.
fn used_by(path: &Path, text: &str, all: &mut Vec<(PathBuf, String)>) -> Result<(), String> {
    let (file, _) = parse(text, FileId(0));
    for item in file.items {
        let Item::Use(used) = item else { continue };
        let path = plain(&path.with_file_name(used.node));
        if all.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let text = LIBRARY.get_file(&path).and_then(|file| file.contents_utf8());
        let text = text.ok_or_else(|| format!("the library lacks {}", spec::shown(&path)))?;
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

/// A new job.
struct Made {
    /// By their path in the user's folder: the job's own file first, then those that it uses.
    files: Vec<(PathBuf, String)>,
    /// What was changed of the template.
    changes: Changes,
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
        Ok(self.files.iter().map(|(path, _)| spec::shown(&out.join(path))).collect())
    }

    /// # Errors
    /// What is wrong with what was given, shown there, or with the files as they would stand in `out`.
    fn compiled(&self, out: &Path) -> Result<(), Failure> {
        let trial = tempfile::tempdir().map_err(|error| format!("no temporary folder: {}", WriteError::from(error)))?;
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
        Err(Failure::of_spec(findings, sources))
    }

    fn check_that_nothing_stands_there(&self, out: &Path) -> Result<(), String> {
        for (number, (path, text)) in self.files.iter().enumerate() {
            let path = out.join(path);
            let shown = spec::shown(&path);
            let why = match std::fs::read(&path) {
                Ok(there) if there == text.as_bytes() => continue,
                Ok(_) => "says something else",
                Err(error) if is_absent(&error) => continue,
                Err(error) => &format!("cannot be read ({error})"),
            };
            let way = match number {
                0 => "--out names another folder, --name another job",
                _ => "the new job is made with the library's: take another folder with --out",
            };
            return Err(format!("{shown} is there already and {why}; {way}"));
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

fn put(folder: &Path, files: &[(PathBuf, String)]) -> Result<(), String> {
    let mut set = FileSet::default();
    for (path, text) in files {
        let path = folder.join(path);
        let folder = path.parent().unwrap_or(folder);
        files::made(folder)?;
        set.write(&path, |out| Ok(out.write_all(text.as_bytes())?)).map_err(|error| error.to_string())?;
    }
    set.finish().map_err(|error| error.to_string())
}
