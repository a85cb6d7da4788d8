//! From the command line's file to jobs, with the findings told on the way.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{Buffers, Disk, Files, Project};
use flank_chain_dsl::limits::FILE_BYTES;
use flank_chain_dsl::{Compilation, Diagnostic, Job, Request, Sources, compile_request, read_other_file};
use flank_expr::Graph;
use sha2::{Digest, Sha256};

use crate::arguments::Which;
use crate::eprint;
use crate::failure::{Failure, in_full};

/// The jobs that are asked for. Warnings are told.
///
/// # Errors
/// What is wrong with the spec.
pub(crate) fn jobs<'g>(graph: &'g Graph, which: &Which) -> Result<(Compilation<'g>, Vec<Job<'g>>), Failure> {
    which.check()?;
    let mut compilation = sound(compiled(graph, &which.file, which.request())?)?;
    let jobs = asked_for(&mut compilation, which)?;
    Ok((compilation, jobs))
}

/// What becomes of a file, or of the standard input where that is called `-`.
///
/// # Errors
/// If the standard input cannot be read.
pub(crate) fn compiled<'g>(graph: &'g Graph, file: &Path, request: Request<'_>) -> Result<Compilation<'g>, Failure> {
    Ok(compile_request(graph, file, &Request { files: files(file)?, ..request }))
}

/// A spec with the files that it uses.
///
/// # Errors
/// If the standard input cannot be read.
pub(crate) fn project(file: &Path) -> Result<Project, Failure> {
    Ok(Project::open(file, files(file)?))
}

/// The disk, with the standard input in the place of a file that is called `-`.
fn files(file: &Path) -> Result<Arc<dyn Files>, Failure> {
    let disk = Arc::new(Disk);
    Ok(if is_stdin(file) { Arc::new(Buffers::over(disk).with(file, stdin()?)) } else { disk })
}

pub(crate) fn is_stdin(file: &Path) -> bool {
    file.as_os_str() == "-"
}

/// A spec from the standard input; one byte more than a file may have, so that a longer text is refused and not cut.
///
/// # Errors
/// Why it cannot be read.
fn stdin() -> Result<String, Failure> {
    let mut text = String::new();
    let read = std::io::stdin().take(FILE_BYTES.most as u64 + 1).read_to_string(&mut text);
    read.map_err(|error| format!("cannot read the standard input: {error}"))?;
    Ok(text)
}

/// A compilation without errors, whose warnings are told.
///
/// # Errors
/// All findings, if one is an error.
pub(crate) fn sound(compilation: Compilation<'_>) -> Result<Compilation<'_>, Failure> {
    if compilation.has_errors() {
        return Err(Failure::of_spec(&compilation.diagnostics, &compilation.sources));
    }
    tell(&compilation.diagnostics, &compilation.sources);
    Ok(compilation)
}

/// The jobs of a compilation that are asked for.
///
/// # Errors
/// Which there are, if there is none of that name, or none at all.
pub(crate) fn asked_for<'g>(compilation: &mut Compilation<'g>, which: &Which) -> Result<Vec<Job<'g>>, Failure> {
    let jobs = compilation.take_jobs(which.job.as_deref());
    let jobs = jobs.map_err(|finding| Failure::of_spec(&[finding], &compilation.sources))?;
    eprint(&set_in_several(which, &jobs));
    Ok(jobs)
}

/// The values that were set by hand and change several jobs; empty if none does.
fn set_in_several(which: &Which, jobs: &[Job<'_>]) -> String {
    let mut out = String::new();
    for (name, _) in &which.set {
        let changed = jobs.iter().filter(|job| which.changes(name, job));
        let changed: Vec<&str> = changed.map(|job| job.name.as_str()).collect();
        if let [first, _, ..] = changed[..] {
            out += &format!(
                "note: `--set {name}` changes {} jobs: {}; `--set {first}.{name}=…` changes one\n",
                changed.len(),
                changed.join(", ")
            );
        }
    }
    out
}

/// Shows findings with the source underlined, and where to read more about the first error.
pub(crate) fn tell(diagnostics: &[Diagnostic], sources: &Sources) {
    eprint(&in_full(diagnostics, sources));
}

/// What a command read: where all that it writes comes from, and what it must not write over.
#[derive(Debug, Default)]
pub(crate) struct Origin {
    /// SHA-256 of all texts of the compilation, in its order.
    pub(crate) hash: String,
    /// All files, without links.
    files: Vec<PathBuf>,
}

impl Origin {
    pub(crate) fn of(compilation: &Compilation<'_>) -> Origin {
        let mut hash = Sha256::new();
        for (_, source) in compilation.sources.files() {
            hash.update((source.text.len() as u64).to_le_bytes());
            hash.update(source.text.as_bytes());
        }
        let hash = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Origin { hash, files: compilation.sources.files().filter_map(|(_, source)| source.file.clone()).collect() }
    }

    /// Reads a file that is no spec, of at most so many bytes.
    ///
    /// # Errors
    /// Why it cannot be read, in the words that are said of specs.
    pub(crate) fn other_text(&mut self, path: &Path, most: usize) -> Result<String, Failure> {
        let mut sources = Sources::default();
        match read_other_file(&Disk, &mut sources, path, most) {
            Ok(id) => {
                let source = sources.file(id);
                self.files.extend(source.file.clone());
                Ok(source.text.clone())
            }
            Err(finding) => Err(Failure::of_spec(&[finding], &sources)),
        }
    }

    /// Whether a path leads to something that was read.
    pub(crate) fn holds(&self, path: &Path) -> bool {
        std::fs::canonicalize(path).is_ok_and(|there| self.files.contains(&there))
    }
}

/// A path as messages show it: with forward slashes, the same on every system.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}
