//! Directions of first variations of a run.

use crate::contract::TaylorField;
use crate::numbers::Row;
use crate::state::StateVector;

/// A first variation: a tangent vector of state and parameters.
///
/// Before a run it is the direction of the variation of its start. After the run `state` is the derivative of the end
/// along that direction, at fixed times of start and end. `parameters` is unchanged.
pub struct Tangent<F: TaylorField> {
    /// Variation of the state, in its order and units.
    pub state: F::State,
    /// Variation of the parameters, in their order.
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
    /// The zero variation.
    pub fn zero() -> Self {
        Self {
            state: F::State::zeros(F::State::CAPACITY),
            parameters: F::Parameters::<f64>::zeros(F::Parameters::<f64>::CAPACITY),
        }
    }

    /// Variation along this direction of the state, at fixed parameters.
    pub fn of_state(direction: F::State) -> Self {
        Self {
            state: direction,
            ..Self::zero()
        }
    }

    /// Variation of one component of the state; zero for an index past the last one.
    pub fn of_component(component: usize) -> Self {
        let mut tangent = Self::zero();
        if let Some(entry) = tangent.state.as_mut_slice().get_mut(component) {
            *entry = 1.0;
        }
        tangent
    }

    /// Variation of one parameter, at a fixed state; zero for an index past the last one.
    pub fn of_parameter(parameter: usize) -> Self {
        let mut tangent = Self::zero();
        if let Some(entry) = tangent.parameters.as_mut_slice().get_mut(parameter) {
            *entry = 1.0;
        }
        tangent
    }
}
