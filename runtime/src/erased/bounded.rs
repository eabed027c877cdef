//! Vectors and rows whose length is known at run time, stored in arrays of fixed capacity.

use core::fmt;

use crate::numbers::{Numbers, Row};
use crate::state::{Plain, StateVector};

/// Components that are combined together: as many as a SIMD register of 256 bits has.
const BLOCK: usize = 4;

/// Calls `at` with every index below `count`, rounded up to whole blocks within the capacity `C`.
///
/// NOTE: the length of a block is known when this is compiled, so that its components are computed together.
#[inline(always)]
fn in_blocks<const C: usize>(count: usize, mut at: impl FnMut(usize)) {
    for block in 0..C / BLOCK {
        if block * BLOCK >= count {
            return;
        }
        for i in 0..BLOCK {
            at(block * BLOCK + i);
        }
    }
    for i in C / BLOCK * BLOCK..C {
        at(i);
    }
}

/// At most `C` values.
#[derive(Clone, Copy)]
pub struct Bounded<T, const C: usize> {
    count: usize,
    values: [T; C],
}

impl<T: Copy, const C: usize> Bounded<T, C> {
    /// A vector of `count` equal values; values beyond the capacity are dropped.
    #[inline(always)]
    pub fn all(count: usize, value: T) -> Self {
        Self {
            count: count.min(C),
            values: [value; C],
        }
    }
}

impl<T, const C: usize> AsRef<[T]> for Bounded<T, C> {
    #[inline(always)]
    fn as_ref(&self) -> &[T] {
        &self.values[..self.count.min(C)]
    }
}

impl<T, const C: usize> AsMut<[T]> for Bounded<T, C> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [T] {
        &mut self.values[..self.count.min(C)]
    }
}

impl<T: PartialEq, const C: usize> PartialEq for Bounded<T, C> {
    fn eq(&self, other: &Self) -> bool {
        self.as_ref() == other.as_ref()
    }
}

impl<T: fmt::Debug, const C: usize> fmt::Debug for Bounded<T, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_ref().fmt(f)
    }
}

impl<const C: usize> StateVector for Bounded<f64, C> {
    const CAPACITY: usize = C;

    type Each<T: Plain> = Bounded<T, C>;

    #[inline(always)]
    fn each<T: Plain>(count: usize, value: T) -> Bounded<T, C> {
        Bounded::all(count, value)
    }

    #[inline(always)]
    fn zeros(count: usize) -> Self {
        Self::all(count, 0.0)
    }

    #[inline(always)]
    fn as_slice(&self) -> &[f64] {
        self.as_ref()
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        self.as_mut()
    }

    #[inline(always)]
    fn padded(&self) -> &[f64] {
        &self.values
    }

    #[inline(always)]
    fn padded_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    #[inline(always)]
    fn for_each_place(&self, at: impl FnMut(usize)) {
        in_blocks::<C>(self.count, at);
    }
}

impl<L: Numbers, const C: usize> Row<L> for Bounded<L, C> {
    const CAPACITY: usize = C;

    #[inline(always)]
    fn zeros(count: usize) -> Self {
        Self::all(count, L::ZERO)
    }

    #[inline(always)]
    fn as_slice(&self) -> &[L] {
        self.as_ref()
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [L] {
        self.as_mut()
    }

    #[inline(always)]
    fn padded(&self) -> &[L] {
        &self.values
    }

    #[inline(always)]
    fn padded_mut(&mut self) -> &mut [L] {
        &mut self.values
    }

    #[inline(always)]
    fn for_each_place(&self, at: impl FnMut(usize)) {
        in_blocks::<C>(self.count, at);
    }
}

/// At most `K` times `C` numbers.
#[derive(Debug, Clone, Copy)]
pub struct Wide<L, const C: usize, const K: usize> {
    count: usize,
    values: [[L; C]; K],
}

impl<L: Copy, const C: usize, const K: usize> Wide<L, C, K> {
    /// A list of `count` equal numbers; numbers beyond the capacity are dropped.
    #[inline(always)]
    pub fn all(count: usize, value: L) -> Self {
        Self {
            count: count.min(C * K),
            values: [[value; C]; K],
        }
    }
}

impl<L, const C: usize, const K: usize> AsRef<[L]> for Wide<L, C, K> {
    #[inline(always)]
    fn as_ref(&self) -> &[L] {
        &self.values.as_flattened()[..self.count]
    }
}

impl<L, const C: usize, const K: usize> AsMut<[L]> for Wide<L, C, K> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [L] {
        &mut self.values.as_flattened_mut()[..self.count]
    }
}

impl<L: PartialEq, const C: usize, const K: usize> PartialEq for Wide<L, C, K> {
    fn eq(&self, other: &Self) -> bool {
        self.as_ref() == other.as_ref()
    }
}

impl<L: Numbers, const C: usize, const K: usize> Row<L> for Wide<L, C, K> {
    const CAPACITY: usize = C * K;

    #[inline(always)]
    fn zeros(count: usize) -> Self {
        Self::all(count, L::ZERO)
    }

    #[inline(always)]
    fn as_slice(&self) -> &[L] {
        self.as_ref()
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [L] {
        self.as_mut()
    }
}
