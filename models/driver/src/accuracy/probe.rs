//! Record of a run for comparisons: its positions at given times, its impacts and its end.

use std::ops::ControlFlow;

use dalembert::audit::Finding;
use dalembert::describe::Topology;
use dalembert::integrate::Counters;
use dalembert::{Event, Observer, Outcome, Segment, StateVector};

use super::TIMES;
use crate::grid::Grid;
use crate::names;
use crate::run::{Ending, Solved};
use crate::typed::Model;

/// Largest number of impacts that are kept for comparison; later impacts are only counted.
const KEPT: usize = 1 << 20;

/// Records positions at equally spaced times, and the sequence of impacts.
pub struct Probe<'a, M> {
    model: &'a M,
    times: Grid,
    positions: Vec<Vec<f64>>,
    impacts: Vec<Met>,
}

/// An impact: its time, and the index of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    pub t: f64,
    pub surface: usize,
}

impl<'a, M: Model> Probe<'a, M> {
    /// A probe of a run from 0 to `until`.
    pub fn new(model: &'a M, until: f64) -> Self {
        Self {
            model,
            times: Grid {
                end: until,
                count: TIMES + 1,
            },
            positions: Vec::new(),
            impacts: Vec::new(),
        }
    }

    fn next_time(&self) -> Option<f64> {
        self.times.time(self.positions.len() as u64)
    }

    /// The track of the run that this probe has observed, with the result of its audit.
    pub fn track(self, solved: &Solved<M::State>, audit: Audited) -> Track {
        let last = self.model.position(&solved.run.state);
        let description = self.model.description();
        Track {
            surfaces: names::surfaces(description).collect(),
            topologies: description
                .coordinates
                .iter()
                .map(|coordinate| coordinate.topology)
                .collect(),
            positions: self.positions,
            impacts: self.impacts,
            audit,
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
                Err(_) => vec![f64::NAN; self.model.description().coordinates.len()],
            };
            self.positions.push(position);
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        if self.impacts.len() < KEPT {
            self.impacts.push(Met {
                t: event.t,
                surface: event.surface,
            });
        }
        ControlFlow::Continue(())
    }
}

/// The finding of the audit of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Audited {
    /// The run was not audited.
    Not,
    /// The scene has surfaces that cannot be audited.
    Impossible,
    /// No surface is met between impacts.
    Confirmed,
    /// A surface may be met between impacts, or the audit found another defect.
    Doubted(Finding),
}

impl Audited {
    /// The reason for which the events of the run `name` are not confirmed.
    fn doubt(self, surfaces: &[&str], name: &str) -> Option<String> {
        let surface = |index: usize| surfaces.get(index).copied().unwrap_or_default();
        match self {
            Self::Confirmed => None,
            Self::Not => Some(format!("the impacts of {name} were not checked")),
            Self::Impossible => Some(format!(
                "the impacts of {name} cannot be checked: the effects of this scene allow no independent search"
            )),
            Self::Doubted(Finding::MayBeMet { surface: index, t }) => Some(format!(
                "{name} may miss an impact on `{}` at t = {t}",
                surface(index)
            )),
            Self::Doubted(Finding::Misplaced { surface: index, t }) => Some(format!(
                "{name} has an impact at t = {t} that does not lie on `{}`",
                surface(index)
            )),
            Self::Doubted(Finding::NoDenseOutput { t }) => Some(format!(
                "{name} has no dense output at t = {t}, so that impacts cannot be checked there"
            )),
            Self::Doubted(_) => Some(format!("the impacts of {name} are not confirmed")),
        }
    }
}

/// The first difference between two runs.
enum Difference {
    /// The impact with this number, counted from 1, in both runs; `None` for a run that does not have it.
    Impact {
        number: usize,
        met: [Option<Met>; 2],
    },
    /// The outcomes or the numbers of impacts.
    End,
}

/// Samples of a run.
#[derive(Debug, Clone)]
pub struct Track {
    /// The names of the surfaces.
    surfaces: Vec<&'static str>,
    /// The topologies of the coordinates.
    topologies: Vec<Topology>,
    /// Positions at each time that the run reached.
    positions: Vec<Vec<f64>>,
    /// The first impacts, in order of time.
    impacts: Vec<Met>,
    audit: Audited,
    /// Positions at the end.
    last: Vec<f64>,
    pub outcome: Outcome,
    pub t: f64,
    pub counters: Counters,
    pub step: Option<f64>,
}

impl Track {
    /// True if both meet the same surfaces in the same order and end for the same reason.
    pub fn ends_as(&self, other: &Self) -> bool {
        self.difference(other).is_none()
    }

    /// Describes the first difference between the events of both runs. `names` are the names of this run and of `other`.
    pub fn difference_from(&self, other: &Self, names: [&str; 2]) -> Option<String> {
        let [this, others] = names;
        match self.difference(other)? {
            Difference::Impact { number, met } => {
                let [met, other_met] = met.map(|met| self.told(met));
                Some(format!(
                    "the runs differ at impact {number}: {this} {met}, {others} {other_met}"
                ))
            }
            Difference::End => Some(format!(
                "the runs end differently: {this} with {} after {} impacts, {others} with {} after {}",
                self.outcome.kind(),
                self.counters.impacts,
                other.outcome.kind(),
                other.counters.impacts
            )),
        }
    }

    fn difference(&self, other: &Self) -> Option<Difference> {
        let at = |index: usize| [self, other].map(|track| track.impacts.get(index).copied());
        let longest = self.impacts.len().max(other.impacts.len());
        let surfaces = |[a, b]: [Option<Met>; 2]| [a, b].map(|met| met.map(|met| met.surface));
        let differs = |index: &usize| {
            let [this, others] = surfaces(at(*index));
            this != others
        };
        if let Some(index) = (0..longest).find(differs) {
            return Some(Difference::Impact {
                number: index + 1,
                met: at(index),
            });
        }
        let ends = |track: &Self| (track.outcome.kind(), track.counters.impacts);
        (ends(self) != ends(other)).then_some(Difference::End)
    }

    /// Describes an impact.
    fn told(&self, met: Option<Met>) -> String {
        match met {
            None => "has no further impact".to_owned(),
            Some(Met { t, surface }) => {
                let name = self.surfaces.get(surface).copied();
                format!("hits `{}` at t = {t}", name.unwrap_or_default())
            }
        }
    }

    /// The reason for which the events of the run, called `name`, are not confirmed independently of event location;
    /// `None` if they are.
    pub fn doubt(&self, name: &str) -> Option<String> {
        self.audit.doubt(&self.surfaces, name)
    }

    /// True if the run that ended with `ending` is the same to the last digit. Coordinates that the mode does not have
    /// are not compared.
    pub fn is_run_of(&self, ending: &Ending) -> bool {
        let mut pairs = self.last.iter().zip(&ending.last.q);
        self.t == ending.t
            && self.outcome.kind() == ending.outcome.kind()
            && pairs.all(|(left, right)| left == right || right.is_nan())
    }

    /// The largest relative difference from `reference` of a position, or of the time at the end. It is infinite if a
    /// position is NaN.
    pub fn distance(&self, reference: &Self) -> f64 {
        let scales: Vec<f64> = (0..self.topologies.len())
            .map(|i| reference.scale(i))
            .collect();
        let pairs = self.positions.iter().zip(&reference.positions);
        let pairs = pairs.chain([(&self.last, &reference.last)]);
        let differences = pairs.flat_map(|(left, right)| {
            let components = left.iter().zip(right).zip(&scales);
            components.map(|((left, right), scale)| (left - right).abs() / scale)
        });
        let late = (self.t - reference.t).abs();
        // Two runs of length 0 have equal ends.
        let end = if late == 0.0 { 0.0 } else { late / reference.t };
        let number = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        differences.map(number).fold(number(end), f64::max)
    }

    /// The largest absolute value of a coordinate; at least 1 for an angle, and 1 for a coordinate that stays at 0.
    fn scale(&self, coordinate: usize) -> f64 {
        let positions = self.positions.iter().chain([&self.last]);
        let values = positions.map(|position| position[coordinate].abs());
        let largest = values.fold(0.0, f64::max);
        match self.topologies[coordinate] {
            Topology::Circle => largest.max(1.0),
            _ if largest > 0.0 => largest,
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_without_an_audit_is_not_confirmed() {
        let finding = Finding::NoDenseOutput { t: 1.0 };
        for audit in [Audited::Not, Audited::Impossible, Audited::Doubted(finding)] {
            let doubt = audit.doubt(&[], "the run").expect("a doubt");
            assert!(doubt.contains("the run"), "{audit:?}: {doubt}");
        }
        assert_eq!(Audited::Confirmed.doubt(&[], "the run"), None);
    }
}
