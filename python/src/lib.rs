//! The extension module `dalembert._native` of the Python package.
//!
//! | file | job |
//! |---|---|
//! | `error.rs` | exceptions, with mistakes in texts as data |
//! | `model.rs` | models: texts to forms, values of parameters, descriptions |
//! | `request.rs` | the arguments of a run, as settings and state of the driver |
//! | `recorder.rs` | samples, impacts and contacts of a run as columns of numbers; signals |
//! | `events.rs`, `cells.rs` | events and callbacks of the user; sign changes of a function |
//! | `export.rs` | models for other languages |
//! | `run.rs` | runs that have ended, as arrays |
//! | `ensemble.rs` | rows and sums of members of an ensemble; columns of rows |
//! | `evaluate.rs` | all derived quantities at a state |
//! | `report.rs` | derivations and verdicts |
//!
//! The names, defaults and documentation that users see are in the Python files of the package.

mod cells;
mod ensemble;
mod error;
mod evaluate;
mod events;
mod export;
mod model;
mod recorder;
mod report;
mod request;
mod run;

/// The version of the package.
#[pyo3::pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The player of an animation, as HTML; `data` is JSON.
#[pyo3::pyfunction]
fn player(name: &str, data: &str) -> String {
    dalembert_driver::player::element(name, data)
}

/// The functions and classes of the module.
#[pyo3::pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use super::{player, version};
    #[pymodule_export]
    use crate::ensemble::{NativeEnsemble, column, csv_lines};
    #[pymodule_export]
    use crate::export::{lines, to_c};
    #[pymodule_export]
    use crate::model::{NativeModel, close, load, shipped};
    #[pymodule_export]
    use crate::report::{derive, documentation};
    #[pymodule_export]
    use crate::run::{ContactTable, CrossingTable, ImpactTable, NativeRun, Table};
}
