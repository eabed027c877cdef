//! Samples, impacts and contacts of a run as columns of numbers, and signals during the run.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use dalembert::describe::ModeInfo;
use dalembert_driver::{
    Changes, Contact, Control, Ending, Grid, Impact, Piece, Point, Refusal, Watch, steer,
};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error;
use crate::events::{Calls, Events, Watched};
use crate::model::NativeModel;
use crate::request::{Course, Request, Steering};
use crate::run::NativeRun;

/// Time between two checks for signals of the process.
const PATIENCE: Duration = Duration::from_millis(50);

/// Number of steps between two checks of the clock.
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
    /// True for an impact at the same time as another one.
    pub simultaneous: Vec<bool>,
    /// True for an impact so light that rounding may have decided it.
    pub grazing: Vec<bool>,
}

/// Events at which a surface begins or ceases to hold the motion.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    pub at: Columns,
    pub surfaces: Vec<i64>,
    pub begins: Vec<bool>,
    /// Time at which impacts accumulate, if a contact begins that way; else NaN.
    pub accumulation: Vec<f64>,
}

/// Events of the user.
#[derive(Debug, Default)]
pub(crate) struct Crossings {
    pub at: Columns,
    pub events: Vec<i64>,
    pub rising: Vec<bool>,
}

/// Samples, impacts, contacts and events of a run.
#[derive(Debug, Default)]
pub(crate) struct Record {
    pub samples: Columns,
    pub impacts: Impacts,
    pub contacts: Contacts,
    pub crossings: Crossings,
    pub stop: Option<Stop>,
}

/// An end of a run that the user requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stop {
    /// A terminal event.
    Event(usize),
    /// A callback, by its name.
    Call(&'static str),
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
    /// A list of times.
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
    /// True if only samples are requested: the run ends after the last sample.
    only_samples: bool,
    side: Side,
    events: Events,
    calls: Calls,
    /// The state at which an event ended the run inside a step.
    cut: Option<(f64, Point)>,
    record: Record,
    signals: Signals,
}

/// The side from which a state at the time of an impact is approached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Before,
    After,
}

/// Checks for signals of the process from time to time.
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

    /// Checks for signals after a step; true if a check was due.
    pub(crate) fn look(&mut self) -> bool {
        self.steps = (self.steps + 1) % STEPS;
        if self.steps != 0 || self.last.elapsed() < PATIENCE {
            return false;
        }
        self.last = Instant::now();
        self.take(Python::attach(|py| py.check_signals()));
        true
    }

    /// Returns the value of a result. For an error, keeps the first one and returns the default.
    fn take<T: Default>(&mut self, result: PyResult<T>) -> T {
        result.unwrap_or_else(|error| {
            self.interrupt.get_or_insert(error);
            T::default()
        })
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
    fn finish(mut self, ending: &mut Ending) -> Record {
        if let Some((t, point)) = self.cut.take() {
            (ending.t, ending.last) = (t, point);
        }
        while let Some(time) = self.next_time().filter(|&time| time <= ending.t) {
            self.sample(time, &ending.last);
        }
        self.record
    }

    /// Takes the samples of a stretch up to a time. The sample at that time is left to the next stretch, unless states
    /// before impacts are requested.
    fn take_samples(&mut self, piece: &dyn Piece, end: f64) {
        while let Some(time) = self.next_time() {
            if time > end || (time == end && self.side == Side::After) {
                break;
            }
            self.sample(time, &piece.at(time));
        }
    }

    /// Takes the events of a stretch, up to an event that ends the run.
    fn take_events(&mut self, piece: &dyn Piece) {
        let found = self.events.follow(piece);
        for crossing in self.signals.take(found) {
            let point = piece.at(crossing.t);
            let crossings = &mut self.record.crossings;
            crossings.at.push(self.modes, crossing.t, &point);
            crossings.events.push(crossing.event as i64);
            crossings.rising.push(crossing.rising);
            let called = self.calls.crossing(&crossing, &point);
            let stops = self.signals.take(called);
            self.record.stop = match self.events.is_terminal(crossing.event) {
                true => Some(Stop::Event(crossing.event)),
                false => stops.then_some(Stop::Call("on_event")),
            };
            if self.record.stop.is_some() {
                self.cut = Some((crossing.t, point));
                return;
            }
        }
    }

    /// Ends the run if a callback asks for it.
    fn heed(&mut self, name: &'static str, called: PyResult<bool>) {
        if self.signals.take(called) {
            self.record.stop.get_or_insert(Stop::Call(name));
        }
    }
}

impl Watch for Recorder<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        self.take_events(piece);
        let end = self.cut.as_ref().map_or(piece.span().1, |(t, _)| *t);
        self.take_samples(piece, end);
        if self.cut.is_none() {
            let called = self.calls.step(piece);
            self.heed("on_step", called);
        }
        if self.signals.look()
            && let Some(progress) = &self.calls.progress
        {
            let shown = Python::attach(|py| progress.call1(py, (end,)).map(drop));
            self.signals.take(shown);
        }
    }

    fn impact(&mut self, impact: Impact) {
        self.events.jump();
        let called = self.calls.impact(&impact);
        self.heed("on_event", called);
        let impacts = &mut self.record.impacts;
        impacts.before.push(self.modes, impact.t, &impact.before);
        impacts.after.push(self.modes, impact.t, &impact.after);
        impacts.surfaces.push(impact.surface as i64);
        impacts.simultaneous.push(impact.simultaneous);
        impacts.grazing.push(impact.graze);
    }

    fn contact(&mut self, contact: Contact) {
        let called = self.calls.contact(&contact);
        self.heed("on_event", called);
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
        let is_sampled = self.only_samples && self.next_time().is_none();
        self.signals.interrupt.is_some() || self.record.stop.is_some() || is_sampled
    }
}

/// Runs a model.
pub(crate) fn simulate(
    py: Python<'_>,
    model: &NativeModel,
    mut request: Request<'_>,
) -> PyResult<NativeRun> {
    let calls = request.calls();
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
        // The end is not known before the run. Runs are deterministic, so the same run is made twice.
        let nothing = Times::Grid(Grid { count: 0, ..grid });
        grid.end = record(py, model, &course, Samples::of(nothing))?.1.t;
    }
    if grid.end == 0.0 {
        grid.count = grid.count.min(1);
    }
    let times = match &listed {
        Some(times) => Times::Listed(times),
        None => Times::Grid(grid),
    };
    let watched = request.watched.as_ref().map(Py::get);
    let watched = Watched::of(py, &request.events, watched);
    let samples = Samples::of(times);
    let (record, ending) = record_watched(py, model, &course, samples, watched, calls)?;
    Ok(NativeRun::new(model.clone(), course, record, ending))
}

/// The states of a run at these times, in order, up to its end.
pub(crate) fn states_at(
    py: Python<'_>,
    model: &NativeModel,
    course: &Course,
    times: &[f64],
    side: Side,
) -> PyResult<Columns> {
    check_times(times, course.settings.until)?;
    let samples = Samples {
        times: Times::Listed(times),
        only: true,
        side,
    };
    Ok(record(py, model, course, samples)?.0.samples)
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

/// Requested samples.
struct Samples<'a> {
    times: Times<'a>,
    /// True if nothing else is requested.
    only: bool,
    side: Side,
}

impl<'a> Samples<'a> {
    fn of(times: Times<'a>) -> Self {
        Self {
            times,
            only: false,
            side: Side::After,
        }
    }
}

/// Makes a run without events and callbacks, detached from Python.
fn record(
    py: Python<'_>,
    model: &NativeModel,
    course: &Course,
    samples: Samples<'_>,
) -> PyResult<(Record, Ending)> {
    let (watched, calls) = (Watched::default(), Calls::default());
    record_watched(py, model, course, samples, watched, calls)
}

/// Makes a run, detached from Python.
fn record_watched(
    py: Python<'_>,
    model: &NativeModel,
    course: &Course,
    samples: Samples<'_>,
    watched: Watched<'_>,
    calls: Calls,
) -> PyResult<(Record, Ending)> {
    py.detach(|| {
        let built = model.build();
        let mut recorder = Recorder {
            modes: &model.describe().modes,
            times: samples.times,
            taken: 0,
            only_samples: samples.only,
            side: samples.side,
            events: Events::new(watched),
            calls,
            cut: None,
            record: Record::default(),
            signals: Signals::new(),
        };
        let ending = match &course.steering {
            None => built.simulate(&course.origin, &course.settings, &mut recorder),
            Some(steering) => steered(model, course, steering, &mut recorder)?,
        };
        let mut ending = ending.map_err(|refusal| error::run(built.as_ref(), &refusal))?;
        match recorder.signals.interrupt.take() {
            Some(interrupt) => Err(interrupt),
            None => Ok((recorder.finish(&mut ending), ending)),
        }
    })
}

/// Makes a run whose inputs are a function of the user.
fn steered(
    model: &NativeModel,
    course: &Course,
    steering: &Steering,
    recorder: &mut Recorder<'_>,
) -> PyResult<Result<Ending, Refusal>> {
    let count = model.form.documentation.inputs.len();
    let failure = RefCell::new(None);
    let inputs = |t: f64, q: &[f64], qdot: &[f64]| -> Vec<f64> {
        let values = Python::attach(|py| {
            let state = (
                t,
                PyArray1::from_slice(py, q),
                PyArray1::from_slice(py, qdot),
            );
            steering.function.call1(py, state)?.extract(py)
        });
        values.unwrap_or_else(|error| {
            failure.borrow_mut().get_or_insert(error);
            vec![f64::NAN; count]
        })
    };
    let control = Control {
        inputs: &inputs,
        changes: steering.period.map_or(Changes::Everywhere, Changes::Held),
    };
    let (origin, settings) = (&course.origin, &course.settings);
    let ended = steer(
        &model.form,
        &model.values,
        origin,
        settings,
        &control,
        recorder,
    );
    match failure.into_inner() {
        Some(failure) => Err(failure),
        None => ended.ok_or_else(|| {
            error::refused("inputs: the model is too large for inputs that are functions")
        }),
    }
}
