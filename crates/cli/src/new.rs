//! `flank new`: a job of the library becomes one of the user's, with the machines and tools that it uses.

use std::collections::BTreeMap;
use std::io::{BufRead, Write};
use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::ast::{Item, Job, JobStatement, Param};
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, Span, compile_file};
use flank_export::write_atomically;
use flank_expr::Graph;
use include_dir::{Dir, include_dir};
use serde_json::{Value, json};

use crate::arguments::New;
use crate::failure::Failure;
use crate::{Ending, print, spec};

/// The library as it was when the program was built.
static LIBRARY: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../specs");

pub(crate) fn run(arguments: &New) -> Result<Ending, Failure> {
    let Some(template) = &arguments.template else {
        print(&if arguments.json { list_as_json() } else { list() });
        return Ok(Ending::Done);
    };
    let files = find(template)?.named(arguments)?;
    let written = write(&files, arguments)?;
    print(&if arguments.json {
        format!("{:#}\n", json!({ "schema": "flank.new/1", "job": written[0], "files": written }))
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

/// The jobs of the library that stand alone in their file, by name.
fn templates() -> BTreeMap<String, Template> {
    let found = files(&LIBRARY).filter_map(|(path, text)| {
        let (file, _) = parse(text, FileId(0));
        let mut jobs =
            file.items.into_iter().filter_map(|item| if let Item::Job(job) = item { Some(job) } else { None });
        let (job, None) = (jobs.next()?, jobs.next()) else { return None };
        let doc = file.doc.first().map_or("", |line| line.trim()).to_owned();
        Some((job.name.node.clone(), Template { path, text, doc, job }))
    });
    found.collect()
}

fn files(folder: &'static Dir<'static>) -> impl Iterator<Item = (&'static Path, &'static str)> {
    let inner = folder.dirs().flat_map(|inner| files(inner).collect::<Vec<_>>());
    folder.files().filter_map(|file| Some((file.path(), file.contents_utf8()?))).chain(inner)
}

fn list() -> String {
    let templates = templates();
    let width = templates.keys().map(String::len).max().unwrap_or(0);
    let lines = templates.iter().map(|(name, template)| format!("  {name:width$}  {}\n", template.doc));
    format!("Jobs to start from, as in `flank new {}`:\n{}", "helical_gear --name my_gear", lines.collect::<String>())
}

fn list_as_json() -> String {
    let all: Vec<Value> =
        templates().iter().map(|(name, template)| json!({ "name": name, "about": template.doc })).collect();
    format!("{:#}\n", json!({ "schema": "flank.templates/1", "templates": all }))
}

fn find(name: &str) -> Result<Template, String> {
    let mut templates = templates();
    templates.remove(name).ok_or_else(|| {
        let near = templates.keys().min_by_key(|known| strsim::osa_distance(known, name));
        let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        format!("the library has no job `{name}`{near} `flank new` lists them")
    })
}

impl Template {
    /// The files of the new job, by their path: its own first.
    fn named(self, arguments: &New) -> Result<Vec<(PathBuf, String)>, String> {
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
            values.push((parameter, value.clone()));
        }
        if arguments.ask {
            let open =
                parameters.iter().filter(|known| !values.iter().any(|(set, _)| set.name.node == known.name.node));
            let asked: Vec<_> = open.filter_map(|parameter| Some((parameter, self.asked(parameter)?))).collect();
            values.extend(asked);
        }
        let mut changes: Vec<(Span, String)> = values
            .into_iter()
            .filter_map(|(parameter, value)| Some((parameter.default.as_ref()?.span, value)))
            .chain([(self.job.name.span, name.to_owned())])
            .collect();
        changes.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
        let mut text = self.text.to_owned();
        for (span, value) in changes {
            text.replace_range(span.start as usize..span.end as usize, &value);
        }
        let mut all = vec![(self.path.with_file_name(format!("{name}.chain")), text)];
        used_by(self.path, self.text, &mut all)?;
        Ok(all)
    }

    /// The value that the user gives a parameter; nothing if it stays as it is.
    fn asked(&self, parameter: &Param) -> Option<String> {
        let span = parameter.default.as_ref()?.span;
        let default = &self.text[span.start as usize..span.end as usize];
        let about = parameter.doc.first().map_or(String::new(), |line| format!(" ({})", line.trim()));
        anstream::eprint!("{}{about} [{default}]: ", parameter.name.node);
        let _ = std::io::stderr().flush();
        let mut answer = String::new();
        std::io::stdin().lock().read_line(&mut answer).ok()?;
        Some(answer.trim().to_owned()).filter(|answer| !answer.is_empty())
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

/// Writes what compiles, and names it: the job's own file first. Nothing that stands there is changed.
fn write(files: &[(PathBuf, String)], arguments: &New) -> Result<Vec<String>, Failure> {
    let trial = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    put(trial.path(), files)?;
    let graph = Graph::new();
    let compilation = compile_file(&graph, &trial.path().join(&files[0].0), &[]);
    if compilation.has_errors() {
        return Err(Failure::of_spec(&compilation.diagnostics, &compilation.sources));
    }
    for (path, text) in files {
        let there = std::fs::read_to_string(arguments.out.join(path)).ok();
        if there.is_some_and(|there| there != *text) {
            let path = spec::shown(&arguments.out.join(path));
            return Err(format!(
                "{path} is there already and says something else; --out names another folder, --name another job"
            )
            .into());
        }
    }
    put(&arguments.out, files)?;
    Ok(files.iter().map(|(path, _)| spec::shown(&arguments.out.join(path))).collect())
}

fn put(folder: &Path, files: &[(PathBuf, String)]) -> Result<(), String> {
    for (path, text) in files {
        let path = folder.join(path);
        let folder = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
        write_atomically(&path, |out| Ok(out.write_all(text.as_bytes())?)).map_err(|error| error.to_string())?;
    }
    Ok(())
}
