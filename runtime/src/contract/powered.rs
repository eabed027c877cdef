//! Powers: the rates at which named causes change the energy of a system.

use super::System;
use crate::error::Fault;
use crate::state::StateVector;

/// A system with named forces: what changes its energy, by cause.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no named forces: declare `forces {{ .. }}` in its `model!`"
)]
pub trait Powered: System {
    /// One number per cause.
    type Powers: StateVector;

    /// The number of causes. Of powers of fixed number it is known.
    #[inline(always)]
    fn power_count(&self) -> usize {
        Self::Powers::CAPACITY
    }

    /// The causes: the named forces in the order of declaration; then `constraints`, where constraints are affine or not
    /// linear in the velocities, and `time`, where the Lagrangian depends on it.
    const POWERS: &'static [&'static str];

    /// The powers, in units of energy per time; the energy changes at the rate of their sum.
    ///
    /// # Errors
    /// [`Fault`].
    fn powers(&self, t: f64, state: &Self::State) -> Result<Self::Powers, Fault>;
}
