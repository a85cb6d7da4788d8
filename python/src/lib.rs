//! The native half of the Python package `flank`: requests in, answers out. The names that users know stand in `python/flank`.

mod answer;
mod exchange;
mod failure;
mod grid;
mod job;
mod language;
mod operations;
mod options;
mod run;
mod sweep;

use pyo3::prelude::*;

#[pymodule]
mod _flank {
    /// Of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    /// Whether it is built as wheels are.
    #[pymodule_export]
    const IS_RELEASE: bool = !cfg!(debug_assertions);

    #[pymodule_export]
    use crate::answer::Answer;
    #[pymodule_export]
    use crate::exchange::{import_rexs, new_job, templates};
    #[pymodule_export]
    use crate::grid::Grid;
    #[pymodule_export]
    use crate::job::{Job, load};
    #[pymodule_export]
    use crate::language::{check, codes, explain, layout, test, unit_size, units};
    #[pymodule_export]
    use crate::operations::{
        contact, convert, derive, deviation, fit, measure, mesh, mill, plot, report, solid, solve, synthesis,
        tolerance, view,
    };
    #[pymodule_export]
    use crate::options::evaluator;
    #[pymodule_export]
    use crate::run::threads;
    #[pymodule_export]
    use crate::sweep::{OpenStudy, sweep_chunks, sweep_columns, sweep_gather, sweep_plan, sweep_status};
}
