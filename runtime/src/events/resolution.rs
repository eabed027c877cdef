//! How small a gap can be told from zero: `32 u` times the sum of the absolute values of its terms.
//!
//! The terms are not known here, but how far the gap moves when a component moves by a small part of itself is:
//! `sum_i |dh/dx_i| |x_i|`, at a zero of `h` the same up to the degree of the terms. Conditions of surfaces are granted the
//! same: on their boundary rounding decides.

use crate::contract::Impacting;
use crate::integrate::Tolerance;
use crate::state::StateVector;

/// The part by which a component is moved: half the digits, where difference quotients are best.
const PART: f64 = 1.0 / (1 << 26) as f64;

/// Rounding errors in units of the sum of terms.
const UNITS: f64 = 16.0 * f64::EPSILON;

/// The size of the rounding errors of a surface's gap at a state whose components have come from values of these
/// sizes. Takes one evaluation of the gaps per component and one for time, and one more.
pub(crate) fn resolution<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
    sizes: &Sys::State,
    evaluations: &mut u64,
) -> f64 {
    *evaluations += 1;
    let here = system.gaps(t, state).as_slice()[surface];
    let later = system.gaps(t + PART * t, state).as_slice()[surface];
    let sum = sum_of_terms(system, surface, (t, state), here, sizes, evaluations);
    UNITS * (sum + (later - here).abs() / PART)
}

/// `sum_i |dh/dx_i| sizes_i`, with `here` the gap.
fn sum_of_terms<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    (t, state): (f64, &Sys::State),
    here: f64,
    sizes: &Sys::State,
    evaluations: &mut u64,
) -> f64 {
    let mut sum = 0.0;
    for i in 0..system.state_len() {
        let mut moved = *state;
        moved.as_mut_slice()[i] += PART * sizes.as_slice()[i].abs();
        sum += (system.gaps(t, &moved).as_slice()[surface] - here).abs();
    }
    *evaluations += 1 + system.state_len() as u64;
    sum / PART
}

/// How far a surface's gap moves when every component of the state errs by the tolerance: `unit` holds the sizes of the
/// components, their scale, and the tolerance. Costs what [`resolution`] costs.
pub(crate) fn error_within<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    (t, state): (f64, &Sys::State),
    (sizes, scale, tolerance): (&Sys::State, &Sys::State, Tolerance),
    evaluations: &mut u64,
) -> f64 {
    let share = tolerance.absolute() / tolerance.relative();
    let mut units = *sizes;
    for (own, scale) in units.as_mut_slice().iter_mut().zip(scale.as_slice()) {
        *own = own.abs() + share * scale;
    }
    let here = system.gaps(t, state).as_slice()[surface];
    tolerance.relative() * sum_of_terms(system, surface, (t, state), here, &units, evaluations)
}

/// Whether a surface counts, and would if rounding had moved the state: a component of one of these sizes, or time,
/// either way by as much as all of them together may be off.
pub(crate) fn counts_beyond_rounding<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
    sizes: &Sys::State,
) -> bool {
    let part = 2.0 * UNITS * (1.0 + system.state_len() as f64);
    let later = [0.0, part * t, -part * t];
    let counts_throughout = later
        .into_iter()
        .all(|later| system.surface_active(surface, t + later, state));
    counts_throughout
        && (0..system.state_len()).all(|i| {
            [part, -part].into_iter().all(|part| {
                let mut moved = *state;
                moved.as_mut_slice()[i] += part * sizes.as_slice()[i].abs();
                system.surface_active(surface, t, &moved)
            })
        })
}
