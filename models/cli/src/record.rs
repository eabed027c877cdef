//! What is kept of a run: states at equally spaced times, the impacts, and the trace for a picture.
//!
//! Samples, impacts and contacts are handed on while the run goes on; only a picture keeps impacts in memory.

use std::io;

use dalembert_driver::{Contact, Grid, Impact, Piece, Point, Watch};

use crate::error::CliError;
use crate::plot::trace::Trace;
use crate::progress::Progress;

/// What to keep of a run.
pub struct Wanted<'a> {
    /// The times of the samples.
    pub grid: Grid,
    /// The empty trace of a picture.
    pub trace: Option<Trace>,
    /// What samples, impacts and contacts are handed to, in order of time.
    pub keeps: Vec<&'a mut dyn Keep>,
}

/// Takes what a run shows. The first error ends the run.
pub trait Keep {
    /// The state at a time of the grid. An impact at that very instant came before.
    fn sample(&mut self, t: f64, point: &Point) -> io::Result<()>;

    /// An impact was carried out.
    fn impact(&mut self, impact: &Impact) -> io::Result<()>;

    /// A surface begins or ceases to hold the motion.
    fn contact(&mut self, contact: &Contact) -> io::Result<()>;

    /// What is said of an error.
    fn failed(&self, error: io::Error) -> CliError;
}

/// How many impacts there were.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally {
    /// On each surface.
    pub per_surface: Vec<u64>,
    /// So light that rounding may have decided them.
    pub grazing: u64,
    /// At the same time as another.
    pub simultaneous: u64,
    /// Times that a surface began to hold the motion.
    pub contacts: u64,
}

/// Keeps what was asked for while a run goes on.
pub struct Recorder<'a> {
    grid: Grid,
    /// Samples taken so far.
    taken: u64,
    keeps: Vec<&'a mut dyn Keep>,
    failure: Option<CliError>,
    record: Record,
    progress: Progress,
}

/// What is known of a run that has ended.
pub struct Record {
    /// Impacts, in order of time, if there is a picture.
    pub impacts: Vec<Impact>,
    /// The trace, if a picture was asked for.
    pub trace: Option<Trace>,
    /// The number of impacts, kept or not.
    pub tally: Tally,
}

impl Tally {
    /// Counts an impact.
    pub fn count(&mut self, impact: &Impact) {
        if self.per_surface.len() <= impact.surface {
            self.per_surface.resize(impact.surface + 1, 0);
        }
        self.per_surface[impact.surface] += 1;
        self.grazing += u64::from(impact.graze);
        self.simultaneous += u64::from(impact.simultaneous);
    }

    /// The impacts on one surface.
    pub fn on(&self, surface: usize) -> u64 {
        self.per_surface.get(surface).copied().unwrap_or(0)
    }

    /// All impacts.
    pub fn total(&self) -> u64 {
        self.per_surface.iter().sum()
    }
}

impl<'a> Recorder<'a> {
    /// A recorder that has seen nothing.
    pub fn new(wanted: Wanted<'a>, progress: Progress) -> Self {
        Self {
            grid: wanted.grid,
            taken: 0,
            keeps: wanted.keeps,
            failure: None,
            record: Record {
                impacts: Vec::new(),
                trace: wanted.trace,
                tally: Tally::default(),
            },
            progress,
        }
    }

    /// Takes the sample at the run's last instant, if the grid has one there.
    ///
    /// # Errors
    /// The first of what the run was handed to.
    pub fn finish(mut self, t: f64, last: &Point) -> Result<Record, CliError> {
        while let Some(time) = self.next_time().filter(|&time| time <= t) {
            self.sample(time, last);
        }
        if let Some(trace) = &mut self.record.trace {
            trace.corner(t, last);
        }
        self.progress.finish();
        match self.failure {
            None => Ok(self.record),
            Some(failure) => Err(failure),
        }
    }

    fn next_time(&self) -> Option<f64> {
        self.grid.time(self.taken)
    }

    fn sample(&mut self, t: f64, point: &Point) {
        self.taken += 1;
        self.hand_on(|keep| keep.sample(t, point));
    }

    /// Hands something on, until that fails once.
    fn hand_on(&mut self, mut give: impl FnMut(&mut dyn Keep) -> io::Result<()>) {
        if self.failure.is_some() {
            return;
        }
        for keep in &mut self.keeps {
            if let Err(error) = give(*keep) {
                self.failure = Some(keep.failed(error));
                return;
            }
        }
    }
}

impl Watch for Recorder<'_> {
    /// The step's last instant is left to the next step: at an impact, a sample shows the state after it.
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        while let Some(time) = self.next_time().filter(|&time| time < end) {
            self.sample(time, &piece.at(time));
        }
        if let Some(trace) = &mut self.record.trace {
            trace.follow(piece);
        }
        self.progress.at(end);
    }

    fn impact(&mut self, impact: Impact) {
        self.hand_on(|keep| keep.impact(&impact));
        self.record.tally.count(&impact);
        if let Some(trace) = &mut self.record.trace {
            trace.corner(impact.t, &impact.before);
            trace.corner(impact.t, &impact.after);
            self.record.impacts.push(impact);
        }
    }

    fn contact(&mut self, contact: Contact) {
        self.hand_on(|keep| keep.contact(&contact));
        self.record.tally.contacts += u64::from(contact.begins);
        if let Some(trace) = &mut self.record.trace {
            trace.corner(contact.t, &contact.at);
        }
    }

    fn wants_warnings(&self) -> bool {
        true
    }

    fn is_over(&self) -> bool {
        self.failure.is_some()
    }
}
