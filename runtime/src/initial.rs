//! Completing initial velocities: what the constraints leave open is chosen as small as possible.

use crate::contract::Constrained;
use crate::error::StateError;
use crate::linalg::qr::least_norm;
use crate::state::StateVector;

/// Room for the constraint forms: constraints times coordinates.
const ENTRIES: usize = 64 * 64;

/// Largest part of the sum of a residual's absolute terms that the result may leave, as for
/// [`System::state`](crate::System::state).
const ACCEPTED: f64 = 1e-9;

/// Newton's steps where constraints are not linear in the velocities.
const STEPS: u32 = 48;

/// The velocities with the components of `qdot` where `named` is not 0, and elsewhere those of least norm that
/// satisfy every constraint `eta(qdot) + eta_0 = 0`. Where constraints are not linear in the velocities, they are those to which
/// Newton's steps lead from 1: of several solutions one that is positive where it can be.
///
/// # Errors
/// [`StateError::OffConstraint`] if the components that are free cannot satisfy a constraint;
/// [`StateError::NotFinite`] for a named component that is not finite; [`StateError::TooLarge`] beyond 64
/// coordinates.
pub fn complete_velocities<Sys: Constrained>(
    system: &Sys,
    t: f64,
    q: &Sys::Vector,
    qdot: &Sys::Vector,
    named: &Sys::Vector,
) -> Result<Sys::Vector, StateError> {
    let (n, m) = (Sys::Vector::LEN, Sys::Multipliers::LEN);
    if n * m > ENTRIES || m > n {
        return Err(StateError::TooLarge { limit: 64 });
    }
    let mut velocities = *qdot;
    for i in 0..n {
        if named.as_slice()[i] == 0.0 {
            velocities.as_mut_slice()[i] = if Sys::IS_LINEAR { 0.0 } else { 1.0 };
        } else if !velocities.as_slice()[i].is_finite() {
            return Err(StateError::NotFinite { component: n + i });
        }
    }
    let mut buffer = [0.0; ENTRIES];
    let forms = &mut buffer[..n * m];
    let mut affine = Sys::Multipliers::zeros();
    for _ in 0..if Sys::IS_LINEAR { 1 } else { STEPS } {
        system.linearised_forms(t, q, &velocities, forms, &mut affine);
        let mut wanted = Sys::Multipliers::zeros();
        for (a, row) in forms.chunks_exact_mut(n.max(1)).enumerate() {
            wanted.as_mut_slice()[a] = -residual(row, affine.as_slice()[a], &velocities).0;
            for (entry, named) in row.iter_mut().zip(named.as_slice()) {
                if *named != 0.0 {
                    *entry = 0.0;
                }
            }
        }
        let mut chosen = Sys::Vector::zeros();
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
    let rows = forms.chunks_exact(Sys::Vector::LEN.max(1));
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
