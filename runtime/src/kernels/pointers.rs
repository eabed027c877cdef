//! Kernels behind pointers, for a form that is known only at run time.

use super::{KernelSet, KernelTable};
use crate::numbers::Numbers;

/// A source of tables of pointers to kernels, one table per kind of number.
pub trait Tabled: Copy {
    /// The table over this kind of number, if there is one.
    fn table<L: Numbers>(&self) -> Option<&KernelTable<L>>;
}

/// The kernels of tables of pointers.
#[derive(Debug, Clone, Copy)]
pub struct Pointers<T>(pub T);

impl KernelSet {
    /// Kernels needed for enclosures of gaps.
    pub const OF_GAPS: Self = Self::NONE.gap();

    /// Kernels for enclosures of gaps and of the conditions of surfaces.
    pub const OF_SURFACES: Self = Self::NONE.gap().conditions();

    /// Kernels for enclosures of rates.
    pub const OF_RATES: Self = Self::NONE.rate();

    /// Kernels needed for variations.
    pub const OF_VARIATIONS: Self = Self::NONE
        .velocity()
        .motion()
        .residuals()
        .levels()
        .gaps()
        .contact()
        .coefficient()
        .focus()
        .trace()
        .reset()
        .outputs();

    /// Kernels needed for variations of a mode.
    pub const OF_TRANSITIONS: Self = Self::OF_VARIATIONS.nearest().energy().entry();
}
