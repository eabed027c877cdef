//! One number, or several side by side: what Taylor series are computed in.
//!
//! Generated series are written once, over [`Numbers`]. With `f64` they are those of one motion. With several lanes they
//! are those of as many motions at once; every lane has the bits that `f64` has, whatever the others hold.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::math;

/// The circle constant, as [`Numbers::constant`] takes it.
pub const PI: [f64; 4] = [
    core::f64::consts::PI,
    1.2246467991473532e-16,
    -2.9947698097183397e-33,
    1.1124542208633653e-49,
];

/// Coefficients that a series may have: orders 0 to 32.
pub const LENGTH: usize = 33;

/// `1 / k`; 0 at 0.
pub const INVERSES: [f64; LENGTH] = {
    let mut inverses = [0.0; LENGTH];
    let mut k = 1;
    while k < LENGTH {
        inverses[k] = 1.0 / k as f64;
        k += 1;
    }
    inverses
};

/// One number, or one of each of several lanes.
pub trait Numbers:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Number of lanes.
    const LANES: usize;

    /// Zero in every lane.
    const ZERO: Self;

    /// The same number in every lane.
    fn of(number: f64) -> Self;

    /// The constant that is the sum of these numbers, each the nearest to what those before it leave: the first alone
    /// unless numbers have more than double precision.
    #[inline(always)]
    fn constant(parts: [f64; 4]) -> Self {
        Self::of(parts[0])
    }

    /// `1 / k`, for `k` up to 32.
    #[inline(always)]
    fn inverse(k: usize) -> Self {
        Self::of(INVERSES[k])
    }

    /// The number that `of_lane` gives for each lane.
    fn gathered(of_lane: impl FnMut(usize) -> f64) -> Self;

    /// The number of a lane.
    fn lane(&self, lane: usize) -> f64;

    /// `self b + c`, rounded as [`math::mul_add`] does.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;

    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `|x|`
    #[must_use]
    fn abs(self) -> Self;

    /// The larger of two.
    #[must_use]
    fn max(self, other: Self) -> Self;

    /// Sine and cosine.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    /// A function of every lane.
    #[must_use]
    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self::gathered(|lane| function(self.lane(lane)))
    }

    /// `x` with its sign turned where `sign` is negative.
    #[must_use]
    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        Self::gathered(|lane| match sign.lane(lane) < 0.0 {
            true => -self.lane(lane),
            false => self.lane(lane),
        })
    }

    /// The angle of `(x, y)`, with `self` for `y`.
    #[must_use]
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        Self::gathered(|lane| math::atan2(self.lane(lane), x.lane(lane)))
    }

    /// The power with a constant exponent.
    #[must_use]
    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        self.map(|x| math::powf(x, exponent))
    }

    /// The power with a constant exponent that is no double.
    #[must_use]
    #[inline(always)]
    fn power(self, exponent: Self) -> Self {
        self.powf(exponent.lane(0))
    }

    /// Sine.
    #[must_use]
    #[inline(always)]
    fn sin(self) -> Self {
        self.map(math::sin)
    }

    /// Cosine.
    #[must_use]
    #[inline(always)]
    fn cos(self) -> Self {
        self.map(math::cos)
    }

    /// Tangent.
    #[must_use]
    #[inline(always)]
    fn tan(self) -> Self {
        self.map(math::tan)
    }

    /// Arc sine.
    #[must_use]
    #[inline(always)]
    fn asin(self) -> Self {
        self.map(math::asin)
    }

    /// Arc cosine.
    #[must_use]
    #[inline(always)]
    fn acos(self) -> Self {
        self.map(math::acos)
    }

    /// Arc tangent.
    #[must_use]
    #[inline(always)]
    fn atan(self) -> Self {
        self.map(math::atan)
    }

    /// The exponential.
    #[must_use]
    #[inline(always)]
    fn exp(self) -> Self {
        self.map(math::exp)
    }

    /// The natural logarithm.
    #[must_use]
    #[inline(always)]
    fn ln(self) -> Self {
        self.map(math::ln)
    }

    /// Hyperbolic sine.
    #[must_use]
    #[inline(always)]
    fn sinh(self) -> Self {
        self.map(math::sinh)
    }

    /// Hyperbolic cosine.
    #[must_use]
    #[inline(always)]
    fn cosh(self) -> Self {
        self.map(math::cosh)
    }

    /// Hyperbolic tangent.
    #[must_use]
    #[inline(always)]
    fn tanh(self) -> Self {
        self.map(math::tanh)
    }
}

impl Numbers for f64 {
    const LANES: usize = 1;
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn of(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        of_lane(0)
    }

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        *self
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        math::mul_add(self, b, c)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        math::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        math::abs(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
}

/// A fixed number of [`Numbers`]. Implemented by arrays.
pub trait Row<L>: Copy + Debug + Send + Sync + 'static {
    /// How many.
    const LEN: usize;

    /// All of them zero.
    const ZERO: Self;

    /// All of them, in order.
    fn as_slice(&self) -> &[L];

    /// All of them, in order, to be written.
    fn as_mut_slice(&mut self) -> &mut [L];
}

impl<L: Numbers, const D: usize> Row<L> for [L; D] {
    const LEN: usize = D;
    const ZERO: Self = [L::ZERO; D];

    #[inline(always)]
    fn as_slice(&self) -> &[L] {
        self
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [L] {
        self
    }
}
