//! The kernels of several modes, selected by an index.

use core::marker::PhantomData;

use super::{Given, Kernels, NoKernels};

/// Kernels selected by their index in a list.
pub trait Chosen: Kernels {
    /// The kernels with this index; [`NoKernels`] past the end.
    fn at(place: usize) -> Self;
}

impl Chosen for NoKernels {
    #[inline(always)]
    fn at(_: usize) -> Self {
        Self
    }
}

/// The kernels `A` at index 0 and the list `B` from index 1 on, as in `Choice<A, Choice<B, NoKernels>>`.
#[derive(Debug, Clone, Copy)]
pub struct Choice<A, B> {
    place: usize,
    list: PhantomData<(A, B)>,
}

impl<A, B: Chosen> Choice<A, B> {
    /// The selected kernels if they are not the first.
    #[inline(always)]
    pub(super) fn others(&self) -> Option<B> {
        self.place.checked_sub(1).map(B::at)
    }
}

impl<A: Given, B: Chosen> Chosen for Choice<A, B> {
    #[inline(always)]
    fn at(place: usize) -> Self {
        Self {
            place,
            list: PhantomData,
        }
    }
}

// NOTE: `GIVEN`, which a form with modes has, selects no kernels. The kernels of a mode are selected by index.
impl<A: Given, B: Chosen> Given for Choice<A, B> {
    const GIVEN: Self = Self {
        place: usize::MAX,
        list: PhantomData,
    };

    const IS_NONE: bool = true;
}
