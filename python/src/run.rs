//! Runs that have ended, as arrays of numpy.

use std::sync::{Mutex, PoisonError};

use dalembert_driver::outcome::{self, Fact};
use dalembert_driver::{Ending, Variable, differentiate, names};
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use crate::error;
use crate::model::NativeModel;
use crate::recorder::{self, Columns, Contacts, Crossings, Impacts, Record, Side, Signals, Stop};
use crate::request::Course;

/// States, one per row.
#[pyclass(frozen, get_all, module = "dalembert._native")]
pub struct Table {
    t: Py<PyArray1<f64>>,
    q: Py<PyArray2<f64>>,
    qdot: Py<PyArray2<f64>>,
    p: Py<PyArray2<f64>>,
    energy: Py<PyArray1<f64>>,
    outputs: Py<PyArray2<f64>>,
    view: Option<Py<PyArray2<f64>>>,
    mode: Option<Py<PyArray1<i64>>>,
}

/// Impacts, one per row.
#[pyclass(frozen, get_all, module = "dalembert._native")]
pub struct ImpactTable {
    before: Py<Table>,
    after: Py<Table>,
    surfaces: Py<PyArray1<i64>>,
    simultaneous: Py<PyArray1<bool>>,
    grazing: Py<PyArray1<bool>>,
}

/// Events at which a surface begins or ceases to hold the motion, one per row.
#[pyclass(frozen, get_all, module = "dalembert._native")]
pub struct ContactTable {
    at: Py<Table>,
    surfaces: Py<PyArray1<i64>>,
    begins: Py<PyArray1<bool>>,
    accumulation: Py<PyArray1<f64>>,
}

/// Events of the user, one per row.
#[pyclass(frozen, get_all, module = "dalembert._native")]
pub struct CrossingTable {
    at: Py<Table>,
    events: Py<PyArray1<i64>>,
    rising: Py<PyArray1<bool>>,
}

/// A run that has ended.
#[pyclass(frozen, module = "dalembert._native")]
pub struct NativeRun {
    model: NativeModel,
    course: Course,
    ending: Ending,
    samples: Lazy<Columns, Table>,
    impacts: Lazy<Impacts, ImpactTable>,
    contacts: Lazy<Contacts, ContactTable>,
    crossings: Lazy<Crossings, CrossingTable>,
    stop: Option<Stop>,
}

/// Columns that become arrays at their first use.
struct Lazy<C, T> {
    columns: Mutex<Option<C>>,
    made: PyOnceLock<Py<T>>,
}

impl<C: Default, T> Lazy<C, T> {
    fn new(columns: C) -> Self {
        Self {
            columns: Mutex::new(Some(columns)),
            made: PyOnceLock::new(),
        }
    }

    fn get(&self, py: Python<'_>, make: impl FnOnce(C) -> PyResult<Py<T>>) -> PyResult<Py<T>> {
        let made = self.made.get_or_try_init(py, || {
            let columns = self.columns.lock().unwrap_or_else(PoisonError::into_inner);
            make({ columns }.take().unwrap_or_default())
        });
        Ok(made?.clone_ref(py))
    }
}

impl Table {
    /// The columns as arrays that own them.
    fn of(py: Python<'_>, model: &NativeModel, columns: Columns) -> PyResult<Py<Self>> {
        let description = model.describe();
        let (n, outputs) = (description.coordinates.len(), description.outputs.len());
        let rows = columns.t.len();
        let table = Self {
            q: matrix(py, columns.q, rows, n)?,
            qdot: matrix(py, columns.qdot, rows, n)?,
            p: matrix(py, columns.p, rows, n)?,
            energy: array(py, columns.energy),
            outputs: matrix(py, columns.outputs, rows, outputs)?,
            view: match description.view {
                Some(_) => Some(matrix(py, columns.view, rows, 2)?),
                None => None,
            },
            mode: (!description.modes.is_empty()).then(|| array(py, columns.mode)),
            t: array(py, columns.t),
        };
        Py::new(py, table)
    }
}

fn array<T: Element>(py: Python<'_>, values: Vec<T>) -> Py<PyArray1<T>> {
    values.into_pyarray(py).unbind()
}

fn matrix(
    py: Python<'_>,
    values: Vec<f64>,
    rows: usize,
    columns: usize,
) -> PyResult<Py<PyArray2<f64>>> {
    Ok(values.into_pyarray(py).reshape([rows, columns])?.unbind())
}

impl NativeRun {
    pub(crate) fn new(model: NativeModel, course: Course, record: Record, ending: Ending) -> Self {
        Self {
            model,
            course,
            ending,
            samples: Lazy::new(record.samples),
            impacts: Lazy::new(record.impacts),
            contacts: Lazy::new(record.contacts),
            crossings: Lazy::new(record.crossings),
            stop: record.stop,
        }
    }
}

#[pymethods]
impl NativeRun {
    /// The samples.
    #[getter]
    fn samples(&self, py: Python<'_>) -> PyResult<Py<Table>> {
        self.samples
            .get(py, |columns| Table::of(py, &self.model, columns))
    }

    /// The impacts.
    #[getter]
    fn impacts(&self, py: Python<'_>) -> PyResult<Py<ImpactTable>> {
        self.impacts.get(py, |impacts| {
            let table = ImpactTable {
                before: Table::of(py, &self.model, impacts.before)?,
                after: Table::of(py, &self.model, impacts.after)?,
                surfaces: array(py, impacts.surfaces),
                simultaneous: array(py, impacts.simultaneous),
                grazing: array(py, impacts.grazing),
            };
            Py::new(py, table)
        })
    }

    /// The contacts.
    #[getter]
    fn contacts(&self, py: Python<'_>) -> PyResult<Py<ContactTable>> {
        self.contacts.get(py, |contacts| {
            let table = ContactTable {
                at: Table::of(py, &self.model, contacts.at)?,
                surfaces: array(py, contacts.surfaces),
                begins: array(py, contacts.begins),
                accumulation: array(py, contacts.accumulation),
            };
            Py::new(py, table)
        })
    }

    /// The events of the user.
    #[getter]
    fn crossings(&self, py: Python<'_>) -> PyResult<Py<CrossingTable>> {
        self.crossings.get(py, |crossings| {
            let table = CrossingTable {
                at: Table::of(py, &self.model, crossings.at)?,
                events: array(py, crossings.events),
                rising: array(py, crossings.rising),
            };
            Py::new(py, table)
        })
    }

    /// The kind of the outcome.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.stop {
            Some(Stop::Event(_)) => "event",
            Some(Stop::Call(_)) => "stopped",
            None => self.ending.outcome.kind(),
        }
    }

    /// The event or the callback that ended the run.
    #[getter]
    fn stop(&self) -> (Option<usize>, Option<&'static str>) {
        match self.stop {
            Some(Stop::Event(event)) => (Some(event), None),
            Some(Stop::Call(name)) => (None, Some(name)),
            None => (None, None),
        }
    }

    /// The last time.
    #[getter]
    fn t_end(&self) -> f64 {
        self.ending.t
    }

    /// True if the requested time, number of impacts or event was reached.
    #[getter]
    fn reached(&self) -> bool {
        self.ending.reached || matches!(self.stop, Some(Stop::Event(_)))
    }

    /// The outcome in words.
    #[getter]
    fn words(&self) -> String {
        self.ending.outcome.to_string()
    }

    /// Details of the outcome, by name.
    #[getter]
    fn details<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, fact) in outcome::details(self.model.describe(), &self.ending.outcome) {
            dict.set_item(name, value(py, fact)?)?;
        }
        Ok(dict)
    }

    /// Counts of work by name.
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, count) in outcome::counters(&self.ending.counters) {
            dict.set_item(name, count)?;
        }
        Ok(dict)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.ending.warnings.clone()
    }

    /// The form, the integrator, the tolerance and the fixed step, if there is one.
    #[getter]
    fn settings(&self) -> (&'static str, &'static str, f64, Option<f64>) {
        let settings = &self.course.settings;
        let (form, integrator) = (settings.form.name(), settings.integrator.name());
        (form, integrator, settings.tol, self.ending.step)
    }

    /// The law in force on each surface, by name.
    #[getter]
    fn laws(&self) -> Vec<(&'static str, Option<String>)> {
        let surfaces = names::surfaces(self.model.describe());
        let laws = self.ending.laws.iter();
        let laws = laws.map(|law| law.map(|law| law.to_string()));
        surfaces.zip(laws).collect()
    }

    /// The last state: positions, velocities, energy.
    #[getter]
    fn last(&self) -> (Vec<f64>, Vec<f64>, f64) {
        let last = &self.ending.last;
        (last.q.clone(), last.qdot.clone(), last.energy)
    }

    /// Derivatives of the last positions and velocities, one column for each variable.
    fn jacobian(&self, py: Python<'_>, wrt: Vec<String>) -> PyResult<Py<PyArray2<f64>>> {
        let description = self.model.describe();
        if self.course.steering.is_some() {
            return Err(error::refused(
                "jacobian: the derivatives of inputs that are functions are not known",
            ));
        }
        let variables = wrt.iter().map(|name| Variable::find(description, name));
        let variables: Vec<Variable> = variables
            .collect::<Result<_, _>>()
            .map_err(error::refused)?;
        let found = py.detach(|| {
            let built = self.model.build();
            let mut signals = Signals::new();
            let mut is_over = || {
                let _ = signals.look();
                signals.interrupt.is_some()
            };
            let origin = &self.course.origin;
            let mut settings = self.course.settings.clone();
            if self.stop.is_some() {
                settings.until = self.ending.t;
            }
            let settings = &settings;
            let form = &self.model.form;
            let start = (&*self.model.values, self.model.mode);
            let varied = differentiate(form, start, origin, settings, &variables, &mut is_over);
            match signals.interrupt {
                Some(interrupt) => Err(interrupt),
                None => varied.map_err(|refusal| error::run(built.as_ref(), &refusal)),
            }
        })?;
        let found = found.map_err(|reason| error::variation(description, &reason))?;
        let rows = 2 * description.coordinates.len();
        let columns = found.q.iter().zip(&found.qdot);
        let columns: Vec<f64> = columns
            .flat_map(|(q, qdot)| q.iter().chain(qdot))
            .copied()
            .collect();
        let matrix = columns.into_pyarray(py).reshape([wrt.len(), rows])?;
        Ok(matrix.transpose()?.unbind())
    }

    /// States at these times, in order, from a repetition of the run. With `before`, states at impacts are those before
    /// them.
    fn at(
        &self,
        py: Python<'_>,
        times: PyReadonlyArray1<'_, f64>,
        before: bool,
    ) -> PyResult<Py<Table>> {
        let times = times.as_array().to_vec();
        let side = if before { Side::Before } else { Side::After };
        let columns = recorder::states_at(py, &self.model, &self.course, &times, side)?;
        Table::of(py, &self.model, columns)
    }
}

fn value<'py>(py: Python<'py>, fact: Fact) -> PyResult<Bound<'py, PyAny>> {
    match fact {
        Fact::Number(number) => number.into_bound_py_any(py),
        Fact::Index(index) => index.into_bound_py_any(py),
        Fact::Flag(flag) => flag.into_bound_py_any(py),
        Fact::Name(name) => name.into_bound_py_any(py),
        Fact::List(facts) => {
            let values: PyResult<Vec<_>> = facts.into_iter().map(|it| value(py, it)).collect();
            values?.into_bound_py_any(py)
        }
    }
}
