//! A declared model with values for its parameters.

use core::fmt::Debug;

use super::{At, Kernels, Tables};
use crate::contract::{RankDrop, System};
use crate::error::{Fault, StateError};
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// A form of a declared model, or of a scene: what `model!` writes. The traits of [`contract`](crate::contract) are made of it.
pub trait Declared: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// A state.
    type State: StateVector;
    /// One number per coordinate.
    type Vector: StateVector;
    /// One number per momentum or quasi-velocity in a state.
    type Impulse: StateVector;
    /// One number per surface.
    type Gaps: StateVector;
    /// One number per constraint.
    type Multipliers: StateVector;
    /// One number per integrable constraint whose function is known.
    type Levels: StateVector;
    /// One number per coordinate.
    type Positions<L: Numbers>: Row<L>;
    /// One number per component of a state.
    type Components<L: Numbers>: Row<L>;
    /// One number per parameter.
    type Arguments<L: Numbers>: Row<L>;
    /// The values of the parameters, or where they stand.
    type Values<'a>: AsRef<[f64]>;
    /// Room for the values of every kernel that gives several things at once.
    type Room<L: Numbers>: Row<L>;
    /// The kernels.
    type Kernels: Kernels;

    /// Whether rates may have narrow features ([`Tables::can_be_narrow`]), of some system of this type.
    const MAY_BE_NARROW: bool;

    /// The kernels.
    fn kernels(&self) -> Self::Kernels;

    /// What is known besides.
    fn tables(&self) -> &'static Tables;

    /// The values of the parameters.
    fn arguments(&self) -> Self::Values<'_>;

    /// As [`System::rank_drop`], of a form whose constraint forms may become dependent.
    fn rank_drop_along(
        &self,
        motion: impl Fn(f64) -> (f64, Self::State),
        reach: f64,
    ) -> Option<RankDrop> {
        let _ = (motion, reach);
        None
    }

    /// As [`System::admit`], with constraints.
    fn admits(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        let _ = (t, q, qdot);
        Ok(())
    }

    /// As [`System::complete_position`], with equations of positions.
    fn completed_position(
        &self,
        t: f64,
        q: &Self::Vector,
        placed: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, placed);
        Ok(*q)
    }

    /// As [`System::complete_velocity`], with constraints.
    fn completed_velocity(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
        named: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, q, named);
        Ok(*qdot)
    }

    /// As [`System::state_nearest`], with constraints that are not linear in the velocities.
    fn nearest_by_steps(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.state_unchecked(t, q, qdot)
    }
}

/// Writes the values of a kernel.
///
/// # Errors
/// As [`Kernels`](super::Kernels).
#[inline(always)]
pub fn write<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    [first, second]: [&[f64]; 2],
    values: &mut [f64],
) -> Result<(), Fault> {
    let arguments = system.arguments();
    let at = At {
        parameters: arguments.as_ref(),
        t,
        first,
        second,
    };
    kernel(&system.kernels(), at, values)
}

/// The values of a kernel as a vector of this length.
#[inline(always)]
pub(super) fn vector<S: Declared, V: StateVector>(
    system: &S,
    (kernel, count): (
        impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        usize,
    ),
    t: f64,
    places: [&[f64]; 2],
) -> Result<V, Fault> {
    let mut values = V::zeros(count);
    write(system, kernel, t, places, values.as_mut_slice())?;
    Ok(values)
}

/// The only value of a kernel.
///
/// # Errors
/// As [`Kernels`](super::Kernels).
#[inline(always)]
pub fn number<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    places: [&[f64]; 2],
) -> Result<f64, Fault> {
    let mut value = [0.0];
    write(system, kernel, t, places, &mut value)?;
    Ok(value[0])
}

/// The values of a kernel that gives several things at once.
#[inline(always)]
pub(super) fn several<S: Declared>(
    system: &S,
    (kernel, count): (
        impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        usize,
    ),
    t: f64,
    places: [&[f64]; 2],
) -> Result<S::Room<f64>, Fault> {
    let mut room = S::Room::<f64>::zeros(count);
    write(system, kernel, t, places, &mut room.as_mut_slice()[..count])?;
    Ok(room)
}

/// Two vectors that a kernel gives: positions and velocities.
///
/// # Errors
/// As [`Kernels`](super::Kernels).
pub fn pair<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    places: [&[f64]; 2],
) -> Result<[S::Vector; 2], Fault> {
    let n = system.coordinate_count();
    let both = several(system, (kernel, 2 * n), t, places)?;
    let (first, second) = both.as_slice()[..2 * n].split_at(n);
    Ok([S::Vector::of(first), S::Vector::of(second)])
}
