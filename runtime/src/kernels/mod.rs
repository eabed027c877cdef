//! What a generator gives of a model: kernels over any numbers, and tables. Everything else is made of them, once.
//!
//! | file | job |
//! |---|---|
//! | `tables.rs` | what is known of a form besides its kernels: sizes, laws, conditions, charts |
//! | `declared.rs` | a model with values for its parameters: kernels, tables and the types of its vectors |
//! | `system.rs`, `constrained.rs`, `impacting.rs`, .. | the traits of `contract`, of every declared model |
//! | `described.rs` | names, declared values and inspection |

mod constrained;
mod declared;
mod described;
mod impacting;
mod system;
mod tables;
mod variational;

use crate::contract::{Tangent, TaylorField};
use crate::error::Fault;
use crate::numbers::{Numbers, Row};
pub use dalembert_numbers::kernel::{First, Kernel, Second, Shape};
pub use declared::{Declared, number, pair, write};
pub use described::{Documented, Quantity};
pub use system::nearest_of_declared;
pub use tables::{Beside, Chart, Condition, Dimensions, Form, Surface, Tables};
pub use variational::{energy_over, enter, enter_over, nearest_over};

/// What a kernel reads.
#[derive(Debug, Clone, Copy)]
pub struct At<'a, L> {
    /// The parameters, in the order of declaration.
    pub parameters: &'a [L],
    /// The time.
    pub t: L,
    /// Positions or a state ([`Kernel::first`]).
    pub first: &'a [L],
    /// Velocities, momenta and the like ([`Kernel::second`]).
    pub second: &'a [L],
}

/// A declared form with constraints.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no constraints: declare `constraints {{ .. }}` in its `model!`"
)]
pub trait HasConstraints: Declared {}

/// A declared form with surfaces.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no impact surfaces: declare `impacts {{ .. }}` in its `model!`"
)]
pub trait HasSurfaces: Declared {}

/// A declared form whose divergence was derived.
#[diagnostic::on_unimplemented(message = "the divergence of `{Self}` was not derived")]
pub trait HasDivergence: Declared {}

/// A declared form whose runs can be varied: the types of what that takes.
pub trait HasVariations: Declared + TaylorField<State = <Self as Declared>::State> {
    /// One number per surface.
    type Clearances<L: Numbers>: Row<L>;
    /// See [`Variational::Collision`](crate::contract::Variational::Collision).
    type Collision<L: Numbers>: Row<L>;
    /// See [`Variational::Deviations`](crate::contract::Variational::Deviations).
    type Deviations<L: Numbers>: Row<L>;
    /// A square matrix by its columns.
    type Columns: Copy + AsRef<[<Self as Declared>::State]> + AsMut<[<Self as Declared>::State]>;
    /// As many directions as a state has components.
    type Tangents: Copy + AsRef<[Tangent<Self>]> + AsMut<[Tangent<Self>]>;

    /// A matrix of zeros.
    fn columns() -> Self::Columns;

    /// No directions.
    fn tangents() -> Self::Tangents;
}

/// A function per kernel, in a trait, and kernels that have none of them.
macro_rules! kernels {
    (
        $(#[$doc:meta])*
        plain { $($plain:ident: $name:ident,)* }
        of_surface { $($of_surface:ident: $surface_name:ident,)* }
    ) => {
        $(#[$doc])*
        pub trait Kernels {
            /// The kernels that this form shares with another.
            type Base: Kernels;

            /// The kernels that this form shares with another.
            const BASE: Self::Base;

            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                ///
                /// # Errors
                /// The guard that does not hold; [`Fault::NotDerived`].
                #[inline(always)]
                fn $plain<L: Numbers>(
                    &self,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    Self::BASE.$plain(at, values)
                }
            )*
            $(
                #[doc = concat!("[`Kernel::", stringify!($surface_name), "`] of a surface.")]
                ///
                /// # Errors
                /// The guard that does not hold; [`Fault::NotDerived`].
                #[inline(always)]
                fn $of_surface<L: Numbers>(
                    &self,
                    surface: usize,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    Self::BASE.$of_surface(surface, at, values)
                }
            )*
        }

        impl Kernels for NoKernels {
            type Base = Self;

            const BASE: Self = Self;

            $(
                #[inline(always)]
                fn $plain<L: Numbers>(
                    &self,
                    _: At<'_, L>,
                    _: &mut [L],
                ) -> Result<(), Fault> {
                    Err(Fault::NotDerived)
                }
            )*
            $(
                #[inline(always)]
                fn $of_surface<L: Numbers>(
                    &self,
                    _: usize,
                    _: At<'_, L>,
                    _: &mut [L],
                ) -> Result<(), Fault> {
                    Err(Fault::NotDerived)
                }
            )*
        }
    };
}

/// What a form that shares nothing with another begins with: every kernel is [`Fault::NotDerived`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoKernels;

kernels! {
    /// The kernels of one form of a model: each writes its values, of which `values` has exactly as many places. A slice shorter than
    /// what a kernel reads or writes is a mistake of the caller, and panics. What is not given is that of [`Kernels::BASE`].
    plain {
        rate: Rate,
        scale: Scale,
        velocity: Velocity,
        momentum: Momentum,
        motion: Motion,
        nearest: Nearest,
        nearest_momenta: NearestMomenta,
        energy: Energy,
        force: Force,
        multipliers: Multipliers,
        residuals: Residuals,
        forms: Forms,
        restore: Restore,
        levels: Levels,
        level_scales: LevelScales,
        level_correction: LevelCorrection,
        reaction_force: ReactionForce,
        constrained_velocity: ConstrainedVelocity,
        gaps: Gaps,
        gap_rates: GapRates,
        gap_accelerations: GapAccelerations,
        gap_responses: GapResponses,
        divergence: Divergence,
        density_form: DensityForm,
        log_density: LogDensity,
        log_volume: LogVolume,
        density_gradient: DensityGradient,
        powers: Powers,
        outputs: Outputs,
        view_path: ViewPath,
        view_region: ViewRegion,
        initial: Initial,
        until: Until,
        geometry: Geometry,
    }
    of_surface {
        gap: Gap,
        conditions: Conditions,
        coefficient: Coefficient,
        blow: Blow,
        contact: Contact,
        reset: Reset,
        entry: Entry,
        focus: Focus,
        trace: Trace,
    }
}
