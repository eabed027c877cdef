//! Mechanical systems, and the terms of the principle that determines their motion.

use super::{Along, Chart, VectorField};
use crate::error::{Fault, ParameterError, StateError};
use crate::state::StateVector;

/// Quantity that a state keeps when parameters change. A state holds momenta or quasi-velocities. With other
/// parameters, the same momenta belong to other velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// The velocities: a body whose mass is exchanged keeps its speed.
    Velocities,
    /// The momenta: a body whose mass grows becomes slower.
    Momenta,
}

/// A mechanical system: a state with positions, velocities, momenta and an energy.
///
/// # Examples
///
/// ```
/// use dalembert::System;
///
/// dalembert::model! {
///     pub Pendulum {
///         coordinates { theta: angle; }
///         parameters { m > 0 = 2; l > 0 = 1/2; g = 10; }
///         lagrangian = m*l^2*dot(theta)^2/2 + m*g*l*cos(theta);
///     }
/// }
///
/// let pendulum = Pendulum::default();
/// let state = pendulum.state(0.0, &[0.0].into(), &[3.0].into())?;
/// assert_eq!(pendulum.position(&state)[0], 0.0);
/// assert_eq!(pendulum.velocity(0.0, &state)?[0], 3.0);
/// assert_eq!(pendulum.momentum(0.0, &state)?[0], 1.5);
/// assert_eq!(pendulum.energy(0.0, &state)?, 2.25 - 10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a mechanical system: declare a `lagrangian` in its `model!`"
)]
pub trait System: VectorField {
    /// N numbers, one per coordinate, in the order of declaration: q, qdot or p.
    type Vector: StateVector;

    /// A change of the velocity part of a state: N momenta in the global form, N - M quasi-velocities in the form
    /// reduced to D.
    type Impulse: StateVector;

    /// N, the number of coordinates. The default is correct for vectors of fixed size.
    #[inline(always)]
    fn coordinate_count(&self) -> usize {
        Self::Vector::CAPACITY
    }

    /// Number of components of an impulse. The default is correct for impulses of fixed size.
    #[inline(always)]
    fn impulse_len(&self) -> usize {
        Self::Impulse::CAPACITY
    }

    /// A vector with N zeros.
    #[inline(always)]
    fn zero_vector(&self) -> Self::Vector {
        StateVector::zeros(self.coordinate_count())
    }

    /// The zero impulse.
    #[inline(always)]
    fn zero_impulse(&self) -> Self::Impulse {
        StateVector::zeros(self.impulse_len())
    }

    /// Positions q.
    fn position(&self, state: &Self::State) -> Self::Vector;

    /// Velocities `qdot = g^{-1}(p - A)`. `A` is the part of the Lagrangian that is linear in the velocities.
    ///
    /// # Errors
    /// [`Fault::MetricNotPositive`].
    fn velocity(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault>;

    /// Momenta `p = g qdot + A`.
    ///
    /// # Errors
    /// A [`Fault`], for states that do not hold momenta themselves.
    fn momentum(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault>;

    /// The state with these positions and velocities, without checks. A state reduced to D represents only velocities
    /// that satisfy the constraints: it holds the quasi-velocities of `qdot`, and the deviation of `qdot` from the
    /// constraints is lost.
    ///
    /// # Errors
    /// [`Fault`] where the state cannot be formed.
    fn state_unchecked(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault>;

    /// The state with these positions and momenta. They are taken unchanged if the state holds momenta; otherwise it
    /// holds the nearest momenta in the metric that the constraints allow.
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

    /// True if smooth motion is known to conserve [`System::energy`]: no force does work, and nothing depends on
    /// time. Methods that conserve a discrete energy then carry it across elastic impacts. The default is false.
    fn conserves_energy(&self) -> bool {
        false
    }

    /// True if time occurs in the rates, the gaps, the conditions or the laws, whatever the values of the parameters.
    /// Then the return map of a section is not the same at all times. The default is true.
    fn depends_on_time(&self) -> bool {
        true
    }

    /// Adds the impulse `size * direction` to the momenta or quasi-velocities of the state.
    fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse);

    /// Checks every parameter against its declaration.
    ///
    /// # Errors
    /// The first [`ParameterError`], in order of declaration.
    fn check_parameters(&self) -> Result<(), ParameterError>;

    /// Number of position components of a state: the index of its first momentum or quasi-velocity.
    fn motion_start(&self, state: &Self::State) -> usize {
        let _ = state;
        self.coordinate_count()
    }

    /// The mode of a state (see [`modes`](crate::modes)); 0 for systems without modes.
    fn mode(&self, state: &Self::State) -> usize {
        let _ = state;
        0
    }

    /// The first coordinate outside the open interval of its chart. `None` by default.
    fn outside_chart(&self, state: &Self::State) -> Option<usize> {
        let _ = state;
        None
    }

    /// Interval `number` of the chart at a state: a component of the state, and the open interval in which it must
    /// stay. `None` past the last one. The default has no intervals, even if [`System::outside_chart`] is implemented:
    /// a run then checks the chart at the ends of its steps, but not inside them.
    fn chart(&self, state: &Self::State, number: usize) -> Option<Chart> {
        let _ = (state, number);
        None
    }

    /// True if the constraint forms may become dependent somewhere, because the build has not proved them independent.
    /// A run checks the rank in every step of such a system, and never for other systems.
    #[inline(always)]
    fn can_lose_rank(&self) -> bool {
        false
    }

    /// True if the constraint forms are proved to be independent along a whole stretch of motion. False by default,
    /// which means not known: [`System::rank_drop`] then samples the whole step.
    fn keeps_rank(&self, along: Along<'_>) -> bool {
        let _ = along;
        false
    }

    /// The first place in a piece of smooth motion at which the constraint forms become dependent, up to the fraction
    /// `reach` of the piece. `motion` gives time and state at a fraction of the piece. `None` if there is no such
    /// place, or if [`System::can_lose_rank`] is false.
    fn rank_drop(
        &self,
        motion: impl Fn(f64) -> (f64, Self::State),
        reach: f64,
    ) -> Option<RankDrop> {
        let _ = (motion, reach);
        None
    }

    /// Refuses positions and velocities that violate a constraint by more than 1e-9 of the sum of the absolute values
    /// of its terms. Systems without constraints accept every state.
    ///
    /// # Errors
    /// [`StateError::OffPosition`] for positions that violate a holonomic constraint, [`StateError::OffConstraint`] for
    /// velocities that violate a constraint.
    fn admit(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        let _ = (t, q, qdot);
        Ok(())
    }

    /// The state with these positions, and with the nearest velocities in the metric that satisfy the constraints.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints are singular, or [`Fault::ProjectionFailed`].
    fn state_nearest(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.state_unchecked(t, q, qdot)
    }

    /// Same as [`System::state_nearest`], in the mode of the state `from`. All other functions that make a state from
    /// positions make it in the mode in which a run begins.
    ///
    /// # Errors
    /// The errors of [`System::state_nearest`].
    fn state_moved(
        &self,
        from: &Self::State,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        let _ = from;
        self.state_nearest(t, q, qdot)
    }

    /// Completes positions: moves the positions whose `placed` is not 1 so that all positions satisfy the holonomic
    /// constraints. Returns `q` unchanged if there are no such constraints. If every position is placed, only checks
    /// `q`.
    ///
    /// # Errors
    /// [`StateError::OffPosition`] if no such positions were found.
    fn complete_position(
        &self,
        t: f64,
        q: &Self::Vector,
        placed: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, placed);
        Ok(*q)
    }

    /// Completes velocities: chooses the velocities whose `named` is not 1 so that all velocities satisfy the
    /// constraints. Without constraints, returns `qdot` unchanged.
    ///
    /// # Errors
    /// [`StateError::OffConstraint`] where the named velocities contradict the constraints; [`StateError::Fault`]
    /// with a fault of the system.
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
    /// [`StateError`] for a parameter that contradicts its declaration, a number that is not finite, a coordinate
    /// outside its chart, or a constraint (of positions or velocities) violated by more than 1e-9 of the sum of the
    /// absolute values of its terms.
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

    /// Same as [`System::state`], but moves positions to nearby ones that the constraints allow, and then the
    /// velocity to the nearest allowed one in the metric.
    ///
    /// # Errors
    /// The errors of [`System::state`] except `OffConstraint`; `OffPosition` if no allowed positions were found
    /// nearby.
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

    /// The state of this system that continues a state of `from`, the same system with other parameters. `keep` selects
    /// the quantity that stays the same. Without this conversion, a state keeps its components: momenta in the global
    /// form, so that velocities jump with the masses, and quasi-velocities on D.
    ///
    /// # Errors
    /// The errors of [`System::state`]; [`Fault::FirstOrder`] for momenta of a first-order system.
    fn carried(
        &self,
        from: &Self,
        t: f64,
        state: &Self::State,
        keep: Keep,
    ) -> Result<Self::State, StateError> {
        carried(self, from, t, state, keep)
    }

    /// The state after every check except that of the constraints.
    ///
    /// # Errors
    /// The errors of [`System::state`] except `OffConstraint` and `OffPosition`.
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

/// Implementation of [`System::carried`]. `system` makes states in the mode of the new state, `from` in that of
/// `state`.
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

/// A place in a piece of smooth motion at which constraint forms become dependent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankDrop {
    /// The last fraction of the piece before this place.
    pub theta: f64,
    /// Index of the constraint that depends on the earlier ones there, or vanishes.
    pub constraint: usize,
}

/// The terms of the Lagrange-d'Alembert principle
///
/// ```text
/// d/dt dL/dqdot = f + lambda_a eta^a,   eta^a(qdot) + eta^a_0 = 0,   f = dL/dq + F
/// ```
///
/// A discrete principle combines these terms in its own way and cannot recover them from the rate of the state.
/// Positions, velocities and momenta are N numbers each, in every form of the state.
///
/// # Examples
///
/// ```
/// use dalembert::Lagrangian;
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// let pendulum = Pendulum::default();
/// let force = pendulum.force(0.0, &[1.0].into(), &[0.0].into());
/// assert_eq!(force[0], -1.0_f64.sin());
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not give the parts of its equations: declare it with `dalembert::model!`"
)]
pub trait Lagrangian: System {
    /// M numbers, one per constraint, in the order of declaration; none without constraints.
    type Reactions: StateVector;

    /// M, the number of constraints; 0 without constraints. The default is correct for reactions of fixed size.
    #[inline(always)]
    fn reaction_count(&self) -> usize {
        Self::Reactions::CAPACITY
    }

    /// Reactions with M zeros.
    #[inline(always)]
    fn zero_reactions(&self) -> Self::Reactions {
        StateVector::zeros(self.reaction_count())
    }

    /// The force `f = dL/dq + F`, without the constraint force.
    fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector;

    /// The constraint force `lambda_a eta^a` for given multipliers.
    fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions)
    -> Self::Vector;

    /// The velocity of the momenta `p + mu_a eta^a`, with `mu` such that the velocity satisfies the constraints. Also
    /// returns `mu`.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints are singular.
    fn constrained_velocity(
        &self,
        t: f64,
        q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<(Self::Vector, Self::Reactions), Fault>;
}
