//! Dual numbers: values with first derivatives, for forward-mode derivatives of series and impact maps.

use core::ops::{Add, Div, Mul, Neg, Sub};

use wide::f64x4;

use crate::math;
use crate::numbers::Numbers;

/// Number of directions whose derivatives are computed side by side.
pub const DIRECTIONS: usize = 4;

/// A dual number: a value and its derivatives along [`DIRECTIONS`] directions.
///
/// Every operation of [`Numbers`] propagates the derivatives by its differentiation rule, so that a function written
/// over [`Numbers`] gives its value and its differential, exact to rounding. The value has the same bits as with
/// `f64`.
///
/// # Examples
///
/// ```
/// use dalembert::numbers::Numbers;
/// use dalembert::variations::Dual;
///
/// // x sin(y) at (2, 0): its derivatives by x and y are 0 and 2.
/// let x = Dual::new(2.0, [1.0, 0.0, 0.0, 0.0]);
/// let y = Dual::new(0.0, [0.0, 1.0, 0.0, 0.0]);
/// let product = x * y.sin();
/// assert_eq!(product.value, 0.0);
/// assert_eq!(product.slopes()[..2], [0.0, 2.0]);
/// ```
// NOTE: a vector, not an array: loops or single numbers in each operation of a long series take minutes to compile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    slopes: f64x4,
}

/// The same factor along each direction.
#[inline(always)]
fn all(factor: f64) -> f64x4 {
    // NOTE: written out, since `splat` is a loop until it is optimised.
    f64x4::new([factor, factor, factor, factor])
}

/// `a*b + c` along each direction, fused if [`math::mul_add`] is.
#[inline(always)]
fn fused(a: f64x4, b: f64, c: f64x4) -> f64x4 {
    #[cfg(all(target_feature = "fma", feature = "std", not(feature = "strict")))]
    {
        a.mul_add(all(b), c)
    }
    #[cfg(not(all(target_feature = "fma", feature = "std", not(feature = "strict"))))]
    {
        a * all(b) + c
    }
}

impl Dual {
    /// A constant: its derivatives are 0.
    pub const fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: f64x4::ZERO,
        }
    }

    /// A number with its derivative along each direction.
    #[inline]
    pub const fn new(value: f64, slopes: [f64; DIRECTIONS]) -> Self {
        Self {
            value,
            slopes: f64x4::new(slopes),
        }
    }

    /// The derivative along each direction.
    #[inline]
    pub fn slopes(&self) -> [f64; DIRECTIONS] {
        self.slopes.to_array()
    }

    /// Chain rule. `value` and `derivative` are those of the outer function.
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Self {
        // NOTE: a number that does not depend on a direction keeps derivative 0 along it, even if the function has
        // infinite slope.
        let moves = self.slopes.simd_ne(f64x4::ZERO);
        Self {
            value,
            slopes: moves & (self.slopes * all(derivative)),
        }
    }
}

impl Add for Dual {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slopes: self.slopes + other.slopes,
        }
    }
}

impl Sub for Dual {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slopes: self.slopes - other.slopes,
        }
    }
}

impl Mul for Dual {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let of_other = other.slopes * all(self.value);
        Self {
            value: self.value * other.value,
            slopes: fused(self.slopes, other.value, of_other),
        }
    }
}

impl Div for Dual {
    type Output = Self;

    // The derivative of a quotient needs other operations besides division.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slopes: (self.slopes - other.slopes * all(value)) / all(other.value),
        }
    }
}

impl Neg for Dual {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slopes: -self.slopes,
        }
    }
}

impl Numbers for Dual {
    const LANES: usize = 1;
    const ZERO: Self = Self::constant(0.0);

    #[inline(always)]
    fn of(number: f64) -> Self {
        Self::constant(number)
    }

    #[inline(always)]
    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        Self::constant(of_lane(0))
    }

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        self.value
    }

    #[inline(always)]
    fn is_below_zero(&self) -> Option<bool> {
        self.value.is_below_zero()
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self {
            value: math::mul_add(self.value, b.value, c.value),
            slopes: fused(self.slopes, b.value, fused(b.slopes, self.value, c.slopes)),
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = math::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.turned(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        match self.value < other.value || self.value.is_nan() {
            true => other,
            false => self,
        }
    }

    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        match sign.value < 0.0 {
            true => -self,
            false => self,
        }
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let squared = self.value * self.value + x.value * x.value;
        let (along_y, along_x) = (x.value / squared, self.value / squared);
        Self {
            value: math::atan2(self.value, x.value),
            slopes: self.slopes * all(along_y) - x.slopes * all(along_x),
        }
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let slope = exponent * math::powf(self.value, exponent - 1.0);
        self.chain(math::powf(self.value, exponent), slope)
    }

    #[inline(always)]
    fn power(self, exponent: Self) -> Self {
        self.powf(exponent.value)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = math::sin_cos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    dalembert_numbers::functions_of_one_number!(dalembert_numbers::functions_by_first_derivatives);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the derivative of a function with a central difference, and its value with that over `f64`.
    fn check(name: &str, x: f64, function: impl Fn(Dual) -> Dual, plain: impl Fn(f64) -> f64) {
        let found = function(Dual::new(x, [1.0, 0.0, 0.0, -2.0]));
        assert_eq!(found.value.to_bits(), plain(x).to_bits(), "{name} at {x}");
        let step = 1e-5;
        let expected = (plain(x + step) - plain(x - step)) / (2.0 * step);
        let [along, .., back] = found.slopes();
        assert!((back + 2.0 * along).abs() < 1e-12 * (1.0 + along.abs()));
        let error = (along - expected).abs();
        assert!(
            error < 1e-8 * (1.0 + expected.abs()),
            "{name} at {x}: {found:?}, {expected}"
        );
    }

    #[test]
    fn functions_carry_their_derivatives() {
        macro_rules! functions {
            ($($name:ident at $x:expr),* $(,)?) => {
                $(check(stringify!($name), $x, |x| Numbers::$name(x), |x| Numbers::$name(x));)*
            };
        }
        functions! {
            sqrt at 0.7, abs at -0.7, abs at 0.7, sin at 0.3, cos at 0.3, tan at 0.4, asin at 0.6, acos at 0.6,
            atan at 1.7, exp at 0.9, ln at 0.4, sinh at 0.8, cosh at 0.8, tanh at 0.8,
        }
        check("powf", 1.3, |x| x.powf(2.3), |x| math::powf(x, 2.3));
    }

    #[test]
    fn operations_of_two_carry_their_derivatives() {
        macro_rules! operations {
            ($($name:literal: |$x:ident| $expression:expr),* $(,)?) => {
                $(check($name, 0.7, |$x: Dual| $expression(Dual::of), |$x: f64| $expression(|value: f64| value));)*
            };
        }
        type Of<L> = fn(f64) -> L;
        fn quotient<L: Numbers>(x: L) -> impl Fn(Of<L>) -> L {
            move |of| (x * x + of(2.0)) / (of(1.5) - x) - x
        }
        fn angle<L: Numbers>(x: L) -> impl Fn(Of<L>) -> L {
            move |of| (x + of(0.2)).atan2(x * x - of(3.0))
        }
        fn fused<L: Numbers>(x: L) -> impl Fn(Of<L>) -> L {
            move |of| x.mul_add(x - of(2.0), -x).turned(of(-1.0))
        }
        operations! {
            "quotient": |x| quotient(x),
            "angle": |x| angle(x),
            "fused": |x| fused(x),
        }
    }

    #[test]
    fn a_direction_that_changes_nothing_stays_out_of_steep_functions() {
        let root = Dual::new(0.0, [0.0, 1.0, 0.0, -1.0]).sqrt();
        assert_eq!(root.slopes(), [0.0, f64::INFINITY, 0.0, f64::NEG_INFINITY]);
    }
}
