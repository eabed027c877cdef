//! Models for other languages: a C header, and functions as plain data.

use dalembert_codegen::export::{self, Line, Operand, Part, Routine, Takes};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::refused;

/// The parts of a model: itself, one of its scenes, or its modes.
fn parts(py: Python<'_>, source: &str, scene: Option<&str>) -> PyResult<Vec<Part>> {
    let found = py.detach(|| export::export(source, scene).map_err(|error| error.to_string()));
    let found = found.map_err(refused)?;
    found.ok_or_else(|| refused(format!("unknown scene `{}`", scene.unwrap_or("all"))))
}

/// A C99 header.
#[pyfunction]
pub fn to_c(py: Python<'_>, source: &str, scene: Option<&str>) -> PyResult<String> {
    Ok(export::header(&parts(py, source, scene)?))
}

/// The functions of a model as lines: one dictionary for each part.
#[pyfunction]
pub fn lines<'py>(
    py: Python<'py>,
    source: &str,
    scene: Option<&str>,
) -> PyResult<Bound<'py, PyList>> {
    let parts = parts(py, source, scene)?;
    let dicts: PyResult<Vec<_>> = parts.iter().map(|part| dictionary(py, part)).collect();
    PyList::new(py, dicts?)
}

fn dictionary<'py>(py: Python<'py>, part: &Part) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &part.name)?;
    dict.set_item("coordinates", &part.coordinates)?;
    dict.set_item("motion", &part.motion)?;
    let parameters: Vec<&str> = part.parameters.iter().map(|(name, _)| &**name).collect();
    dict.set_item("parameters", parameters)?;
    let routines = PyDict::new(py);
    for routine in &part.routines {
        routines.set_item(&routine.name, function(py, routine)?)?;
    }
    dict.set_item("routines", routines)?;
    Ok(dict)
}

/// A tuple: true for a function of the state, its lines, its results, and their description.
fn function<'py>(py: Python<'py>, routine: &Routine) -> PyResult<Bound<'py, PyAny>> {
    let lines: PyResult<Vec<_>> = routine.lines.lines.iter().map(|it| line(py, it)).collect();
    let outputs: PyResult<Vec<_>> = routine
        .lines
        .outputs
        .iter()
        .map(|it| operand(py, it))
        .collect();
    let of_state = routine.takes == Takes::State;
    (of_state, lines?, outputs?, &routine.about).into_bound_py_any(py)
}

/// A value with its operation and operands; None for a demand on values.
fn line<'py>(py: Python<'py>, line: &Line) -> PyResult<Bound<'py, PyAny>> {
    let Line::Let {
        value,
        operation,
        operands,
    } = line
    else {
        return Ok(py.None().into_bound(py));
    };
    let operands: PyResult<Vec<_>> = operands.iter().map(|it| operand(py, it)).collect();
    (value, operation, operands?).into_bound_py_any(py)
}

fn operand<'py>(py: Python<'py>, operand: &Operand) -> PyResult<Bound<'py, PyAny>> {
    match *operand {
        Operand::Value(value) => ("value", value).into_bound_py_any(py),
        Operand::Number(number) => ("number", number).into_bound_py_any(py),
        Operand::Time => ("t", 0).into_bound_py_any(py),
        Operand::State(i) => ("s", i).into_bound_py_any(py),
        Operand::Velocity(i) => ("v", i).into_bound_py_any(py),
        Operand::Parameter(k) => ("k", k).into_bound_py_any(py),
    }
}
