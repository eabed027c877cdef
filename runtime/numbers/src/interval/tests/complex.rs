//! Complex numbers as numbers of the language, to test bounds off the real axis.

use core::ops::{Add, Div, Mul, Neg, Sub};

use num_complex::Complex64;

use crate::numbers::Numbers;

/// A complex number. Functions with a kink choose their branch by the real part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Complex(Complex64);

impl Complex {
    pub(crate) fn new(real: f64, imaginary: f64) -> Self {
        Self(Complex64::new(real, imaginary))
    }

    pub(crate) fn real(self) -> f64 {
        self.0.re
    }

    pub(crate) fn imaginary(self) -> f64 {
        self.0.im
    }

    pub(crate) fn magnitude(self) -> f64 {
        self.0.norm()
    }
}

macro_rules! operators {
    ($($name:ident $function:ident)*) => {$(
        impl $name for Complex {
            type Output = Self;

            fn $function(self, other: Self) -> Self {
                Self(self.0.$function(other.0))
            }
        }
    )*};
}

operators! { Add add Sub sub Mul mul Div div }

impl Neg for Complex {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Functions that complex numbers lack.
trait Missing {
    fn log1p(self) -> Self;
}

impl Missing for Complex64 {
    fn log1p(self) -> Self {
        (Self::ONE + self).ln()
    }
}

macro_rules! functions {
    ($($name:ident)+) => {$(
        fn $name(self) -> Self {
            Self(self.0.$name())
        }
    )+};
}

impl Numbers for Complex {
    const LANES: usize = 1;
    const ZERO: Self = Self(Complex64::ZERO);

    fn of(number: f64) -> Self {
        Self::new(number, 0.0)
    }

    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        Self::of(of_lane(0))
    }

    fn lane(&self, _: usize) -> f64 {
        self.0.re
    }

    fn is_below_zero(&self) -> Option<bool> {
        None
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn abs(self) -> Self {
        self.turned(self)
    }

    fn max(self, other: Self) -> Self {
        if self.0.re > other.0.re { self } else { other }
    }

    fn turned(self, sign: Self) -> Self {
        if sign.0.re < 0.0 { -self } else { self }
    }

    /// The angle `-i ln((x + i y) / sqrt(x^2 + y^2))`, also for complex `x` and `y`.
    fn atan2(self, x: Self) -> Self {
        let radius = (x * x + self * self).sqrt();
        let turn = (x.0 + Complex64::I * self.0) / radius.0;
        Self(-Complex64::I * turn.ln())
    }

    fn powf(self, exponent: f64) -> Self {
        Self(self.0.powf(exponent))
    }

    fn power(self, exponent: Self) -> Self {
        Self(self.0.powc(exponent.0))
    }

    functions! { sqrt }

    crate::functions_of_one_number!(functions);
}
