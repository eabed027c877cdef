//! Record of a run for comparisons: its positions at given times, its impacts and its end.

use std::ops::ControlFlow;

use dalembert::audit::Finding;
use dalembert::describe::Topology;
use dalembert::integrate::Counters;
use dalembert::{Event, Hold, Observer, Outcome, Segment, StateVector};

use super::{AT_END, TIMES};
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
    limits: Vec<Limit>,
}

/// A time at which impacts on a surface accumulate. How many of them are carried out before it, rounding decides.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limit {
    t: f64,
    surface: usize,
    /// Number of impacts of the run before it.
    impacts: usize,
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
            limits: Vec::new(),
        }
    }

    fn next_time(&self) -> Option<f64> {
        self.times.time(self.positions.len() as u64)
    }

    fn note_limit(&mut self, t: f64, surface: usize) {
        if self.impacts.len() < KEPT {
            self.limits.push(Limit {
                t,
                surface,
                impacts: self.impacts.len(),
            });
        }
    }

    /// The track of the run that this probe has observed, with the result of its audit.
    pub fn track(mut self, solved: &Solved<M::State>, audit: Audited) -> Track {
        if let Outcome::Zeno { t, surface } = solved.run.outcome {
            self.note_limit(t, surface);
        }
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
            limits: self.limits,
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

    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        if let Some(t) = hold.accumulation {
            self.note_limit(t, hold.surface);
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
    /// Accumulations of impacts, in order of time.
    limits: Vec<Limit>,
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
        let mut from = [0, 0];
        for (this, others) in self.limits.iter().zip(&other.limits) {
            if this.surface != others.surface {
                break;
            }
            let until = [this.impacts, others.impacts];
            let differs = self.differs_between(other, from, until, Some(this.surface));
            if differs.is_some() {
                return differs;
            }
            from = until;
        }
        // Impacts before an accumulation were compared already.
        let rest = [self.impacts.len() - from[0], other.impacts.len() - from[1]];
        let more = [
            self.more_at_end(other).min(rest[0]),
            other.more_at_end(self).min(rest[1]),
        ];
        let until = [self.impacts.len() - more[0], other.impacts.len() - more[1]];
        let differs = self.differs_between(other, from, until, None);
        let end = |track: &Self, from: usize| {
            let impacts = track.counters.impacts.saturating_sub(from as u64);
            (track.outcome.kind(), track.limits.len(), impacts)
        };
        let ends_alike = end(self, from[0] + more[0]) == end(other, from[1] + more[1]);
        differs.or_else(|| (!ends_alike).then_some(Difference::End))
    }

    /// Number of impacts that this run has more than the other, if they lie at its end: rounding decides whether an impact
    /// lies before or after it.
    fn more_at_end(&self, other: &Self) -> usize {
        let more = self.impacts.len().saturating_sub(other.impacts.len());
        let last = &self.impacts[self.impacts.len() - more..];
        let is_at_end = |met: &Met| (met.t - self.t).abs() <= AT_END * self.t.abs();
        match last.iter().all(is_at_end) {
            true => more,
            false => 0,
        }
    }

    /// The first difference between impacts of both runs. Before an accumulation on a surface, one of the runs may have more
    /// impacts on it.
    fn differs_between(
        &self,
        other: &Self,
        from: [usize; 2],
        until: [usize; 2],
        accumulating: Option<usize>,
    ) -> Option<Difference> {
        let at = |place: usize| {
            let of = |track: &Self, k: usize| {
                let index = from[k] + place;
                (index < until[k]).then(|| track.impacts[index])
            };
            [of(self, 0), of(other, 1)]
        };
        let longest = (until[0] - from[0]).max(until[1] - from[1]);
        let differs = |place: &usize| {
            let surfaces = at(*place).map(|met| met.map(|met| met.surface));
            match surfaces {
                [Some(this), Some(others)] => this != others,
                [Some(one), None] | [None, Some(one)] => Some(one) != accumulating,
                [None, None] => false,
            }
        };
        (0..longest).find(differs).map(|place| Difference::Impact {
            number: from[0] + place + 1,
            met: at(place),
        })
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

    /// The largest relative difference from `reference` of a position, of the time of an accumulation, or of the time at the end.
    /// It is infinite if a position is NaN. A run that ends where impacts accumulate ends at the limit, not at its last impact.
    pub fn distance(&self, reference: &Self) -> f64 {
        let scales: Vec<f64> = (0..self.topologies.len())
            .map(|i| reference.scale(i))
            .collect();
        let pairs = self.positions.iter().zip(&reference.positions);
        let accumulates = |track: &Self| matches!(track.outcome, Outcome::Zeno { .. });
        let is_limit = accumulates(self) && accumulates(reference);
        let ends = (!is_limit).then_some((&self.last, &reference.last));
        let pairs = pairs.chain(ends);
        let differences = pairs.flat_map(|(left, right)| {
            let components = left.iter().zip(right).zip(&scales);
            components.map(|((left, right), scale)| (left - right).abs() / scale)
        });
        let limits = self.limits.iter().zip(&reference.limits);
        let times = limits.map(|(this, others)| [this.t, others.t]);
        let ends = (!is_limit).then_some([self.t, reference.t]);
        // Two runs of length 0 have equal ends.
        let late = times
            .chain(ends)
            .map(|[this, others]| match this == others {
                true => 0.0,
                false => ((this - others) / others).abs(),
            });
        let number = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        differences.chain(late).map(number).fold(0.0, f64::max)
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
