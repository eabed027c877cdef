//! How small a gap can be told from zero: `32 u` times the sum of the absolute values of its terms.
//!
//! The terms are not known here, but how far the gap moves when a component moves by a small part of itself is:
//! `sum_i |dh/dx_i| |x_i|`, at a zero of `h` the same up to the degree of the terms. Conditions of surfaces are granted the
//! same: on their boundary rounding decides.

use crate::contract::Impacting;
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
    let mut gap = |t: f64, state: &Sys::State| {
        *evaluations += 1;
        system.gaps(t, state).as_slice()[surface]
    };
    let here = gap(t, state);
    let mut sum = (gap(t + PART * t, state) - here).abs();
    for i in 0..Sys::State::LEN {
        let mut moved = *state;
        moved.as_mut_slice()[i] += PART * sizes.as_slice()[i].abs();
        sum += (gap(t, &moved) - here).abs();
    }
    UNITS * sum / PART
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
    let part = 2.0 * UNITS * (1.0 + Sys::State::LEN as f64);
    let later = [0.0, part * t, -part * t];
    let counts_throughout = later
        .into_iter()
        .all(|later| system.surface_active(surface, t + later, state));
    counts_throughout
        && (0..Sys::State::LEN).all(|i| {
            [part, -part].into_iter().all(|part| {
                let mut moved = *state;
                moved.as_mut_slice()[i] += part * sizes.as_slice()[i].abs();
                system.surface_active(surface, t, &moved)
            })
        })
}
