//! Specs that are made: of the library, and of files of other programs.

use std::path::PathBuf;

use flank::{Disk, ImportRequest, NewJob, Signs, Words};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answer::Answer;
use crate::failure;
use crate::options::Options;

/// What there is to start from.
#[pyfunction]
pub(crate) fn templates() -> Answer {
    Answer::of_document(&flank::templates(), &"")
}

/// Writes a job, a machine or a tool of the library with all that it uses.
#[pyfunction]
pub(crate) fn new_job(
    py: Python<'_>,
    template: String,
    folder: PathBuf,
    name: Option<String>,
    values: Vec<(String, String)>,
) -> PyResult<Answer> {
    let words = |text: String, origin: &str| Words { text, origin: origin.to_string() };
    let request = NewJob {
        template,
        name: name.map(|name| words(name, "option `name`")),
        values: values.into_iter().map(|(name, value)| (name, words(value, "option `values`"))).collect(),
        folder,
    };
    let made = py.detach(|| flank::new_job(&request)).map_err(|failure| failure::raised(py, failure))?;
    Ok(Answer::of_document(&made, &""))
}

/// A job of a machine summary, and what is doubtful about the file.
#[pyfunction]
pub(crate) fn import_rexs(
    py: Python<'_>,
    file: PathBuf,
    options: &Bound<'_, PyDict>,
) -> PyResult<(Answer, Vec<String>)> {
    let given = Options(options);
    let request = ImportRequest {
        file,
        signs: given.kind("signs", Signs::Frames)?,
        coefficients: given.kinds("coefficients")?.first().copied(),
        settings: given.given("settings")?,
        outside: given.given("outside")?,
        inside: given.given("inside")?,
        name: given.or("name", "imported".to_string())?,
        library: given.or("library", "specs".to_string())?,
    };
    let imported = py.detach(|| flank::import(&Disk, &request)).map_err(|failure| failure::raised(py, failure))?;
    let doubts = imported.doubts.clone();
    Ok((Answer::of_document(&imported, &imported.text), doubts))
}
