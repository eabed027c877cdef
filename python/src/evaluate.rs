//! Evaluation of all derived quantities at a state.

use dalembert::describe::Report;
use dalembert_driver::{OffConstraint, Origin, Rates};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::model::NativeModel;
use crate::request::vector;

/// A time, positions, and velocities or momenta.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct At {
    t: f64,
    q: Vec<f64>,
    qdot: Option<Vec<f64>>,
    p: Option<Vec<f64>>,
}

/// The quantities by name: numbers, vectors and matrices.
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    model: &NativeModel,
    at: &At,
) -> PyResult<Bound<'py, PyDict>> {
    let built = model.build();
    let refuse = |reason| error::state(model.describe(), &reason);
    built
        .check_parameters()
        .map_err(|reason| refuse(reason.into()))?;
    let rates = match (&at.qdot, &at.p) {
        (Some(qdot), None) => Rates::Velocities(vector(built.as_ref(), "qdot", qdot)?),
        (None, Some(p)) => Rates::Momenta(vector(built.as_ref(), "p", p)?),
        (None, None) if model.describe().is_first_order => Rates::Velocities(vec![0.0; at.q.len()]),
        _ => return Err(error::refused("q needs either qdot or p")),
    };
    let origin = Origin {
        q: vector(built.as_ref(), "q", &at.q)?,
        rates,
        policy: OffConstraint::Keep,
    };
    let state = built.state(at.t, &origin).map_err(refuse)?;
    let mut collected = Collected {
        py,
        dict: PyDict::new(py),
        failure: None,
    };
    let inspected = built.inspect(at.t, &state, &mut collected);
    inspected.map_err(|fault| refuse(fault.into()))?;
    match collected.failure {
        Some(failure) => Err(failure),
        None => Ok(collected.dict),
    }
}

/// Collects a report in a dictionary.
struct Collected<'py> {
    py: Python<'py>,
    dict: Bound<'py, PyDict>,
    failure: Option<PyErr>,
}

impl<'py> Collected<'py> {
    fn take(&mut self, name: &str, value: PyResult<Bound<'py, PyAny>>) {
        let taken = value.and_then(|value| self.dict.set_item(name, value));
        self.failure = self.failure.take().or(taken.err());
    }
}

impl Report for Collected<'_> {
    fn scalar(&mut self, name: &str, value: f64) {
        let taken = self.dict.set_item(name, value);
        self.failure = self.failure.take().or(taken.err());
    }

    fn vector(&mut self, name: &str, values: &[f64]) {
        let array = PyArray1::from_slice(self.py, values);
        self.take(name, Ok(array.into_any()));
    }

    fn matrix(&mut self, name: &str, rows: usize, columns: usize, values: &[f64]) {
        let array = PyArray1::from_slice(self.py, values);
        let shaped = array.reshape([rows, columns]);
        self.take(name, shaped.map(Bound::into_any));
    }
}
