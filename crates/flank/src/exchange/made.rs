//! What is made of the library: files that compile, beside what stands there.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{FileId, compile_file, format};
use flank_export::{FileSet, WriteError, make_folder};
use flank_expr::Graph;
use schemars::JsonSchema;
use serde::Serialize;

use crate::exchange::changes::{Changes, Words};
use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::monitor::Unwatched;
use crate::project::shown_path;
use crate::testing::{TestRequest, test_spec};

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

/// Something new.
pub(super) struct Made {
    /// By their path in the user's folder: its own file first, then those that it uses.
    pub(super) files: Vec<(PathBuf, String)>,
    /// What was changed of the template.
    pub(super) changes: Changes,
}

impl Made {
    /// Writes what compiles, and names it: the job's own file first. Nothing that stands there is changed.
    pub(super) fn write(mut self, out: &Path) -> Result<Vec<String>, Failure> {
        self.compiled(out)?;
        // as given values stand there, columns of laws and comments may not line up any more
        if let Ok(laid_out) = format(&self.files[0].1, FileId(0)) {
            self.files[0].1 = laid_out;
        }
        self.check_that_nothing_stands_there(out)?;
        if !is_in_project(out) {
            self.files.push((PathBuf::from(MARKER), MARK.to_owned()));
        }
        put(out, &self.files)?;
        Ok(self.files.iter().map(|(path, _)| shown_path(&out.join(path))).collect())
    }

    /// What the job of this name is expected to be like and is not, as it is written; nothing where it does not compile.
    ///
    /// # Errors
    /// If there is no place to try it, or no memory.
    pub(super) fn failed(&self, name: &str) -> Result<Vec<String>, Failure> {
        let trial = self.trial()?;
        let request = TestRequest { snapshot: false, ..TestRequest::new(trial.path().join(&self.files[0].0)) };
        let tested = test_spec(&request, &Unwatched)?;
        let own = tested.items.into_iter().filter(|item| item.name == name);
        let failed = own.flat_map(|item| item.expectations).filter(|expectation| !expectation.holds);
        Ok(failed.map(|expectation| expectation.place.text).collect())
    }

    /// The files in a folder of their own.
    fn trial(&self) -> Result<tempfile::TempDir, Failure> {
        let no_folder = |error| Failure::Input(format!("no temporary folder: {}", WriteError::from(error)));
        let trial = tempfile::tempdir().map_err(no_folder)?;
        put(trial.path(), &self.files)?;
        Ok(trial)
    }

    /// # Errors
    /// What is wrong with what was given, shown there, or with the files as they would stand in `out`.
    fn compiled(&self, out: &Path) -> Result<(), Failure> {
        let trial = self.trial()?;
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
