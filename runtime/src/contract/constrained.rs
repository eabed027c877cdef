//! Systems with constraints.

use super::{Level, System};
use crate::error::Fault;
use crate::state::StateVector;

/// A system with constraints `eta^a(qdot) + eta^a_0 = 0`, or `phi^a(t, q, qdot) = 0` that are not linear in the velocities:
/// then `eta^a = dphi^a/dqdot`, and `phi^a` stands for `eta^a(qdot) + eta^a_0`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints: declare `constraints {{ .. }}` in its `model!`"
)]
pub trait Constrained: System {
    /// M numbers, one per constraint, in the order of declaration.
    type Multipliers: StateVector;

    /// One number per constraint that is integrable with a known function (see
    /// [`ConstraintInfo::level`](crate::describe::ConstraintInfo::level)).
    type Levels: StateVector;

    /// M, the number of constraints. Of multipliers of fixed number it is known.
    #[inline(always)]
    fn constraint_count(&self) -> usize {
        Self::Multipliers::CAPACITY
    }

    /// The number of levels. Where it is fixed it is known.
    #[inline(always)]
    fn level_count(&self) -> usize {
        Self::Levels::CAPACITY
    }

    /// M zeros.
    #[inline(always)]
    fn zero_multipliers(&self) -> Self::Multipliers {
        StateVector::zeros(self.constraint_count())
    }

    /// As many zeros as there are levels.
    #[inline(always)]
    fn zero_levels(&self) -> Self::Levels {
        StateVector::zeros(self.level_count())
    }

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

    /// The forms `eta^a` (M rows of N, row after row) and their affine parts `eta^a_0` (M) at a position; of constraints that
    /// are not linear, those at rest.
    fn constraint_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    );

    /// Whether every constraint is linear or affine in the velocities.
    #[inline(always)]
    fn is_linear(&self) -> bool {
        true
    }

    /// The constraints linearised at a velocity: forms and affine parts as [`Constrained::constraint_forms`] gives them, with
    /// `eta^a(qdot) + eta^a_0` the residual at this velocity. Of linear constraints they are the same at all of them.
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

    /// Whether every state satisfies the constraints by its construction: the form reduced to D.
    fn is_reduced(&self) -> bool;

    /// Brings the velocity back to the constraints after a step. Unlike [`System::state_nearest`] it need not move it
    /// as little as possible: where some velocities follow from the others at every state, those are recomputed
    /// and the others kept to the last digit. Does nothing where [`Constrained::is_reduced`].
    ///
    /// # Errors
    /// [`Fault`]; the state is unchanged then.
    fn restore(&self, t: f64, state: &mut Self::State) -> Result<(), Fault>;

    /// Which constraint each level belongs to, and whether it is declared to be 0. Empty where none is: then every motion
    /// keeps the levels that it starts with.
    #[inline(always)]
    fn declared_levels(&self) -> &'static [Level] {
        &[]
    }

    /// The natural sizes of the levels that are declared to be 0: the sum of the absolute values of their terms, sines and
    /// cosines counted as 1. 0 for the others.
    fn level_scales(&self, t: f64, q: &Self::Vector) -> Self::Levels {
        let _ = (t, q);
        self.zero_levels()
    }

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
