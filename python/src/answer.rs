//! Results of operations.

use std::fmt::Display;

use flank::PointGrid;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::grid::Grid;

/// A result: its document, its text, and its arrays.
#[pyclass(frozen, module = "flank._flank")]
pub(crate) struct Answer {
    told: Box<dyn Told>,
    #[pyo3(get)]
    grids: Vec<Py<Grid>>,
    /// Of settings that were fitted.
    #[pyo3(get)]
    covariance: Vec<Vec<f64>>,
}

/// What every result can be asked.
trait Told: Send + Sync {
    fn document(&self) -> String;
    fn text(&self) -> String;
    fn seconds(&self) -> Option<f64>;
}

impl<A: flank::Answer> Told for A {
    fn document(&self) -> String {
        document(self)
    }

    fn text(&self) -> String {
        self.to_string()
    }

    fn seconds(&self) -> Option<f64> {
        self.timing().map(|timing| timing.elapsed.as_secs_f64())
    }
}

/// Of a result whose text was made before.
struct Document {
    document: String,
    text: String,
    seconds: Option<f64>,
}

/// What a result is made of again: document, text, seconds, points, and how settings scatter together.
type Parts = (String, String, Option<f64>, Vec<Py<Grid>>, Vec<Vec<f64>>);

impl Told for Document {
    fn document(&self) -> String {
        self.document.clone()
    }

    fn text(&self) -> String {
        self.text.clone()
    }

    fn seconds(&self) -> Option<f64> {
        self.seconds
    }
}

/// As `--json` prints it.
pub(crate) fn document(result: &impl serde::Serialize) -> String {
    let document = serde_json::to_value(result).expect("results have keys that are texts");
    format!("{document:#}\n")
}

impl Answer {
    /// A result with what is to be handed over in arrays.
    pub(crate) fn new<A: flank::Answer>(py: Python<'_>, answer: A, grids: Vec<PointGrid>) -> PyResult<Answer> {
        let grids = grids.into_iter().map(|grid| Py::new(py, Grid::new(py, grid)?)).collect::<PyResult<_>>()?;
        Ok(Answer { told: Box::new(answer), grids, covariance: Vec::new() })
    }

    /// With how settings that were fitted scatter together.
    pub(crate) fn with_covariance(self, covariance: Vec<Vec<f64>>) -> Answer {
        Answer { covariance, ..self }
    }

    /// A document that has a text of its own.
    pub(crate) fn of_document(result: &impl serde::Serialize, text: &impl Display) -> Answer {
        let told = Document { document: document(result), text: text.to_string(), seconds: None };
        Answer { told: Box::new(told), grids: Vec::new(), covariance: Vec::new() }
    }
}

#[pymethods]
impl Answer {
    #[new]
    fn restored(
        document: String,
        text: String,
        seconds: Option<f64>,
        grids: Vec<Py<Grid>>,
        covariance: Vec<Vec<f64>>,
    ) -> Answer {
        Answer { told: Box::new(Document { document, text, seconds }), grids, covariance }
    }

    /// A pickle has what can be asked, and not the job that it was asked of.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, Parts) {
        let answer = slf.get();
        let grids = answer.grids.iter().map(|grid| grid.clone_ref(slf.py())).collect();
        let covariance = answer.covariance.clone();
        (slf.get_type(), (answer.document(), answer.text(), answer.seconds(), grids, covariance))
    }

    /// The document, as JSON.
    fn document(&self) -> String {
        self.told.document()
    }

    /// The text for people.
    fn text(&self) -> String {
        self.told.text()
    }

    /// From the request to the result, if that was measured.
    fn seconds(&self) -> Option<f64> {
        self.told.seconds()
    }
}
