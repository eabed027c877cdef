//! Test that states lie on the allowed side of the surfaces.

use dalembert::contract::{TaylorField, Variational};
use dalembert::law::Law;
use dalembert::numbers::{Numbers, Row};
use dalembert::state::StateVector;
use dalembert::variations::Dual;
use dalembert::{Fault, Instance};

use crate::variation::constant;

/// Largest distance behind a surface that counts as rounding, as a fraction of the size of the state.
const ROUNDING: f64 = 1e-9;

/// The active surfaces at a state, those whose conditions hold, with their gaps.
///
/// # Errors
/// A [`Fault`] where a gap does not exist.
pub(crate) fn gaps<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
) -> Result<Vec<(usize, f64)>, Fault> {
    let parameters = TaylorField::parameters(system);
    let parameters = constant::<S::Parameters<Dual>>(parameters.as_slice());
    let row = constant::<S::Row<Dual>>(state.as_slice());
    let gaps = system.clearances(&parameters, Dual::of(t), &row)?;
    let numbered = gaps.as_slice().iter().map(|gap| gap.value).enumerate();
    let counted = numbered.filter(|(surface, _)| system.counts(*surface, t, state));
    Ok(counted.collect())
}

/// The first wall behind which a state lies, with its gap. `size` is the size of the state. The surface of a reset is no
/// wall: a motion may pass it, and an equilibrium may lie behind it.
///
/// # Errors
/// A [`Fault`] where a gap does not exist.
pub(crate) fn behind<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    size: f64,
) -> Result<Option<(usize, f64)>, Fault> {
    let parameters = TaylorField::parameters(system);
    let is_wall = |surface| system.declared_law(&parameters, surface).0 != Law::Reset;
    let gaps = gaps(system, t, state)?;
    let mut behind = gaps.into_iter();
    Ok(behind.find(|(surface, gap)| *gap < -ROUNDING * size && is_wall(*surface)))
}

/// The size of a state: the largest absolute value of its components, at least 1.
pub(crate) fn size(components: &[f64]) -> f64 {
    let values = components.iter();
    values.fold(1.0_f64, |most, value| most.max(value.abs()))
}
