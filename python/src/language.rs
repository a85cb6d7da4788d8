//! What works on texts: findings, layout, error pages, tests of specs.

use std::path::PathBuf;
use std::sync::Arc;

use flank::{Buffers, CheckResult, Code, Disk, Project, TestRequest};
use flank_chain_dsl::Dimension;
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::failure;
use crate::run::run;

/// What is wrong with specs; a text lies over the file of its path.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, specs: Vec<(PathBuf, Option<String>)>) -> Answer {
    let (result, text) = py.detach(|| {
        let files = specs.into_iter().map(|(path, text)| flank::check(&project(path, text))).collect();
        let result = CheckResult { files };
        let text: String = result.files.iter().map(|of| of.findings.rendered(false)).collect();
        (result, text)
    });
    Answer::of_document(&result, &text)
}

fn project(path: PathBuf, text: Option<String>) -> Project {
    let files = Buffers::over(Arc::new(Disk));
    let files = match text {
        Some(text) => files.with(&path, text),
        None => files,
    };
    Project::open(path, Arc::new(files))
}

/// A text as it is laid out.
#[pyfunction]
pub(crate) fn layout(py: Python<'_>, path: PathBuf, text: String) -> PyResult<String> {
    let laid_out = flank::lay_out(&project(path, Some(text)));
    laid_out.map(|layout| layout.text).map_err(|failure| failure::raised(py, failure))
}

/// Checks what specs expect.
#[pyfunction]
#[pyo3(signature = (paths, filter=None, snapshot=true))]
pub(crate) fn test(py: Python<'_>, paths: Vec<PathBuf>, filter: Option<String>, snapshot: bool) -> PyResult<Answer> {
    let result = run(py, move |monitor| {
        let found = flank::find_specs(&paths)?;
        let requests =
            found.into_iter().map(|path| TestRequest { filter: filter.clone(), snapshot, ..TestRequest::new(path) });
        flank::test(&requests.collect::<Vec<_>>(), monitor)
    })?;
    Ok(Answer::of_document(&result, &result))
}

/// Code, severity and title of all findings.
#[pyfunction]
pub(crate) fn codes() -> String {
    serde_json::to_string(&flank::error_codes()).expect("codes have keys that are texts")
}

/// The page about a code; none if there is no such code.
#[pyfunction]
pub(crate) fn explain(code: &str) -> Option<&'static str> {
    code.parse::<Code>().ok().map(flank::error_page)
}

/// The units of the language, in the order in which messages list them.
#[pyfunction]
pub(crate) fn units() -> Vec<&'static str> {
    flank::vocabulary().units.to_vec()
}

/// The powers of length and angle that a unit is a product of, and its size in mm and radians; none if there is no such unit.
#[pyfunction]
pub(crate) fn unit_size(name: &str) -> Option<(i32, i32, f64)> {
    let (size, Dimension { length, angle }) = flank::product_size(name)?;
    Some((length, angle, size))
}
