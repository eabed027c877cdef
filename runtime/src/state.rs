//! Fixed-size vectors of numbers: all that an integrator knows of a state.

use core::fmt::Debug;

use nalgebra::SVector;

/// A fixed number of `f64` components, stored in a row on the stack.
///
/// Integrators work on these and on nothing else; what the components mean is the system's affair
/// (see [`System`](crate::System)). Implemented by nalgebra's `SVector<f64, D>` for every `D`,
/// zero included.
pub trait StateVector: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Number of components.
    const LEN: usize;

    /// The vector of zeros.
    fn zeros() -> Self;

    /// The components in order.
    fn as_slice(&self) -> &[f64];

    /// The components in order, to be written.
    fn as_mut_slice(&mut self) -> &mut [f64];

    /// Whether every component is finite.
    fn is_finite(&self) -> bool {
        self.as_slice()
            .iter()
            .all(|component| component.is_finite())
    }
}

impl<const D: usize> StateVector for SVector<f64, D> {
    const LEN: usize = D;

    #[inline(always)]
    fn zeros() -> Self {
        Self::repeat(0.0)
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
