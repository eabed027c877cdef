//! Events and callbacks of the user along a run.

use std::collections::HashMap;

use dalembert_driver::{AnyModel, Contact, Impact, Piece, Point};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::cells::Sign;
use crate::error::refused;
use crate::model::NativeModel;

/// An event, as `dalembert/_events.py` hands it on: a Python function, or `None` for the next expression; a direction;
/// true if it ends the run.
pub(crate) type Wanted = (Option<Py<PyAny>>, i32, bool);

/// Functions of the user that are called during a run.
#[derive(Default)]
pub(crate) struct Calls {
    /// `(t, q, qdot)` after each step.
    pub step: Option<Py<PyAny>>,
    /// `(kind, index, t, before, after)` at each impact, contact and event.
    pub event: Option<Py<PyAny>>,
    /// `(t)` from time to time.
    pub progress: Option<Py<PyAny>>,
}

/// A sign change of an event.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    pub t: f64,
    pub event: usize,
    pub rising: bool,
}

/// The function of an event.
enum Function {
    /// A declared output of the watched model.
    Output(usize),
    Python(Py<PyAny>),
}

/// Events that a run watches: functions with directions, and true for each event that ends the run.
#[derive(Default)]
pub(crate) struct Watched<'a> {
    events: Vec<(Function, i32, bool)>,
    /// The model whose last outputs are the expressions.
    model: Option<&'a NativeModel>,
}

impl<'a> Watched<'a> {
    /// The events of a request. The expressions are the last outputs of the model.
    pub(crate) fn of(py: Python<'_>, wanted: &[Wanted], model: Option<&'a NativeModel>) -> Self {
        let expressions = wanted.iter().filter(|(function, ..)| function.is_none());
        let outputs = model.map_or(0, |model| model.describe().outputs.len());
        let mut next = outputs.saturating_sub(expressions.count());
        let events = wanted.iter().map(|(function, direction, is_terminal)| {
            let function = match function {
                Some(function) => Function::Python(function.clone_ref(py)),
                None => {
                    next += 1;
                    Function::Output(next - 1)
                }
            };
            (function, *direction, *is_terminal)
        });
        Self {
            events: events.collect(),
            model,
        }
    }
}

/// The events of a run in progress.
pub(crate) struct Events {
    events: Vec<(Function, i32, bool)>,
    signs: Vec<Sign>,
    model: Option<Box<dyn AnyModel>>,
}

impl Events {
    pub(crate) fn new(watched: Watched<'_>) -> Self {
        Self {
            signs: watched.events.iter().map(|_| Sign::default()).collect(),
            events: watched.events,
            model: watched.model.map(NativeModel::build),
        }
    }

    pub(crate) fn is_terminal(&self, event: usize) -> bool {
        self.events[event].2
    }

    /// Forgets the signs, because the motion jumps.
    pub(crate) fn jump(&mut self) {
        self.signs.iter_mut().for_each(Sign::jump);
    }

    /// The sign changes along a stretch of smooth motion, in order of time.
    pub(crate) fn follow(&mut self, piece: &dyn Piece) -> PyResult<Vec<Crossing>> {
        let (start, end) = piece.span();
        if self.events.is_empty() || start >= end {
            return Ok(Vec::new());
        }
        self.enter(&piece.at(start));
        let mut found = Vec::new();
        let mut states = States {
            piece,
            model: self.model.as_deref(),
            known: HashMap::new(),
        };
        for (event, (function, direction, _)) in self.events.iter().enumerate() {
            let mut value = |t: f64| states.value(function, t);
            for zero in self.signs[event].follow([start, end], &mut value)? {
                if *direction == 0 || (*direction > 0) == zero.rising {
                    let (t, rising) = (zero.t, zero.rising);
                    found.push(Crossing { t, event, rising });
                }
            }
        }
        found.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.event.cmp(&b.event)));
        Ok(found)
    }

    /// Sets the watched model to the mode of a state.
    fn enter(&mut self, point: &Point) {
        let Some((model, name)) = self.model.as_mut().zip(point.mode) else {
            return;
        };
        let modes = &model.description().modes;
        if let Some(mode) = modes.iter().position(|mode| mode.name == name) {
            model.set_mode(mode);
        }
    }
}

/// Requested states of a step, with the outputs of the watched model.
struct States<'a> {
    piece: &'a dyn Piece,
    model: Option<&'a dyn AnyModel>,
    known: HashMap<u64, (Point, Vec<f64>)>,
}

impl States<'_> {
    fn value(&mut self, function: &Function, t: f64) -> PyResult<f64> {
        let (piece, model) = (self.piece, self.model);
        let (point, outputs) = self.known.entry(t.to_bits()).or_insert_with(|| {
            let point = piece.at(t);
            let [q, qdot] = [&point.q, &point.qdot].map(|values| known(values));
            let outputs = model.and_then(|model| model.outputs(t, &q, &qdot));
            (point, outputs.unwrap_or_default())
        });
        match function {
            Function::Output(index) => Ok(outputs.get(*index).copied().unwrap_or(f64::NAN)),
            Function::Python(function) => Python::attach(|py| {
                let value = function.call1(py, (t, array(py, &point.q), array(py, &point.qdot)))?;
                value.extract(py)
            }),
        }
    }
}

/// Values with 0 for coordinates that a mode lacks.
fn known(values: &[f64]) -> Vec<f64> {
    let known = values.iter();
    known
        .map(|value| if value.is_nan() { 0.0 } else { *value })
        .collect()
}

fn array<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, values)
}

impl Calls {
    /// Calls the function of steps; true if it ends the run.
    pub(crate) fn step(&self, piece: &dyn Piece) -> PyResult<bool> {
        let Some(function) = &self.step else {
            return Ok(false);
        };
        let (_, t) = piece.span();
        let point = piece.at(t);
        Python::attach(|py| {
            let state = (t, array(py, &point.q), array(py, &point.qdot));
            stops(function.call1(py, state)?.bind(py))
        })
    }

    /// Calls the function of events at a crossing; true if it ends the run.
    pub(crate) fn crossing(&self, crossing: &Crossing, point: &Point) -> PyResult<bool> {
        let kind = if crossing.rising { "rising" } else { "falling" };
        self.event(kind, crossing.event, crossing.t, point, point)
    }

    /// Calls the function of events at an impact; true if it ends the run.
    pub(crate) fn impact(&self, impact: &Impact) -> PyResult<bool> {
        let Impact { before, after, .. } = impact;
        self.event("impact", impact.surface, impact.t, before, after)
    }

    /// Calls the function of events where a contact begins or ends; true if it ends the run.
    pub(crate) fn contact(&self, contact: &Contact) -> PyResult<bool> {
        let kind = if contact.begins { "contact" } else { "release" };
        self.event(kind, contact.surface, contact.t, &contact.at, &contact.at)
    }

    fn event(
        &self,
        kind: &str,
        index: usize,
        t: f64,
        before: &Point,
        after: &Point,
    ) -> PyResult<bool> {
        let Some(function) = &self.event else {
            return Ok(false);
        };
        Python::attach(|py| {
            let [before, after] =
                [before, after].map(|point| (array(py, &point.q), array(py, &point.qdot)));
            stops(
                function
                    .call1(py, (kind, index, t, before, after))?
                    .bind(py),
            )
        })
    }
}

/// True if the result of a function of the user ends the run.
fn stops(result: &Bound<'_, PyAny>) -> PyResult<bool> {
    if result.is_none() {
        return Ok(false);
    }
    if let Ok(word) = result.cast::<PyString>() {
        if word.to_str()? == "stop" {
            return Ok(true);
        }
    } else if let Ok(flag) = result.extract::<bool>() {
        return Ok(flag);
    }
    Err(refused(format!(
        "a callback returned {}; expected None or False to go on, True or \"stop\" to end the run",
        result.repr()?
    )))
}
