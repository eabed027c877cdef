//! Motions as first-order differential equations: their rates and their power series.

use crate::error::Fault;
use crate::jet::{Jets, LENGTH, Work};
use crate::numbers::{Numbers, Rated, Row};
use crate::state::StateVector;

/// A first-order system of ordinary differential equations on a state of fixed size.
///
/// # Examples
///
/// ```
/// use dalembert::{Fault, VectorField};
/// use nalgebra::SVector;
///
/// /// Van der Pol's oscillator.
/// struct VanDerPol {
///     mu: f64,
/// }
///
/// impl VectorField for VanDerPol {
///     type State = SVector<f64, 2>;
///
///     fn rate(&self, _t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault> {
///         let [x, v] = [state[0], state[1]];
///         *rate = SVector::from([v, self.mu * (1.0 - x * x) * v - x]);
///         Ok(())
///     }
/// }
///
/// let field = VanDerPol { mu: 2.0 };
/// let mut rate = field.zero_state();
/// field.rate(0.0, &SVector::from([2.0, 1.0]), &mut rate)?;
/// assert_eq!(rate, SVector::from([1.0, -8.0]));
/// # Ok::<(), dalembert::Fault>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no vector field: declare it with `dalembert::model!`"
)]
pub trait VectorField {
    /// The state; the system gives its components their meaning.
    type State: StateVector;

    /// Number of components of a state. The default is correct for states of fixed size.
    #[inline(always)]
    fn state_len(&self) -> usize {
        Self::State::CAPACITY
    }

    /// A state with all components 0.
    #[inline(always)]
    fn zero_state(&self) -> Self::State {
        StateVector::zeros(self.state_len())
    }

    /// Writes the time derivative of `state` at time `t`.
    ///
    /// # Errors
    /// A [`Fault`] where the derivative does not exist; `rate` is unspecified then.
    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault>;

    /// Natural unit of each component, a vector of the same length as the state. Absolute tolerances are multiplied by
    /// it, so that a tolerance means the same for a momentum as for its velocity. Ones by default.
    fn scale(&self, t: f64, state: &Self::State) -> Self::State {
        let _ = (t, state);
        let mut ones = state.zeroed();
        ones.as_mut_slice().fill(1.0);
        ones
    }

    /// True if rates may have features that are narrow relative to a step, for example narrow bumps of an
    /// exponential. Steps are then checked against [`VectorField::rates_along`].
    #[inline(always)]
    fn can_be_narrow(&self) -> bool {
        false
    }

    /// True if, at these values of the parameters, rates may have features much narrower than those of a sine, or
    /// cannot be bounded. False if [`VectorField::can_be_narrow`] is false. A run calls it once; the call costs about
    /// as much as a few evaluations of the rate.
    fn has_narrow_rates(&self) -> bool {
        self.can_be_narrow()
    }

    /// Encloses all rates along a part of the motion. `component(i)` returns an enclosure of component `i` of the
    /// state; `rate(i, ..)` receives an enclosure of its rate. Called only if [`VectorField::can_be_narrow`] is true.
    /// The default does nothing.
    ///
    /// # Errors
    /// A [`Fault`] where the rates do not exist.
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

/// A vector field with the power series of its motions, for the integrator [`Taylor`](crate::Taylor).
///
/// Series are computed over [`Numbers`]: `f64` for one motion, SIMD lanes for several at once. [`TaylorField::begin`]
/// computes the quantities at one moment, [`TaylorField::advance`] the higher coefficients.
///
/// # Examples
///
/// ```
/// use dalembert::jet::{Jets, LENGTH};
/// use dalembert::numbers::Row;
/// use dalembert::{StateVector, System, TaylorField};
///
/// dalembert::model! {
///     pub Oscillator {
///         coordinates { x; }
///         lagrangian = (dot(x)^2 - x^2)/2;
///     }
/// }
///
/// type State = <Oscillator as TaylorField>::Row<f64>;
///
/// let system = Oscillator::default();
/// let start = system.state(0.0, &[1.0].into(), &[0.0].into())?;
/// let parameters = system.parameters();
/// let mut coefficients = [State::zeros(2); LENGTH];
/// coefficients[0].as_mut_slice().copy_from_slice(start.as_slice());
/// let mut firsts = <Oscillator as TaylorField>::Firsts::<f64>::zeros(system.firsts_len());
/// system.begin(&parameters, 0.0, &coefficients[0], &mut firsts)?;
/// let mut gaps = [<Oscillator as TaylorField>::Gaps::<f64>::zeros(0); LENGTH];
/// let mut jets = <Oscillator as TaylorField>::Jets::<f64>::ZERO;
/// system.advance(&parameters, 1.0, 4, &firsts, &mut coefficients, &mut gaps, &mut jets);
///
/// // x = cos t = 1 - t^2/2 + t^4/24 - ..
/// let of_x = coefficients.map(|state| state.as_slice()[0]);
/// assert!((of_x[2] + 1.0 / 2.0).abs() < 1e-16 && (of_x[4] - 1.0 / 24.0).abs() < 1e-16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "the Taylor coefficients of `{Self}` are not known: declare it with `dalembert::model!`"
)]
pub trait TaylorField: VectorField {
    /// The parameters of the system.
    type Parameters<L: Numbers>: Row<L>;

    /// A state over `L`: one number per component, in the same order.
    type Row<L: Numbers>: Row<L>;

    /// One number per surface. Empty if a gap is not analytic, like `|x|`, or if there are no surfaces.
    type Gaps<L: Numbers>: Row<L>;

    /// Quantities at one moment: the rates, then the gaps, then the other values that coefficients above order 0 depend
    /// on.
    type Firsts<L: Numbers>: Row<L>;

    /// Storage for the coefficients of intermediate values.
    type Jets<L: Numbers>: Jets;

    /// True if the kernels are called through pointers. Then everything that follows a step in lanes is called through
    /// a pointer as well, and is compiled once for all integrators.
    const IS_BEHIND_POINTERS: bool = false;

    /// Work of an expansion, if known. It determines the order of the series.
    #[inline(always)]
    fn work(&self) -> Option<Work> {
        None
    }

    /// Number of gaps with series. The default is correct for a fixed number.
    #[inline(always)]
    fn series_gap_count(&self) -> usize {
        Self::Gaps::<f64>::CAPACITY
    }

    /// Number of quantities at one moment. The default is correct for a fixed number.
    #[inline(always)]
    fn firsts_len(&self) -> usize {
        Self::Firsts::<f64>::CAPACITY
    }

    /// The parameters.
    fn parameters(&self) -> Self::Parameters<f64>;

    /// Writes the quantities at `(t, state)`. `parameters` may differ from the system's own.
    ///
    /// # Errors
    /// A [`Fault`] if the derivative does not exist in at least one of the lanes; `firsts` is unspecified then.
    fn begin<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        firsts: &mut Self::Firsts<L>,
    ) -> Result<(), Fault>;

    /// Writes the power series of the motion through `coefficients[0]`, and of the gaps along it. `firsts` are the
    /// quantities that [`TaylorField::begin`] wrote for this state and these parameters.
    ///
    /// ```text
    /// state(t + unit s) = coefficients[0] + coefficients[1] s + .. + coefficients[order] s^order + ..
    /// ```
    ///
    /// `order` is 1 or more; orders above 32 are not computed. The previous content of `jets` is ignored.
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
