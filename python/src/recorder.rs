//! Samples, impacts and contacts of a run as columns of numbers, and the signals that come meanwhile.

use std::time::{Duration, Instant};

use dalembert::describe::ModeInfo;
use dalembert_driver::{Contact, Ending, Grid, Impact, Piece, Point, Watch};
use pyo3::prelude::*;

use crate::error;
use crate::model::NativeModel;
use crate::request::{Course, Request};
use crate::run::NativeRun;

/// The time between two looks at the signals of the process.
const PATIENCE: Duration = Duration::from_millis(50);

/// Steps between two looks at the clock.
const STEPS: u32 = 64;

/// States, one after the other; vectors row after row.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    pub t: Vec<f64>,
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
    pub p: Vec<f64>,
    pub energy: Vec<f64>,
    pub outputs: Vec<f64>,
    /// Points of the view; empty without one.
    pub view: Vec<f64>,
    /// Numbers of modes; empty without modes.
    pub mode: Vec<i64>,
}

/// Impacts, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Impacts {
    pub before: Columns,
    pub after: Columns,
    pub surfaces: Vec<i64>,
    /// Which were at the same time as another, and which so light that rounding may have decided them.
    pub simultaneous: Vec<bool>,
    pub grazing: Vec<bool>,
}

/// Moments where a surface begins or ceases to hold the motion.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    pub at: Columns,
    pub surfaces: Vec<i64>,
    pub begins: Vec<bool>,
    /// Time at which impacts accumulate, if a contact begins that way; else NaN.
    pub accumulation: Vec<f64>,
}

/// Samples, impacts and contacts of a run.
#[derive(Debug, Default)]
pub(crate) struct Record {
    pub samples: Columns,
    pub impacts: Impacts,
    pub contacts: Contacts,
}

impl Columns {
    fn push(&mut self, modes: &[ModeInfo], t: f64, point: &Point) {
        self.t.push(t);
        self.q.extend_from_slice(&point.q);
        self.qdot.extend_from_slice(&point.qdot);
        self.p.extend_from_slice(&point.p);
        self.energy.push(point.energy);
        self.outputs.extend_from_slice(&point.outputs);
        self.view.extend(point.view.iter().flatten());
        if let Some(name) = point.mode {
            let number = modes.iter().position(|mode| mode.name == name);
            self.mode.push(number.map_or(-1, |number| number as i64));
        }
    }
}

/// The times of samples, in order.
pub(crate) enum Times<'a> {
    /// Equally spaced.
    Grid(Grid),
    /// These.
    Listed(&'a [f64]),
}

impl Times<'_> {
    fn time(&self, index: usize) -> Option<f64> {
        match self {
            Self::Grid(grid) => grid.time(index as u64),
            Self::Listed(times) => times.get(index).copied(),
        }
    }
}

/// Records a run.
struct Recorder<'a> {
    modes: &'a [ModeInfo],
    times: Times<'a>,
    taken: usize,
    /// True if only samples are wanted: the run ends after the last.
    only_samples: bool,
    record: Record,
    signals: Signals,
}

/// Looks at the signals of the process from time to time.
pub(crate) struct Signals {
    last: Instant,
    steps: u32,
    pub interrupt: Option<PyErr>,
}

impl Signals {
    pub(crate) fn new() -> Self {
        Self {
            last: Instant::now(),
            steps: 0,
            interrupt: None,
        }
    }

    /// Looks after a step.
    pub(crate) fn look(&mut self) {
        self.steps = (self.steps + 1) % STEPS;
        if self.steps != 0 || self.last.elapsed() < PATIENCE {
            return;
        }
        self.last = Instant::now();
        self.interrupt = Python::attach(|py| py.check_signals()).err();
    }
}

impl Recorder<'_> {
    fn next_time(&self) -> Option<f64> {
        self.times.time(self.taken)
    }

    fn sample(&mut self, t: f64, point: &Point) {
        self.taken += 1;
        self.record.samples.push(self.modes, t, point);
    }

    /// Takes the samples at the last instant of the run.
    fn finish(mut self, ending: &Ending) -> Record {
        while let Some(time) = self.next_time().filter(|&time| time <= ending.t) {
            self.sample(time, &ending.last);
        }
        self.record
    }
}

impl Watch for Recorder<'_> {
    /// The step's last instant is left to the next step: at an impact, a sample shows the state after it.
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        while let Some(time) = self.next_time().filter(|&time| time < end) {
            self.sample(time, &piece.at(time));
        }
        self.signals.look();
    }

    fn impact(&mut self, impact: Impact) {
        let impacts = &mut self.record.impacts;
        impacts.before.push(self.modes, impact.t, &impact.before);
        impacts.after.push(self.modes, impact.t, &impact.after);
        impacts.surfaces.push(impact.surface as i64);
        impacts.simultaneous.push(impact.simultaneous);
        impacts.grazing.push(impact.graze);
    }

    fn contact(&mut self, contact: Contact) {
        let contacts = &mut self.record.contacts;
        contacts.at.push(self.modes, contact.t, &contact.at);
        contacts.surfaces.push(contact.surface as i64);
        contacts.begins.push(contact.begins);
        let accumulation = contact.accumulation;
        contacts.accumulation.push(accumulation.unwrap_or(f64::NAN));
    }

    fn wants_warnings(&self) -> bool {
        !self.only_samples
    }

    fn is_over(&self) -> bool {
        self.signals.interrupt.is_some() || (self.only_samples && self.next_time().is_none())
    }
}

/// Makes a run of a model.
pub(crate) fn simulate(
    py: Python<'_>,
    model: &NativeModel,
    request: Request<'_>,
) -> PyResult<NativeRun> {
    let built = model.build();
    let checked = built.check_parameters();
    checked.map_err(|reason| error::state(model.describe(), &reason.into()))?;
    let course = request.course(built.as_ref())?;
    drop(built);
    let listed = request
        .times
        .as_ref()
        .map(|times| times.as_array().to_vec());
    if let Some(times) = &listed {
        check_times(times, course.settings.until)?;
    }
    let mut grid = Grid {
        end: course.settings.until,
        count: request.samples,
    };
    let ends_by_impacts = course.settings.impacts.is_some() && !course.has_end;
    if listed.is_none() && grid.count > 0 && ends_by_impacts {
        // The end is not known beforehand: runs are deterministic, and the same one is made twice.
        let nothing = Times::Grid(Grid { count: 0, ..grid });
        grid.end = record(py, model, &course, nothing, false)?.1.t;
    }
    if grid.end == 0.0 {
        grid.count = grid.count.min(1);
    }
    let times = match &listed {
        Some(times) => Times::Listed(times),
        None => Times::Grid(grid),
    };
    let (record, ending) = record(py, model, &course, times, false)?;
    Ok(NativeRun::new(model.clone(), course, record, ending))
}

/// The states of a run at these times, in order, up to its end.
pub(crate) fn states_at(
    py: Python<'_>,
    model: &NativeModel,
    course: &Course,
    times: &[f64],
) -> PyResult<Columns> {
    check_times(times, course.settings.until)?;
    let (record, _) = record(py, model, course, Times::Listed(times), true)?;
    Ok(record.samples)
}

fn check_times(times: &[f64], until: f64) -> PyResult<()> {
    let is_refused = |time: &f64| !(0.0..=until).contains(time);
    if let Some(time) = times.iter().copied().find(|time| is_refused(time)) {
        return Err(error::refused(format!(
            "times: {time} is not accepted; expected times from 0 to {until}"
        )));
    }
    match times.is_sorted() {
        true => Ok(()),
        false => Err(error::refused("times: they are not in order; sort them")),
    }
}

/// Makes a run, detached from Python.
fn record(
    py: Python<'_>,
    model: &NativeModel,
    course: &Course,
    times: Times<'_>,
    only_samples: bool,
) -> PyResult<(Record, Ending)> {
    py.detach(|| {
        let built = model.build();
        let mut recorder = Recorder {
            modes: &model.describe().modes,
            times,
            taken: 0,
            only_samples,
            record: Record::default(),
            signals: Signals::new(),
        };
        let ending = built.simulate(&course.origin, &course.settings, &mut recorder);
        let ending = ending.map_err(|refusal| error::run(built.as_ref(), &refusal))?;
        match recorder.signals.interrupt.take() {
            Some(interrupt) => Err(interrupt),
            None => Ok((recorder.finish(&ending), ending)),
        }
    })
}
