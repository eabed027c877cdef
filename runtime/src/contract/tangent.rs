//! Directions in which a run is varied.

use crate::contract::TaylorField;
use crate::numbers::Row;
use crate::state::StateVector;

/// A first variation: how fast the state changes along a direction, and the parameters with it.
///
/// Before a run it is the direction that its start is varied in; after the run `state` is the derivative of the end
/// along that direction, at fixed times of start and end. `parameters` stays what it was.
pub struct Tangent<F: TaylorField> {
    /// Of the state, in its order and units.
    pub state: F::State,
    /// Of the parameters, in their order.
    pub parameters: F::Parameters<f64>,
}

impl<F: TaylorField> Clone for Tangent<F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: TaylorField> Copy for Tangent<F> {}

impl<F: TaylorField> core::fmt::Debug for Tangent<F> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Tangent")
            .field("state", &self.state)
            .field("parameters", &self.parameters)
            .finish()
    }
}

impl<F: TaylorField> Tangent<F> {
    /// No variation.
    pub fn zero() -> Self {
        Self {
            state: F::State::zeros(F::State::CAPACITY),
            parameters: F::Parameters::<f64>::zeros(F::Parameters::<f64>::CAPACITY),
        }
    }

    /// Along this direction of the state, at fixed parameters.
    pub fn of_state(direction: F::State) -> Self {
        Self {
            state: direction,
            ..Self::zero()
        }
    }

    /// Along one component of the state; past the last one, no variation.
    pub fn of_component(component: usize) -> Self {
        let mut tangent = Self::zero();
        if let Some(entry) = tangent.state.as_mut_slice().get_mut(component) {
            *entry = 1.0;
        }
        tangent
    }

    /// Along one parameter, at a fixed state; past the last one, no variation.
    pub fn of_parameter(parameter: usize) -> Self {
        let mut tangent = Self::zero();
        if let Some(entry) = tangent.parameters.as_mut_slice().get_mut(parameter) {
            *entry = 1.0;
        }
        tangent
    }
}
