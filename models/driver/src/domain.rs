//! The states that a model allows: on the allowed side of its surfaces, within its charts.

use dalembert::Instance;
use dalembert::contract::{TaylorField, Variational};
use dalembert::numbers::{Numbers, Row};
use dalembert::state::StateVector;
use dalembert::variations::Dual;

use crate::variation::constant;

/// Largest gap behind a surface that is rounding, as a fraction of the size of the state.
const ROUNDING: f64 = 1e-9;

/// True if a state is behind a surface that counts there, or its gaps do not exist. `size` is that of the state.
pub(crate) fn is_behind<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    size: f64,
) -> bool {
    let parameters = TaylorField::parameters(system);
    let parameters = constant::<S::Parameters<Dual>>(parameters.as_slice());
    let row = constant::<S::Row<Dual>>(state.as_slice());
    let Ok(gaps) = system.clearances(&parameters, Dual::of(t), &row) else {
        return true;
    };
    let mut numbered = gaps.as_slice().iter().map(|gap| gap.value).enumerate();
    numbered.any(|(surface, gap)| gap < -ROUNDING * size && system.counts(surface, t, state))
}

/// The largest absolute value of some components of a state, at least 1.
pub(crate) fn size(components: &[f64]) -> f64 {
    let values = components.iter();
    values.fold(1.0_f64, |most, value| most.max(value.abs()))
}
