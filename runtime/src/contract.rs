//! The traits between generated code and runtime: one per effect, so that a scene pays for what it declares.
//!
//! Only [`VectorField`] is known to integrators. Time is an argument everywhere; autonomous systems ignore it.

use crate::error::{Fault, ParameterError, StateError};
use crate::impacts::law::{Blow, Contact, Jump, Law};
use crate::jet::{Jets, LENGTH, Work};
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// A first-order system of ordinary differential equations on a state of fixed size.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no vector field: declare it with `dalembert::model!`"
)]
pub trait VectorField {
    /// The state; its components mean what the system says.
    type State: StateVector;

    /// Writes the time derivative of `state` at time `t`.
    ///
    /// # Errors
    /// A [`Fault`] where the derivative does not exist; `rate` is unspecified then.
    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault>;

    /// The size of one unit of each component: absolute tolerances are multiplied by it, so that they mean
    /// the same for a momentum as for the velocity it belongs to. Ones unless overridden.
    fn scale(&self, t: f64, state: &Self::State) -> Self::State {
        let _ = (t, state);
        let mut ones = Self::State::zeros();
        ones.as_mut_slice().fill(1.0);
        ones
    }
}

/// A vector field with the power series of its motions: what [`Taylor`](crate::Taylor) integrates.
///
/// Series are written over [`Numbers`]: of one motion with `f64`, of several at once with lanes. What belongs to one moment
/// is computed by [`TaylorField::begin`], everything above it by [`TaylorField::advance`].
#[diagnostic::on_unimplemented(
    message = "the Taylor coefficients of `{Self}` are not known: declare it with `dalembert::model!`"
)]
pub trait TaylorField: VectorField {
    /// The parameters of the system.
    type Parameters<L: Numbers>: Row<L>;

    /// As many numbers as a state has components, in their order.
    type Row<L: Numbers>: Row<L>;

    /// One number per surface, or none where a gap is not analytic, as `|x|` is not, or there are no surfaces.
    type Gaps<L: Numbers>: Row<L>;

    /// What is known at one moment: the rate, then the gaps, then whatever coefficients above order 0 take of it.
    type Firsts<L: Numbers>: Row<L>;

    /// Room for the coefficients of intermediate values.
    type Jets<L: Numbers>: Jets;

    /// What an expansion takes, if it is known: the order of series is chosen by it.
    const WORK: Option<Work> = None;

    /// The parameters.
    fn parameters(&self) -> Self::Parameters<f64>;

    /// Writes what is known at `(t, state)`.
    ///
    /// # Errors
    /// A [`Fault`] where the derivative does not exist, in whatever lane; `firsts` is unspecified then.
    fn begin<L: Numbers>(
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        firsts: &mut Self::Firsts<L>,
    ) -> Result<(), Fault>;

    /// Writes the power series of the motion that is at `coefficients[0]`, where `firsts` is known, and of the gaps along
    /// it:
    ///
    /// ```text
    /// state(t + unit s) = coefficients[0] + coefficients[1] s + .. + coefficients[order] s^order + ..
    /// ```
    ///
    /// `order` is 1 or more; orders above 32 are not computed. What `jets` holds before does not matter.
    fn advance<L: Numbers>(
        parameters: &Self::Parameters<L>,
        unit: L,
        order: usize,
        firsts: &Self::Firsts<L>,
        coefficients: &mut [Self::Row<L>; LENGTH],
        gaps: &mut [Self::Gaps<L>; LENGTH],
        jets: &mut Self::Jets<L>,
    );
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

    /// Adds `size * direction` to what the state holds of the motion: an impulse.
    fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse);

    /// Checks every parameter against its declaration.
    ///
    /// # Errors
    /// The first [`ParameterError`], in order of declaration.
    fn check_parameters(&self) -> Result<(), ParameterError>;

    /// The first coordinate outside the open interval of its chart. None by default.
    fn outside_chart(&self, state: &Self::State) -> Option<usize> {
        let _ = state;
        None
    }

    /// Refuses velocities off the constraints by more than 1e-9 of the sum of absolute terms. Systems without
    /// constraints accept all.
    ///
    /// # Errors
    /// [`StateError::OffConstraint`].
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
    /// outside its chart, a constraint violated by more than 1e-9 of the sum of its absolute terms.
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

    /// As [`System::state`], but moves an off-constraint velocity to the nearest allowed one in the metric.
    ///
    /// # Errors
    /// As [`System::state`], without `OffConstraint`.
    fn state_projected(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, StateError> {
        self.checked(t, q, qdot)?;
        Ok(self.state_nearest(t, q, qdot)?)
    }

    /// The state after every check but that of the constraints.
    ///
    /// # Errors
    /// As [`System::state`], without `OffConstraint`.
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

/// A system with constraints `eta^a(qdot) + eta^a_0 = 0`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints: declare `constraints {{ .. }}` in its `model!`"
)]
pub trait Constrained: System {
    /// M numbers, one per constraint, in the order of declaration.
    type Multipliers: StateVector;

    /// One number per constraint that is integrable with a known function (see
    /// [`ConstraintInfo::level`](crate::describe::ConstraintInfo::level)).
    type Levels: StateVector;

    /// The multipliers `lambda_a`; the constraint force is `lambda_a eta^a`.
    ///
    /// # Errors
    /// [`Fault`].
    fn multipliers(&self, t: f64, state: &Self::State) -> Result<Self::Multipliers, Fault>;

    /// `eta^a(qdot) + eta^a_0`, and the sum of the absolute values of its terms, sines and cosines counted as 1: its
    /// natural scale.
    fn residuals(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> (Self::Multipliers, Self::Multipliers);

    /// The forms `eta^a` (M rows of N, row after row) and their affine parts `eta^a_0` (M) at a position.
    fn constraint_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    );

    /// Whether every state satisfies the constraints by its construction: the form reduced to D.
    const IS_REDUCED: bool;

    /// Brings the velocity back to the constraints after a step. Unlike [`System::state_nearest`] it need not move it
    /// as little as possible: where some velocities follow from the others at every state, those are recomputed
    /// and the others kept to the last digit. Does nothing where [`Constrained::IS_REDUCED`].
    ///
    /// # Errors
    /// [`Fault`]; the state is unchanged then.
    fn restore(&self, t: f64, state: &mut Self::State) -> Result<(), Fault>;

    /// The position-level values `f^k(t, q)` of the integrable constraints; the motion keeps them.
    fn levels(&self, t: f64, q: &Self::Vector) -> Self::Levels;

    /// One Newton step on position level, orthogonal in the metric: the change of q that moves the levels by
    /// `-excess` to first order.
    ///
    /// # Errors
    /// [`Fault`].
    fn level_correction(
        &self,
        t: f64,
        q: &Self::Vector,
        excess: &Self::Levels,
    ) -> Result<Self::Vector, Fault>;
}

/// A system with impact surfaces `h_s >= 0`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no impact surfaces: declare `impacts {{ .. }}` in its `model!`"
)]
pub trait Impacting: System {
    /// S numbers, one per surface, in the order of declaration.
    type Gaps: StateVector;

    /// The gaps `h_s`; motion is allowed where they are not negative, and everywhere at a surface with a reset.
    fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps;

    /// The gap rates `dh_s(qdot) + d_t h_s`.
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_rates(&self, t: f64, state: &Self::State) -> Result<Self::Gaps, Fault>;

    /// The second rates `d^2h_s/dt^2` where the motion's part of the state, momenta or quasi-velocities, changes at the
    /// rates `motion`. `None` for a system that does not know them: it cannot go on along a surface.
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_accelerations(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// What the impulse `motion` changes the gap rates by. `None` as for [`Impacting::gap_accelerations`].
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_responses(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// Whether the surface counts here: all its `when` conditions are positive.
    fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        let _ = (surface, t, state);
        true
    }

    /// The declared law of a surface, at this system's parameters.
    fn law(&self, surface: usize) -> Law;

    /// Positions and velocities after the declared reset of a surface; `None` where its law is no reset.
    ///
    /// # Errors
    /// [`Fault`].
    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Jump<Self::Vector>>, Fault> {
        let _ = (surface, t, state);
        Ok(None)
    }

    /// The impulse of the declared law of a surface, where that is one.
    ///
    /// # Errors
    /// As [`Impacting::contact`].
    fn blow(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Blow<Self::Impulse>, Fault> {
        Ok(self.contact(surface, t, state)?.blow(self.law(surface)))
    }

    /// What an impact on this surface by any law needs, and motion along it.
    ///
    /// # Errors
    /// [`Fault`]; [`Fault::SingularSurface`] where `dh(pi_D grad h)` is not positive.
    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Contact<Self::Impulse>, Fault>;
}

/// A system whose divergence with respect to the invariant-volume candidate `mu_C` was derived.
#[diagnostic::on_unimplemented(message = "the divergence of `{Self}` was not derived")]
pub trait Divergence: System {
    /// Divergence of the motion on D* with respect to `mu_C` (the Leray quotient of the Liouville volume).
    ///
    /// # Errors
    /// [`Fault`].
    fn divergence(&self, t: f64, state: &Self::State) -> Result<f64, Fault>;

    /// The density form `theta = m_ab L_{W^a} eta^b` at a position: N components.
    ///
    /// # Errors
    /// [`Fault`].
    fn density_form(&self, t: f64, q: &Self::Vector) -> Result<Self::Vector, Fault>;
}

/// A system whose motion keeps a volume `exp(G) mu_C`, with `G` a function of the configuration (and of `t`, where the
/// system depends on it).
///
/// ```text
/// mu_C = det g / |det A_dep|  dq dv_ind
/// ```
///
/// is the natural volume on the states that satisfy the constraints, the quotient of the Liouville volume by the
/// constraint momenta. `v_ind` are the velocities of [`InvariantVolume::INDEPENDENT`]; the other ones follow from them,
/// and `A_dep` are their columns of the constraint forms. Without constraints it is the Liouville volume
/// `det g dq dv = dq dp`. Impacts by the law `elastic` keep `exp(G) mu_C` as well where the constraints are linear.
///
/// Implemented for models with a proved claim `density: exact`, `density: locally_exact`, or `density = EXPR` where
/// `EXPR` does not depend on velocities; then `G = ln |EXPR|`. Where `G` has no closed form, it is an integral; where it is
/// not determined up to a constant either, the trait is not implemented, and the notes in the model's documentation say
/// so.
///
/// At given parameters both logarithms are determined up to a constant: only their differences between configurations
/// have a meaning. `G` depends on how the constraint forms were written, the volume does not.
///
/// # References
/// W. Clark and A. Bloch, *Invariant forms in hybrid and impact systems and a taming of Zeno*, Theorem 2.8: with linear
/// constraints that do not depend on time and without forces that depend on velocities, `exp(G) mu_C` is invariant iff
/// `dG = theta` on all velocities that the constraints allow, `theta` being [`Divergence::density_form`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no invariant volume: declare `claims {{ density: exact; }}` in its `model!`, \
               or state the density where none is found"
)]
pub trait InvariantVolume: System {
    /// Indices of the coordinates whose velocities, with the positions, are the coordinates of the volume. In
    /// increasing order, one for each dimension that the constraints leave.
    const INDEPENDENT: &'static [usize];

    /// Whether `G` is a function of the configuration; else it grows by a constant with each turn of some angle, which
    /// is stored unwrapped.
    const IS_SINGLE_VALUED: bool;

    /// Whether `G` is numeric: without a closed form, it is the integral of `dG` along the line from a regular
    /// configuration, to rounding, and a [`Fault::SingularConstraint`] where a singularity lies on that line.
    const IS_INTEGRAL: bool;

    /// `G`, the logarithm of the density with respect to `mu_C`.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints that `G` is made of are singular.
    fn log_density(&self, t: f64, q: &Self::Vector) -> Result<f64, Fault>;

    /// `G + ln det g - ln |det A_dep|`, the logarithm of the density of the volume in positions and independent
    /// velocities.
    ///
    /// # Errors
    /// As [`InvariantVolume::log_density`], and [`Fault::SingularConstraint`] where the other velocities do not follow
    /// from the independent ones.
    fn log_volume(&self, t: f64, q: &Self::Vector) -> Result<f64, Fault>;
}
