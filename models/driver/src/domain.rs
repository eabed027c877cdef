//! Test that states lie on the allowed side of the surfaces.

use dalembert::contract::{TaylorField, Variational};
use dalembert::law::Law;
use dalembert::numbers::{Numbers, Row};
use dalembert::state::StateVector;
use dalembert::variations::Dual;
use dalembert::{Fault, Instance};

use crate::variation::constant;

/// Largest difference that counts as rounding, as a fraction of the size of the state.
const ROUNDING: f64 = 1e-9;

/// Distance of a state from one at which a reset is compared with the state before, relative to the components.
const ASIDE: f64 = 1e-3;

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

/// The first surface behind which a state lies and no motion comes, with its gap. `size` is the size of the state. A
/// reset that changes nothing is a gate, which motion passes in both directions.
///
/// # Errors
/// A [`Fault`] where a gap does not exist.
pub(crate) fn behind<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    size: f64,
) -> Result<Option<(usize, f64)>, Fault> {
    let mut gaps = gaps(system, t, state)?.into_iter();
    let is_behind = |(surface, gap): &(usize, f64)| {
        *gap < -ROUNDING * size && !is_gate(system, *surface, t, state)
    };
    Ok(gaps.find(is_behind))
}

/// True if a surface has a reset that changes no state, as seen at a state next to this one: a reset such as
/// `dot(x) = -dot(x)` leaves some states as they are.
fn is_gate<S: Instance + Variational>(
    system: &S,
    surface: usize,
    t: f64,
    state: &S::State,
) -> bool {
    let parameters = TaylorField::parameters(system);
    let mut near = S::Row::<f64>::zeros(state.as_slice().len());
    for (index, value) in state.as_slice().iter().enumerate() {
        near.as_mut_slice()[index] = value + ASIDE * (1.0 + value.abs()) * (1.0 + index as f64);
    }
    let are_same = |after: &S::Row<f64>| {
        let mut pairs = after.as_slice().iter().zip(near.as_slice());
        pairs.all(|(after, before)| (after - before).abs() <= ROUNDING * (1.0 + before.abs()))
    };
    let after = system.passed(&parameters, surface, t, &near);
    system.declared_law(&parameters, surface).0 == Law::Reset
        && after.is_ok_and(|after| after.as_ref().is_some_and(are_same))
}

/// True if a state lies behind a wall. The surface of a reset is no wall here: an equilibrium may lie behind it.
///
/// # Errors
/// A [`Fault`] where a gap does not exist.
pub(crate) fn is_behind_wall<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    size: f64,
) -> Result<bool, Fault> {
    let parameters = TaylorField::parameters(system);
    let is_wall = |surface| system.declared_law(&parameters, surface).0 != Law::Reset;
    let gaps = gaps(system, t, state)?;
    let mut numbered = gaps.into_iter();
    Ok(numbered.any(|(surface, gap)| gap < -ROUNDING * size && is_wall(surface)))
}

/// The size of a state: the largest absolute value of its components, at least 1.
pub(crate) fn size(components: &[f64]) -> f64 {
    let values = components.iter();
    values.fold(1.0_f64, |most, value| most.max(value.abs()))
}
