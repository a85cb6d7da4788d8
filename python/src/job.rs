//! Jobs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{Buffers, Disk, Files, JobSelection, Project, ValueSource};
use pyo3::prelude::*;

use crate::failure;

/// A job of a spec: its texts and its values.
#[pyclass(frozen, module = "flank._flank")]
pub(crate) struct Job {
    job: flank::Job,
    /// Where relative paths were looked for when it was loaded.
    folder: Option<PathBuf>,
}

/// Name, value, unit, range, step, document, giver, whether it counts, whether it is an error of the machine.
type Parameter = (String, f64, String, Option<(f64, f64)>, Option<f64>, String, Option<String>, bool, bool);

/// Name, frame, counts of the sample.
type Surface = (String, String, Option<(usize, usize)>);

/// The jobs of a spec, or one of them with other values. Texts lie over the files of their paths.
#[pyfunction]
#[pyo3(signature = (path, texts, name=None, set=Vec::new()))]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    texts: Vec<(PathBuf, String)>,
    name: Option<String>,
    set: Vec<(String, String)>,
) -> PyResult<Vec<Job>> {
    let jobs = py.detach(move || {
        let files: Arc<dyn Files> = match texts.is_empty() {
            true => Arc::new(Disk),
            false => Arc::new(
                texts.into_iter().fold(Buffers::over(Arc::new(Disk)), |files, (path, text)| files.with(&path, text)),
            ),
        };
        let project = Project::open(path, files);
        match name {
            Some(name) => project.job(&name, &set).map(|job| vec![job]),
            None => project.jobs(&set),
        }
    });
    let jobs = jobs.map_err(|failure| failure::raised(py, failure))?;
    let folder = std::env::current_dir().ok();
    Ok(jobs.into_iter().map(|job| Job { job, folder: folder.clone() }).collect())
}

impl Job {
    /// What requests ask for.
    pub(crate) fn selection(&self) -> JobSelection {
        let selection = JobSelection::from(&self.job);
        let is_moved = self.job.file().is_relative() && std::env::current_dir().ok() != self.folder;
        match self.job.texts().first().filter(|_| is_moved) {
            // a relative path means another file since the working directory has changed
            Some((real, _)) => JobSelection { project: Project::open(real, Arc::new(self.buffers())), ..selection },
            None => selection,
        }
    }

    /// The same with one more text, taken for what stands in a file.
    pub(crate) fn selection_with(&self, path: &Path, text: String) -> JobSelection {
        let selection = self.selection();
        let project = Project::open(selection.file(), Arc::new(self.buffers().with(path, text)));
        JobSelection { project, ..selection }
    }

    /// Its texts over the files of the disk.
    fn buffers(&self) -> Buffers {
        let texts = self.job.texts().iter();
        texts.fold(Buffers::over(Arc::new(Disk)), |files, (path, text)| files.with(path, text))
    }
}

#[pymethods]
impl Job {
    #[getter]
    fn name(&self) -> &str {
        self.job.name()
    }

    #[getter]
    fn file(&self) -> String {
        flank::shown_path(self.job.file())
    }

    #[getter]
    fn hash(&self) -> &str {
        self.job.hash()
    }

    #[getter]
    fn set(&self) -> Vec<(String, String)> {
        self.job.set().to_vec()
    }

    #[getter]
    fn texts(&self) -> Vec<(String, String)> {
        self.job.texts().iter().map(|(path, text)| (path.display().to_string(), text.clone())).collect()
    }

    #[getter]
    fn doc(&self) -> String {
        self.job.doc().join("\n")
    }

    #[getter]
    fn warnings(&self) -> String {
        serde_json::to_string(self.job.warnings()).expect("findings have keys that are texts")
    }

    /// As [`Parameter`].
    fn parameters(&self) -> Vec<Parameter> {
        let of = |of: &flank::JobParameter| {
            let giver = match &of.given_by {
                ValueSource::Definition(name) => Some(name.clone()),
                ValueSource::Job => Some(String::new()),
                ValueSource::Caller => None,
            };
            let range = of.range.map(|[low, high]| (low, high));
            let (name, unit) = (of.name.clone(), of.unit.clone());
            (name, of.value, unit, range, of.step, of.doc.join("\n"), giver, of.is_count, of.is_error)
        };
        self.job.parameters().iter().map(of).collect()
    }

    /// As [`Surface`].
    fn surfaces(&self) -> Vec<Surface> {
        let of = |of: &flank::JobSurface| (of.name.clone(), of.frame.clone(), of.counts.map(|[r, c]| (r, c)));
        self.job.surfaces().iter().map(of).collect()
    }
}
