//! Discrete Lagrange-d'Alembert principle at the midpoint, of orders 2 and 4. The methods are implicit, have a fixed
//! step, and stay on D to rounding.
//!
//! ```text
//! v = (q1 - q0)/h,  qm = (q0 + q1)/2,  tm = t0 + h/2,   f = dL/dq + F
//!
//! dL/dqdot(tm, qm, v) - h/2 f(tm, qm, v) = p0 + lambda_a eta^a(t0, q0)    with   eta(tm, qm)(v) + eta_0(tm, qm) = 0
//! dL/dqdot(tm, qm, v) + h/2 f(tm, qm, v) = p1 - mu_a eta^a(t1, q1)        with   (q1, p1) on D at t1
//! ```
//!
//! The first line, N + M equations, gives `v` and `lambda`; the second gives `p1 = p0 + h f + lambda_a eta^a(t0, q0) +
//! mu_a eta^a(t1, q1)`. If the ends are exchanged and `h` becomes `-h`, the two lines are exchanged, so that the step
//! is self-adjoint. It maps D to itself. In two successive steps `mu + lambda'` at the common point is the multiplier
//! of the discrete Lagrange-d'Alembert equations of the midpoint Lagrangian with the midpoint constraint, so that the
//! `q` are those of Cortes and Martinez. Compositions of the step are maps of D, and self-adjoint where they are
//! symmetric.
//!
//! Every iteration that solves the first line for `v` satisfies the constraints at the midpoint:
//! `P = p0 + h/2 f(v) + lambda eta(q0)`, `(v, nu) = constrained_velocity(qm, P)`, `lambda += nu`. At the solution `nu`
//! is 0.

use super::controller::not_finite;
use super::embedded::Counted;
use super::fixed::{Advance, Departure, FixedStep, Method};
use super::iteration::{Iteration, Verdict};
use super::precise::Precise;
use super::stepper::StepFailure;
use crate::contract::Lagrangian;
use crate::error::Fault;
use crate::math::larger;
use crate::state::{StateVector, scaled};

/// The discrete Lagrange-d'Alembert midpoint rule: order 2 with dense output of order 2.
///
/// - Constraints, including affine and time-dependent ones, hold to rounding at the ends of all steps without
///   projection. If the start violates the constraints, the end of the first step satisfies them.
/// - The method is symmetric: reversible systems retrace their path to rounding. If their motion is regular, the energy
///   error of size `h^2` does not grow. The method is not symplectic, since there is no symplectic structure to
///   preserve: if the motion is chaotic and not reversible, the energy error performs a random walk and grows like
///   `t^(1/2)`.
/// - Without constraints and forces it is the variational midpoint rule, symplectic in `(q, p)`, with the
///   consequences listed in [`Gauss4`](super::Gauss4).
/// - Holonomic constraints (`d(f) = 0`) hold on velocities. Their levels `f` are kept to order 2, to rounding where
///   `f` is quadratic, and the effect `Projection` returns to them.
///
/// Largest energy error and energy drift over a million steps of 0.05 (`models/stability/src/structure.rs`):
///
/// | system | `H` | [`Dla2`] | [`Dla4`] |
/// |---|---|---|---|
/// | knife edge in a quadratic potential, steered by a pendulum | 0.5 | 3.8e-4, 1e-8 | 2.2e-8, 1e-12 |
/// | nonholonomic particle | 0.8 | 4.7e-4, 2e-7 | 1.5e-8, 1e-12 |
///
/// The energy error of the knife edge in a magnetic field, with the steering coupled to the position (`H = 0.4`), is
/// 3e-3 to 7e-3 and grows like `t^0.5`. With [`Dla4`] it is 2.7e-7 and grows like `t^0.3` to `t^0.5`. The motion is
/// chaotic, so these numbers depend on rounding. The error of the free rolling disk is rounding error, 3e-12 of `H`.
///
/// A step takes 5 to 15 iterations, each with one force and one constrained velocity. Use the method for long runs of
/// systems with constraints, where the shape of the motion matters more than the digits of one orbit.
///
/// # References
/// J. Cortes, S. Martinez, *Non-holonomic integrators*, Nonlinearity 14 (2001); R. McLachlan, M. Perlmutter,
/// *Integrators for nonholonomic mechanical systems*, J. Nonlinear Sci. 16 (2006); S. Ferraro, D. Iglesias, D. Martin
/// de Diego, *Momentum and energy preserving integrators for nonholonomic dynamics*, Nonlinearity 21 (2008).
pub type Dla2<S> = FixedStep<S, MidpointPrinciple>;

/// Five steps of [`Dla2`] composed to order 4 (Suzuki): dense output of order 4.
///
/// It has the properties of [`Dla2`], with energy errors of size `h^4`. One of the five steps goes back in time by
/// 0.66 `h`, so the method is unsuitable for strongly damped systems.
///
/// # References
/// M. Suzuki, *Fractal decomposition of exponential operators*, 1990; Hairer, Lubich, Wanner, *Geometric numerical
/// integration*, II.4, Example 4.3.
pub type Dla4<S> = FixedStep<S, ComposedPrinciple>;

/// The step of [`Dla2`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MidpointPrinciple;

/// The step of [`Dla4`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComposedPrinciple;

/// Suzuki's `1/(4 - 4^(1/3))`: four substeps of this fraction go forward, and one of `1 - 4 FORWARD` goes back.
const FORWARD: f64 = 0.414_490_771_794_375_74;
const BACK: f64 = 1.0 - 4.0 * FORWARD;

macro_rules! principle {
    ($method:ident, $name:literal, $order:literal, $refinements:literal, $parts:expr) => {
        impl Method for $method {
            const NAME: &'static str = $name;
            const ORDER: usize = $order;
            const DENSE_ORDER: usize = $order;
            const REFINEMENTS: u32 = $refinements;
            const IS_IMPLICIT: bool = true;
            const MEETS: bool = true;

            /// Rounding error of the positions: N numbers, stored in a state.
            type Memory<S: StateVector> = S;

            fn memory<S: StateVector>(like: &S) -> Self::Memory<S> {
                like.zeroed()
            }
        }

        impl<F: Lagrangian> Advance<F> for $method {
            fn advance(
                field: &mut Counted<'_, F>,
                h: f64,
                departure: &Departure<'_, F::State>,
                memory: &mut F::State,
            ) -> Result<Precise<F::State>, StepFailure> {
                compose(field, h, departure, memory, &$parts)
            }
        }
    };
}

principle!(MidpointPrinciple, "dla2", 2, 0, [1.0]);
principle!(
    ComposedPrinciple,
    "dla4",
    4,
    1,
    [FORWARD, FORWARD, BACK, FORWARD, FORWARD]
);

/// A point on the path, with the predictions for the next step.
struct Point<F: Lagrangian> {
    t: f64,
    /// NOTE: the sum is compensated, because unwrapped angles grow. If their increments were rounded alike in every
    /// step, the computed midpoint would always lie on the same side of the exact one, and the energy would drift.
    q: Precise<F::Vector>,
    p: F::Vector,
    qdot: F::Vector,
    /// Rate of `qdot`.
    bend: F::Vector,
    /// Reactions per unit of time.
    reactions: F::Reactions,
}

/// Makes the substeps of a step one after the other.
fn compose<F: Lagrangian>(
    field: &mut Counted<'_, F>,
    h: f64,
    departure: &Departure<'_, F::State>,
    memory: &mut F::State,
    parts: &[f64],
) -> Result<Precise<F::State>, StepFailure> {
    let mut point = depart(field.field, h, departure)?;
    let stored = memory.as_slice().iter();
    for (rest, stored) in point.q.rest.as_mut_slice().iter_mut().zip(stored) {
        *rest = *stored;
    }
    for part in parts {
        point = midpoint_step(field, part * h, &point)?;
    }
    let rests = point.q.rest.as_slice().iter();
    for (stored, rest) in memory.as_mut_slice().iter_mut().zip(rests) {
        *stored = *rest;
    }
    let end = field
        .field
        .state_unchecked(point.t, &point.q.value, &point.qdot)?;
    Ok(Precise::new(end))
}

/// The start of a step; `bend` comes from the velocity half a step ahead.
fn depart<F: Lagrangian>(
    system: &F,
    h: f64,
    departure: &Departure<'_, F::State>,
) -> Result<Point<F>, Fault> {
    let Departure { t, state, rate, .. } = *departure;
    let state = &state.value;
    let mut ahead = *state;
    for i in 0..ahead.count() {
        ahead.as_mut_slice()[i] += 0.5 * h * rate.as_slice()[i];
    }
    let qdot = system.velocity(t, state)?;
    let later = system.velocity(t + 0.5 * h, &ahead)?;
    Ok(Point {
        t,
        q: Precise::new(system.position(state)),
        p: system.momentum(t, state)?,
        qdot,
        bend: combined(&later, 2.0 / h, &qdot, -2.0 / h),
        reactions: system.zero_reactions(),
    })
}

/// One step of the midpoint principle.
#[inline(never)]
fn midpoint_step<F: Lagrangian>(
    field: &mut Counted<'_, F>,
    h: f64,
    from: &Point<F>,
) -> Result<Point<F>, StepFailure> {
    let (middle, t) = (from.t + 0.5 * h, from.t + h);
    let mut qdot = combined(&from.qdot, 1.0, &from.bend, 0.5 * h);
    let mut reactions = scaled(&from.reactions, h);
    let mut iteration = Iteration::new();
    // Change of the momenta over the step without the reaction at its end.
    let gain = loop {
        field.counters.rate_evaluations += 1;
        let qm = from.q.advanced(|i| 0.5 * h * qdot.padded()[i]).value;
        let force = field.field.force(middle, &qm, &qdot);
        let reaction = field
            .field
            .reaction_force(from.t, &from.q.value, &reactions);
        let half = combined(&reaction, 1.0, &force, 0.5 * h);
        let momenta = combined(&from.p, 1.0, &half, 1.0);
        let (next, missing) = field.field.constrained_velocity(middle, &qm, &momenta)?;
        reactions = combined(&reactions, 1.0, &missing, 1.0);
        let (change, size) = (distance(&next, &qdot), distance(&next, &next.zeroed()));
        qdot = next;
        match iteration.judge(change, size) {
            Verdict::GoOn => {}
            Verdict::Solved => break combined(&reaction, 1.0, &force, h),
            Verdict::Diverges => {
                let failure = match not_finite(qdot.as_slice()) {
                    Some(component) => StepFailure::NonFinite { component },
                    None => StepFailure::NotConverged { t: from.t },
                };
                return Err(failure);
            }
        }
    };
    let q = from.q.advanced(|i| h * qdot.padded()[i]);
    let free = combined(&from.p, 1.0, &gain, 1.0);
    let (arriving, last) = field.field.constrained_velocity(t, &q.value, &free)?;
    let reaction = field.field.reaction_force(t, &q.value, &last);
    Ok(Point {
        t,
        q,
        p: combined(&free, 1.0, &reaction, 1.0),
        qdot: arriving,
        bend: combined(&arriving, 2.0 / h, &qdot, -2.0 / h),
        reactions: scaled(&last, 1.0 / h),
    })
}

/// `alpha a + beta b`
#[inline(always)]
fn combined<V: StateVector>(a: &V, alpha: f64, b: &V, beta: f64) -> V {
    let mut sum = *a;
    for (sum, b) in sum.as_mut_slice().iter_mut().zip(b.as_slice()) {
        *sum = alpha * *sum + beta * b;
    }
    sum
}

/// Largest difference of components; NaN if any difference is.
fn distance<V: StateVector>(a: &V, b: &V) -> f64 {
    let pairs = a.as_slice().iter().zip(b.as_slice());
    pairs.fold(0.0, |largest, (a, b)| larger(largest, (a - b).abs()))
}
