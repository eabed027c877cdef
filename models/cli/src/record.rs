//! Records of a run: states at equally spaced times, the impacts, and the curve of a picture.
//!
//! Samples, impacts and contacts are forwarded during the run. Impacts are kept in memory only for a picture.

use std::io;

use dalembert_driver::{Contact, Grid, Impact, ImpactTally, Piece, Point, Watch};

use crate::error::CliError;
use crate::plot::trace::Trace;
use crate::progress::Progress;

/// Requested records of a run.
pub struct Wanted<'a> {
    /// The times of the samples.
    pub grid: Grid,
    /// An empty trace, if a picture is requested.
    pub trace: Option<Trace>,
    /// Receivers. Each gets the samples, impacts and contacts in order of time.
    pub keeps: Vec<&'a mut dyn Keep>,
}

/// Receiver of the data of a run. The first error ends the run.
pub trait Keep {
    /// The state at a time of the grid; an impact at the same instant comes first.
    fn sample(&mut self, t: f64, point: &Point) -> io::Result<()>;

    /// An impact happened.
    fn impact(&mut self, impact: &Impact) -> io::Result<()>;

    /// A surface begins or ceases to hold the motion.
    fn contact(&mut self, contact: &Contact) -> io::Result<()>;

    /// Converts an I/O error of this receiver to an error that names its file.
    fn failed(&self, error: io::Error) -> CliError;
}

/// Makes the requested records during a run.
pub struct Recorder<'a> {
    grid: Grid,
    /// Number of samples taken so far.
    taken: u64,
    keeps: Vec<&'a mut dyn Keep>,
    failure: Option<CliError>,
    record: Record,
    progress: Progress,
}

/// Records of a finished run.
pub struct Record {
    /// The impacts in order of time, if there is a picture.
    pub impacts: Vec<Impact>,
    /// The trace, if a picture was requested.
    pub trace: Option<Trace>,
    /// The numbers of impacts and contacts, with or without a picture.
    pub tally: ImpactTally,
}

impl<'a> Recorder<'a> {
    /// A recorder before the start of a run.
    pub fn new(wanted: Wanted<'a>, progress: Progress) -> Self {
        Self {
            grid: wanted.grid,
            taken: 0,
            keeps: wanted.keeps,
            failure: None,
            record: Record {
                impacts: Vec::new(),
                trace: wanted.trace,
                tally: ImpactTally::default(),
            },
            progress,
        }
    }

    /// Takes the samples that are left up to the end `t` of the run, where the state is `last`, and one at the end, wherever
    /// it is. Returns the records.
    ///
    /// # Errors
    /// The first error of a receiver.
    pub fn finish(mut self, t: f64, last: &Point) -> Result<Record, CliError> {
        while let Some(time) = self.next_time().filter(|&time| time <= t) {
            self.sample(time, last);
        }
        if self.grid.count > 0 && self.grid.time(self.taken.saturating_sub(1)) != Some(t) {
            self.sample(t, last);
        }
        if let Some(trace) = &mut self.record.trace {
            trace.end(t, last);
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

    /// Forwards data to all receivers, until one fails.
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
    /// The end of a step is sampled with the next step, so that a sample at the time of an impact shows the state after
    /// it.
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

    fn hears(&mut self, impact: &Impact<()>) -> bool {
        self.record.tally.count(impact);
        !self.keeps.is_empty() || self.record.trace.is_some()
    }

    fn impact(&mut self, impact: Impact) {
        self.hand_on(|keep| keep.impact(&impact));
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
