//! Resolution of gaps: a gap counts as zero below `32 u` times the sum of the absolute values of its terms, with the
//! unit roundoff `u`.
//!
//! The runtime does not know the terms. It estimates their sum by `sum_i |dh/dx_i| |x_i|`, from difference quotients:
//! each component is changed by a small fraction of itself. At a zero of `h` the estimate agrees with the sum of the
//! terms up to a factor of their degree, but for terms that do not change: `sqrt(1 + x) - 1` near `x = 0`. The width of
//! an enclosure at the state covers these. Conditions of surfaces have a similar tolerance
//! ([`is_beyond_rounding`]), because rounding decides on their boundary.

use crate::contract::Impacting;
use crate::integrate::Tolerance;
use crate::numbers::TaylorModel;
use crate::state::StateVector;

/// Relative change of a component in a difference quotient. It is the square root of the roundoff, where one-sided
/// quotients are most accurate.
const PART: f64 = 1.0 / (1 << 26) as f64;

/// Rounding error of a gap, in units of the sum of its terms.
const UNITS: f64 = 16.0 * f64::EPSILON;

/// Rounding error of a surface's gap at a state whose components were computed from values of these sizes. Evaluates
/// the gaps once per component, once for time, and once more, and encloses the gap once.
pub(crate) fn resolution<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
    sizes: &Sys::State,
    evaluations: &mut u64,
) -> f64 {
    *evaluations += 1;
    let here = system.gap(surface, t, state);
    let later = system.gap(surface, t + PART * t, state);
    let sum = sum_of_terms(system, surface, (t, state), here, sizes, evaluations);
    UNITS * (sum + (later - here).abs() / PART) + evaluation_error(system, surface, t, state)
}

/// The least rounding at the ends and in the middle of a stretch of a step. What is hidden by less may be passed over.
pub(crate) fn least_on([left, right]: [f64; 2], rounding: impl FnMut(f64) -> f64) -> f64 {
    let places = [left, 0.5 * (left + right), right];
    places
        .map(rounding)
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// Width of the enclosure of a surface's gap at a state, which covers the rounding errors of its evaluation; 0 if it is
/// not bounded.
fn evaluation_error<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
) -> f64 {
    let exact = |value: f64| TaylorModel::exact([value, 0.0, 0.0, 0.0]);
    let component = |i: usize| exact(state.as_slice()[i]);
    let range = system.gap_along(surface, exact(t), &component).range();
    let width = range.hi - range.lo;
    if width.is_finite() { width } else { 0.0 }
}

/// `sum_i |dh/dx_i| sizes_i`; `here` is the gap.
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
        sum += (system.gap(surface, t, &moved) - here).abs();
    }
    *evaluations += 1 + system.state_len() as u64;
    sum / PART
}

/// Rounding error of a surface's gap rate for these velocities: a multiple of the sum of the absolute values of its terms. The
/// rate of the surface itself is no larger where both cancel.
pub(crate) fn rate_resolution<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    (t, state): (f64, &Sys::State),
    velocities: &[f64],
    evaluations: &mut u64,
) -> f64 {
    let mut changes = state.zeroed();
    changes.as_mut_slice()[..velocities.len()].copy_from_slice(velocities);
    let here = system.gap(surface, t, state);
    UNITS * sum_of_terms(system, surface, (t, state), here, &changes, evaluations)
}

/// Change of a surface's gap if every component of the state has an error of the size of the tolerance. `sizes` are the
/// absolute values of the components, `scale` their units for the absolute part of the tolerance. Evaluates the gaps
/// once per component and once more.
pub(crate) fn error_within<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    (t, state): (f64, &Sys::State),
    (sizes, scale, tolerance): (&Sys::State, &Sys::State, Tolerance),
    evaluations: &mut u64,
) -> f64 {
    let share = tolerance.absolute() / tolerance.relative();
    let mut units = *sizes;
    for (unit, scale) in units.as_mut_slice().iter_mut().zip(scale.as_slice()) {
        *unit = unit.abs() + share * scale;
    }
    let here = system.gap(surface, t, state);
    tolerance.relative() * sum_of_terms(system, surface, (t, state), here, &units, evaluations)
}

/// True if a surface `counts` at this state, or does not, as asked, and still so after any one component, or time, is
/// changed in either direction by a bound of the total rounding error. `sizes` are the sizes of the components.
pub(crate) fn is_beyond_rounding<Sys: Impacting>(
    system: &Sys,
    (surface, counts): (usize, bool),
    t: f64,
    state: &Sys::State,
    sizes: &Sys::State,
) -> bool {
    let part = 2.0 * UNITS * (1.0 + system.state_len() as f64);
    let later = [0.0, part * t, -part * t];
    let is_so = |t: f64, state: &Sys::State| system.surface_active(surface, t, state) == counts;
    later.into_iter().all(|later| is_so(t + later, state))
        && (0..system.state_len()).all(|i| {
            [part, -part].into_iter().all(|part| {
                let mut moved = *state;
                moved.as_mut_slice()[i] += part * sizes.as_slice()[i].abs();
                is_so(t, &moved)
            })
        })
}
