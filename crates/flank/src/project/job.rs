//! A job by itself.

use std::sync::Arc;

use flank_chain_dsl::{Buffers, compile_request};
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
        let asked = JobSelection { project: self.clone(), job: Some(name.to_string()), set: set.to_vec() };
        asked.check()?;
        let graph = Graph::new();
        let mut compilation = compile_request(&graph, self.file(), &asked.request());
        let findings = Findings::new(&compilation.diagnostics, &compilation.sources);
        if compilation.has_errors() {
            return Err(Failure::Findings(findings));
        }
        let job = spec::asked_for(&mut compilation, &asked, &Unwatched)?.remove(0);
        let texts = compilation.sources.files().filter_map(|(_, source)| Some((source.file.as_ref()?, &source.text)));
        let files =
            texts.fold(Buffers::over(self.shared_files()), |files, (file, text)| files.with(file, text.clone()));
        let parameter = |of: &flank_chain_dsl::Parameter<'_>| JobParameter {
            name: of.name.clone(),
            value: units::shown(of.dimension, of.value),
            unit: units::whole_symbol(of.dimension),
            is_count: of.is_count,
        };
        let surface = |of: &flank_chain_dsl::GeneratedSurface<'_>| JobSurface {
            name: of.name.clone(),
            frame: of.frame.clone(),
            counts: of.sample.as_ref().map(|sample| sample.counts),
        };
        Ok(Job {
            name: name.to_string(),
            set: set.to_vec(),
            project: Project::open(self.file(), Arc::new(files)),
            doc: job.doc.clone(),
            parameters: job.parameters.iter().map(parameter).collect(),
            surfaces: job.surfaces.iter().map(surface).collect(),
            warnings: findings,
        })
    }
}

impl Job {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
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
