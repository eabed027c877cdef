//! State vectors on the stack, the only form in which integrators know states.

use core::fmt::Debug;

use nalgebra::SVector;

/// A vector of `f64` components, stored contiguously on the stack.
///
/// To integrators, a vector is a list of components; the system gives them their meaning (see
/// [`System`](crate::System)). Implemented by nalgebra's `SVector<f64, D>` for every `D`, also 0; its number of
/// components is part of its type. Other vectors have a fixed capacity and use as many components as the system
/// declares ([`VectorField::state_len`](crate::VectorField::state_len) and its relatives).
///
/// # Examples
///
/// ```
/// use dalembert::StateVector;
/// use nalgebra::SVector;
///
/// let state = SVector::<f64, 3>::zeros();
/// assert_eq!(<SVector<f64, 3> as StateVector>::CAPACITY, 3);
/// assert!(StateVector::is_finite(&state));
/// ```
pub trait StateVector: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Largest number of components; for a vector of fixed size, their number.
    const CAPACITY: usize;

    /// Array with one value per component.
    type Each<T: Plain>: Plain + AsRef<[T]> + AsMut<[T]>;

    /// An array with the same value for each of `count` components. If the type fixes the number of components, `count`
    /// is ignored.
    fn each<T: Plain>(count: usize, value: T) -> Self::Each<T>;

    /// A vector of `count` zeros. If the type fixes the number of components, `count` is ignored.
    fn zeros(count: usize) -> Self;

    /// The vector with these components. If the type fixes the number of components, `components` must have that
    /// length.
    fn of(components: &[f64]) -> Self {
        let mut vector = Self::zeros(components.len());
        vector.as_mut_slice().copy_from_slice(components);
        vector
    }

    /// A zero vector with the same number of components.
    #[inline(always)]
    fn zeroed(&self) -> Self {
        Self::zeros(self.count())
    }

    /// The number of components.
    #[inline(always)]
    fn count(&self) -> usize {
        self.as_slice().len()
    }

    /// The components in order.
    fn as_slice(&self) -> &[f64];

    /// The components in order, to be written.
    fn as_mut_slice(&mut self) -> &mut [f64];

    /// All components within the capacity: those in use, then zeros. Their number is known at compile time. Linear
    /// combinations keep the zeros ([`StateVector::for_each_place`]).
    #[inline(always)]
    fn padded(&self) -> &[f64] {
        self.as_slice()
    }

    /// Mutable form of [`StateVector::padded`]. The components after those in use must stay 0.
    #[inline(always)]
    fn padded_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }

    /// Calls `at` with the indices of the components, and of the zeros that fill their last block
    /// ([`StateVector::padded`]). The length of a block is known at compile time, which makes linear combinations faster
    /// than loops over the components.
    #[inline(always)]
    fn for_each_place(&self, mut at: impl FnMut(usize)) {
        for i in 0..self.padded().len() {
            at(i);
        }
    }

    /// True if every component is finite.
    fn is_finite(&self) -> bool {
        self.as_slice()
            .iter()
            .all(|component| component.is_finite())
    }
}

/// Plain data that may be stored per component.
pub trait Plain: Copy + Debug + PartialEq + Send + Sync + 'static {}

impl<T: Copy + Debug + PartialEq + Send + Sync + 'static> Plain for T {}

impl<const D: usize> StateVector for SVector<f64, D> {
    const CAPACITY: usize = D;

    type Each<T: Plain> = [T; D];

    #[inline(always)]
    fn each<T: Plain>(_: usize, value: T) -> [T; D] {
        [value; D]
    }

    #[inline(always)]
    fn zeros(_: usize) -> Self {
        Self::repeat(0.0)
    }

    #[inline(always)]
    fn count(&self) -> usize {
        D
    }

    #[inline(always)]
    fn as_slice(&self) -> &[f64] {
        self.data.as_slice()
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        self.data.as_mut_slice()
    }
}

/// A vector times a number.
#[inline(always)]
pub(crate) fn scaled<V: StateVector>(vector: &V, factor: f64) -> V {
    let mut scaled = *vector;
    for component in scaled.as_mut_slice() {
        *component *= factor;
    }
    scaled
}
