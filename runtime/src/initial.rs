//! Completion of initial states. Positions come first: they are completed to satisfy the holonomic constraints. Then
//! the velocities are completed to satisfy all constraints.

use crate::contract::Constrained;
use crate::error::StateError;
use crate::generated::check_positions;
use crate::linalg::qr::least_norm;
use crate::state::StateVector;

/// Size of the buffer for the constraint forms: constraints times coordinates.
const ENTRIES: usize = 64 * 64;

/// Accepted residual, relative to the sum of the absolute values of its terms, as in
/// [`System::state`](crate::System::state).
const ACCEPTED: f64 = 1e-9;

/// Size of a coefficient of a constraint, relative to the largest one, that may be the rounding of 0, as `cos(pi/2)` is. No
/// velocity is divided by it.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// Maximum number of Newton steps, for positions and for constraints that are nonlinear in the velocities.
const STEPS: u32 = 48;

/// Values at which all free positions start, tried in this order if Newton's iteration from the given positions fails.
/// At 0, the usual start value, a square has zero slope.
const BEGINNINGS: [f64; 6] = [1.0, -1.0, 0.25, -0.25, 4.0, -4.0];

/// Completes positions. Positions of `q` where `placed` is not 0 are kept. The others are found by Newton's iteration
/// with steps of least Euclidean norm. It starts at `q`. If it fails, or ends outside of the chart, all free positions
/// start at 1, then at -1, 1/4, -1/4, 4 and -4, so that positive solutions are found first. If `q` satisfies the
/// constraints already, it is returned unchanged; if all its positions are placed, it is only checked.
///
/// # Errors
/// [`StateError::OffPosition`] for `q` as given if no solution was found; [`StateError::NotFinite`] for a position that
/// is not finite; [`StateError::TooLarge`] if the numbers of coordinates and of constraints have a product above
/// `64^2`.
pub fn complete_positions<Sys: Constrained>(
    system: &Sys,
    t: f64,
    q: &Sys::Vector,
    placed: &Sys::Vector,
) -> Result<Sys::Vector, StateError> {
    if let Some(component) = q.as_slice().iter().position(|value| !value.is_finite()) {
        return Err(StateError::NotFinite { component });
    }
    let refused = match check_positions(system, t, q) {
        Ok(()) => return Ok(*q),
        Err(error) => error,
    };
    if system.coordinate_count() * system.constraint_count() > ENTRIES {
        return Err(StateError::TooLarge { limit: 64 });
    }
    let is_free = |i: usize| placed.as_slice()[i] == 0.0;
    if !(0..system.coordinate_count()).any(is_free) {
        return Err(refused);
    }
    if let Some(found) = solved_from(system, t, *q, &is_free) {
        return Ok(found);
    }
    let found = BEGINNINGS.iter().find_map(|&value| {
        let mut start = *q;
        for (i, entry) in start.as_mut_slice().iter_mut().enumerate() {
            if is_free(i) {
                *entry = value;
            }
        }
        solved_from(system, t, start, &is_free)
    });
    found.ok_or(refused)
}

/// Result of Newton's iteration from `q`, if it satisfies the holonomic constraints and lies in the chart.
fn solved_from<Sys: Constrained>(
    system: &Sys,
    t: f64,
    mut q: Sys::Vector,
    is_free: &dyn Fn(usize) -> bool,
) -> Option<Sys::Vector> {
    let n = system.coordinate_count();
    let mut buffer = [0.0; ENTRIES];
    for _ in 0..STEPS {
        let values = system.levels(t, &q);
        let forms = &mut buffer[..n * system.constraint_count()];
        system.constraint_forms(t, &q, forms, &mut system.zero_multipliers());
        let (mut rows, mut wanted) = (0, system.zero_levels());
        for (level, value) in system.declared_levels().iter().zip(values.as_slice()) {
            if !level.is_zero {
                continue;
            }
            // Rows move to the front: the source index is never below the target index.
            for i in 0..n {
                let entry = forms[level.constraint * n + i];
                forms[rows * n + i] = if is_free(i) { entry } else { 0.0 };
            }
            wanted.as_mut_slice()[rows] = -value;
            rows += 1;
        }
        let mut change = system.zero_vector();
        let wanted = &wanted.as_slice()[..rows];
        least_norm(&mut forms[..rows * n], n, wanted, change.as_mut_slice());
        let before = q;
        for (entry, change) in q.as_mut_slice().iter_mut().zip(change.as_slice()) {
            *entry += change;
        }
        if q == before {
            break;
        }
    }
    let state = system.state_unchecked(t, &q, &system.zero_vector()).ok()?;
    let is_inside = system.outside_chart(&state).is_none();
    (is_inside && check_positions(system, t, &q).is_ok()).then_some(q)
}

/// Completes velocities. Velocities of `qdot` where `named` is not 0 are kept. The others are those of least Euclidean
/// norm, in coordinates, that satisfy every constraint `eta(qdot) + eta_0 = 0`. For constraints that are nonlinear in
/// the velocities, Newton's iteration starts with all free velocities at 1, so that it tends to find positive
/// solutions.
///
/// # Errors
/// [`StateError::OffConstraint`] if the free components cannot satisfy a constraint; [`StateError::NotFinite`] for a
/// named component that is not finite; [`StateError::TooLarge`] if there are more constraints than coordinates, or if
/// their numbers have a product above `64^2`.
pub fn complete_velocities<Sys: Constrained>(
    system: &Sys,
    t: f64,
    q: &Sys::Vector,
    qdot: &Sys::Vector,
    named: &Sys::Vector,
) -> Result<Sys::Vector, StateError> {
    let (n, m) = (system.coordinate_count(), system.constraint_count());
    if n * m > ENTRIES || m > n {
        return Err(StateError::TooLarge { limit: 64 });
    }
    let mut velocities = *qdot;
    for i in 0..n {
        if named.as_slice()[i] == 0.0 {
            velocities.as_mut_slice()[i] = if system.is_linear() { 0.0 } else { 1.0 };
        } else if !velocities.as_slice()[i].is_finite() {
            return Err(StateError::NotFinite { component: n + i });
        }
    }
    let mut buffer = [0.0; ENTRIES];
    let forms = &mut buffer[..n * m];
    let mut affine = system.zero_multipliers();
    for _ in 0..if system.is_linear() { 1 } else { STEPS } {
        system.linearised_forms(t, q, &velocities, forms, &mut affine);
        let mut wanted = system.zero_multipliers();
        for (a, row) in forms.chunks_exact_mut(n.max(1)).enumerate() {
            wanted.as_mut_slice()[a] = -residual(row, affine.as_slice()[a], &velocities).0;
            let largest = row
                .iter()
                .fold(0.0_f64, |most, entry| most.max(entry.abs()));
            for (entry, named) in row.iter_mut().zip(named.as_slice()) {
                if *named != 0.0 || entry.abs() <= ROUNDED * largest {
                    *entry = 0.0;
                }
            }
        }
        let mut chosen = system.zero_vector();
        least_norm(forms, n, wanted.as_slice(), chosen.as_mut_slice());
        let before = velocities;
        for i in 0..n {
            velocities.as_mut_slice()[i] += chosen.as_slice()[i];
        }
        if velocities == before {
            break;
        }
    }
    system.linearised_forms(t, q, &velocities, forms, &mut affine);
    check::<Sys>(forms, &affine, &velocities)?;
    Ok(velocities)
}

/// `eta(qdot) + eta_0` for one form, and the sum of the absolute values of its terms.
fn residual<V: StateVector>(form: &[f64], affine: f64, velocities: &V) -> (f64, f64) {
    let (mut sum, mut scale) = (affine, affine.abs());
    for (entry, velocity) in form.iter().zip(velocities.as_slice()) {
        sum += entry * velocity;
        scale += (entry * velocity).abs();
    }
    (sum, scale)
}

fn check<Sys: Constrained>(
    forms: &[f64],
    affine: &Sys::Multipliers,
    velocities: &Sys::Vector,
) -> Result<(), StateError> {
    let rows = forms.chunks_exact(velocities.count().max(1));
    for (constraint, (form, affine)) in rows.zip(affine.as_slice()).enumerate() {
        let (residual, scale) = residual(form, *affine, velocities);
        let holds = residual.abs() <= ACCEPTED * scale;
        if !holds {
            return Err(StateError::OffConstraint {
                constraint,
                residual,
                scale,
            });
        }
    }
    Ok(())
}
