//! Systems with inputs, and what changes the energy of a system.

use super::System;
use crate::error::Fault;
use crate::inputs::Steered;
use crate::state::StateVector;

/// A system whose `inputs` the caller supplies. It holds their values like parameters, 0 at first, until they are set.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no inputs: declare `inputs {{ u; }}` in its `model!`"
)]
pub trait Actuated: System + Copy {
    /// One number per input, in the order of declaration: `[f64; K]`.
    type Inputs: Copy;

    /// Sets all inputs.
    fn set_inputs(&mut self, inputs: &Self::Inputs);

    /// The system with inputs that are a function of time and state.
    fn with_inputs<F>(self, inputs: F) -> Steered<Self, F>
    where
        F: Fn(f64, &Self::State) -> Self::Inputs,
    {
        Steered {
            system: self,
            inputs,
        }
    }
}

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
