//! `VectorField`, `System`, `Lagrangian` and `Divergence` of every declared model.

use super::declared::{number, several, vector, write};
use super::{At, Declared, Form, HasConstraints, HasDivergence, Kernels};
use crate::contract::{Divergence, Lagrangian, RankDrop, System, VectorField};
use crate::error::{Fault, ParameterError, StateError};
use crate::generated::check_coefficient;
use crate::nearest::nearest_by_steps;
use crate::numbers::{Numbers, Rated, Row};
use crate::state::StateVector;

impl<S: Declared> VectorField for S {
    type State = S::State;

    #[inline(always)]
    fn state_len(&self) -> usize {
        let dimensions = &self.tables().dimensions;
        dimensions.coordinates + dimensions.motion
    }

    #[inline]
    fn rate(&self, t: f64, state: &S::State, rate: &mut S::State) -> Result<(), Fault> {
        let places = [state.as_slice(), &[]];
        write(self, S::Kernels::rate, t, places, rate.as_mut_slice())
    }

    #[inline]
    fn scale(&self, t: f64, state: &S::State) -> S::State {
        let mut scale = state.zeroed();
        let places = [state.as_slice(), &[]];
        // Units have no guards.
        let _ = write(self, S::Kernels::scale, t, places, scale.as_mut_slice());
        scale
    }

    #[inline(always)]
    fn can_be_narrow(&self) -> bool {
        self.tables().can_be_narrow
    }

    fn rates_along(
        &self,
        t: Rated,
        component: &dyn Fn(usize) -> Rated,
        rate: &mut dyn FnMut(usize, Rated),
    ) -> Result<(), Fault> {
        // NOTE: a constant, so that kernels over intervals are compiled only where they are asked for.
        if const { !S::MAY_BE_NARROW } {
            return Err(Fault::NotDerived);
        }
        let mut state = S::Components::<Rated>::zeros(self.state_len());
        for (i, entry) in state.as_mut_slice().iter_mut().enumerate() {
            *entry = component(i);
        }
        let mut rates = state.zeroed();
        let arguments: S::Arguments<Rated> = over_numbers(self);
        let at = At {
            parameters: arguments.as_slice(),
            t,
            first: state.as_slice(),
            second: &[],
        };
        self.kernels().rate(at, rates.as_mut_slice())?;
        for (i, own) in rates.as_slice().iter().enumerate() {
            rate(i, *own);
        }
        Ok(())
    }
}

/// The parameters as numbers of any kind.
#[inline(always)]
pub(super) fn over_numbers<S: Declared, L: Numbers>(system: &S) -> S::Arguments<L> {
    let values = system.arguments();
    let values = values.as_ref();
    let mut numbers = S::Arguments::<L>::zeros(values.len());
    for (number, value) in numbers.as_mut_slice().iter_mut().zip(values) {
        *number = L::of(*value);
    }
    numbers
}

/// Positions and what a state holds of the motion as one state.
#[inline(always)]
fn joined<S: Declared>(q: &[f64], motion: &[f64]) -> S::State {
    let mut state = S::State::zeros(q.len() + motion.len());
    let (positions, rest) = state.as_mut_slice().split_at_mut(q.len());
    positions.copy_from_slice(q);
    rest.copy_from_slice(motion);
    state
}

/// A state whose motion is given by a kernel of positions and something else.
#[inline(always)]
fn state_by<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    q: &S::Vector,
    other: &S::Vector,
) -> Result<S::State, Fault> {
    let mut state = system.zero_state();
    let (positions, motion) = state.as_mut_slice().split_at_mut(q.count());
    positions.copy_from_slice(q.as_slice());
    write(system, kernel, t, [q.as_slice(), other.as_slice()], motion)?;
    Ok(state)
}

/// As [`System::state_nearest`], by Newton's steps from constraints that are not linear in the velocities.
///
/// # Errors
/// As [`nearest_by_steps`].
pub fn nearest_of_declared<S: Declared + HasConstraints>(
    system: &S,
    t: f64,
    q: &S::Vector,
    qdot: &S::Vector,
) -> Result<S::State, Fault> {
    nearest_by_steps(system, t, q, qdot, |qdot| {
        state_by(system, S::Kernels::nearest, t, q, qdot)
    })
}

impl<S: Declared> System for S {
    type Vector = S::Vector;
    type Impulse = S::Impulse;

    #[inline(always)]
    fn coordinate_count(&self) -> usize {
        self.tables().dimensions.coordinates
    }

    #[inline(always)]
    fn impulse_len(&self) -> usize {
        self.tables().dimensions.motion
    }

    #[inline]
    fn position(&self, state: &S::State) -> S::Vector {
        S::Vector::of(&state.as_slice()[..self.coordinate_count()])
    }

    #[inline]
    fn velocity(&self, t: f64, state: &S::State) -> Result<S::Vector, Fault> {
        let kernel = (S::Kernels::velocity, self.coordinate_count());
        vector(self, kernel, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn momentum(&self, t: f64, state: &S::State) -> Result<S::Vector, Fault> {
        let n = self.coordinate_count();
        match self.tables().form {
            Form::Global => Ok(S::Vector::of(&state.as_slice()[n..])),
            Form::Reduced => vector(self, (S::Kernels::momentum, n), t, [state.as_slice(), &[]]),
            Form::FirstOrder => Err(Fault::FirstOrder),
        }
    }

    #[inline]
    fn state_unchecked(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<S::State, Fault> {
        match self.tables().form {
            Form::FirstOrder => Ok(joined::<S>(q.as_slice(), &[])),
            _ => state_by(self, S::Kernels::motion, t, q, qdot),
        }
    }

    #[inline]
    fn state_from_momenta(&self, t: f64, q: &S::Vector, p: &S::Vector) -> Result<S::State, Fault> {
        match self.tables().form {
            Form::Global => Ok(joined::<S>(q.as_slice(), p.as_slice())),
            Form::Reduced => state_by(self, S::Kernels::nearest_momenta, t, q, p),
            Form::FirstOrder => Err(Fault::FirstOrder),
        }
    }

    #[inline]
    fn state_nearest(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<S::State, Fault> {
        let tables = self.tables();
        match tables.form {
            Form::Reduced => state_by(self, S::Kernels::nearest, t, q, qdot),
            Form::Global if tables.dimensions.constraints == 0 => self.state_unchecked(t, q, qdot),
            Form::Global if !tables.is_linear => self.nearest_by_steps(t, q, qdot),
            Form::Global => state_by(self, S::Kernels::nearest, t, q, qdot),
            Form::FirstOrder => self.state_unchecked(t, q, qdot),
        }
    }

    #[inline]
    fn energy(&self, t: f64, state: &S::State) -> Result<f64, Fault> {
        match self.tables().form {
            Form::FirstOrder => Err(Fault::FirstOrder),
            _ => number(self, S::Kernels::energy, t, [state.as_slice(), &[]]),
        }
    }

    #[inline(always)]
    fn conserves_energy(&self) -> bool {
        self.tables().conserves_energy
    }

    #[inline]
    fn kick(&self, state: &mut S::State, size: f64, direction: &S::Impulse) {
        let motion = &mut state.as_mut_slice()[self.coordinate_count()..];
        for (entry, direction) in motion.iter_mut().zip(direction.as_slice()) {
            *entry += size * direction;
        }
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        let values = self.arguments();
        for (parameter, &value) in self.tables().parameters.iter().zip(values.as_ref()) {
            if !parameter.assumption.holds(value) {
                return Err(ParameterError {
                    name: parameter.name,
                    value,
                    expected: parameter.assumption,
                });
            }
        }
        for (index, surface) in self.tables().surfaces.iter().enumerate() {
            if let Some(name) = surface.coefficient {
                let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                    kernels.coefficient(index, at, values)
                };
                let value = number(self, kernel, 0.0, [&[], &[]]).unwrap_or(f64::NAN);
                check_coefficient(name, value)?;
            }
        }
        Ok(())
    }

    #[inline]
    fn outside_chart(&self, state: &S::State) -> Option<usize> {
        let outside = self.tables().charts.iter().find(|chart| {
            let value = state.as_slice()[chart.coordinate];
            let is_inside = chart.ends[0] < value && value < chart.ends[1];
            !is_inside
        });
        outside.map(|chart| chart.coordinate)
    }

    #[inline(always)]
    fn can_lose_rank(&self) -> bool {
        self.tables().can_lose_rank
    }

    fn rank_drop(&self, motion: impl Fn(f64) -> (f64, S::State), reach: f64) -> Option<RankDrop> {
        self.rank_drop_along(motion, reach)
    }

    fn admit(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<(), StateError> {
        self.admits(t, q, qdot)
    }

    fn complete_position(
        &self,
        t: f64,
        q: &S::Vector,
        placed: &S::Vector,
    ) -> Result<S::Vector, StateError> {
        self.completed_position(t, q, placed)
    }

    fn complete_velocity(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
        named: &S::Vector,
    ) -> Result<S::Vector, StateError> {
        match self.tables().form {
            Form::FirstOrder => Ok(self.velocity(t, &joined::<S>(q.as_slice(), &[]))?),
            _ => self.completed_velocity(t, q, qdot, named),
        }
    }
}

impl<S: Declared> Lagrangian for S {
    type Reactions = S::Multipliers;

    #[inline(always)]
    fn reaction_count(&self) -> usize {
        self.tables().dimensions.constraints
    }

    #[inline]
    fn force(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> S::Vector {
        let kernel = (S::Kernels::force, self.coordinate_count());
        let force = vector(self, kernel, t, [q.as_slice(), qdot.as_slice()]);
        force.unwrap_or_else(|_| self.zero_vector())
    }

    #[inline]
    fn reaction_force(&self, t: f64, q: &S::Vector, reactions: &S::Multipliers) -> S::Vector {
        if self.tables().dimensions.constraints == 0 {
            return self.zero_vector();
        }
        let kernel = (S::Kernels::reaction_force, self.coordinate_count());
        let force = vector(self, kernel, t, [q.as_slice(), reactions.as_slice()]);
        force.unwrap_or_else(|_| self.zero_vector())
    }

    #[inline]
    fn constrained_velocity(
        &self,
        t: f64,
        q: &S::Vector,
        p: &S::Vector,
    ) -> Result<(S::Vector, S::Multipliers), Fault> {
        let (n, m) = (
            self.coordinate_count(),
            self.tables().dimensions.constraints,
        );
        if self.tables().form == Form::FirstOrder {
            return Err(Fault::FirstOrder);
        }
        if !self.tables().is_linear {
            return Err(Fault::NonlinearConstraints);
        }
        if m == 0 {
            let state = self.state_from_momenta(t, q, p)?;
            return Ok((self.velocity(t, &state)?, self.zero_reactions()));
        }
        let kernel = (S::Kernels::constrained_velocity, n + m);
        let both = several(self, kernel, t, [q.as_slice(), p.as_slice()])?;
        let (qdot, multipliers) = both.as_slice()[..n + m].split_at(n);
        Ok((S::Vector::of(qdot), S::Multipliers::of(multipliers)))
    }
}

impl<S: Declared + HasDivergence> Divergence for S {
    #[inline]
    fn divergence(&self, t: f64, state: &S::State) -> Result<f64, Fault> {
        number(self, S::Kernels::divergence, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn density_form(&self, t: f64, q: &S::Vector) -> Result<S::Vector, Fault> {
        let kernel = (S::Kernels::density_form, self.coordinate_count());
        vector(self, kernel, t, [q.as_slice(), &[]])
    }
}
