//! What first variations need besides the power series of the motion: transitions, written over numbers.

use super::{System, Tangent, TaylorField};
use crate::error::Fault;
use crate::law::Law;
use crate::numbers::{Interval, Numbers, Row};

/// A system whose states, gaps and transitions can be computed in any [`Numbers`], and so be differentiated.
///
/// Parameters are given as numbers too, in the order of [`TaylorField::parameters`]. Every function here is one of the
/// system's own, written once more over `L`: with `f64` it gives the same value up to rounding.
#[diagnostic::on_unimplemented(
    message = "the variations of `{Self}` are not known: add `variations` to the scene in its `model!`"
)]
pub trait Variational: TaylorField + System + Sized {
    /// N numbers, one per coordinate: positions or velocities.
    type Configuration<L: Numbers>: Row<L>;

    /// One number per surface, whether gaps have series or not.
    type Clearances<L: Numbers>: Row<L>;

    /// The numbers of a [`Contact`](crate::Contact), in its order, and the direction of the impulse after them.
    type Collision<L: Numbers>: Row<L>;

    /// One number per equation that the motion keeps to because of constraints: M in the global form, none in the form
    /// reduced to D; and one per constraint that has a position level. Of a model with modes as many as a state has components
    /// but one: those of the mode, the components that it does not use, the number of the mode, zeros.
    type Deviations<L: Numbers>: Row<L>;

    /// As many states as a state has components: a square matrix by its columns.
    type Columns: Copy + AsRef<[Self::State]> + AsMut<[Self::State]>;

    /// The columns of a matrix of zeros.
    fn columns() -> Self::Columns;

    /// As many directions as a state has components.
    type Tangents: Copy + AsRef<[Tangent<Self>]> + AsMut<[Tangent<Self>]>;

    /// No directions in any of these places.
    fn tangents() -> Self::Tangents;

    /// Whether a surface counts here, as [`Impacting::surface_active`](crate::Impacting::surface_active) says.
    fn counts(&self, surface: usize, t: f64, state: &Self::State) -> bool;

    /// Whether a surface counts, and has a law, at all times and states of a box; `None` where that is not certain. A system whose
    /// surfaces count everywhere need not say so.
    fn counts_throughout(
        &self,
        parameters: &Self::Parameters<Interval>,
        surface: usize,
        t: Interval,
        state: &Self::Row<Interval>,
    ) -> Option<bool> {
        let _ = (parameters, surface, t, state);
        Some(true)
    }

    /// The velocities of a state.
    ///
    /// # Errors
    /// [`Fault`].
    fn velocities<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Configuration<L>, Fault>;

    /// The state with these positions and velocities, as [`System::state_unchecked`] makes it.
    ///
    /// # Errors
    /// [`Fault`]; of a model with modes, [`Fault::SeveralModes`].
    fn composed<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        q: &Self::Configuration<L>,
        qdot: &Self::Configuration<L>,
    ) -> Result<Self::Row<L>, Fault>;

    /// `eta^a(qdot) + eta^a_0` of the constraints where a state may be off them, then the levels `f^k` of those that have one; of a model
    /// with modes, the components that no variation changes after them.
    ///
    /// # Errors
    /// [`Fault`].
    fn deviations<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Deviations<L>, Fault>;

    /// The gaps `h_s`.
    ///
    /// # Errors
    /// [`Fault`].
    fn clearances<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Clearances<L>, Fault>;

    /// What an impact on a surface by any law that is an impulse needs.
    ///
    /// # Errors
    /// [`Fault`].
    fn collision<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Collision<L>, Fault>;

    /// The state at the instantaneous constraints of a surface, as [`Impacting::focus`](crate::Impacting::focus) brings it
    /// there; `None` where it has none.
    ///
    /// # Errors
    /// [`Fault`].
    fn focus<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Option<Self::Row<L>>, Fault> {
        let _ = (parameters, surface, t, state);
        Ok(None)
    }

    /// A rate of the state with the force that keeps the instantaneous constraints of a surface, as
    /// [`Impacting::trace`](crate::Impacting::trace) gives it; `None` where it has none.
    ///
    /// # Errors
    /// [`Fault`].
    fn trace<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
        rate: &Self::Row<L>,
    ) -> Result<Option<Self::Row<L>>, Fault> {
        let _ = (parameters, surface, t, state, rate);
        Ok(None)
    }

    /// Positions and velocities after the declared reset of a surface; `None` where its law is no reset, and of a model with
    /// modes, whose resets are those of the mode ([`Self::passed`]).
    ///
    /// # Errors
    /// [`Fault`].
    fn landing<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Option<[Self::Configuration<L>; 2]>, Fault>;

    /// The state after the declared reset of a surface, or after a transition to another mode; `None` where it is
    /// neither, or not known over numbers.
    ///
    /// # Errors
    /// [`Fault`].
    fn passed<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Option<Self::Row<L>>, Fault> {
        match self.landing(parameters, surface, t, state)? {
            Some([q, qdot]) => self.composed(parameters, t, &q, &qdot).map(Some),
            None => Ok(None),
        }
    }

    /// The declared law of a surface, and its coefficient as a number of the parameters; 0 for a law without one.
    fn declared_law<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
    ) -> (Law, L);
}
