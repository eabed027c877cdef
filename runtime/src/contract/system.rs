//! Mechanical systems, and the principle that their motions come from.

use super::VectorField;
use crate::error::{Fault, ParameterError, StateError};
use crate::state::StateVector;

/// What of a motion stays where parameters change: a state holds momenta or quasi-velocities, whose velocities are others with
/// other parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// The velocities: a mass that is exchanged goes on as fast.
    Velocities,
    /// The momenta: a mass that grows becomes slower.
    Momenta,
}

/// A mechanical system: a state with positions, velocities, momenta and an energy.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a mechanical system: declare a `lagrangian` in its `model!`"
)]
pub trait System: VectorField {
    /// N numbers, one per coordinate, in the order of declaration: q, qdot or p.
    type Vector: StateVector;

    /// A change of what the state holds of the motion: of the N momenta in the global form, of the N - M
    /// quasi-velocities in the form reduced to D.
    type Impulse: StateVector;

    /// N, the number of coordinates. Of vectors of fixed size it is known.
    #[inline(always)]
    fn coordinate_count(&self) -> usize {
        Self::Vector::CAPACITY
    }

    /// The number of components of an impulse. Of impulses of fixed size it is known.
    #[inline(always)]
    fn impulse_len(&self) -> usize {
        Self::Impulse::CAPACITY
    }

    /// N zeros.
    #[inline(always)]
    fn zero_vector(&self) -> Self::Vector {
        StateVector::zeros(self.coordinate_count())
    }

    /// No impulse.
    #[inline(always)]
    fn zero_impulse(&self) -> Self::Impulse {
        StateVector::zeros(self.impulse_len())
    }

    /// Positions q.
    fn position(&self, state: &Self::State) -> Self::Vector;

    /// Velocities `qdot = g^{-1}(p - A)`.
    ///
    /// # Errors
    /// [`Fault::MetricNotPositive`].
    fn velocity(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault>;

    /// Momenta `p = g qdot + A`.
    ///
    /// # Errors
    /// [`Fault`], for states that do not hold momenta themselves.
    fn momentum(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault>;

    /// The state with these positions and velocities, taken as they are. A state reduced to D holds only velocities
    /// that satisfy the constraints: there the quasi-velocities of `qdot` are taken, whatever it is off.
    ///
    /// # Errors
    /// [`Fault`] where the state cannot be formed.
    fn state_unchecked(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault>;

    /// The state with these positions and momenta: taken as they are where the state holds momenta, else those
    /// nearest to them in the metric that the constraints allow.
    ///
    /// # Errors
    /// [`Fault`] where the state cannot be formed.
    fn state_from_momenta(
        &self,
        t: f64,
        q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<Self::State, Fault>;

    /// Kinetic plus potential energy `1/2 g(qdot, qdot) + V`.
    ///
    /// # Errors
    /// [`Fault::MetricNotPositive`].
    fn energy(&self, t: f64, state: &Self::State) -> Result<f64, Fault>;

    /// Whether smooth motion is known to keep [`System::energy`]: no force does work, and time occurs nowhere. Methods that
    /// keep a discrete energy carry it across elastic impacts then. False unless known.
    fn conserves_energy(&self) -> bool {
        false
    }

    /// Adds `size * direction` to what the state holds of the motion: an impulse.
    fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse);

    /// Checks every parameter against its declaration.
    ///
    /// # Errors
    /// The first [`ParameterError`], in order of declaration.
    fn check_parameters(&self) -> Result<(), ParameterError>;

    /// How many components of a state, positions, come before those that hold its motion.
    fn motion_start(&self, state: &Self::State) -> usize {
        let _ = state;
        self.coordinate_count()
    }

    /// The mode that a state is of (see [`modes`](crate::modes)); 0 for systems without modes.
    fn mode(&self, state: &Self::State) -> usize {
        let _ = state;
        0
    }

    /// The first coordinate outside the open interval of its chart. None by default.
    fn outside_chart(&self, state: &Self::State) -> Option<usize> {
        let _ = state;
        None
    }

    /// Whether the constraint forms may become dependent somewhere: not proved otherwise while building. A run watches such
    /// systems in every step, and only them.
    #[inline(always)]
    fn can_lose_rank(&self) -> bool {
        false
    }

    /// The first place in `[0, reach]` along a piece of smooth motion at which the constraint forms become dependent;
    /// `motion` gives time and state at a part of it. None where [`System::can_lose_rank`] is false.
    fn rank_drop(
        &self,
        motion: impl Fn(f64) -> (f64, Self::State),
        reach: f64,
    ) -> Option<RankDrop> {
        let _ = (motion, reach);
        None
    }

    /// Refuses positions that an equation among the constraints forbids, and velocities off the constraints, both by more
    /// than 1e-9 of the sum of absolute terms. Systems without constraints accept all.
    ///
    /// # Errors
    /// [`StateError::OffPosition`], [`StateError::OffConstraint`].
    fn admit(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        let _ = (t, q, qdot);
        Ok(())
    }

    /// The state with these positions, and with the velocities nearest to these in the metric that satisfy the
    /// constraints.
    ///
    /// # Errors
    /// A [`Fault`] met on the way.
    fn state_nearest(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.state_unchecked(t, q, qdot)
    }

    /// The positions with those whose `placed` is not 1 moved to where they satisfy the equations of positions among the
    /// constraints; without such equations, `q` as it is. With nothing left to move it is a check of `q`.
    ///
    /// # Errors
    /// [`StateError::OffPosition`] where no such positions were found.
    fn complete_position(
        &self,
        t: f64,
        q: &Self::Vector,
        placed: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, placed);
        Ok(*q)
    }

    /// The velocities with those whose `named` is not 1 replaced by what the constraints make of the named
    /// ones. Without constraints there is nothing to choose, and `qdot` is returned as it is.
    ///
    /// # Errors
    /// [`StateError::OffConstraint`] where the named velocities contradict the constraints; a [`Fault`] met on
    /// the way.
    fn complete_velocity(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
        named: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, q, named);
        Ok(*qdot)
    }

    /// The state with these positions and velocities, if they satisfy every constraint and declaration.
    ///
    /// # Errors
    /// [`StateError`]: a parameter against its declaration, a number that is not finite, a coordinate
    /// outside its chart, a constraint (of positions or velocities) violated by more than 1e-9 of the sum of its absolute
    /// terms.
    fn state(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, StateError> {
        let state = self.checked(t, q, qdot)?;
        self.admit(t, q, qdot)?;
        Ok(state)
    }

    /// As [`System::state`], but moves positions to a place near by that the constraints allow, and then the velocity to
    /// the nearest allowed one in the metric.
    ///
    /// # Errors
    /// As [`System::state`], without `OffConstraint`; `OffPosition` if no allowed place was found near by.
    fn state_projected(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, StateError> {
        let q = self.complete_position(t, q, &self.zero_vector())?;
        self.checked(t, &q, qdot)?;
        Ok(self.state_nearest(t, &q, qdot)?)
    }

    /// The state of this system that goes on where a state of `from`, the system with other parameters, ends. A state that is
    /// merely handed on keeps its components: momenta in the global form, so that velocities jump with the masses, and
    /// quasi-velocities on D.
    ///
    /// # Errors
    /// As [`System::state`]; [`Fault::FirstOrder`] for momenta of a first-order system.
    fn carried(
        &self,
        from: &Self,
        t: f64,
        state: &Self::State,
        keep: Keep,
    ) -> Result<Self::State, StateError> {
        carried(self, from, t, state, keep)
    }

    /// The state after every check but that of the constraints.
    ///
    /// # Errors
    /// As [`System::state`], without `OffConstraint` and `OffPosition`.
    fn checked(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, StateError> {
        self.check_parameters()?;
        let components = q.as_slice().iter().chain(qdot.as_slice());
        if let Some(component) = components.clone().position(|value| !value.is_finite()) {
            return Err(StateError::NotFinite { component });
        }
        let state = self.state_unchecked(t, q, qdot)?;
        if let Some(coordinate) = self.outside_chart(&state) {
            return Err(StateError::OutsideChart { coordinate });
        }
        Ok(state)
    }
}

/// As [`System::carried`], of a system that makes states in the mode of this one.
pub(crate) fn carried<S: System + ?Sized>(
    system: &S,
    from: &S,
    t: f64,
    state: &S::State,
    keep: Keep,
) -> Result<S::State, StateError> {
    let q = from.position(state);
    match keep {
        Keep::Velocities => system.state(t, &q, &from.velocity(t, state)?),
        Keep::Momenta => {
            let carried = system.state_from_momenta(t, &q, &from.momentum(t, state)?)?;
            system.state(t, &q, &system.velocity(t, &carried)?)?;
            Ok(carried)
        }
    }
}

/// Where constraint forms become dependent along a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankDrop {
    /// The last place before it, as a part of the motion.
    pub theta: f64,
    /// Index of the constraint that depends on the earlier ones there, or vanishes.
    pub constraint: usize,
}

/// The parts of Lagrange and d'Alembert's principle
///
/// ```text
/// d/dt dL/dqdot = f + lambda_a eta^a,   eta^a(qdot) + eta^a_0 = 0,   f = dL/dq + F
/// ```
///
/// that a discrete principle puts together anew: what the rate of the state has already put together cannot be
/// taken apart. Positions, velocities and momenta are N numbers each, whatever the state holds.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not give the parts of its equations: declare it with `dalembert::model!`"
)]
pub trait Lagrangian: System {
    /// M numbers, one per constraint, in the order of declaration; none without constraints.
    type Reactions: StateVector;

    /// M, the number of constraints; 0 without constraints. Of reactions of fixed number it is known.
    #[inline(always)]
    fn reaction_count(&self) -> usize {
        Self::Reactions::CAPACITY
    }

    /// M zeros.
    #[inline(always)]
    fn zero_reactions(&self) -> Self::Reactions {
        StateVector::zeros(self.reaction_count())
    }

    /// `f = dL/dq + F`: the force besides that of the constraints.
    fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector;

    /// `lambda_a eta^a`: the force of the constraints for given multipliers.
    fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions)
    -> Self::Vector;

    /// The velocity at the momenta `p + mu_a eta^a`, with the `mu` that make it satisfy the constraints; and `mu`.
    ///
    /// # Errors
    /// [`Fault`].
    fn constrained_velocity(
        &self,
        t: f64,
        q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<(Self::Vector, Self::Reactions), Fault>;
}
