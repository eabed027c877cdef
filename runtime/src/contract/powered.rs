//! Powers: the rates at which named forces and other causes change the energy of a system.

use super::System;
use crate::error::Fault;
use crate::state::StateVector;

/// A system with named forces, and the power of each cause that changes its energy.
///
/// # Examples
///
/// ```
/// use dalembert::{Powered, System};
///
/// dalembert::model! {
///     pub Cart {
///         coordinates { x; }
///         parameters { c > 0 = 1/2; }
///         lagrangian = dot(x)^2/2;
///         forces { drag: -c*dot(x)*d(x); }
///     }
/// }
///
/// let cart = Cart::default();
/// let state = cart.state(0.0, &[0.0].into(), &[2.0].into())?;
/// assert_eq!(Cart::POWERS, ["drag"]);
/// assert_eq!(cart.powers(0.0, &state)?[0], -2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no named forces: declare `forces {{ .. }}` in its `model!`"
)]
pub trait Powered: System {
    /// One number per cause.
    type Powers: StateVector;

    /// Number of causes. The default is correct if `Powers` has a fixed length.
    #[inline(always)]
    fn power_count(&self) -> usize {
        Self::Powers::CAPACITY
    }

    /// Names of the causes: the named forces in order of declaration; then `constraints`, if constraints are affine
    /// or nonlinear in the velocities, and `time`, if the Lagrangian depends on it.
    const POWERS: &'static [&'static str];

    /// The powers, in units of energy per time. Their sum is the rate of the energy.
    ///
    /// # Errors
    /// A [`Fault`] where the velocities or the multipliers do not exist.
    fn powers(&self, t: f64, state: &Self::State) -> Result<Self::Powers, Fault>;
}
