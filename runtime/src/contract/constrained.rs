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
/// // The skate moves along x at speed 2 and turns at rate 3. The force across the edge is m v omega.
/// let skate = Skate::default();
/// let state = skate.state(0.0, &[0.0, 0.0, 0.0].into(), &[2.0, 0.0, 3.0].into())?;
/// assert!((skate.multipliers(0.0, &state)?[0] - 6.0).abs() < 1e-15);
///
/// // A velocity across the edge violates the constraint.
/// let (residuals, _) = skate.residuals(0.0, &[0.0; 3].into(), &[0.0, 1.0, 0.0].into());
/// assert_eq!(residuals[0], 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints: declare `constraints {{ .. }}` in its `model!`"
)]
pub trait Constrained: System {
    /// Vector of M numbers, one per constraint, in the order of declaration.
    type Multipliers: StateVector;

    /// Vector of levels: one value `f^k(t, q)` per integrable constraint with a known integral (see
    /// [`ConstraintInfo::level`](crate::describe::ConstraintInfo::level)).
    type Levels: StateVector;

    /// M, the number of constraints. The default is correct if the type of the multipliers has a fixed length.
    #[inline(always)]
    fn constraint_count(&self) -> usize {
        Self::Multipliers::CAPACITY
    }

    /// The number of levels. The default is correct if the type of the levels has a fixed length.
    #[inline(always)]
    fn level_count(&self) -> usize {
        Self::Levels::CAPACITY
    }

    /// A vector of M zeros.
    #[inline(always)]
    fn zero_multipliers(&self) -> Self::Multipliers {
        StateVector::zeros(self.constraint_count())
    }

    /// A vector of levels that are all 0.
    #[inline(always)]
    fn zero_levels(&self) -> Self::Levels {
        StateVector::zeros(self.level_count())
    }

    /// The Lagrange multipliers `lambda_a`, M numbers in the order of declaration. The constraint force is
    /// `lambda_a eta^a`.
    ///
    /// # Errors
    /// A [`Fault`] where the multipliers do not exist, for example for dependent constraints.
    fn multipliers(&self, t: f64, state: &Self::State) -> Result<Self::Multipliers, Fault>;

    /// The residuals `eta^a(qdot) + eta^a_0`, and their scales: the sums of the absolute values of their terms, with
    /// sines and cosines counted as 1.
    fn residuals(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> (Self::Multipliers, Self::Multipliers);

    /// Writes the forms `eta^a` (M rows of N, row-major) and their affine parts `eta^a_0` (M) at a position. For
    /// nonlinear constraints they are those at zero velocity.
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

    /// Writes the constraints linearised at the velocity `qdot`, in the layout of [`Constrained::constraint_forms`]. At
    /// this velocity `eta^a(qdot) + eta^a_0` is the residual. For linear constraints the result does not depend on the
    /// velocity.
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

    /// True in the form reduced to D, where every state satisfies the constraints by construction.
    fn is_reduced(&self) -> bool;

    /// Corrects the velocity to the constraints after a step. The correction need not be the smallest, unlike that of
    /// [`System::state_nearest`]. If the constraints determine the same velocities from the others at every state, only
    /// the determined ones are recomputed; the others keep all their digits. Does nothing where
    /// [`Constrained::is_reduced`].
    ///
    /// # Errors
    /// A [`Fault`] where the velocity cannot be corrected; the state is then unchanged.
    fn restore(&self, t: f64, state: &mut Self::State) -> Result<(), Fault>;

    /// The constraint of each level, with a flag for levels that are declared to be 0. Empty if no level is declared to
    /// be 0: then every motion keeps its initial levels.
    #[inline(always)]
    fn declared_levels(&self) -> &[Level] {
        &[]
    }

    /// Scales of the levels declared to be 0: the sums of the absolute values of their terms, with sines and cosines
    /// counted as 1. The entries of the other levels are 0.
    fn level_scales(&self, t: f64, q: &Self::Vector) -> Self::Levels {
        let _ = (t, q);
        self.zero_levels()
    }

    /// The levels: values `f^k(t, q)` of the integrals of integrable constraints. They are constant along the motion.
    fn levels(&self, t: f64, q: &Self::Vector) -> Self::Levels;

    /// One Newton step for the positions, orthogonal in the metric: the change of `q` that changes the levels by
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
