//! Kernels behind pointers: a form that is known only at run time.

use super::{KernelSet, KernelTable};
use crate::numbers::Numbers;

/// Something that has tables of pointers to kernels, one per kind of number.
pub trait Tabled: Copy {
    /// The table over these numbers, if there is one.
    fn table<L: Numbers>(&self) -> Option<&'static KernelTable<L>>;
}

/// The kernels of such a table.
#[derive(Debug, Clone, Copy)]
pub struct Pointers<T>(pub T);

impl KernelSet {
    /// What enclosures of gaps take.
    pub const OF_GAPS: Self = Self::NONE.gap();

    /// What enclosures of rates take.
    pub const OF_RATES: Self = Self::NONE.rate();

    /// What variations take.
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
        .reset();

    /// What variations take of a mode.
    pub const OF_TRANSITIONS: Self = Self::OF_VARIATIONS.nearest().energy().entry();
}
