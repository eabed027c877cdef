//! A declared model with values for its parameters.

use core::fmt::Debug;

use super::{At, Kernels, Part, Tables};
use crate::contract::{RankDrop, System};
use crate::error::{Fault, StateError};
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// A form of a declared model or of a scene, as `model!` writes it. The traits of [`contract`](crate::contract) are
/// implemented for it.
pub trait Declared: Copy + Debug + PartialEq + Send + Sync {
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
    /// The values of the parameters, or a reference to them.
    type Values<'a>: AsRef<[f64]>
    where
        Self: 'a;
    /// Storage for the values of every kernel that gives several quantities at once.
    type Room<L: Numbers>: Row<L>;
    /// The kernels.
    type Kernels: Kernels;

    /// True if rates of some system of this type may have narrow features ([`Tables::can_be_narrow`]).
    const MAY_BE_NARROW: bool;

    /// True if constraint forms may become dependent, so that they are enclosed along motions.
    const MAY_LOSE_RANK: bool = false;

    /// True if some system of this type has modes.
    const HAS_MODES: bool = false;

    /// The kernels. A model with modes has no kernels; its modes have them.
    fn kernels(&self) -> Self::Kernels;

    /// The kernels with this index in the list of the modes and their global forms
    /// ([`Mode::kernels`](super::Mode::kernels)).
    #[inline(always)]
    fn kernels_at(&self, place: usize) -> Self::Kernels {
        let _ = place;
        self.kernels()
    }

    /// The mode in which states are made; 0 without modes.
    #[inline(always)]
    fn start(&self) -> usize {
        0
    }

    /// The same system with another mode in which states are made.
    #[inline(always)]
    fn starting_in(&self, mode: usize) -> Self {
        let _ = mode;
        *self
    }

    /// Facts about the form apart from its kernels: sizes, laws, conditions.
    fn tables(&self) -> &Tables;

    /// The values of the parameters.
    fn arguments(&self) -> Self::Values<'_>;

    /// Implementation of [`System::rank_drop`] for a form whose constraint forms may become dependent.
    fn rank_drop_along(
        &self,
        motion: impl Fn(f64) -> (f64, Self::State),
        reach: f64,
    ) -> Option<RankDrop> {
        let _ = (motion, reach);
        None
    }

    /// Implementation of [`System::admit`] with constraints.
    fn admits(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        let _ = (t, q, qdot);
        Ok(())
    }

    /// Implementation of [`System::complete_position`] with holonomic constraints.
    fn completed_position(
        &self,
        t: f64,
        q: &Self::Vector,
        placed: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let _ = (t, placed);
        Ok(*q)
    }

    /// Implementation of [`System::complete_velocity`] with constraints.
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

    /// Implementation of [`System::state_nearest`] with constraints that are nonlinear in the velocities.
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
/// The [`Fault`] of the kernel; see [`Kernels`](super::Kernels).
#[inline(always)]
pub fn write<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    places: [&[f64]; 2],
    values: &mut [f64],
) -> Result<(), Fault> {
    Part::start(system).write(kernel, t, places, values)
}

/// The only value of a kernel.
///
/// # Errors
/// The [`Fault`] of the kernel; see [`Kernels`](super::Kernels).
#[inline(always)]
pub fn number<S: Declared>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
    t: f64,
    places: [&[f64]; 2],
) -> Result<f64, Fault> {
    Part::start(system).number_by(kernel, t, places)
}
