//! Vectors of numbers on the stack: all that an integrator knows of a state.

use core::fmt::Debug;

use nalgebra::SVector;

/// `f64` components, stored in a row on the stack.
///
/// Integrators work on these and on nothing else; what the components mean is the system's affair
/// (see [`System`](crate::System)). Implemented by nalgebra's `SVector<f64, D>` for every `D`, zero included, whose number of
/// components is part of its type. Other vectors have room for some numbers and use as many as the system says
/// ([`VectorField::state_len`](crate::VectorField::state_len) and its relatives).
pub trait StateVector: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The largest number of components; of a vector of a fixed size, their number.
    const CAPACITY: usize;

    /// A value beside each component.
    type Each<T: Plain>: Plain + AsRef<[T]> + AsMut<[T]>;

    /// The same value beside each of `count` components; where the type fixes their number, `count` is ignored.
    fn each<T: Plain>(count: usize, value: T) -> Self::Each<T>;

    /// A vector of `count` zeros. Where the type fixes the number of components, `count` is ignored.
    fn zeros(count: usize) -> Self;

    /// The vector of these components. Where the type fixes their number, it must be theirs.
    fn of(components: &[f64]) -> Self {
        let mut vector = Self::zeros(components.len());
        vector.as_mut_slice().copy_from_slice(components);
        vector
    }

    /// The vector of as many zeros.
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

    /// All components that there is room for: those in use, then zeros. Their number is known while compiling, so that sums of
    /// multiples, which keep the zeros, had better run over all of them.
    #[inline(always)]
    fn padded(&self) -> &[f64] {
        self.as_slice()
    }

    /// The same, to be written; what is behind those in use must stay 0.
    #[inline(always)]
    fn padded_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }

    /// Whether every component is finite.
    fn is_finite(&self) -> bool {
        self.as_slice()
            .iter()
            .all(|component| component.is_finite())
    }
}

/// What can stand beside a component: plain data.
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
