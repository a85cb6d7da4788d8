//! From a spec to jobs, with the findings reported on the way.

use std::path::{Path, PathBuf};

use flank_chain_dsl::{
    Compilation, Diagnostic, Files, GeneratedSurface, Job, Sources, Span, compile_request, read_other_file,
};
use flank_expr::Graph;
use sha2::{Digest, Sha256};

use crate::project::failure::Failure;
use crate::project::findings::{Findings, Place};
use crate::project::monitor::Monitor;
use crate::project::remark::{Message, Remark, RemarkKind};
use crate::project::requests::JobSelection;

/// The jobs that are asked for. Warnings go to the monitor.
///
/// # Errors
/// What is wrong with the spec.
pub(crate) fn jobs<'g>(
    graph: &'g Graph,
    which: &JobSelection,
    monitor: &dyn Monitor,
) -> Result<(Compilation<'g>, Vec<Job<'g>>), Failure> {
    which.check()?;
    let mut compilation = sound(compile_request(graph, which.file(), &which.request()), monitor)?;
    let jobs = asked_for(&mut compilation, (which, which.job.as_slice()), monitor)?;
    Ok((compilation, jobs))
}

/// The jobs that are asked for, without those that none of these surfaces can be of: `basic.concave` is one of job `basic`.
///
/// # Errors
/// What is wrong with the spec.
pub(crate) fn jobs_of_surfaces<'g>(
    graph: &'g Graph,
    which: &JobSelection,
    surfaces: &[&str],
    monitor: &dyn Monitor,
) -> Result<(Compilation<'g>, Vec<Job<'g>>), Failure> {
    let mut request = which.request();
    let named: Option<Vec<&str>> = surfaces.iter().map(|surface| surface.split_once('.').map(|(job, _)| job)).collect();
    if request.jobs.is_empty() {
        request.jobs = named.unwrap_or_default();
    }
    which.check()?;
    let wanted = request.jobs.clone();
    let mut compilation = sound(compile_request(graph, which.file(), &request), monitor)?;
    // a name without a job is told with all surfaces that there are
    let are_there = wanted.iter().all(|name| compilation.jobs.iter().any(|job| job.name == *name));
    let jobs = asked_for(&mut compilation, (which, if are_there { &wanted[..] } else { &[] }), monitor)?;
    Ok((compilation, jobs))
}

/// A compilation without errors, whose warnings go to the monitor.
///
/// # Errors
/// All findings, if one is an error.
pub(crate) fn sound<'g>(compilation: Compilation<'g>, monitor: &dyn Monitor) -> Result<Compilation<'g>, Failure> {
    if compilation.diagnostics.is_empty() {
        return Ok(compilation);
    }
    let findings = Findings::new(&compilation.diagnostics, &compilation.sources);
    if compilation.has_errors() {
        return Err(Failure::Findings(findings));
    }
    monitor.warn(&findings);
    Ok(compilation)
}

/// The jobs of a compilation that are asked for: of these names, or all.
///
/// # Errors
/// Which there are, if there is none of these names, or none at all; what is set in others alone.
pub(crate) fn asked_for<'g>(
    compilation: &mut Compilation<'g>,
    (which, wanted): (&JobSelection, &[impl AsRef<str>]),
    monitor: &dyn Monitor,
) -> Result<Vec<Job<'g>>, Failure> {
    let jobs = compilation.take_jobs(wanted);
    let jobs = jobs.map_err(|findings| Failure::Findings(Findings::new(&findings, &compilation.sources)))?;
    set_in_several(which, &jobs).iter().for_each(|remark| monitor.remark(remark));
    Ok(jobs)
}

/// The values that were set by hand and change several jobs.
fn set_in_several(which: &JobSelection, jobs: &[Job<'_>]) -> Vec<Remark> {
    let remark = |(name, _): &(String, String)| {
        let changed = jobs.iter().filter(|job| which.changes(name, job));
        let changed: Vec<&str> = changed.map(|job| job.name.as_str()).collect();
        let [first, _, ..] = changed[..] else { return None };
        let message = format!(
            "the option `set {name}` changes {} jobs: {}; the option `set {first}.{name}=…` changes one",
            changed.len(),
            changed.join(", ")
        );
        Some(Remark::new(RemarkKind::SeveralJobs, name, message))
    };
    which.set.iter().filter_map(remark).collect()
}

/// What a command read: where all that it writes comes from, and what it must not write over.
#[derive(Debug, Default)]
pub(crate) struct Origin {
    /// SHA-256 of all texts of the compilation, in its order.
    pub(crate) hash: String,
    /// All files, without links.
    files: Vec<PathBuf>,
    sources: Sources,
}

impl Origin {
    /// Of files that are read, without links.
    pub(crate) fn of_files(files: &[PathBuf]) -> Origin {
        Origin { files: files.to_vec(), ..Origin::default() }
    }

    pub(crate) fn of_compilation(compilation: &Compilation<'_>) -> Origin {
        let mut hash = Sha256::new();
        for (_, source) in compilation.sources.files() {
            hash.update((source.text.len() as u64).to_le_bytes());
            hash.update(source.text.as_bytes());
        }
        let hash = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        let files = compilation.sources.files().filter_map(|(_, source)| source.file.clone()).collect();
        Origin { hash, files, sources: compilation.sources.clone() }
    }

    /// Findings in the texts that were read, which end an operation.
    pub(crate) fn findings(&self, diagnostics: &[Diagnostic]) -> Failure {
        Failure::Findings(Findings::new(diagnostics, &self.sources))
    }

    /// A place in the texts that were read.
    pub(crate) fn place(&self, span: Span) -> Place {
        Place::of_span(&self.sources, span)
    }

    /// Messages about surfaces and solids of some jobs, with the places where these are named: `concave`, or with its job `pinion.concave`.
    pub(crate) fn located<Kind>(&self, jobs: &[&Job<'_>], mut messages: Vec<Message<Kind>>) -> Vec<Message<Kind>> {
        let surfaces = || jobs.iter().flat_map(|job| job.surfaces.iter().map(move |surface| (&job.name, surface)));
        for message in &mut messages {
            let Some(name) = &message.of else { continue };
            let is_meant = |(job, surface): &(&String, &GeneratedSurface<'_>)| {
                surface.name == *name || format!("{job}.{}", surface.name) == *name
            };
            let surface = surfaces().find(is_meant).map(|(_, surface)| surface.written);
            let solid = || jobs.iter().flat_map(|job| &job.solids).find(|solid| solid.name == *name);
            let want = || jobs.iter().flat_map(|job| &job.wants).find(|want| want.name == *name);
            let found =
                surface.or_else(|| solid().map(|solid| solid.written)).or_else(|| want().map(|want| want.written));
            message.place = found.map(|written| self.place(written));
        }
        messages
    }

    /// Reads a file that is no spec, of at most so many bytes.
    ///
    /// # Errors
    /// Why it cannot be read, in the words used for specs.
    pub(crate) fn other_text(&mut self, files: &dyn Files, path: &Path, most: usize) -> Result<String, Failure> {
        let mut sources = Sources::default();
        match read_other_file(files, &mut sources, path, most) {
            Ok(id) => {
                let source = sources.file(id);
                self.files.extend(source.file.clone());
                Ok(source.text.clone())
            }
            Err(finding) => Err(Failure::Findings(Findings::new(&[finding], &sources))),
        }
    }

    /// Whether a path leads to something that was read.
    pub(crate) fn holds(&self, path: &Path) -> bool {
        std::fs::canonicalize(path).is_ok_and(|there| self.files.contains(&there))
    }
}
