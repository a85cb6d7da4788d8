//! From the command line's file to jobs, with the findings told on the way.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{Compilation, Diagnostic, Job, Sources, compile_file, read_other_file};
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
    let mut compilation = sound(compile_file(graph, &which.file, &which.set))?;
    let jobs = asked_for(&mut compilation, which)?;
    Ok((compilation, jobs))
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
    jobs.map_err(|finding| Failure::of_spec(&[finding], &compilation.sources))
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
        match read_other_file(&mut sources, path, most) {
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
