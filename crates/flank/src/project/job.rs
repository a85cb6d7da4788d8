//! A job by itself.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::{Buffers, Compilation, ValueSource, compile_request};
use flank_expr::Graph;

use crate::project::Project;
use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::monitor::Unwatched;
use crate::project::requests::JobSelection;
use crate::project::{spec, units};

/// One job of a project with its values. It holds all texts that it is made of, so that it stays the same whatever becomes of their
/// files, and goes from thread to thread. Operations compile it again, each in a graph of its own: that takes milliseconds.
#[derive(Clone, Debug)]
pub struct Job {
    name: String,
    set: Vec<(String, String)>,
    project: Project,
    hash: String,
    texts: Arc<[(PathBuf, String)]>,
    doc: Vec<String>,
    parameters: Vec<JobParameter>,
    surfaces: Vec<JobSurface>,
    warnings: Findings,
}

/// A parameter or a setting of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobParameter {
    /// `teeth`; of a machine or a tool `m.swivel`.
    pub name: String,
    /// In its unit.
    pub value: f64,
    /// `mm`, `deg`, products of mm and rad; empty for a plain number.
    pub unit: String,
    /// Whether it is a whole number.
    pub is_count: bool,
    /// Whether it says how a machine differs from the nominal one, in which it is zero.
    pub is_error: bool,
    /// Between which values it must lie, in its unit, if that is stated.
    pub range: Option<[f64; 2]>,
    /// What it is set in multiples of, in its unit, if that is stated.
    pub step: Option<f64>,
    /// Its doc comment, line by line.
    pub doc: Vec<String>,
    /// Who gives it its value.
    pub given_by: ValueSource,
}

/// A surface that a job generates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobSurface {
    /// Its name.
    pub name: String,
    /// The frame that it is in.
    pub frame: String,
    /// Rows and columns of its sample, if it is sampled.
    pub counts: Option<[usize; 2]>,
}

impl Project {
    /// A job of the spec, with other values for parameters and settings as in [`JobSelection::set`].
    ///
    /// # Errors
    /// What is wrong with the spec or the values, or that there is no such job.
    pub fn job(&self, name: &str, set: &[(String, String)]) -> Result<Job, Failure> {
        Ok(self.compiled_jobs(Some(name), set)?.remove(0))
    }

    /// All jobs of the spec, in its order, with other values for parameters and settings as in [`JobSelection::set`].
    ///
    /// # Errors
    /// What is wrong with the spec or the values, or that there is no job.
    pub fn jobs(&self, set: &[(String, String)]) -> Result<Vec<Job>, Failure> {
        self.compiled_jobs(None, set)
    }

    fn compiled_jobs(&self, name: Option<&str>, set: &[(String, String)]) -> Result<Vec<Job>, Failure> {
        let asked = JobSelection { project: self.clone(), job: name.map(str::to_string), set: set.to_vec() };
        asked.check()?;
        let graph = Graph::new();
        let mut compilation = compile_request(&graph, self.file(), &asked.request());
        let findings = Findings::new(&compilation.diagnostics, &compilation.sources);
        if compilation.has_errors() {
            return Err(Failure::Findings(findings));
        }
        let jobs = spec::asked_for(&mut compilation, (&asked, asked.job.as_slice()), &Unwatched)?;
        let texts = texts(&compilation);
        let files = texts.iter().fold(Buffers::over(self.shared_files()), |files, (file, text)| files.with(file, text));
        let project = Project::open(self.file(), Arc::new(files));
        let hash = spec::Origin::of_compilation(&compilation).hash;
        // of several jobs each has its own
        let set_of = |job: &flank_chain_dsl::Job<'_>| match name {
            Some(_) => set.to_vec(),
            None => set.iter().filter(|(name, _)| asked.changes(name, job)).cloned().collect(),
        };
        let job = |job: &flank_chain_dsl::Job<'_>| Job {
            name: job.name.clone(),
            set: set_of(job),
            project: project.clone(),
            hash: hash.clone(),
            texts: Arc::clone(&texts),
            doc: job.doc.clone(),
            parameters: job.parameters.iter().map(JobParameter::new).collect(),
            surfaces: job.surfaces.iter().map(JobSurface::new).collect(),
            warnings: findings.clone(),
        };
        Ok(jobs.iter().map(job).collect())
    }
}

/// All texts that were read, by the paths of their files without links.
fn texts(compilation: &Compilation<'_>) -> Arc<[(PathBuf, String)]> {
    let texts = compilation.sources.files();
    texts.filter_map(|(_, source)| Some((source.file.clone()?, source.text.clone()))).collect()
}

impl JobParameter {
    fn new(of: &flank_chain_dsl::Parameter<'_>) -> JobParameter {
        let shown = |x: f64| units::shown(of.dimension, x);
        JobParameter {
            name: of.name.clone(),
            value: shown(of.value),
            unit: units::whole_symbol(of.dimension),
            is_count: of.is_count,
            is_error: of.is_error,
            range: of.range.map(|(low, high)| [low, high].map(shown)),
            step: of.step.map(shown),
            doc: of.doc.clone(),
            given_by: of.given_by.clone(),
        }
    }
}

impl JobSurface {
    fn new(of: &flank_chain_dsl::GeneratedSurface<'_>) -> JobSurface {
        JobSurface {
            name: of.name.clone(),
            frame: of.frame.clone(),
            counts: of.sample.as_ref().map(|sample| sample.counts),
        }
    }
}

impl Job {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file of its spec, as it was named.
    pub fn file(&self) -> &Path {
        self.project.file()
    }

    /// SHA-256 of all its texts and of the values that were set from outside, as files say it.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// All texts that it is made of, the spec first, each with the path of its file without links.
    pub fn texts(&self) -> &[(PathBuf, String)] {
        &self.texts
    }

    /// The values that were set from outside the text.
    pub fn set(&self) -> &[(String, String)] {
        &self.set
    }

    /// Its spec with all its texts.
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// Its doc comment, line by line.
    pub fn doc(&self) -> &[String] {
        &self.doc
    }

    /// Its parameters and settings with their values, each after those that it depends on.
    pub fn parameters(&self) -> &[JobParameter] {
        &self.parameters
    }

    /// Its surfaces, in the order of the spec.
    pub fn surfaces(&self) -> &[JobSurface] {
        &self.surfaces
    }

    /// What is doubtful in its spec.
    pub fn warnings(&self) -> &Findings {
        &self.warnings
    }
}

/// What requests ask for.
impl From<&Job> for JobSelection {
    fn from(job: &Job) -> JobSelection {
        JobSelection { project: job.project.clone(), job: Some(job.name.clone()), set: job.set.clone() }
    }
}
