//! The coefficients of a series, and their arithmetic.

use std::fmt::Debug;

use crate::field::Modulus;
use crate::rational::Rational;

/// A field whose elements are the coefficients of series.
///
/// NOTE: a procedural macro runs unoptimised for most users, where every call and every iterator step costs several
/// nanoseconds. [`Arithmetic::scatter`], in which nearly all time is spent, is therefore one plain loop for each
/// kind of number.
pub trait Arithmetic: Copy {
    /// An element.
    type Scalar: Copy + PartialEq + Debug;
    /// A sum of products before reduction.
    type Sum: Copy;

    /// The element of an integer.
    fn integer(self, value: i64) -> Self::Scalar;
    /// The element of a rational number; `None` if the field has none.
    fn rational(self, value: &Rational) -> Option<Self::Scalar>;
    /// `a + b`
    fn add(self, a: Self::Scalar, b: Self::Scalar) -> Self::Scalar;
    /// `a - b`
    fn sub(self, a: Self::Scalar, b: Self::Scalar) -> Self::Scalar;
    /// `a b`
    fn mul(self, a: Self::Scalar, b: Self::Scalar) -> Self::Scalar;
    /// `1 / a`; `None` if `a` is 0 or, for ranges, contains 0.
    fn inv(self, a: Self::Scalar) -> Option<Self::Scalar>;
    /// Pivot quality: 0 for a number that must not be a pivot, largest for the best pivot.
    fn size(self, a: Self::Scalar) -> f64;
    /// The empty sum.
    fn empty(self) -> Self::Sum;
    /// The value of a sum.
    fn settle(self, sum: Self::Sum) -> Self::Scalar;
    /// `sums[row[j]] += factor * b` for every `(j, b)` of `terms`, up to the first `j` with no entry in `row`.
    fn scatter(
        self,
        sums: &mut [Self::Sum],
        row: &[u32],
        factor: Self::Scalar,
        terms: &[(u32, Self::Scalar)],
    );

    /// True if `a` is 0.
    fn is_zero(self, a: Self::Scalar) -> bool {
        a == self.integer(0)
    }

    /// `-a`
    fn neg(self, a: Self::Scalar) -> Self::Scalar {
        self.sub(self.integer(0), a)
    }
}

impl Arithmetic for Modulus {
    type Scalar = u64;
    type Sum = u128;

    fn integer(self, value: i64) -> u64 {
        Modulus::integer(self, value)
    }

    fn rational(self, value: &Rational) -> Option<u64> {
        Modulus::rational(self, value)
    }

    fn add(self, a: u64, b: u64) -> u64 {
        Modulus::add(self, a, b)
    }

    fn sub(self, a: u64, b: u64) -> u64 {
        Modulus::sub(self, a, b)
    }

    fn mul(self, a: u64, b: u64) -> u64 {
        Modulus::mul(self, a, b)
    }

    fn inv(self, a: u64) -> Option<u64> {
        Modulus::inv(self, a)
    }

    fn is_zero(self, a: u64) -> bool {
        a == 0
    }

    fn size(self, a: u64) -> f64 {
        if a == 0 { 0.0 } else { 1.0 }
    }

    fn empty(self) -> u128 {
        0
    }

    fn settle(self, sum: u128) -> u64 {
        self.reduce_wide(sum)
    }

    fn scatter(self, sums: &mut [u128], row: &[u32], factor: u64, terms: &[(u32, u64)]) {
        let multiple = u128::from(self.prime()) << 66;
        let wide = u128::from(factor);
        let mut position = 0;
        while position < terms.len() {
            let (j, b) = terms[position];
            if j as usize >= row.len() {
                return;
            }
            let k = row[j as usize] as usize;
            // Products stay below 2^122, so a sum below 2^127 has room for the next one. The multiple of the prime is
            // larger than 2^126.
            let sum = sums[k].wrapping_add(wide.wrapping_mul(b as u128));
            sums[k] = if sum >> 127 == 0 { sum } else { sum - multiple };
            position += 1;
        }
    }
}

/// Double precision.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Reals;

impl Arithmetic for Reals {
    type Scalar = f64;
    type Sum = f64;

    fn integer(self, value: i64) -> f64 {
        value as f64
    }

    fn rational(self, value: &Rational) -> Option<f64> {
        Some(value.to_f64())
    }

    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }

    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }

    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }

    fn inv(self, a: f64) -> Option<f64> {
        (a != 0.0 && a.is_finite()).then(|| 1.0 / a)
    }

    fn is_zero(self, a: f64) -> bool {
        a == 0.0
    }

    fn size(self, a: f64) -> f64 {
        a.abs()
    }

    fn empty(self) -> f64 {
        0.0
    }

    fn settle(self, sum: f64) -> f64 {
        sum
    }

    fn scatter(self, sums: &mut [f64], row: &[u32], factor: f64, terms: &[(u32, f64)]) {
        for (j, b) in terms {
            let Some(k) = row.get(*j as usize) else {
                return;
            };
            sums[*k as usize] += factor * b;
        }
    }
}
