//! What a run leaves behind to be compared: its positions at given times, and how it ended.

use std::ops::ControlFlow;

use dalembert::describe::{Description, Topology};
use dalembert::integrate::Counters;
use dalembert::{Observer, Outcome, Segment, StateVector};

use super::TIMES;
use crate::driver::Solved;
use crate::entry::Model;
use crate::record::Grid;

/// Keeps positions at equally spaced times.
pub struct Probe<'a, M> {
    model: &'a M,
    times: Grid,
    positions: Vec<Vec<f64>>,
}

impl<'a, M: Model> Probe<'a, M> {
    /// For a run from 0 to `until`.
    pub fn new(model: &'a M, until: f64) -> Self {
        Self {
            model,
            times: Grid {
                end: until,
                count: TIMES + 1,
            },
            positions: Vec::new(),
        }
    }

    fn next_time(&self) -> Option<f64> {
        self.times.time(self.positions.len() as u64)
    }

    /// The track of the run that was watched.
    pub fn track(self, solved: &Solved<M::State>) -> Track {
        let last = self.model.position(&solved.run.state);
        Track {
            description: M::DESCRIPTION,
            positions: self.positions,
            last: last.as_slice().to_vec(),
            outcome: solved.run.outcome,
            t: solved.run.t,
            counters: solved.run.counters,
            step: solved.step,
        }
    }
}

impl<M: Model> Observer<M> for Probe<'_, M> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        let end = segment.t_end();
        while let Some(t) = self.next_time().filter(|&t| t <= end) {
            let position = match segment.at(t) {
                Ok(state) => self.model.position(&state).as_slice().to_vec(),
                Err(_) => vec![f64::NAN; M::DESCRIPTION.coordinates.len()],
            };
            self.positions.push(position);
        }
        ControlFlow::Continue(())
    }
}

/// A run in a few numbers.
#[derive(Debug, Clone)]
pub struct Track {
    description: Description,
    /// At each time that was reached.
    positions: Vec<Vec<f64>>,
    /// At the end.
    last: Vec<f64>,
    pub outcome: Outcome,
    pub t: f64,
    pub counters: Counters,
    pub step: Option<f64>,
}

impl Track {
    /// Whether both end for the same reason after as many impacts.
    pub fn ends_as(&self, other: &Self) -> bool {
        self.outcome.kind() == other.outcome.kind()
            && self.counters.impacts == other.counters.impacts
    }

    /// The largest difference of a position, or of the times at the end, as a share of what `reference` has there.
    /// Infinite where a position is not a number.
    pub fn distance(&self, reference: &Self) -> f64 {
        let scales: Vec<f64> = (0..self.description.coordinates.len())
            .map(|i| reference.scale(i))
            .collect();
        let pairs = self.positions.iter().zip(&reference.positions);
        let pairs = pairs.chain([(&self.last, &reference.last)]);
        let differences = pairs.flat_map(|(own, right)| {
            let components = own.iter().zip(right).zip(&scales);
            components.map(|((own, right), scale)| (own - right).abs() / scale)
        });
        let late = (self.t - reference.t).abs();
        // A run that ends where it begins has no length to compare with.
        let end = if late == 0.0 { 0.0 } else { late / reference.t };
        let number = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        differences.map(number).fold(number(end), f64::max)
    }

    /// The largest absolute value of a coordinate; at least 1 for an angle, and 1 for what stays at 0.
    fn scale(&self, coordinate: usize) -> f64 {
        let positions = self.positions.iter().chain([&self.last]);
        let values = positions.map(|position| position[coordinate].abs());
        let largest = values.fold(0.0, f64::max);
        match self.description.coordinates[coordinate].topology {
            Topology::Circle => largest.max(1.0),
            _ if largest > 0.0 => largest,
            _ => 1.0,
        }
    }
}
