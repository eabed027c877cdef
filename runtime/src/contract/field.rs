//! Motions as differential equations of first order: their rates and their power series.

use crate::error::Fault;
use crate::jet::{Jets, LENGTH, Work};
use crate::numbers::{Numbers, Rated, Row};
use crate::state::StateVector;

/// A first-order system of ordinary differential equations on a state of fixed size.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no vector field: declare it with `dalembert::model!`"
)]
pub trait VectorField {
    /// The state; its components mean what the system says.
    type State: StateVector;

    /// The number of components of a state. Of a state of fixed size it is known.
    #[inline(always)]
    fn state_len(&self) -> usize {
        Self::State::CAPACITY
    }

    /// A state of zeros, to be filled.
    #[inline(always)]
    fn zero_state(&self) -> Self::State {
        StateVector::zeros(self.state_len())
    }

    /// Writes the time derivative of `state` at time `t`.
    ///
    /// # Errors
    /// A [`Fault`] where the derivative does not exist; `rate` is unspecified then.
    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault>;

    /// The size of one unit of each component: absolute tolerances are multiplied by it, so that they mean
    /// the same for a momentum as for the velocity it belongs to. Ones unless overridden.
    fn scale(&self, t: f64, state: &Self::State) -> Self::State {
        let _ = (t, state);
        let mut ones = state.zeroed();
        ones.as_mut_slice().fill(1.0);
        ones
    }

    /// Whether rates may have features that are narrow beside what a step passes, as bumps of an exponential are. Steps are
    /// compared with [`VectorField::rates_along`] then.
    #[inline(always)]
    fn can_be_narrow(&self) -> bool {
        false
    }

    /// All rates along a stretch of motion: `component(i)` gives all values of component `i` of the state, `rate(i, ..)` takes all
    /// values of its rate. Nothing where [`VectorField::can_be_narrow`] is false.
    ///
    /// # Errors
    /// [`Fault`] where the rates do not exist.
    fn rates_along(
        &self,
        t: Rated,
        component: &dyn Fn(usize) -> Rated,
        rate: &mut dyn FnMut(usize, Rated),
    ) -> Result<(), Fault> {
        let _ = (t, component, rate);
        Ok(())
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
    #[inline(always)]
    fn work(&self) -> Option<Work> {
        None
    }

    /// The number of gaps with series. Of gaps of fixed number it is known.
    #[inline(always)]
    fn series_gap_count(&self) -> usize {
        Self::Gaps::<f64>::CAPACITY
    }

    /// How many numbers are known at one moment. Where it is fixed it is known.
    #[inline(always)]
    fn firsts_len(&self) -> usize {
        Self::Firsts::<f64>::CAPACITY
    }

    /// The parameters.
    fn parameters(&self) -> Self::Parameters<f64>;

    /// Writes what is known at `(t, state)` with these parameters, which need not be the system's own.
    ///
    /// # Errors
    /// A [`Fault`] where the derivative does not exist, in whatever lane; `firsts` is unspecified then.
    fn begin<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        firsts: &mut Self::Firsts<L>,
    ) -> Result<(), Fault>;

    /// Writes the power series of the motion that is at `coefficients[0]`, where `firsts` is known, and of the gaps along
    /// it, with these parameters:
    ///
    /// ```text
    /// state(t + unit s) = coefficients[0] + coefficients[1] s + .. + coefficients[order] s^order + ..
    /// ```
    ///
    /// `order` is 1 or more; orders above 32 are not computed. What `jets` holds before does not matter.
    #[allow(
        clippy::too_many_arguments,
        reason = "a series takes what is known and gives state, gaps and intermediate values"
    )]
    fn advance<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        unit: L,
        order: usize,
        firsts: &Self::Firsts<L>,
        coefficients: &mut [Self::Row<L>; LENGTH],
        gaps: &mut [Self::Gaps<L>; LENGTH],
        jets: &mut Self::Jets<L>,
    );
}
