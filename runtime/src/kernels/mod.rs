//! Interface between generator and runtime: kernels over any kind of number, and tables. Everything else is
//! implemented on top of them, once for all models.
//!
//! | file | job |
//! |---|---|
//! | `declared.rs` | a model with values for its parameters: kernels, tables and the types of its vectors |
//! | `part.rs` | the part that is evaluated: the model, or the mode of a state |
//! | `passage.rs` | the state at the entry of a mode |
//! | `choice.rs` | the kernels of several modes |
//! | `pointers.rs` | kernels behind pointers, for a form that is known only at run time |
//! | `system.rs`, `constrained.rs`, `impacting.rs`, .. | the traits of `contract`, for every declared model |
//! | `described.rs` | names, declared values and inspection |

mod choice;
mod constrained;
mod declared;
mod described;
mod impacting;
mod independence;
mod part;
mod passage;
mod pointers;
mod system;
mod variational;

use crate::contract::{Tangent, TaylorField};
use crate::error::Fault;
use crate::numbers::{Numbers, Row};
pub use choice::{Choice, Chosen};
use dalembert_numbers::Held;
pub use dalembert_numbers::description::{Documentation, Quantity};
pub use dalembert_numbers::kernel::{First, Kernel, Second, Shape};
pub use dalembert_numbers::tables::{
    Beside, Chart, Condition, Dimensions, Form, Level, Mode, Passage, Surface, Tables, Transition,
};
pub use declared::{Declared, number, write};
pub use described::Documented;
pub use part::Part;
pub use pointers::{Pointers, Tabled};
pub use system::{log_density, nearest_of_declared};

/// Arguments of a kernel.
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

/// A declared form whose runs can be varied, with the types that variations need.
pub trait HasVariations: Declared + TaylorField<State = <Self as Declared>::State> {
    /// One number per surface.
    type Clearances<L: Numbers>: Row<L>;
    /// See [`Variational::Collision`](crate::contract::Variational::Collision).
    type Collision<L: Numbers>: Row<L>;
    /// See [`Variational::Deviations`](crate::contract::Variational::Deviations).
    type Deviations<L: Numbers>: Row<L>;
    /// A square matrix by its columns.
    type Columns: Copy + AsRef<[<Self as Declared>::State]> + AsMut<[<Self as Declared>::State]>;
    /// Array with one direction per component of a state.
    type Tangents: Copy + AsRef<[Tangent<Self>]> + AsMut<[Tangent<Self>]>;

    /// A matrix of zeros.
    fn columns() -> Self::Columns;

    /// Array without directions.
    fn tangents() -> Self::Tangents;
}

/// Generates the trait with one function per kernel, and the type without any kernel.
macro_rules! kernels {
    (
        $(#[$doc:meta])*
        plain { $($plain:ident: $name:ident,)* }
        of_surface { $($of_surface:ident: $surface_name:ident,)* }
    ) => {
        $(#[$doc])*
        pub trait Kernels {
            /// Type of the kernels that this form shares with another form.
            type Base: Given;

            /// The kernels that this form shares with another.
            const BASE: Self::Base;

            /// Names of the kernels that this form does not share.
            const OWN: KernelSet;

            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                ///
                /// # Errors
                /// The [`Fault`] of the first guard that fails; [`Fault::NotDerived`] for a kernel that the form does
                /// not have.
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
                /// The [`Fault`] of the first guard that fails; [`Fault::NotDerived`] for a kernel that the form does
                /// not have.
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

            const OWN: KernelSet = KernelSet::ALL;

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

        /// A set of kernels by name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct KernelSet(u64);

        impl KernelSet {
            /// No kernels.
            pub const NONE: Self = Self(0);

            /// All kernels.
            pub const ALL: Self = Self(u64::MAX);

            $(
                #[doc = concat!("With [`Kernel::", stringify!($name), "`].")]
                #[must_use]
                pub const fn $plain(self) -> Self {
                    Self(self.0 | 1 << Place::$name as u32)
                }
            )*
            $(
                #[doc = concat!("With [`Kernel::", stringify!($surface_name), "`].")]
                #[must_use]
                pub const fn $of_surface(self) -> Self {
                    Self(self.0 | 1 << Place::$surface_name as u32)
                }
            )*

            const fn has(self, place: Place) -> bool {
                self.0 & (1 << place as u32) != 0
            }
        }

        /// Bits of the kernels in a set.
        #[derive(Clone, Copy)]
        enum Place {
            $($name,)*
            $($surface_name,)*
        }

        /// Kernels over one kind of number behind pointers; `None` for a kernel that the form does not have.
        pub type KernelTable<L> = Table<Held<Plain<L>>, Held<OfSurface<L>>>;

        /// Constant pointers to kernels over one kind of number.
        pub type ConstantTable<L> = Table<&'static Plain<L>, &'static OfSurface<L>>;

        /// One entry per kernel: a pointer, or `None` for a kernel that the form does not have.
        #[derive(Clone, Copy)]
        pub struct Table<P, S> {
            $(
                #[doc = concat!("[`Kernel::", stringify!($name), "`].")]
                pub $plain: Option<P>,
            )*
            $(
                #[doc = concat!("[`Kernel::", stringify!($surface_name), "`] of a surface.")]
                pub $of_surface: Option<S>,
            )*
        }

        impl<L: Numbers> ConstantTable<L> {
            const NONE: Self = Self {
                $($plain: None,)*
                $($of_surface: None,)*
            };

            /// The table in the type that forms store.
            pub const fn held(self) -> KernelTable<L> {
                Table {
                    $($plain: match self.$plain {
                        Some(kernel) => Some(Held::Static(kernel)),
                        None => None,
                    },)*
                    $($of_surface: match self.$of_surface {
                        Some(kernel) => Some(Held::Static(kernel)),
                        None => None,
                    },)*
                }
            }

            /// Pointers to the selected kernels of a form. Kernels that forms share point to the same functions.
            pub const fn of<K: Given>(which: KernelSet) -> Self {
                if K::IS_NONE {
                    return Self::NONE;
                }
                let base = Self::of::<K::Base>(which);
                Self {
                    $($plain: match (which.has(Place::$name), K::OWN.has(Place::$name)) {
                        (true, true) => Some(const {
                            &|at: At<'_, L>, values: &mut [L]| K::GIVEN.$plain(at, values)
                        }),
                        _ => base.$plain,
                    },)*
                    $($of_surface: match (
                        which.has(Place::$surface_name),
                        K::OWN.has(Place::$surface_name),
                    ) {
                        (true, true) => Some(const {
                            &|surface: usize, at: At<'_, L>, values: &mut [L]| {
                                K::GIVEN.$of_surface(surface, at, values)
                            }
                        }),
                        _ => base.$of_surface,
                    },)*
                }
            }

        }

        impl<L: Numbers> KernelTable<L> {
            /// Evaluates the kernel of this name.
            ///
            /// # Errors
            /// The [`Fault`] of the kernel; [`Fault::NotDerived`] for one that the table does not have.
            pub fn run(&self, kernel: Kernel, at: At<'_, L>, values: &mut [L]) -> Result<(), Fault> {
                match kernel {
                    $(Kernel::$name => match &self.$plain {
                        Some(kernel) => kernel(at, values),
                        None => Err(Fault::NotDerived),
                    },)*
                    $(Kernel::$surface_name(surface) => match &self.$of_surface {
                        Some(kernel) => kernel(surface, at, values),
                        None => Err(Fault::NotDerived),
                    },)*
                }
            }

            /// Builds a table by looking up every kernel by name. A kernel of surfaces is looked up by the constructor
            /// of its names.
            pub fn found(
                plain: impl Fn(Kernel) -> Option<Held<Plain<L>>>,
                of_surface: impl Fn(fn(usize) -> Kernel) -> Option<Held<OfSurface<L>>>,
            ) -> Self {
                Self {
                    $($plain: plain(Kernel::$name),)*
                    $($of_surface: of_surface(Kernel::$surface_name),)*
                }
            }
        }

        impl<A: Given, B: Chosen> Kernels for Choice<A, B> {
            type Base = NoKernels;

            const BASE: NoKernels = NoKernels;

            const OWN: KernelSet = KernelSet::NONE;

            $(
                #[inline]
                fn $plain<L: Numbers>(
                    &self,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    match self.others() {
                        None => A::GIVEN.$plain(at, values),
                        Some(others) => others.$plain(at, values),
                    }
                }
            )*
            $(
                #[inline]
                fn $of_surface<L: Numbers>(
                    &self,
                    surface: usize,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    match self.others() {
                        None => A::GIVEN.$of_surface(surface, at, values),
                        Some(others) => others.$of_surface(surface, at, values),
                    }
                }
            )*
        }

        impl<T: Tabled> Kernels for Pointers<T> {
            type Base = NoKernels;

            const BASE: NoKernels = NoKernels;

            const OWN: KernelSet = KernelSet::ALL;

            $(
                #[inline(always)]
                fn $plain<L: Numbers>(
                    &self,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    match self.0.table() {
                        Some(Table { $plain: Some(kernel), .. }) => kernel(at, values),
                        _ => Err(Fault::NotDerived),
                    }
                }
            )*
            $(
                #[inline(always)]
                fn $of_surface<L: Numbers>(
                    &self,
                    surface: usize,
                    at: At<'_, L>,
                    values: &mut [L],
                ) -> Result<(), Fault> {
                    match self.0.table() {
                        Some(Table { $of_surface: Some(kernel), .. }) => {
                            kernel(surface, at, values)
                        }
                        _ => Err(Fault::NotDerived),
                    }
                }
            )*
        }
    };
}

/// Kernels that are determined by their type.
pub trait Given: Kernels {
    /// The kernels.
    const GIVEN: Self;

    /// True if the type has no kernels.
    const IS_NONE: bool = false;
}

impl Given for NoKernels {
    const GIVEN: Self = Self;

    const IS_NONE: bool = true;
}

/// A kernel behind a pointer.
pub type Plain<L> = dyn Fn(At<'_, L>, &mut [L]) -> Result<(), Fault> + Send + Sync;

/// A kernel of surfaces behind a pointer.
pub type OfSurface<L> = dyn Fn(usize, At<'_, L>, &mut [L]) -> Result<(), Fault> + Send + Sync;

/// The kernels of a form that has none, and the base of a form that shares none. Every kernel gives
/// [`Fault::NotDerived`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoKernels;

kernels! {
    /// The kernels of one form of a model. Each writes its values to `values`, which must have exactly one entry per
    /// value. A slice shorter than a kernel reads or writes is an error of the caller and panics. A kernel that a form
    /// does not define is the kernel of [`Kernels::BASE`].
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
