//! The velocity nearest to a given one that satisfies constraints which are not linear in it, by Newton's steps.

use crate::contract::Constrained;
use crate::error::Fault;
use crate::state::StateVector;

/// Newton's steps; each doubles the digits, once the first few have come near.
const STEPS: u32 = 48;

/// Part of the sum of a residual's absolute terms that counts as rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The largest part that is accepted where steps no longer help, as for [`System::state`](crate::System::state).
const ACCEPTED: f64 = 1e-9;

/// The state to which Newton's steps lead from a velocity; `step` makes one, orthogonal in the metric.
///
/// # Errors
/// [`Fault::ProjectionFailed`] where they lead nowhere; a [`Fault`] of a step.
pub fn nearest_by_steps<S: Constrained>(
    system: &S,
    t: f64,
    q: &S::Vector,
    qdot: &S::Vector,
    step: impl Fn(&S::Vector) -> Result<S::State, Fault>,
) -> Result<S::State, Fault> {
    let mut state = system.state_unchecked(t, q, qdot)?;
    let mut velocity = *qdot;
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let (part, _) = worst(system, t, q, &velocity);
        // Within rounding nothing is gained once a step does not halve what is left.
        if part <= ROUNDING || part <= ACCEPTED && part > 0.5 * least {
            return Ok(state);
        }
        least = least.min(part);
        state = step(&velocity)?;
        velocity = system.velocity(t, &state)?;
    }
    match worst(system, t, q, &velocity) {
        (part, _) if part <= ACCEPTED => Ok(state),
        (_, constraint) => Err(Fault::ProjectionFailed { constraint }),
    }
}

/// The largest residual in parts of the sum of its absolute terms, and whose it is; NaN counts as largest.
fn worst<S: Constrained>(system: &S, t: f64, q: &S::Vector, qdot: &S::Vector) -> (f64, usize) {
    let (residuals, scales) = system.residuals(t, q, qdot);
    let pairs = residuals.as_slice().iter().zip(scales.as_slice());
    let mut worst = (0.0, 0);
    for (constraint, (residual, scale)) in pairs.enumerate() {
        let part = match residual.abs() {
            0.0 => 0.0,
            residual => residual / scale,
        };
        if part.is_nan() || part > worst.0 {
            worst = (if part.is_nan() { f64::INFINITY } else { part }, constraint);
        }
    }
    worst
}
