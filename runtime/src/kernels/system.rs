//! Implementations of `VectorField`, `System`, `Lagrangian` and `Divergence` for every declared model.

use super::independence::keeps_rank;
use super::part::has_modes;
use super::{At, Declared, Form, HasConstraints, HasDivergence, Kernels, Part, number, write};
use crate::contract::{
    Along, Chart, Divergence, Keep, Lagrangian, RankDrop, System, VectorField, carried,
};
use crate::error::{Fault, ParameterError, StateError};
use crate::generated::check_coefficient;
use crate::nearest::nearest_by_steps;
use crate::numbers::{Everywhere, Numbers, Rated, Row};
use crate::quadrature::line_integral;
use crate::state::StateVector;

impl<S: Declared> VectorField for S {
    type State = S::State;

    #[inline(always)]
    fn state_len(&self) -> usize {
        self.tables().dimensions.state
    }

    #[inline]
    fn rate(&self, t: f64, state: &S::State, rate: &mut S::State) -> Result<(), Fault> {
        let places = [state.as_slice(), &[]];
        let part = Part::of(self, places[0]);
        let (entries, others) = rate
            .as_mut_slice()
            .split_at_mut(part.tables.dimensions.state);
        others.fill(0.0);
        part.write(S::Kernels::rate, t, places, entries)
    }

    #[inline]
    fn scale(&self, t: f64, state: &S::State) -> S::State {
        let mut scale = state.zeroed();
        let places = [state.as_slice(), &[]];
        let part = Part::of(self, places[0]);
        let (entries, others) = scale
            .as_mut_slice()
            .split_at_mut(part.tables.dimensions.state);
        others.fill(1.0);
        // The kernel of the scales has no guards, so it cannot fail.
        let _ = part.write(S::Kernels::scale, t, places, entries);
        scale
    }

    #[inline(always)]
    fn can_be_narrow(&self) -> bool {
        self.tables().can_be_narrow
    }

    fn has_narrow_rates(&self) -> bool {
        // NOTE: a constant, so that kernels over [`Everywhere`] are compiled only where they are needed.
        if const { !S::MAY_BE_NARROW } {
            return false;
        }
        Part::all(self).any(|part| part.tables.can_be_narrow && has_sharp_rates(self, &part))
    }

    fn rates_along(
        &self,
        t: Rated,
        component: &dyn Fn(usize) -> Rated,
        rate: &mut dyn FnMut(usize, Rated),
    ) -> Result<(), Fault> {
        // NOTE: a constant, so that kernels over intervals are compiled only where they are needed.
        if const { !S::MAY_BE_NARROW } {
            return Err(Fault::NotDerived);
        }
        let mut state = S::Components::<Rated>::zeros(self.state_len());
        for (i, entry) in state.as_mut_slice().iter_mut().enumerate() {
            *entry = component(i);
        }
        let mut rates = state.zeroed();
        let arguments: S::Arguments<Rated> = over_numbers(self);
        let part = Part::of(self, state.as_slice());
        let at = At {
            parameters: arguments.as_slice(),
            t,
            first: state.as_slice(),
            second: &[],
        };
        let entries = &mut rates.as_mut_slice()[..part.tables.dimensions.state];
        part.kernels.rate(at, entries)?;
        for (i, component) in rates.as_slice().iter().enumerate() {
            rate(i, *component);
        }
        Ok(())
    }
}

/// True if a rate of the part may have narrow features at some state, or cannot be bounded for all states.
fn has_sharp_rates<S: Declared>(system: &S, part: &Part<'_, S>) -> bool {
    let mut state = S::Components::<Everywhere>::zeros(system.state_len());
    state.as_mut_slice().fill(Everywhere::ANY);
    let mut rates = state.zeroed();
    let arguments: S::Arguments<Everywhere> = over_numbers(system);
    let at = At {
        parameters: arguments.as_slice(),
        t: Everywhere::ANY,
        first: state.as_slice(),
        second: &[],
    };
    let entries = &mut rates.as_mut_slice()[..part.tables.dimensions.state];
    part.kernels.rate(at, entries).is_err() || entries.iter().any(Everywhere::is_sharp)
}

/// The parameters as [`Numbers`].
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

/// Number of positions and parameters up to which they share a short array.
const FEW: usize = 16;

/// Calls `then` with room for the positions of a gap and with the parameters, both as [`Numbers`].
///
/// NOTE: all elements of an array are initialised, and numbers of some kinds are long. The array is therefore short where
/// the capacities of the rows are much larger than necessary.
#[inline(always)]
pub(super) fn with_places<S: Declared, L: Numbers, T>(
    system: &S,
    positions: usize,
    then: impl FnOnce(&mut [L], &[L]) -> T,
) -> T {
    let values = system.arguments();
    let values = values.as_ref();
    let fits = S::Positions::<L>::CAPACITY + S::Arguments::<L>::CAPACITY <= FEW;
    if fits || positions + values.len() > FEW {
        let mut q = S::Positions::<L>::zeros(positions);
        let arguments: S::Arguments<L> = over_numbers(system);
        return then(q.as_mut_slice(), arguments.as_slice());
    }
    let mut numbers = [L::ZERO; FEW];
    let (q, rest) = numbers.split_at_mut(positions);
    let arguments = &mut rest[..values.len()];
    for (number, value) in arguments.iter_mut().zip(values) {
        *number = L::of(*value);
    }
    then(q, arguments)
}

/// Implements [`System::state_nearest`] by Newton steps, for constraints that are nonlinear in the velocities.
///
/// # Errors
/// The errors of [`nearest_by_steps`].
pub fn nearest_of_declared<S: Declared + HasConstraints>(
    system: &S,
    t: f64,
    q: &S::Vector,
    qdot: &S::Vector,
) -> Result<S::State, Fault> {
    let part = Part::start(system);
    let positions = part.gathered(q);
    nearest_by_steps(system, t, q, qdot, |qdot| {
        part.state_by(S::Kernels::nearest, t, &positions, &part.gathered(qdot))
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
        let part = Part::of(self, state.as_slice());
        let mut q = self.zero_vector();
        let n = part.lengths()[0];
        q.as_mut_slice()[..n].copy_from_slice(&state.as_slice()[..n]);
        part.spread(q)
    }

    #[inline]
    fn velocity(&self, t: f64, state: &S::State) -> Result<S::Vector, Fault> {
        let part = Part::of(self, state.as_slice());
        part.coordinates(S::Kernels::velocity, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn momentum(&self, t: f64, state: &S::State) -> Result<S::Vector, Fault> {
        let part = Part::of(self, state.as_slice());
        match part.tables.form {
            Form::Global => {
                let mut p = self.zero_vector();
                let n = part.lengths()[0];
                p.as_mut_slice()[..n].copy_from_slice(&state.as_slice()[n..2 * n]);
                Ok(part.spread(p))
            }
            Form::Reduced => part.coordinates(S::Kernels::momentum, t, [state.as_slice(), &[]]),
            Form::FirstOrder => Err(Fault::FirstOrder),
        }
    }

    #[inline]
    fn state_unchecked(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<S::State, Fault> {
        let part = Part::start(self);
        let q = part.gathered(q);
        match part.tables.form {
            Form::FirstOrder => Ok(part.joined(q.as_slice(), &[])),
            _ => part.state_by(S::Kernels::motion, t, &q, &part.gathered(qdot)),
        }
    }

    #[inline]
    fn state_from_momenta(&self, t: f64, q: &S::Vector, p: &S::Vector) -> Result<S::State, Fault> {
        let part = Part::start(self);
        let [q, p] = [part.gathered(q), part.gathered(p)];
        match part.tables.form {
            Form::Global => Ok(part.joined(q.as_slice(), p.as_slice())),
            Form::Reduced => part.state_by(S::Kernels::nearest_momenta, t, &q, &p),
            Form::FirstOrder => Err(Fault::FirstOrder),
        }
    }

    #[inline]
    fn state_nearest(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<S::State, Fault> {
        let part = Part::start(self);
        let tables = part.tables;
        match tables.form {
            Form::FirstOrder => self.state_unchecked(t, q, qdot),
            Form::Global if tables.dimensions.constraints == 0 => self.state_unchecked(t, q, qdot),
            Form::Global if !tables.is_linear => self.nearest_by_steps(t, q, qdot),
            _ => {
                let [q, qdot] = [part.gathered(q), part.gathered(qdot)];
                part.state_by(S::Kernels::nearest, t, &q, &qdot)
            }
        }
    }

    fn state_moved(
        &self,
        from: &S::State,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
    ) -> Result<S::State, Fault> {
        let here = Part::of(self, from.as_slice()).starting_here();
        here.state_nearest(t, q, qdot)
    }

    #[inline]
    fn energy(&self, t: f64, state: &S::State) -> Result<f64, Fault> {
        let part = Part::of(self, state.as_slice());
        match part.tables.form {
            Form::FirstOrder => Err(Fault::FirstOrder),
            _ => part.number_by(S::Kernels::energy, t, [state.as_slice(), &[]]),
        }
    }

    #[inline(always)]
    fn conserves_energy(&self) -> bool {
        self.tables().conserves_energy
    }

    fn depends_on_time(&self) -> bool {
        self.tables().depends_on_time
    }

    #[inline]
    fn kick(&self, state: &mut S::State, size: f64, direction: &S::Impulse) {
        let [n, k] = Part::of(self, state.as_slice()).lengths();
        let motion = &mut state.as_mut_slice()[n..n + k];
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
                check_coefficient(name, coefficient(self, index))?;
            }
        }
        Ok(())
    }

    fn carried(
        &self,
        from: &Self,
        t: f64,
        state: &S::State,
        keep: Keep,
    ) -> Result<S::State, StateError> {
        let here = Part::of(self, state.as_slice()).starting_here();
        carried(&here, from, t, state, keep)
    }

    fn motion_start(&self, state: &S::State) -> usize {
        Part::of(self, state.as_slice()).lengths()[0]
    }

    #[inline(always)]
    fn mode(&self, state: &S::State) -> usize {
        Part::of(self, state.as_slice()).number()
    }

    #[inline]
    fn outside_chart(&self, state: &S::State) -> Option<usize> {
        let part = Part::of(self, state.as_slice());
        let outside = part.tables.charts.iter().find(|chart| {
            let value = state.as_slice()[chart.coordinate];
            let is_inside = chart.ends[0] < value && value < chart.ends[1];
            !is_inside
        });
        outside.map(|chart| part.coordinate(chart.coordinate))
    }

    #[inline]
    fn chart(&self, state: &S::State, number: usize) -> Option<Chart> {
        let part = Part::of(self, state.as_slice());
        part.tables.charts.get(number).copied()
    }

    #[inline(always)]
    fn can_lose_rank(&self) -> bool {
        self.tables().can_lose_rank
    }

    fn keeps_rank(&self, along: Along<'_>) -> bool {
        match const { S::MAY_LOSE_RANK } {
            true => keeps_rank(self, along),
            false => false,
        }
    }

    fn rank_drop(&self, motion: impl Fn(f64) -> (f64, S::State), reach: f64) -> Option<RankDrop> {
        self.rank_drop_along(motion, reach)
    }

    fn admit(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> Result<(), StateError> {
        let admitted = self.admits(t, q, qdot);
        admitted.map_err(|error| Part::start(self).refusal(error))
    }

    fn complete_position(
        &self,
        t: f64,
        q: &S::Vector,
        placed: &S::Vector,
    ) -> Result<S::Vector, StateError> {
        let part = Part::start(self);
        let (q, placed) = (part.alone(q, 0.0), part.alone(placed, 1.0));
        let completed = self.completed_position(t, &q, &placed);
        completed.map_err(|error| part.refusal(error))
    }

    fn complete_velocity(
        &self,
        t: f64,
        q: &S::Vector,
        qdot: &S::Vector,
        named: &S::Vector,
    ) -> Result<S::Vector, StateError> {
        let part = Part::start(self);
        if part.tables.form == Form::FirstOrder {
            let state = part.joined(part.gathered(q).as_slice(), &[]);
            return Ok(self.velocity(t, &state)?);
        }
        let (qdot, named) = (part.alone(qdot, 0.0), part.alone(named, 1.0));
        let completed = self.completed_velocity(t, q, &qdot, &named);
        completed.map_err(|error| part.refusal(error))
    }
}

/// The coefficient of restitution of a surface's law; NaN for a law without one.
pub(super) fn coefficient<S: Declared>(system: &S, surface: usize) -> f64 {
    let Some((part, local)) = Part::of_surface(system, surface) else {
        return f64::NAN;
    };
    let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
        kernels.coefficient(local, at, values)
    };
    part.number_by(kernel, 0.0, [&[], &[]]).unwrap_or(f64::NAN)
}

impl<S: Declared> Lagrangian for S {
    type Reactions = S::Multipliers;

    #[inline(always)]
    fn reaction_count(&self) -> usize {
        self.tables().dimensions.constraints
    }

    #[inline]
    fn force(&self, t: f64, q: &S::Vector, qdot: &S::Vector) -> S::Vector {
        let part = Part::start(self);
        let [q, qdot] = [part.gathered(q), part.gathered(qdot)];
        let force = part.coordinates(S::Kernels::force, t, [q.as_slice(), qdot.as_slice()]);
        force.unwrap_or_else(|_| self.zero_vector())
    }

    #[inline]
    fn reaction_force(&self, t: f64, q: &S::Vector, reactions: &S::Multipliers) -> S::Vector {
        let part = Part::start(self);
        if part.tables.dimensions.constraints == 0 {
            return self.zero_vector();
        }
        let q = part.gathered(q);
        let places = [q.as_slice(), reactions.as_slice()];
        let force = part.coordinates(S::Kernels::reaction_force, t, places);
        force.unwrap_or_else(|_| self.zero_vector())
    }

    #[inline]
    fn constrained_velocity(
        &self,
        t: f64,
        q: &S::Vector,
        p: &S::Vector,
    ) -> Result<(S::Vector, S::Multipliers), Fault> {
        if has_modes(self) {
            return Err(Fault::SeveralModes);
        }
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
        let both = Part::start(self).several(kernel, t, [q.as_slice(), p.as_slice()])?;
        let (qdot, multipliers) = both.as_slice()[..n + m].split_at(n);
        Ok((S::Vector::of(qdot), S::Multipliers::of(multipliers)))
    }
}

impl<S: Declared + HasDivergence> Divergence for S {
    #[inline]
    fn divergence(&self, t: f64, state: &S::State) -> Result<f64, Fault> {
        let part = Part::of(self, state.as_slice());
        part.number_by(S::Kernels::divergence, t, [state.as_slice(), &[]])
    }

    #[inline]
    fn density_form(&self, t: f64, q: &S::Vector) -> Result<S::Vector, Fault> {
        let part = Part::start(self);
        let q = part.gathered(q);
        part.coordinates(S::Kernels::density_form, t, [q.as_slice(), &[]])
    }
}

/// Implementation of [`InvariantVolume::log_density`](crate::InvariantVolume::log_density).
///
/// # Errors
/// The [`Fault`] of a kernel; [`Fault::SingularConstraint`] where a line integral does not converge.
pub fn log_density<S: Declared>(system: &S, t: f64, q: &S::Vector) -> Result<f64, Fault> {
    let density = number(system, S::Kernels::log_density, t, [q.as_slice(), &[]])?;
    let Some(reference) = &system.tables().density_reference else {
        return Ok(density);
    };
    let gradient = |q: &S::Vector| {
        let mut gradient = q.zeroed();
        let places = [q.as_slice(), &[][..]];
        let values = gradient.as_mut_slice();
        write(system, S::Kernels::density_gradient, t, places, values)?;
        Ok(gradient)
    };
    Ok(density + line_integral(reference, q, gradient)?)
}
