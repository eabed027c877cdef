//! What is kept of a run: states at equally spaced times, the impacts, and the trace for a picture.

use crate::driver::{Contact, Impact, Piece, Watch};
use crate::entry::Point;
use crate::plot::trace::Trace;
use crate::progress::Progress;

/// `count` equally spaced times from 0 to `end`, both included; the time 0 alone if `count` is 1.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// The last time.
    pub end: f64,
    /// The number of times.
    pub count: u64,
}

impl Grid {
    /// The time of this index; `None` past the last.
    pub fn time(&self, index: u64) -> Option<f64> {
        let last = self.count.checked_sub(1)?;
        match index {
            0 => Some(0.0),
            _ if index < last => Some(self.end * (index as f64 / last as f64)),
            _ => (index == last).then_some(self.end),
        }
    }
}

/// What to keep of a run.
pub struct Wanted {
    /// The times of the samples.
    pub grid: Grid,
    /// Whether to keep every impact, or to count them only.
    pub impacts: bool,
    /// The empty trace of a picture.
    pub trace: Option<Trace>,
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
pub struct Recorder {
    grid: Grid,
    keeps_impacts: bool,
    /// Samples taken so far, in order of time.
    pub samples: Vec<(f64, Point)>,
    /// Impacts, in order of time, if they were asked for.
    pub impacts: Vec<Impact>,
    /// Where surfaces begin and cease to hold the motion, if impacts were asked for.
    pub contacts: Vec<Contact>,
    /// The trace, if a picture was asked for.
    pub trace: Option<Trace>,
    /// The number of impacts, kept or not.
    pub tally: Tally,
    progress: Progress,
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

impl Recorder {
    /// A recorder that has seen nothing.
    pub fn new(wanted: Wanted, progress: Progress) -> Self {
        Self {
            grid: wanted.grid,
            keeps_impacts: wanted.impacts,
            samples: Vec::new(),
            impacts: Vec::new(),
            contacts: Vec::new(),
            trace: wanted.trace,
            tally: Tally::default(),
            progress,
        }
    }

    /// Takes the sample at the run's last instant, if the grid has one there.
    pub fn finish(&mut self, t: f64, last: &Point) {
        while let Some(time) = self.next_time().filter(|&time| time <= t) {
            self.samples.push((time, last.clone()));
        }
        if let Some(trace) = &mut self.trace {
            trace.corner(t, last);
        }
        self.progress.finish();
    }

    fn next_time(&self) -> Option<f64> {
        self.grid.time(self.samples.len() as u64)
    }
}

impl Watch for Recorder {
    /// The step's last instant is left to the next step: at an impact, a sample shows the state after it.
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        while let Some(time) = self.next_time().filter(|&time| time < end) {
            self.samples.push((time, piece.at(time)));
        }
        if let Some(trace) = &mut self.trace {
            trace.follow(piece);
        }
        self.progress.at(end);
    }

    fn impact(&mut self, impact: Impact) {
        if let Some(trace) = &mut self.trace {
            trace.corner(impact.t, &impact.before);
            trace.corner(impact.t, &impact.after);
        }
        self.tally.count(&impact);
        if self.keeps_impacts {
            self.impacts.push(impact);
        }
    }

    fn contact(&mut self, contact: Contact) {
        if let Some(trace) = &mut self.trace {
            trace.corner(contact.t, &contact.at);
        }
        self.tally.contacts += u64::from(contact.begins);
        if self.keeps_impacts {
            self.contacts.push(contact);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(grid: Grid) -> Vec<f64> {
        (0..).map_while(|index| grid.time(index)).collect()
    }

    #[test]
    fn a_grid_holds_both_ends_exactly() {
        assert_eq!(times(Grid { end: 0.3, count: 4 }).len(), 4);
        assert_eq!(times(Grid { end: 0.3, count: 4 }).last(), Some(&0.3));
        assert_eq!(times(Grid { end: 2.0, count: 3 }), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn short_grids() {
        assert!(times(Grid { end: 2.0, count: 0 }).is_empty());
        assert_eq!(times(Grid { end: 2.0, count: 1 }), [0.0]);
        assert_eq!(times(Grid { end: 2.0, count: 2 }), [0.0, 2.0]);
    }
}
