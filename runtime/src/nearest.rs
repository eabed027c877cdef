//! The velocity nearest to a given one that satisfies constraints nonlinear in the velocities, by Newton's method.

use crate::contract::Constrained;
use crate::error::Fault;
use crate::state::StateVector;

/// Maximum number of Newton steps. Near the solution, each step doubles the number of correct digits.
const STEPS: u32 = 48;

/// Residual that counts as rounding, relative to the sum of the absolute values of its terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Largest relative residual that is accepted if further steps do not reduce it, as in
/// [`System::state`](crate::System::state).
const ACCEPTED: f64 = 1e-9;

/// State at the limit of Newton's iteration from a velocity. `step` makes one step, which is orthogonal in the metric.
///
/// # Errors
/// [`Fault::ProjectionFailed`] where the iteration does not converge; the [`Fault`] of a step.
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
        // A residual that is accepted, and was not halved by the last step, ends the iteration.
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

/// The largest residual, relative to the sum of the absolute values of its terms, and the index of its constraint. NaN
/// counts as infinite.
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
