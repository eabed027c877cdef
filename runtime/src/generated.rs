//! Functions that generated code calls in addition to the public traits. They are not part of the public interface.

use nalgebra::SVector;

use crate::contract::{Constrained, System};
use crate::describe::{Instance, Report};
use crate::error::{Fault, ParameterError, StateError};
use crate::numbers::Numbers;
use crate::state::StateVector;
use dalembert_numbers::description::Assumption;

/// Largest accepted residual of a constraint for a given state, relative to the sum of the absolute values of its
/// terms. Rounded decimal input passes, a wrong velocity does not.
const ADMITTED_RESIDUAL: f64 = 1e-9;

/// The components of a vector.
#[inline(always)]
pub fn components<const D: usize>(vector: &SVector<f64, D>) -> [f64; D] {
    vector.data.0[0]
}

/// The vector with these components.
#[inline(always)]
pub fn vector<const D: usize>(components: [f64; D]) -> SVector<f64, D> {
    SVector::from_array_storage(nalgebra::ArrayStorage([components]))
}

/// The first `D` numbers of an argument of a kernel.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn numbers<L, const D: usize>(numbers: &[L]) -> &[L; D] {
    match numbers.first_chunk() {
        Some(numbers) => numbers,
        None => too_few(D, numbers.len()),
    }
}

/// The first `D` entries of a kernel's output.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn places<L, const D: usize>(places: &mut [L]) -> &mut [L; D] {
    let count = places.len();
    match places.first_chunk_mut() {
        Some(places) => places,
        None => too_few(D, count),
    }
}

#[cold]
fn too_few(wanted: usize, found: usize) -> ! {
    panic!("a kernel of {wanted} numbers was given {found}")
}

/// `N` components of a state, from index `OFFSET` on.
#[inline(always)]
pub fn part<const OFFSET: usize, const D: usize, const N: usize>(
    state: &SVector<f64, D>,
) -> SVector<f64, N> {
    let mut values = [0.0; N];
    for (entry, value) in values.iter_mut().zip(state.as_slice().iter().skip(OFFSET)) {
        *entry = *value;
    }
    vector(values)
}

/// Concatenates positions and the second half of a state (velocities, momenta or quasi-velocities).
#[inline(always)]
pub fn join<const N: usize, const K: usize, const D: usize>(
    q: &SVector<f64, N>,
    p: &SVector<f64, K>,
) -> SVector<f64, D> {
    let mut values = [0.0; D];
    for (entry, value) in values.iter_mut().zip(q.iter().chain(p.iter())) {
        *entry = *value;
    }
    vector(values)
}

/// Checks `value > 0`. The error is [`Fault::MetricNotPositive`] with this pivot.
#[inline(always)]
pub fn positive_pivot(pivot: usize, value: f64) -> Result<(), Fault> {
    match value > 0.0 {
        true => Ok(()),
        false => Err(Fault::MetricNotPositive { pivot, value }),
    }
}

/// Ratio of squared norms below which a constraint form counts as dependent on the earlier ones: what is left of it
/// after projection on their orthogonal complement consists of rounding errors.
const LEAST_SQUARED_RATIO: f64 = 16.0 * f64::EPSILON * f64::EPSILON;

/// Checks `squared > LEAST_SQUARED_RATIO * reference`. The error is the fault of a dependent constraint.
#[inline(always)]
pub fn independent_constraint(
    constraint: usize,
    squared: f64,
    reference: f64,
) -> Result<(), Fault> {
    match squared > LEAST_SQUARED_RATIO * reference {
        true => Ok(()),
        false => Err(singular_constraint(constraint, squared, reference)),
    }
}

/// Smallest accepted ratio of a pivot of the constraint mass matrix to its diagonal entry. Below it more than six
/// digits are lost.
const LEAST_PIVOT_RATIO: f64 = 1e-6;

/// Checks `pivot > LEAST_PIVOT_RATIO * diagonal`. The error is the fault of a dependent constraint.
#[inline(always)]
pub fn regular_mass(constraint: usize, pivot: f64, diagonal: f64) -> Result<(), Fault> {
    match pivot > LEAST_PIVOT_RATIO * diagonal {
        true => Ok(()),
        false => Err(singular_constraint(constraint, pivot, diagonal)),
    }
}

/// Same check as [`independent_constraint`]. The error is the fault of a singular frame.
#[inline(always)]
pub fn independent_form(quasi: usize, squared: f64, reference: f64) -> Result<(), Fault> {
    match squared > LEAST_SQUARED_RATIO * reference {
        true => Ok(()),
        false => Err(Fault::SingularFrame { quasi }),
    }
}

#[cold]
fn singular_constraint(constraint: usize, squared: f64, reference: f64) -> Fault {
    let ratio = reference / squared;
    let condition = if ratio > 0.0 {
        crate::math::sqrt(ratio)
    } else {
        f64::INFINITY
    };
    Fault::SingularConstraint {
        constraint,
        condition,
    }
}

/// Checks `squared > 0`. The error is the fault of a surface whose gap rate no admissible impulse changes.
#[inline(always)]
pub fn regular_surface(surface: usize, squared: f64) -> Result<(), Fault> {
    match squared > 0.0 {
        true => Ok(()),
        false => Err(Fault::SingularSurface { surface }),
    }
}

/// Same check as [`independent_constraint`]. The error is the fault of a surface whose instantaneous constraints depend
/// on each other or on the constraints.
#[inline(always)]
pub fn independent_at(surface: usize, squared: f64, reference: f64) -> Result<(), Fault> {
    match squared > LEAST_SQUARED_RATIO * reference {
        true => Ok(()),
        false => Err(Fault::SingularSurface { surface }),
    }
}

/// Checks that a declared coefficient of restitution lies in \[0, 1\]. For a surface that adds energy, set the law at
/// run time.
///
/// # Errors
/// [`ParameterError`] with the surface's name where the coefficient is outside \[0, 1\].
pub fn check_coefficient(name: &'static str, value: f64) -> Result<(), ParameterError> {
    let expected = Assumption::Within {
        low: 0.0,
        high: 1.0,
    };
    match expected.holds(value) {
        true => Ok(()),
        false => Err(ParameterError {
            name,
            value,
            expected,
        }),
    }
}

/// Reports the derived quantities of a state, computed in the global form.
///
/// # Errors
/// The first [`Fault`] of the global form at this state; [`Fault::NotDerived`] without a global form.
pub fn inspect_globally<S: Instance>(
    system: &S,
    t: f64,
    state: &S::State,
    report: &mut dyn Report,
) -> Result<(), Fault> {
    let (q, qdot) = (system.position(state), system.velocity(t, state)?);
    let global = system.global().ok_or(Fault::NotDerived)?;
    let state = global.state_unchecked(t, &q, &qdot)?;
    global.inspect(t, &state, report)
}

/// Checks that positions and velocities satisfy the constraints.
///
/// # Errors
/// [`StateError::OffPosition`] for a position-level constraint, [`StateError::OffConstraint`] for a velocity-level one.
pub fn admit<S: Constrained>(
    system: &S,
    t: f64,
    q: &S::Vector,
    qdot: &S::Vector,
) -> Result<(), StateError> {
    check_positions(system, t, q)?;
    let (residuals, scales) = system.residuals(t, q, qdot);
    let pairs = residuals.as_slice().iter().zip(scales.as_slice());
    for (constraint, (&residual, &scale)) in pairs.enumerate() {
        let holds = residual.abs() <= ADMITTED_RESIDUAL * scale;
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

/// Checks that positions satisfy the position-level constraints.
///
/// # Errors
/// [`StateError::OffPosition`] with the first violated equation.
pub(crate) fn check_positions<S: Constrained>(
    system: &S,
    t: f64,
    q: &S::Vector,
) -> Result<(), StateError> {
    if !system.declared_levels().iter().any(|level| level.is_zero) {
        return Ok(());
    }
    let (values, scales) = (system.levels(t, q), system.level_scales(t, q));
    let sizes = values.as_slice().iter().zip(scales.as_slice());
    for (level, (&residual, &scale)) in system.declared_levels().iter().zip(sizes) {
        let holds = residual.abs() <= ADMITTED_RESIDUAL * scale;
        if level.is_zero && !holds {
            return Err(StateError::OffPosition {
                constraint: level.constraint,
                residual,
                scale,
            });
        }
    }
    Ok(())
}

/// Argument names of generated functions, declared as functions. Imported around generated code, they shadow constants
/// of the same names in the user's scope; local variables shadow them in turn.
#[rustfmt::skip]
#[allow(missing_docs)]
pub mod arguments {
    pub fn t() {}
    pub fn state() {}
    pub fn rate() {}
    pub fn q() {}
    pub fn placed() {}
    pub fn from() {}
    pub fn keep() {}
    pub fn qdot() {}
    pub fn p() {}
    pub fn excess() {}
    pub fn forms() {}
    pub fn affine() {}
    pub fn surface() {}
    pub fn values() {}
    pub fn report() {}
    pub fn size() {}
    pub fn direction() {}
    pub fn motion() {}
    pub fn inputs() {}
    pub fn unit() {}
    pub fn order() {}
    pub fn coefficients() {}
    pub fn jets() {}
    pub fn parameters() {}
    pub fn firsts() {}
    pub fn gaps() {}
    pub fn k() {}
    pub fn weight() {}
    pub fn inverse() {}
    pub fn step() {}
    pub fn visitor() {}
    pub fn reach() {}
    pub fn after_q() {}
    pub fn after_qdot() {}
    pub fn component() {}
}

/// The gaps of a declared system over any [`Numbers`].
pub trait OverNumbers {
    /// The gap of one surface. Arguments: see [`Impacting::gap_along`](crate::Impacting::gap_along).
    fn gap_over<L: Numbers>(&self, surface: usize, t: L, component: &dyn Fn(usize) -> L) -> L;
}

/// Three-valued conditions of surfaces over intervals: true, false, or undecided (`None`).
pub mod certain {
    use crate::numbers::Interval;

    /// True if the condition `margin > 0`, or `margin >= 0` if it is closed, holds on the whole interval, false if it
    /// holds nowhere; `None` if undecided.
    #[inline]
    pub fn holds(margin: Interval, is_closed: bool) -> Option<bool> {
        let (is_true, is_false) = match is_closed {
            true => (margin.lo >= 0.0, margin.hi < 0.0),
            false => (margin.lo > 0.0, margin.hi <= 0.0),
        };
        (is_true || is_false).then_some(is_true)
    }

    /// True if all conditions hold.
    #[inline]
    pub fn all(conditions: impl Iterator<Item = Option<bool>>) -> Option<bool> {
        let mut all = Some(true);
        for condition in conditions {
            match condition {
                Some(false) => return Some(false),
                Some(true) => {}
                None => all = None,
            }
        }
        all
    }

    /// True if no condition holds.
    #[inline]
    pub fn none(conditions: impl Iterator<Item = Option<bool>>) -> Option<bool> {
        all(conditions.map(|condition| condition.map(|holds| !holds)))
    }

    /// Decision for the last of several transitions, where `no_other` is true if none of the others counts: true if its
    /// own conditions hold, false if they fail and another transition counts. Otherwise undecided: if no transition is
    /// taken, the motion ends there and nothing is certified.
    #[inline]
    pub fn last(holds: Option<bool>, no_other: Option<bool>) -> Option<bool> {
        match (holds, no_other) {
            (Some(true), _) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        }
    }
}

/// The checks for every lane of a vector. Each returns the fault of the first lane that fails.
pub mod lanes {
    use crate::error::Fault;
    use crate::numbers::Numbers;

    /// Same check as [`positive_pivot`](super::positive_pivot), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn positive_pivot<L: Numbers>(pivot: usize, value: L) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| super::positive_pivot(pivot, value.lane(lane)))
    }

    /// Same check as [`independent_constraint`](super::independent_constraint), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn independent_constraint<L: Numbers>(
        constraint: usize,
        squared: L,
        reference: L,
    ) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| {
            super::independent_constraint(constraint, squared.lane(lane), reference.lane(lane))
        })
    }

    /// Same check as [`regular_mass`](super::regular_mass), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn regular_mass<L: Numbers>(constraint: usize, pivot: L, diagonal: L) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| {
            super::regular_mass(constraint, pivot.lane(lane), diagonal.lane(lane))
        })
    }

    /// Same check as [`independent_form`](super::independent_form), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn independent_form<L: Numbers>(
        quasi: usize,
        squared: L,
        reference: L,
    ) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| {
            super::independent_form(quasi, squared.lane(lane), reference.lane(lane))
        })
    }

    /// Same check as [`regular_surface`](super::regular_surface), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn regular_surface<L: Numbers>(surface: usize, squared: L) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| super::regular_surface(surface, squared.lane(lane)))
    }

    /// Same check as [`independent_at`](super::independent_at), in every lane.
    ///
    /// # Errors
    /// The [`Fault`] of the first lane that fails.
    #[inline(always)]
    pub fn independent_at<L: Numbers>(
        surface: usize,
        squared: L,
        reference: L,
    ) -> Result<(), Fault> {
        (0..L::LANES).try_for_each(|lane| {
            super::independent_at(surface, squared.lane(lane), reference.lane(lane))
        })
    }
}
