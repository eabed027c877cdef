//! Numbers with first derivatives: what a series or an impact map says of its neighbours.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::math;
use crate::numbers::Numbers;

/// A number and its derivatives along `K` directions.
///
/// Every operation of [`Numbers`] carries the derivatives along by its own rule, so that a function written over
/// [`Numbers`] gives its differential with its value, exact to rounding. The value has the bits that `f64` has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const K: usize> {
    /// The number.
    pub value: f64,
    /// Its derivative along each direction.
    pub slopes: [f64; K],
}

impl<const K: usize> Dual<K> {
    /// A number that does not change along any direction.
    pub const fn constant(value: f64) -> Self {
        Self {
            value,
            slopes: [0.0; K],
        }
    }

    /// A function's value here, with its derivative here.
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Self {
        // NOTE: what does not depend on a direction has no derivative along it, however steep the function is.
        let slopes = self.slopes.map(|slope| match slope == 0.0 {
            true => 0.0,
            false => derivative * slope,
        });
        Self { value, slopes }
    }

    #[inline(always)]
    fn combined(self, other: Self, value: f64, rule: impl Fn(f64, f64) -> f64) -> Self {
        let mut slopes = [0.0; K];
        for (i, slope) in slopes.iter_mut().enumerate() {
            *slope = rule(self.slopes[i], other.slopes[i]);
        }
        Self { value, slopes }
    }
}

impl<const K: usize> Add for Dual<K> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combined(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const K: usize> Sub for Dual<K> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combined(other, self.value - other.value, |a, b| a - b)
    }
}

impl<const K: usize> Mul for Dual<K> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combined(other, self.value * other.value, |a, b| {
            math::mul_add(a, other.value, self.value * b)
        })
    }
}

impl<const K: usize> Div for Dual<K> {
    type Output = Self;

    // The derivative of a quotient has other operations in it.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.combined(other, value, |a, b| (a - value * b) / other.value)
    }
}

impl<const K: usize> Neg for Dual<K> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slopes: self.slopes.map(|slope| -slope),
        }
    }
}

impl<const K: usize> Numbers for Dual<K> {
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
    fn mul_add(self, b: Self, c: Self) -> Self {
        let mut slopes = [0.0; K];
        for (i, slope) in slopes.iter_mut().enumerate() {
            let of_b = math::mul_add(self.value, b.slopes[i], c.slopes[i]);
            *slope = math::mul_add(self.slopes[i], b.value, of_b);
        }
        Self {
            value: math::mul_add(self.value, b.value, c.value),
            slopes,
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
        self.combined(x, math::atan2(self.value, x.value), |y, x| {
            along_y * y - along_x * x
        })
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let slope = exponent * math::powf(self.value, exponent - 1.0);
        self.chain(math::powf(self.value, exponent), slope)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = math::sin_cos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    #[inline(always)]
    fn tan(self) -> Self {
        let tangent = math::tan(self.value);
        self.chain(tangent, 1.0 + tangent * tangent)
    }

    #[inline(always)]
    fn asin(self) -> Self {
        let cosine = math::sqrt((1.0 - self.value) * (1.0 + self.value));
        self.chain(math::asin(self.value), 1.0 / cosine)
    }

    #[inline(always)]
    fn acos(self) -> Self {
        let sine = math::sqrt((1.0 - self.value) * (1.0 + self.value));
        self.chain(math::acos(self.value), -1.0 / sine)
    }

    #[inline(always)]
    fn atan(self) -> Self {
        let slope = 1.0 / (1.0 + self.value * self.value);
        self.chain(math::atan(self.value), slope)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let power = math::exp(self.value);
        self.chain(power, power)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(math::ln(self.value), 1.0 / self.value)
    }

    #[inline(always)]
    fn sinh(self) -> Self {
        self.chain(math::sinh(self.value), math::cosh(self.value))
    }

    #[inline(always)]
    fn cosh(self) -> Self {
        self.chain(math::cosh(self.value), math::sinh(self.value))
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        let tangent = math::tanh(self.value);
        self.chain(tangent, (1.0 - tangent) * (1.0 + tangent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type One = Dual<1>;

    /// The derivative of a function against a central difference, and its value against that of `f64`.
    fn check(name: &str, x: f64, function: impl Fn(One) -> One, plain: impl Fn(f64) -> f64) {
        let found = function(Dual {
            value: x,
            slopes: [1.0],
        });
        assert_eq!(found.value.to_bits(), plain(x).to_bits(), "{name} at {x}");
        let step = 1e-5;
        let expected = (plain(x + step) - plain(x - step)) / (2.0 * step);
        let error = (found.slopes[0] - expected).abs();
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
                $(check($name, 0.7, |$x: One| $expression(One::of), |$x: f64| $expression(|own: f64| own));)*
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
        let root = Dual::<2> {
            value: 0.0,
            slopes: [0.0, 1.0],
        }
        .sqrt();
        assert_eq!(root.slopes, [0.0, f64::INFINITY]);
    }
}
