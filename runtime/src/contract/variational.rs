//! Functions that first variations need besides the power series of the motion, over any kind of number.

use super::{System, Tangent, TaylorField};
use crate::error::Fault;
use crate::law::Law;
use crate::numbers::{Interval, Numbers, Row};

/// A system whose states, gaps and transitions can be computed in any [`Numbers`], and therefore differentiated with
/// dual numbers.
///
/// Parameters are passed as numbers too, in the order of [`TaylorField::parameters`]. Every function has a counterpart
/// over doubles in the other traits of the system, and agrees with it up to rounding.
///
/// # Examples
///
/// ```
/// use dalembert::numbers::Row;
/// use dalembert::variations::Dual;
/// use dalembert::{StateVector, System, TaylorField, Variational};
///
/// dalembert::model! {
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0; }
///         initial { x = 1; }
///     }
/// }
///
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[-2.0].into())?;
/// let mut row = <Ball as TaylorField>::Row::<Dual>::zeros(2);
/// for (k, (dual, value)) in row.as_mut_slice().iter_mut().zip(state.as_slice()).enumerate() {
///     let mut slopes = [0.0; 4];
///     slopes[k] = 1.0;
///     *dual = Dual::new(*value, slopes);
/// }
///
/// // The gap and its derivatives with respect to position and momentum.
/// let parameters = Row::zeros(0);
/// let gap = ball.clearances(&parameters, Dual::constant(0.0), &row)?.as_slice()[0];
/// assert_eq!((gap.value, gap.slopes()[0], gap.slopes()[1]), (0.5, 1.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "the variations of `{Self}` are not known: add `variations` to the scene in its `model!`"
)]
pub trait Variational: TaylorField + System + Sized {
    /// N numbers, one per coordinate: positions or velocities.
    type Configuration<L: Numbers>: Row<L>;

    /// One number per surface, with or without a series of its gap.
    type Clearances<L: Numbers>: Row<L>;

    /// The numbers of a [`Contact`](crate::Contact), in its order, followed by the direction of the impulse.
    type Collision<L: Numbers>: Row<L>;

    /// The residuals of the constraints (M in the global form, none in the form reduced to D), then one number per
    /// position level. For a model with modes the length is one less than that of a state. It holds the deviations of
    /// the mode, the components that the mode does not use, the number of the mode, and zeros.
    type Deviations<L: Numbers>: Row<L>;

    /// One state per component of a state: a square matrix by its columns.
    type Columns: Copy + AsRef<[Self::State]> + AsMut<[Self::State]>;

    /// The columns of a zero matrix.
    fn columns() -> Self::Columns;

    /// Array with one direction per component of a state.
    type Tangents: Copy + AsRef<[Tangent<Self>]> + AsMut<[Tangent<Self>]>;

    /// Array without directions.
    fn tangents() -> Self::Tangents;

    /// True if a surface counts here; see [`Impacting::surface_active`](crate::Impacting::surface_active).
    fn counts(&self, surface: usize, t: f64, state: &Self::State) -> bool;

    /// True if a surface counts, and has a law, at all times and states of a box; false if at none; `None` if neither
    /// is certain. The default suffices for a system whose surfaces count everywhere.
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
    /// A [`Fault`] where the metric is singular.
    fn velocities<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Configuration<L>, Fault>;

    /// The state with these positions and velocities, in the mode in which states are made; see
    /// [`System::state_unchecked`].
    ///
    /// # Errors
    /// A [`Fault`] where the state cannot be formed.
    fn composed<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        q: &Self::Configuration<L>,
        qdot: &Self::Configuration<L>,
    ) -> Result<Self::Row<L>, Fault>;

    /// The state in the same mode after `change` has modified its positions and velocities. Both slices have one entry
    /// per coordinate of the model. Entries of coordinates that the mode lacks are 0, and their changes are ignored.
    ///
    /// # Errors
    /// A [`Fault`] where the velocities do not exist or the state cannot be formed.
    fn relocated<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        change: impl FnOnce(&mut [L], &mut [L]),
    ) -> Result<Self::Row<L>, Fault>;

    /// The declared initial positions and velocities of the mode in which states are made, one number per coordinate; 0
    /// for undeclared values. See [`Instance::initial`](crate::Instance::initial).
    ///
    /// # Errors
    /// A [`Fault`] where an expression of the declaration does not exist.
    fn declared_start<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
    ) -> Result<[Self::Configuration<L>; 2], Fault>;

    /// The residuals `eta^a(qdot) + eta^a_0` of all constraints at positions and velocities, followed by zeros.
    ///
    /// # Errors
    /// [`Fault::NotDerived`] for a system without constraints.
    fn residuals_at<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        q: &Self::Configuration<L>,
        qdot: &Self::Configuration<L>,
    ) -> Result<Self::Configuration<L>, Fault>;

    /// The residuals `eta^a(qdot) + eta^a_0` of the constraints that a state may violate, then the levels `f^k` of the
    /// constraints that have one. For a model with modes, the components that no variation changes follow.
    ///
    /// # Errors
    /// A [`Fault`] where the velocities do not exist.
    fn deviations<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Deviations<L>, Fault>;

    /// The gaps `h_s`.
    ///
    /// # Errors
    /// A [`Fault`] where the gaps do not exist.
    fn clearances<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Clearances<L>, Fault>;

    /// Quantities of an impact on a surface, from which every law that is an impulse is evaluated.
    ///
    /// # Errors
    /// A [`Fault`] in the cases of [`Impacting::contact`](crate::Impacting::contact).
    fn collision<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Self::Collision<L>, Fault>;

    /// The state after the impulse of [`Impacting::focus`](crate::Impacting::focus), on the instantaneous constraints
    /// of a surface; `None` if it has none.
    ///
    /// # Errors
    /// A [`Fault`] in the cases of [`Impacting::focus`](crate::Impacting::focus).
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

    /// A rate of the state with the correction of [`Impacting::trace`](crate::Impacting::trace), which keeps the
    /// instantaneous constraints of a surface; `None` if it has none.
    ///
    /// # Errors
    /// A [`Fault`] in the cases of [`Impacting::focus`](crate::Impacting::focus).
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

    /// Positions and velocities after the declared reset of a surface; `None` if its law is not a reset, and for a
    /// model with modes, where [`Self::passed`] applies the resets.
    ///
    /// # Errors
    /// A [`Fault`] of the velocities before the reset, or of the reset itself.
    fn landing<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<Option<[Self::Configuration<L>; 2]>, Fault>;

    /// The state after the declared reset of a surface, or after a transition to another mode; `None` if the surface
    /// is neither, or if the map is not available over this kind of number.
    ///
    /// # Errors
    /// A [`Fault`] of the reset or of the transition.
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

    /// Writes the declared outputs, in order; `values` has their number of entries. An output that the mode does not
    /// have stays as it is.
    ///
    /// # Errors
    /// A [`Fault`] where an output does not exist. The default, for systems without outputs, gives
    /// [`Fault::NotDerived`].
    fn declared_outputs<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        values: &mut [L],
    ) -> Result<(), Fault> {
        let _ = (parameters, t, state, values);
        Err(Fault::NotDerived)
    }

    /// The declared law of a surface, and its coefficient as a function of the parameters; 0 for a law without one.
    fn declared_law<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        surface: usize,
    ) -> (Law, L);
}
