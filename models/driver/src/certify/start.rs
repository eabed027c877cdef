//! The box of initial states of certified motion.

use dalembert::numbers::{Interval, Numbers, Row};
use dalembert::{Constrained, Fault, Instance, StateError, TaylorField, Variational, VectorField};

use super::{Certification, Subject};
use crate::integrator::Form;
use crate::least_squares::solve;
use crate::model::{OffConstraint, Rates};
use crate::owner::Common;
use crate::refusal::{Refusal, Uncertified};

type Parameters = <Common<'static> as TaylorField>::Parameters<Interval>;
type Positions = <Common<'static> as Variational>::Configuration<Interval>;
type State = <Common<'static> as TaylorField>::Row<Interval>;

/// Ranges by the index of their quantity.
type Ranges = [(usize, Interval)];

/// The values of the parameters, some of them replaced by ranges.
pub(super) fn parameters(system: &Common<'_>, ranges: &Ranges) -> Parameters {
    let values = TaylorField::parameters(system);
    let mut parameters: Parameters = row(values.as_slice());
    replace(parameters.as_mut_slice(), ranges);
    parameters
}

/// Ranges of the components of the initial states.
pub(super) fn ranges(
    subject: &Subject<'_>,
    system: &Common<'_>,
    request: &Certification,
) -> Result<Vec<Interval>, Refusal> {
    let tables = &system.form().tables;
    if !tables.modes.is_empty() {
        return Ok(subject.state.iter().copied().map(Interval::point).collect());
    }
    let beginning = Beginning {
        subject,
        system,
        request,
    };
    let start = match tables.dimensions.constraints {
        0 => beginning.free()?,
        _ => beginning.bound()?,
    };
    debug_assert_eq!(start.len(), system.state_len(), "a state of the form");
    Ok(start)
}

/// The start of a model without modes.
struct Beginning<'a> {
    subject: &'a Subject<'a>,
    system: &'a Common<'a>,
    request: &'a Certification,
}

impl Beginning<'_> {
    /// The start of a model without constraints. Ranges of parameters move the declared values.
    fn free(&self) -> Result<Vec<Interval>, Refusal> {
        let parameters = parameters(self.system, &self.request.parameters);
        let is_global = self.request.form == Form::Global;
        let [mut q, mut qdot] = self.moved(&parameters)?;
        if is_global {
            q.extend_from_slice(&self.request.positions);
            qdot.extend_from_slice(&self.request.rates);
        }
        self.composed(&parameters, [&q, &qdot])
    }

    /// The start of a model with constraints: one state for all values of the parameters, with ranges of positions and
    /// quasi-velocities.
    fn bound(&self) -> Result<Vec<Interval>, Refusal> {
        let all = &self.request.parameters;
        if self.is_moved_by(all)? {
            let mut culprits = all.iter().map(std::slice::from_ref);
            let culprit = culprits.find(|one| matches!(self.is_moved_by(one), Ok(true)));
            let index = culprit.unwrap_or(all)[0].0;
            let parameter = self.system.description().parameters[index].name;
            return Err(Uncertified::MovingStart { parameter }.into());
        }
        self.composed(&parameters(self.system, all), [&[], &[]])
    }

    /// The states of a box of positions and velocities. In the reduced form the ranges of the request replace positions
    /// and quasi-velocities.
    fn composed(
        &self,
        parameters: &Parameters,
        ranges: [&Ranges; 2],
    ) -> Result<Vec<Interval>, Refusal> {
        let is_reduced = self.request.form == Form::Reduced;
        let mut start = match (&self.subject.origin.rates, self.subject.origin.policy) {
            (Rates::Velocities(qdot), OffConstraint::Error | OffConstraint::Keep) => {
                let [q, qdot] = [(&self.subject.origin.q, ranges[0]), (qdot, ranges[1])].map(
                    |(values, ranges)| {
                        let mut boxed: Positions = row(values);
                        replace(boxed.as_mut_slice(), ranges);
                        boxed
                    },
                );
                let state = self.system.composed(parameters, Interval::ZERO, &q, &qdot);
                state.map_err(StateError::from)?.as_slice().to_vec()
            }
            (Rates::Momenta(_), _) if is_reduced && !self.request.parameters.is_empty() => {
                return Err(Uncertified::MomentaOfRanges.into());
            }
            _ => self.state().as_slice().to_vec(),
        };
        let (q, motion) = start.split_at_mut(self.subject.origin.q.len());
        replace(q, ranges[0]);
        replace(q, &self.request.positions);
        if is_reduced {
            replace(motion, &self.request.rates);
        }
        Ok(start)
    }

    /// The state of the origin.
    fn state(&self) -> State {
        row(self.subject.state)
    }

    /// The declared positions and velocities of the origin that the ranges of parameters move, with their ranges.
    fn moved(&self, parameters: &Parameters) -> Result<[Vec<(usize, Interval)>; 2], Refusal> {
        let of = |parameters| self.system.declared_start(parameters);
        let [q, qdot] = of(parameters).map_err(StateError::from)?;
        let [middle_q, middle_qdot] = of(&self.middle()).map_err(StateError::from)?;
        let moved = |values: &[f64], ranges: &Positions, middle: &Positions| {
            let pairs = ranges.as_slice().iter().zip(middle.as_slice());
            let entries = pairs.zip(values).enumerate();
            let is_moved =
                |&(_, ((range, middle), &value)): &(_, ((&Interval, &Interval), &f64))| {
                    range != middle && middle.lo <= value && value <= middle.hi
                };
            let moved = entries.filter(is_moved);
            moved.map(|(i, ((range, _), _))| (i, *range)).collect()
        };
        let velocities = match &self.subject.origin.rates {
            Rates::Velocities(values) => moved(values, &qdot, &middle_qdot),
            Rates::Momenta(_) => Vec::new(),
        };
        Ok([moved(&self.subject.origin.q, &q, &middle_q), velocities])
    }

    /// The parameters without ranges.
    fn middle(&self) -> Parameters {
        parameters(self.system, &[])
    }

    /// True if these ranges of parameters move declared values of the origin, or if the origin violates a constraint for
    /// some of them.
    fn is_moved_by(&self, ranges: &Ranges) -> Result<bool, Refusal> {
        if ranges.is_empty() {
            return Ok(false);
        }
        let [ranged, middle] = [parameters(self.system, ranges), self.middle()];
        let [q, qdot] = self.moved(&ranged)?;
        if !q.is_empty() || !qdot.is_empty() {
            return Ok(true);
        }
        let pair = [&ranged, &middle];
        let found = match self.request.form {
            Form::Reduced => self.moves_quasi_velocities(pair),
            Form::Global => self.moves_residuals(pair),
        };
        let found = found.and_then(|found| Ok(found || self.moves_levels(pair)?));
        Ok(found.map_err(StateError::from)?)
    }

    /// True if quasi-velocities follow from the named velocities in another way for other parameters: a named velocity of the
    /// state differs between two choices of parameters, or the named velocities leave quasi-velocities to constraints that
    /// differ.
    fn moves_quasi_velocities(&self, pair: [&Parameters; 2]) -> Result<bool, Fault> {
        let quasi_velocities = self.system.form().tables.dimensions.motion;
        if self.request.rates.len() >= quasi_velocities {
            return Ok(false);
        }
        let state = self.state();
        let of = |parameters| self.named(parameters, &state);
        let [one, other] = [of(pair[0])?, of(pair[1])?];
        if one != other {
            return Ok(true);
        }
        let start = state.as_slice().len() - quasi_velocities;
        let mut columns = Vec::new();
        for k in start..state.as_slice().len() {
            let mut moved = state;
            moved.as_mut_slice()[k] = moved.as_slice()[k] + Interval::point(1.0);
            let changes = self.named(pair[1], &moved)?.into_iter().zip(&other);
            columns.push(changes.map(|(to, from)| (to - *from).middle()).collect());
        }
        let is_determined = solve(&columns, &vec![0.0; other.len()]).is_some();
        Ok(!is_determined && self.moves_residuals(pair)?)
    }

    /// The named velocities of a state.
    fn named(&self, parameters: &Parameters, state: &State) -> Result<Vec<Interval>, Fault> {
        let velocities = self.system.velocities(parameters, Interval::ZERO, state)?;
        let is_named = |i: usize| self.request.named.get(i).is_none_or(|named| *named);
        let velocities = velocities.as_slice().iter().copied().enumerate();
        Ok(velocities
            .filter(|(i, _)| is_named(*i))
            .map(|it| it.1)
            .collect())
    }

    /// True if the residual of a constraint at the origin differs between two choices of parameters.
    fn moves_residuals(&self, pair: [&Parameters; 2]) -> Result<bool, Fault> {
        let Rates::Velocities(qdot) = &self.subject.origin.rates else {
            return Ok(false);
        };
        let [q, qdot]: [Positions; 2] = [row(&self.subject.origin.q), row(qdot)];
        let of = |parameters| {
            self.system
                .residuals_at(parameters, Interval::ZERO, &q, &qdot)
        };
        Ok(of(pair[0])?.as_slice() != of(pair[1])?.as_slice())
    }

    /// True if a level that is declared to be 0 differs between two choices of parameters.
    fn moves_levels(&self, pair: [&Parameters; 2]) -> Result<bool, Fault> {
        let declared = self.system.declared_levels();
        if declared.iter().all(|level| !level.is_zero) {
            return Ok(false);
        }
        let state = self.state();
        let of = |parameters| self.system.deviations(parameters, Interval::ZERO, &state);
        let [one, other] = [of(pair[0])?, of(pair[1])?];
        let off = one.as_slice().len() - declared.len();
        let pairs = one.as_slice()[off..].iter().zip(&other.as_slice()[off..]);
        let mut zero = pairs.zip(declared).filter(|(_, level)| level.is_zero);
        Ok(zero.any(|((one, other), _)| one != other))
    }
}

fn row<R: Row<Interval>>(values: &[f64]) -> R {
    let mut row = R::zeros(values.len());
    for (entry, value) in row.as_mut_slice().iter_mut().zip(values) {
        *entry = Interval::of(*value);
    }
    row
}

fn replace(entries: &mut [Interval], ranges: &Ranges) {
    for &(index, range) in ranges {
        if let Some(entry) = entries.get_mut(index) {
            *entry = range;
        }
    }
}
