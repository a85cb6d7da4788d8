//! Why an operation did not do what it was asked for, as exceptions of `flank._errors`.

use std::ffi::CString;

use flank::{Failure, Findings};
use pyo3::exceptions::{PyKeyboardInterrupt, PyUserWarning};
use pyo3::prelude::*;

/// The exception of a failure.
pub(crate) fn raised(py: Python<'_>, failure: Failure) -> PyErr {
    let words = failure.to_string();
    match failure {
        Failure::Findings(findings) => of_findings(py, &findings),
        Failure::Cancelled => PyKeyboardInterrupt::new_err(()),
        Failure::Unsolved(_) => made(py, "NotSolved", (words, "[]")),
        Failure::NotDone(list) => {
            let list = serde_json::to_string(&list).expect("messages have keys that are texts");
            made(py, "NotSolved", (words, list))
        }
        Failure::File(_) | Failure::Folder(_) => made(py, "FileError", (words,)),
        Failure::Request(_) | Failure::Input(_) | Failure::TooLarge(_) => made(py, "InputError", (words,)),
    }
}

/// The exception with all that is wrong with a spec.
pub(crate) fn of_findings(py: Python<'_>, findings: &Findings) -> PyErr {
    let list = serde_json::to_string(findings).expect("findings have keys that are texts");
    made(py, "SpecError", (findings.rendered(false), list))
}

/// The exception of a fault of the program.
pub(crate) fn internal(py: Python<'_>, words: &str) -> PyErr {
    made(py, "InternalError", (words.to_string(),))
}

/// What is to be known beside results.
pub(crate) fn warn(py: Python<'_>, remarks: &[String]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    remarks.iter().try_for_each(|remark| {
        let text = CString::new(remark.replace('\0', " "))?;
        PyErr::warn(py, &category, &text, 2)
    })
}

/// An exception of the package by its name.
pub(crate) fn made<'py>(py: Python<'py>, name: &str, words: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let exception = py.import("flank._errors").and_then(|errors| errors.getattr(name)?.call1(words));
    exception.map_or_else(|error| error, PyErr::from_value)
}
