//! Ensembles: the rows of some members, with sums that merge exactly.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use dalembert_driver::ensemble::density::{Axis, Counts, Density, MOST_BINS, convergence};
use dalembert_driver::ensemble::exact::ExactSum;
use dalembert_driver::ensemble::parquet::{self, Writer};
use dalembert_driver::ensemble::row::{Columns, Field, Kind, is_behind};
use dalembert_driver::ensemble::runner::{Common, Done, End, Runner, Shared};
use dalembert_driver::ensemble::{Members, Quantity, Tally, Values, is_reached, pilot};
use dalembert_driver::words::Advice;
use dalembert_driver::{AnyModel, Beginning, OffConstraint, Settings};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{self, refused};
use crate::model::NativeModel;
use crate::request::{Given, Request};

/// Time between two checks for signals of the process.
const PATIENCE: Duration = Duration::from_millis(50);

/// Number of members that the runner takes at once, for integrators that run them side by side.
const BLOCK: u64 = 64;

/// Members of an ensemble: the varied quantities, each with its values, or rows with a value of every quantity.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Varied<'py> {
    /// Name, kind and numbers.
    values: Vec<(String, String, Vec<f64>)>,
    seed: Option<u64>,
    count: u64,
    /// Rows of values, one after the other.
    rows: Option<PyReadonlyArray1<'py, f64>>,
    /// Index of the member of the first row.
    first: u64,
}

/// Axes of a density with their ranges and numbers of bins, and times of the states.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Counted {
    axes: Vec<(String, Option<[f64; 2]>, usize)>,
    every: f64,
    discard: f64,
}

/// Fraction of the states of a density, their number, and the distances between halves of the states: split by time,
/// split by members, and expected for independent states.
type Checked = (f64, u64, f64, f64, f64);

/// An ensemble of runs of a model.
#[pyclass(frozen, module = "dalembert._native")]
pub struct NativeEnsemble {
    model: NativeModel,
    start: Given,
    off_constraint: OffConstraint,
    settings: Settings,
    end: End,
    members: Members,
    density: Option<Density>,
    columns: Columns,
    stopped: AtomicBool,
}

impl Common for NativeEnsemble {
    fn model(&self) -> Result<Box<dyn AnyModel>, String> {
        Ok(self.model.build())
    }

    fn beginning(&self, model: &dyn AnyModel) -> Result<Beginning, String> {
        let beginning = self.start.beginning(model);
        beginning.map_err(|error| Python::attach(|py| error.value(py).to_string()))
    }

    fn advice(&self) -> &Advice {
        &error::ADVICE
    }

    fn is_over(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}

/// Rows of some members, and sums over them.
struct Unit {
    rows: Writer<Vec<u8>>,
    tally: Tally,
    sums: Vec<ExactSum>,
    counts: Option<Counts>,
}

#[pymethods]
impl NativeEnsemble {
    /// An ensemble. Only a few members run here, to find ranges of a density that are not given.
    #[new]
    fn new(
        py: Python<'_>,
        model: &NativeModel,
        request: Request<'_>,
        varied: Varied<'_>,
        density: Option<Counted>,
    ) -> PyResult<Self> {
        let built = model.build();
        let members = members(built.as_ref(), &varied)?;
        let off_constraint = request.off_constraint()?;
        let start = request.start();
        let moved = |quantity: &Quantity| matches!(quantity, Quantity::Velocity(_));
        if start.beginning(built.as_ref())?.has_momenta() && members.quantities().iter().any(moved)
        {
            return Err(refused(
                "p: it gives momenta, and velocities are varied; give qdot",
            ));
        }
        let mut ensemble = Self {
            columns: Columns::of(model.describe(), &members),
            settings: request.settings(built.as_ref(), off_constraint)?,
            end: request.end(),
            model: model.clone(),
            start,
            off_constraint,
            members,
            density: None,
            stopped: AtomicBool::new(false),
        };
        if let Some(density) = density {
            ensemble.density = Some(ensemble.measured(py, &density)?);
        }
        Ok(ensemble)
    }

    /// Names of the columns, with the type of their values.
    fn columns(&self) -> Vec<(String, &'static str)> {
        let columns = self.columns.iter();
        columns
            .map(|(name, kind)| {
                let kind = match kind {
                    Kind::Integer => "integer",
                    Kind::Number => "number",
                    Kind::Text => "text",
                };
                (name.to_owned(), kind)
            })
            .collect()
    }

    /// The axes of the density, with their ranges.
    fn axes(&self) -> Vec<(String, [f64; 2], usize)> {
        let axes = self.density.iter().flat_map(|density| &density.axes);
        axes.map(|axis| (axis.name.clone(), axis.range, axis.bins))
            .collect()
    }

    /// Ends all running calls of `run` with an error.
    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Runs members from `first` on, until `last` (exclusive) or until the time is over. Returns their number, rows and
    /// sums.
    fn run<'py>(
        &self,
        py: Python<'py>,
        first: u64,
        last: u64,
        seconds: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let begun = Instant::now();
        let unit = py.detach(|| self.made(first..last, seconds))?;
        let dict = self.told(py, unit)?;
        dict.set_item("seconds", begun.elapsed().as_secs_f64())?;
        Ok(dict)
    }

    /// Convergence of a density from the counts of all members: fraction, states, distances between halves.
    fn convergence(&self, counts: &[u8]) -> PyResult<Vec<Checked>> {
        let density = self.counted()?;
        let members = self.members.count();
        let checkpoints = convergence(&self.read(counts)?, density, members).into_iter();
        Ok(checkpoints
            .map(|it| {
                let distances = (it.over_time, it.over_members, it.independent);
                (it.part, it.samples, distances.0, distances.1, distances.2)
            })
            .collect())
    }

    /// States in each cell, the first axis running fastest, and states outside of all cells, from the counts of all
    /// members.
    fn states(&self, counts: &[u8]) -> PyResult<(Vec<u64>, u64)> {
        let counts = self.read(counts)?;
        Ok((counts.total(), counts.outside()))
    }
}

impl NativeEnsemble {
    fn shared(&self) -> Shared<'_> {
        Shared {
            common: self,
            off_constraint: self.off_constraint,
            settings: &self.settings,
            end: self.end,
            members: &self.members,
            density: self.density.as_ref(),
            starts: &[],
        }
    }

    /// The density, with its ranges.
    fn measured(&self, py: Python<'_>, given: &Counted) -> PyResult<Density> {
        let axes: PyResult<Vec<Axis>> = given
            .axes
            .iter()
            .map(|(name, range, bins)| {
                if !(1..=MOST_BINS).contains(bins) {
                    return Err(refused(format!(
                        "bins: {bins} is not accepted; expected a number from 1 to {MOST_BINS}"
                    )));
                }
                let axis = Axis::named(name, *range, *bins, self.model.describe());
                axis.map_err(|unknown| refused(format!("density: {unknown}")))
            })
            .collect();
        let axes: [Axis; 2] = axes?
            .try_into()
            .map_err(|_| refused("density: expected two quantities"))?;
        let times = [given.every, given.discard];
        let density = py.detach(|| pilot::density(axes, self.shared(), times));
        density.map_err(refused)?.ok_or_else(|| {
            refused(
                "density: a run ends before the first counted state; make every or discard smaller, or until later",
            )
        })
    }

    /// Runs members until the end of the range, or until the time is over; at least one block.
    fn made(&self, members: Range<u64>, seconds: f64) -> PyResult<Unit> {
        let mut runner = Runner::new(self.shared()).map_err(refused)?;
        let numbers = self
            .columns
            .iter()
            .filter(|(_, kind)| *kind != Kind::Text)
            .count();
        let mut unit = Unit {
            rows: Writer::new(Vec::new(), &self.columns, []).map_err(failed)?,
            tally: Tally::new(&self.columns),
            sums: vec![ExactSum::default(); numbers],
            counts: self.density.as_ref().map(Counts::new),
        };
        let is_abreast = runner.is_abreast();
        let (begun, mut looked) = (Instant::now(), Instant::now());
        let mut next = members.start;
        while next < members.end
            && (next == members.start || begun.elapsed().as_secs_f64() < seconds)
        {
            let block = if is_abreast { BLOCK } else { 1 };
            let end = members.end.min(next + block);
            for (member, done) in (next..end).zip(runner.run(next..end)) {
                unit.add(member, done, &self.settings)?;
            }
            next = end;
            if looked.elapsed() >= PATIENCE {
                looked = Instant::now();
                Python::attach(|py| py.check_signals())?;
            }
            if self.is_over() {
                return Err(refused("the ensemble was stopped"));
            }
        }
        Ok(unit)
    }

    /// A unit as data of Python.
    fn told<'py>(&self, py: Python<'py>, unit: Unit) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let tally = &unit.tally;
        dict.set_item("members", tally.members)?;
        let rows = unit.rows.finish().map_err(failed)?;
        dict.set_item("rows", PyBytes::new(py, &rows))?;
        dict.set_item("outcomes", tally.outcomes.clone())?;
        dict.set_item("not_reached", tally.strayed)?;
        let first = tally.first_strayed.iter();
        let first = first.map(|it| (it.member, it.outcome.as_str(), it.reason.as_str()));
        dict.set_item("first_not_reached", first.collect::<Vec<_>>())?;
        dict.set_item("energy_change", tally.energy_change)?;
        dict.set_item("energy_change_relative", tally.relative_change)?;
        let sums = unit.sums.iter().map(|sum| {
            let whole = (
                PyBytes::new(py, &sum.sum()),
                PyBytes::new(py, &sum.squares()),
            );
            (sum.count, sum.least, sum.greatest, whole.0, whole.1)
        });
        dict.set_item("sums", sums.collect::<Vec<_>>())?;
        let counts = unit.counts.as_ref().map(|counts| {
            let mut bytes = Vec::new();
            counts.write(&mut bytes).map(|()| PyBytes::new(py, &bytes))
        });
        dict.set_item("counts", counts.transpose()?)?;
        Ok(dict)
    }

    fn counted(&self) -> PyResult<&Density> {
        let density = self.density.as_ref();
        density.ok_or_else(|| refused("the ensemble counts no density"))
    }

    fn read(&self, mut bytes: &[u8]) -> PyResult<Counts> {
        let mut counts = Counts::new(self.counted()?);
        counts.read(&mut bytes)?;
        Ok(counts)
    }
}

impl Unit {
    fn add(&mut self, member: u64, done: Done, settings: &Settings) -> PyResult<()> {
        self.tally
            .add(&done.row, |outcome| is_reached(outcome, settings));
        let counted = (!is_behind(&done.row)).then_some(&done.row);
        let numbers = counted
            .into_iter()
            .flatten()
            .filter_map(|field| match field {
                Field::Integer(count) => Some(*count as f64),
                Field::Number(number) => Some(*number),
                Field::Text(_) => None,
            });
        for (sum, number) in self.sums.iter_mut().zip(numbers) {
            sum.add(number);
        }
        if let (Some(counts), Some(visits)) = (&mut self.counts, &done.visits) {
            counts.add(member, visits);
        }
        self.rows.add(done.row).map_err(failed)
    }
}

/// An error of Parquet.
fn failed(error: impl std::error::Error) -> PyErr {
    PyOSError::new_err(format!("Parquet: {error}"))
}

/// The values of a column of a part, in Parquet: an array of whole numbers or numbers, or a list of texts.
#[pyfunction]
pub fn column<'py>(py: Python<'py>, part: &[u8], place: usize) -> PyResult<Bound<'py, PyAny>> {
    let part = part.to_vec().into();
    let values = py
        .detach(|| parquet::column(&part, place))
        .map_err(failed)?;
    Ok(match values {
        parquet::Values::Integers(values) => values.into_pyarray(py).into_any(),
        parquet::Values::Numbers(values) => values.into_pyarray(py).into_any(),
        parquet::Values::Texts(values) => values.into_pyobject(py)?.into_any(),
    })
}

/// The rows of a part, in Parquet, as lines of CSV.
#[pyfunction]
pub fn csv_lines<'py>(py: Python<'py>, part: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
    let part = part.to_vec().into();
    let lines = py.detach(|| parquet::csv_lines(&part)).map_err(failed)?;
    Ok(PyBytes::new(py, &lines))
}

/// The requested members of a model.
fn members(model: &dyn AnyModel, varied: &Varied<'_>) -> PyResult<Members> {
    let description = model.description();
    let mut named = Vec::new();
    for (name, kind, numbers) in &varied.values {
        let found = Quantity::find(name, description);
        let (name, quantity) = found
            .and_then(|(name, quantity)| {
                quantity.check_present(model, &name)?;
                Ok((name, quantity))
            })
            .map_err(|unknown| refused(format!("vary: {unknown}")))?;
        named.push((name, quantity, values(kind, numbers)?));
    }
    Ok(match &varied.rows {
        None => Members::product(named, varied.seed, varied.count),
        Some(rows) => {
            let named = named
                .into_iter()
                .map(|(name, quantity, _)| (name, quantity));
            Members::listed(named.collect(), rows.as_array().to_vec(), varied.first)
        }
    })
}

/// Values of a kind, from the numbers that describe them.
fn values(kind: &str, numbers: &[f64]) -> PyResult<Values> {
    Ok(match (kind, numbers) {
        ("spaced", &[low, high, count]) => Values::Spaced {
            ends: [low, high],
            count: count as u64,
        },
        ("uniform", &[low, high]) => Values::Uniform([low, high]),
        ("normal", &[mean, deviation]) => Values::Normal { mean, deviation },
        ("list", numbers) => Values::List(numbers.to_vec()),
        (kind, _) => return Err(refused(format!("vary: no values of the kind {kind}"))),
    })
}
