//! Sampling of the states of a run that a density counts.

use super::{Density, Visits};
use crate::model::Point;
use crate::run::Piece;

/// Sampler of one run.
pub struct Sampler<'a> {
    density: &'a Density,
    taken: u64,
    visits: Visits,
}

impl<'a> Sampler<'a> {
    /// A sampler before the start of a run.
    pub fn new(density: &'a Density) -> Self {
        Self {
            density,
            taken: 0,
            visits: Visits::new(density),
        }
    }

    /// Samples the states of a stretch of motion, without its last instant. That instant belongs to the next stretch,
    /// so that at an impact the state after it counts.
    pub fn follow(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        while let Some(t) = self.next_time().filter(|&t| t < end) {
            self.take(&piece.at(t));
        }
    }

    /// Samples the state at the last instant if a sample is due, and returns all visits.
    pub fn finish(mut self, t: f64, last: &Point) -> Visits {
        // Rounding may put the last sample time after the end.
        let reached = t * (1.0 + 4.0 * f64::EPSILON);
        while self.next_time().is_some_and(|time| time <= reached) {
            self.take(last);
        }
        self.visits.fold();
        self.visits
    }

    fn take(&mut self, point: &Point) {
        self.visits.push(self.taken, self.density.cell(point));
        self.taken += 1;
    }

    fn next_time(&self) -> Option<f64> {
        let Density {
            every,
            discard,
            samples,
            ..
        } = *self.density;
        (self.taken < samples).then(|| discard + (self.taken + 1) as f64 * every)
    }
}
