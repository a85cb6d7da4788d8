//! Keyword arguments as fields of requests: what is not there, or `None`, stays as it is.

use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use flank::{EvaluatorOptions, MountingError, ToleratedAmount, UnknownChoice};
use flank_chain_dsl::Dimension;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure;

/// How operations work numbers out that say nothing of it; none as long as nobody has set it.
static EVALUATOR: Mutex<Option<EvaluatorOptions>> = Mutex::new(None);

/// The same, as it is.
pub(crate) fn evaluator_of_all() -> EvaluatorOptions {
    EVALUATOR.lock().unwrap_or_else(PoisonError::into_inner).unwrap_or_default()
}

/// Sets whether operations use machine code, and how many boxes their searches examine, as far as these are given; says what it was.
#[pyfunction]
#[pyo3(signature = (machine_code=None, boxes=None))]
pub(crate) fn evaluator(machine_code: Option<bool>, boxes: Option<u64>) -> (bool, u64) {
    let mut evaluator = EVALUATOR.lock().unwrap_or_else(PoisonError::into_inner);
    let before = evaluator.unwrap_or_default();
    let machine_code = machine_code.unwrap_or(before.machine_code);
    *evaluator = Some(EvaluatorOptions { machine_code, boxes: boxes.unwrap_or(before.boxes) });
    (before.machine_code, before.boxes)
}

/// A dictionary of keyword arguments.
#[derive(Clone, Copy)]
pub(crate) struct Options<'d, 'py>(pub(crate) &'d Bound<'py, PyDict>);

impl<'py> Options<'_, 'py> {
    /// What is given under a name.
    pub(crate) fn given<T: FromPyObjectOwned<'py>>(self, name: &str) -> PyResult<Option<T>> {
        match self.0.get_item(name)?.filter(|value| !value.is_none()) {
            Some(value) => value.extract().map(Some).map_err(Into::into),
            None => Ok(None),
        }
    }

    /// The same, or a default.
    pub(crate) fn or<T: FromPyObjectOwned<'py>>(self, name: &str, default: T) -> PyResult<T> {
        Ok(self.given(name)?.unwrap_or(default))
    }

    /// Sets a field, if something is given.
    pub(crate) fn put<T: FromPyObjectOwned<'py>>(self, name: &str, field: &mut T) -> PyResult<()> {
        if let Some(value) = self.given(name)? {
            *field = value;
        }
        Ok(())
    }

    /// Kinds by their names.
    pub(crate) fn kinds<K: FromStr<Err = UnknownChoice>>(self, name: &str) -> PyResult<Vec<K>> {
        let names: Vec<String> = self.or(name, Vec::new())?;
        let kinds = names.iter().map(|kind| kind.parse().map_err(|unknown| self.refused(name, &unknown)));
        kinds.collect()
    }

    /// A kind by its name.
    pub(crate) fn kind<K: FromStr<Err = UnknownChoice>>(self, name: &str, default: K) -> PyResult<K> {
        let given: Option<String> = self.given(name)?;
        given.map_or(Ok(default), |kind| kind.parse().map_err(|unknown| self.refused(name, &unknown)))
    }

    fn refused(self, name: &str, unknown: &UnknownChoice) -> PyErr {
        failure::made(self.0.py(), "InputError", (format!("option `{name}`: {unknown}"),))
    }

    /// How the numbers are worked out.
    pub(crate) fn evaluator(self) -> PyResult<EvaluatorOptions> {
        let mut evaluator = evaluator_of_all();
        self.put("boxes", &mut evaluator.boxes)?;
        Ok(evaluator)
    }

    /// Names with amounts of a kind: lengths in mm, angles in radians, numbers, shares, and products by their powers of length and angle,
    /// `-1,0`, in mm and radians.
    pub(crate) fn amounts(self, name: &str) -> PyResult<Vec<(String, ToleratedAmount)>> {
        let given: Vec<(String, String, f64)> = self.or(name, Vec::new())?;
        let amount = |(of, kind, size): (String, String, f64)| {
            let amount = match &*kind {
                "length" => ToleratedAmount::Length(size),
                "angle" => ToleratedAmount::Angle(size),
                "share" => ToleratedAmount::Share(size),
                "number" => ToleratedAmount::Number(size),
                powers => ToleratedAmount::of(size, dimension_of(powers)),
            };
            (of, amount)
        };
        Ok(given.into_iter().map(amount).collect())
    }

    /// Axes with errors, as [`Options::amounts`].
    pub(crate) fn mountings(self, name: &str) -> PyResult<Vec<(String, MountingError)>> {
        let given: Vec<(String, String, f64)> = self.or(name, Vec::new())?;
        let error = |(of, kind, size): (String, String, f64)| {
            (of, if kind == "angle" { MountingError::Angle(size) } else { MountingError::Length(size) })
        };
        Ok(given.into_iter().map(error).collect())
    }
}

/// Of the powers of length and angle.
fn dimension_of(powers: &str) -> Dimension {
    let power = |text: &str| text.parse().unwrap_or(0);
    let (length, angle) = powers.split_once(',').unwrap_or((powers, "0"));
    Dimension { length: power(length), angle: power(angle) }
}
