//! Number type of the functions written by hand: plain doubles, or numbers that count their operations.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number type with the operations that the functions need.
pub trait Number:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// A parameter or a constant.
    fn of(value: f64) -> Self;

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);

    /// The product with a constant.
    #[inline(always)]
    fn times(self, constant: f64) -> Self {
        self * Self::of(constant)
    }

    /// `1/x`
    #[inline(always)]
    fn reciprocal(self) -> Self {
        Self::of(1.0) / self
    }
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        Self::sin_cos(self)
    }
}

/// The components of a state.
#[inline(always)]
pub fn numbers<S: Copy + Into<[f64; N]>, const N: usize>(state: &S) -> [f64; N] {
    (*state).into()
}

/// The parameters of a system as numbers.
#[inline(always)]
pub fn parameters<T: Number, const N: usize>(values: [f64; N]) -> [T; N] {
    values.map(T::of)
}
