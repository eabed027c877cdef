//! Resets: applies the declared map of positions and velocities to a state.

use crate::contract::Impacting;
use crate::error::StateError;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// The state after the reset of a surface, checked against its chart and the constraints.
pub(crate) fn after_reset<Sys: Impacting + ?Sized>(
    system: &Sys,
    surface: usize,
    t: f64,
    before: &Sys::State,
) -> Result<Sys::State, Outcome> {
    if system.law(surface) == Law::Transition {
        return Err(match system.takes(surface, t, before) {
            true => Outcome::LeftMode { surface },
            false => Outcome::Untaken { surface },
        });
    }
    let Some(jump) = system.reset(surface, t, before)? else {
        return Err(Outcome::NoReset { surface });
    };
    let (q, qdot) = (jump.position, jump.velocity);
    // A reset that changes nothing keeps the last digits of the state: momenta are not recomputed from velocities.
    if q == system.position(before) && qdot == system.velocity(t, before)? {
        return Ok(*before);
    }
    let mut components = q.as_slice().iter().chain(qdot.as_slice());
    if let Some(component) = components.position(|value| !value.is_finite()) {
        return Err(Outcome::NonFinite { component });
    }
    let after = system.state_unchecked(t, &q, &qdot)?;
    if let Some(coordinate) = system.outside_chart(&after) {
        return Err(Outcome::LeftChart { coordinate });
    }
    match system.admit(t, &q, &qdot) {
        Err(
            StateError::OffConstraint { constraint, .. }
            | StateError::OffPosition { constraint, .. },
        ) => Err(Outcome::ResetOffConstraint {
            surface,
            constraint,
        }),
        // `admit` gives no other error.
        _ => Ok(after),
    }
}
