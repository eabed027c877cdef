//! Systems with constraints.

use super::{Level, System};
use crate::error::Fault;
use crate::state::StateVector;

/// A system with constraints `eta^a(qdot) + eta^a_0 = 0`, or with constraints `phi^a(t, q, qdot) = 0` that are
/// nonlinear in the velocities: there `eta^a = dphi^a/dqdot`, and `phi^a` replaces `eta^a(qdot) + eta^a_0`.
///
/// # Examples
///
/// ```
/// use dalembert::{Constrained, System};
///
/// dalembert::model! {
///     pub Skate {
///         coordinates { x; y; theta: angle; }
///         lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
///         constraints { edge: cos(theta)*dot(y) - sin(theta)*dot(x) = 0; }
///     }
/// }
///
/// // Along x at speed 2, turning at rate 3: the edge pushes across with the force m v omega.
/// let skate = Skate::default();
/// let state = skate.state(0.0, &[0.0, 0.0, 0.0].into(), &[2.0, 0.0, 3.0].into())?;
/// assert!((skate.multipliers(0.0, &state)?[0] - 6.0).abs() < 1e-15);
///
/// // A velocity across the edge is no motion of the skate.
/// let (residuals, _) = skate.residuals(0.0, &[0.0; 3].into(), &[0.0, 1.0, 0.0].into());
/// assert_eq!(residuals[0], 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints: declare `constraints {{ .. }}` in its `model!`"
)]
pub trait Constrained: System {
    /// M numbers, one per constraint, in the order of declaration.
    type Multipliers: StateVector;

    /// One number per constraint that is integrable with a known function (see
    /// [`ConstraintInfo::level`](crate::describe::ConstraintInfo::level)).
    type Levels: StateVector;

    /// M, the number of constraints. The default is correct for multipliers of fixed number.
    #[inline(always)]
    fn constraint_count(&self) -> usize {
        Self::Multipliers::CAPACITY
    }

    /// The number of levels. The default is correct for a fixed number.
    #[inline(always)]
    fn level_count(&self) -> usize {
        Self::Levels::CAPACITY
    }

    /// Multipliers with M zeros.
    #[inline(always)]
    fn zero_multipliers(&self) -> Self::Multipliers {
        StateVector::zeros(self.constraint_count())
    }

    /// Levels, all zero.
    #[inline(always)]
    fn zero_levels(&self) -> Self::Levels {
        StateVector::zeros(self.level_count())
    }

    /// The multipliers `lambda_a`, M numbers in order of declaration; the constraint force is `lambda_a eta^a`.
    ///
    /// # Errors
    /// A [`Fault`] where they do not exist, for example for dependent constraints.
    fn multipliers(&self, t: f64, state: &Self::State) -> Result<Self::Multipliers, Fault>;

    /// The residuals `eta^a(qdot) + eta^a_0`, and their natural scales: the sums of the absolute values of their
    /// terms, with sines and cosines counted as 1.
    fn residuals(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> (Self::Multipliers, Self::Multipliers);

    /// The forms `eta^a` (M rows of N, row after row) and their affine parts `eta^a_0` (M) at a position; for
    /// nonlinear constraints, those at rest.
    fn constraint_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    );

    /// True if every constraint is linear or affine in the velocities.
    #[inline(always)]
    fn is_linear(&self) -> bool {
        true
    }

    /// The constraints linearised at a velocity: forms and affine parts in the layout of
    /// [`Constrained::constraint_forms`], with `eta^a(qdot) + eta^a_0` the residual at this velocity. For linear
    /// constraints they do not depend on the velocity.
    fn linearised_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    ) {
        let _ = qdot;
        self.constraint_forms(t, q, forms, affine);
    }

    /// True if every state satisfies the constraints by its construction: the form reduced to D.
    fn is_reduced(&self) -> bool;

    /// Brings the velocity back to the constraints after a step. Unlike [`System::state_nearest`] it need not make
    /// the smallest change: where some velocities follow from the others at every state, it recomputes those and
    /// keeps the others to the last digit. Does nothing where [`Constrained::is_reduced`].
    ///
    /// # Errors
    /// A [`Fault`] where the velocity cannot be corrected; the state is unchanged then.
    fn restore(&self, t: f64, state: &mut Self::State) -> Result<(), Fault>;

    /// The constraint of each level, with a flag for levels declared to be 0. Empty if none is declared: then every
    /// motion keeps the levels that it starts with.
    #[inline(always)]
    fn declared_levels(&self) -> &[Level] {
        &[]
    }

    /// Natural scales of the levels declared to be 0: the sums of the absolute values of their terms, with sines and
    /// cosines counted as 1. 0 for the others.
    fn level_scales(&self, t: f64, q: &Self::Vector) -> Self::Levels {
        let _ = (t, q);
        self.zero_levels()
    }

    /// The position-level values `f^k(t, q)` of the integrable constraints. They are constant along the motion.
    fn levels(&self, t: f64, q: &Self::Vector) -> Self::Levels;

    /// One Newton step on position level, orthogonal in the metric: the change of q that changes the levels by
    /// `-excess` to first order.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints are singular.
    fn level_correction(
        &self,
        t: f64,
        q: &Self::Vector,
        excess: &Self::Levels,
    ) -> Result<Self::Vector, Fault>;
}
