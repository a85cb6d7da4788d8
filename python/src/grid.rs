//! Points as arrays of numpy, which take over the memory of results.

use flank::{PointGrid, Status};
use numpy::ndarray::{Dimension, IntoDimension};
use numpy::{Element, PyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

/// The fields of a grid, in their order.
type Parts = (
    String,
    String,
    (usize, usize),
    (String, String),
    Py<PyAny>,
    Py<PyAny>,
    Py<PyAny>,
    Vec<String>,
    Py<PyAny>,
    Py<PyDict>,
    Py<PyDict>,
);

/// The points of a surface, a measuring grid or a line.
#[pyclass(frozen, get_all, module = "flank._flank")]
pub(crate) struct Grid {
    name: String,
    frame: String,
    counts: (usize, usize),
    labels: (String, String),
    /// Rows, columns, 3; mm.
    xyz: Py<PyAny>,
    /// The same, unit vectors.
    normal: Py<PyAny>,
    /// Rows, columns: places in `words`.
    status: Py<PyAny>,
    /// The words of statuses.
    words: Vec<String>,
    /// Rows, columns.
    residual: Py<PyAny>,
    /// Of each unknown its unit and its values, rows, columns.
    unknowns: Py<PyDict>,
    /// Of each field its unit, its meaning and its values: rows, columns, and 3 of a vector.
    fields: Py<PyDict>,
}

impl Grid {
    pub(crate) fn new(py: Python<'_>, grid: PointGrid) -> PyResult<Grid> {
        let [rows, columns] = grid.counts;
        let is_kept = grid.positions.len() == rows * columns;
        let (rows, columns) = if is_kept { (rows, columns) } else { (0, 0) };
        let unknowns = PyDict::new(py);
        for (place, unknown) in grid.unknown_names.iter().enumerate() {
            let values = array(py, grid.unknown(place), [rows, columns])?;
            unknowns.set_item(&unknown.name, (unknown.unit.symbol(), values))?;
        }
        let fields = PyDict::new(py);
        for field in grid.fields {
            let values = match field.width {
                1 => array(py, field.values, [rows, columns])?,
                width => array(py, field.values, [rows, columns, width])?,
            };
            fields.set_item(field.name, (field.unit, field.meaning, values))?;
        }
        Ok(Grid {
            name: grid.name,
            frame: grid.frame,
            counts: (rows, columns),
            labels: grid.labels.into(),
            xyz: array(py, grid.positions.into_flattened(), [rows, columns, 3])?,
            normal: array(py, grid.normals.into_flattened(), [rows, columns, 3])?,
            status: array(py, grid.statuses.iter().map(|status| place(*status)).collect(), [rows, columns])?,
            words: Status::ALL.iter().map(|status| status.word().to_string()).collect(),
            residual: array(py, grid.residuals, [rows, columns])?,
            unknowns: unknowns.unbind(),
            fields: fields.unbind(),
        })
    }
}

#[pymethods]
impl Grid {
    #[new]
    fn restored(py: Python<'_>, parts: Parts) -> PyResult<Grid> {
        let (name, frame, counts, labels, xyz, normal, status, words, residual, unknowns, fields) = parts;
        let [xyz, normal, status, residual] = [xyz, normal, status, residual].map(|values| locked(values.bind(py)));
        let [unknowns, fields] = [unknowns, fields].map(|columns| with_locked(columns.bind(py)));
        Ok(Grid {
            name,
            frame,
            counts,
            labels,
            xyz: xyz?.unbind(),
            normal: normal?.unbind(),
            status: status?.unbind(),
            words,
            residual: residual?.unbind(),
            unknowns: unknowns?.unbind(),
            fields: fields?.unbind(),
        })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (Parts,)) {
        let (py, grid) = (slf.py(), slf.get());
        let [xyz, normal, status, residual] =
            [&grid.xyz, &grid.normal, &grid.status, &grid.residual].map(|values| values.clone_ref(py));
        let [unknowns, fields] = [&grid.unknowns, &grid.fields].map(|columns| columns.clone_ref(py));
        let (name, frame, words) = (grid.name.clone(), grid.frame.clone(), grid.words.clone());
        let (counts, labels) = (grid.counts, grid.labels.clone());
        let parts = (name, frame, counts, labels, xyz, normal, status, words, residual, unknowns, fields);
        (slf.get_type(), (parts,))
    }
}

/// An array of a pickle, which could be written, as one that cannot; what is none stays.
fn locked<'py>(values: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if values.is_none() {
        return Ok(values.clone());
    }
    values.call_method1("setflags", (false,))?;
    // of an array that cannot be written no view can
    values.call_method0("view")
}

/// Columns of a pickle, whose arrays stand last, as ones that cannot be written.
fn with_locked<'py>(columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let locked_columns = PyDict::new(columns.py());
    for (name, column) in columns {
        let column = column.cast_into::<PyTuple>()?;
        let last = column.len() - 1;
        let mut cells: Vec<_> = column.iter().collect();
        cells[last] = locked(&cells[last])?;
        locked_columns.set_item(name, PyTuple::new(columns.py(), cells)?)?;
    }
    Ok(locked_columns)
}

fn place(status: Status) -> u8 {
    let place = Status::ALL.iter().position(|other| *other == status).unwrap_or_default();
    place.try_into().expect("there are few statuses")
}

/// A read-only array over the memory of a list; all NaN, or empty, where the list is.
fn array<T: Element, D: IntoDimension>(py: Python<'_>, values: Vec<T>, shape: D) -> PyResult<Py<PyAny>>
where
    D::Dim: Dimension,
{
    let flat = PyArray1::from_vec(py, values);
    let shape = shape.into_dimension();
    if flat.len()? != shape.size() {
        return Ok(py.None());
    }
    // of an array that cannot be written no view can
    let flat = flat.readwrite().make_nonwriteable();
    let shaped: Bound<'_, PyArray<T, D::Dim>> = flat.reshape(shape)?;
    Ok(shaped.into_any().unbind())
}
