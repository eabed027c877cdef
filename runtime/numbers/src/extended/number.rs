//! Numbers of more than double precision.

use core::cmp::Ordering;
use core::fmt;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::functions::{self, Wide};
use super::sums::Sum;
use crate::math;
use crate::numbers::Numbers;

/// Largest number of parts of an [`Extended`]. Constants of generated code have this many parts.
pub const MOST_PARTS: usize = 4;

/// A number that is the unevaluated sum of `PARTS` doubles: double-double, triple-double or quad-double arithmetic.
/// Each double adds about 53 bits, or 16 digits. The range is that of doubles.
///
/// `PARTS` is 1 to [`MOST_PARTS`]; other counts do not compile. With 1 part the arithmetic is that of `f64`, with the
/// elementary functions rounded from more digits.
///
/// Sums, products, quotients and roots have relative errors of a few units of `2^(-53 PARTS)`. If leading digits
/// cancel, a difference also has an error of about `2^(-53 (PARTS + 1))` times the larger operand. Elementary
/// functions are computed in 6 parts and rounded. Parts below `1e-308` lose digits, so numbers below
/// `1e-308 / 2^(-53 (PARTS - 1))` have fewer than the full number of digits. Sines, cosines and tangents of angles
/// beyond `2^50` are NaN. A result is infinite or NaN if it is so in `f64`.
///
/// ```
/// use dalembert_numbers::Extended;
///
/// let third = Extended::<3>::from(1.0) / Extended::from(3.0);
/// let error = third * Extended::from(3.0) - Extended::from(1.0);
/// assert!(error.nearest().abs() < 1e-47);
/// assert_eq!("0.1".parse::<Extended<2>>()?.parts(), [0.1, -5.551115123125783e-18]);
/// # Ok::<(), dalembert_numbers::NotDecimal>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Extended<const PARTS: usize> {
    /// Each part is the rounded sum of itself and all later parts.
    parts: [f64; PARTS],
}

impl<const PARTS: usize> Extended<PARTS> {
    /// Largest relative change of a number near 1 by rounding: `2^(-53 PARTS)`.
    pub const ROUNDING: f64 = {
        let bits = 53 * PARTS as u64;
        f64::from_bits((1023 - bits) << 52)
    };

    /// The sum of these numbers. The largest must come first.
    pub fn of_parts(parts: [f64; PARTS]) -> Self {
        let mut sum = Sum::of(&[0.0; PARTS]);
        for (level, part) in parts.into_iter().enumerate() {
            sum.add(part, level);
        }
        Self::summed(parts[0], sum)
    }

    /// The summands of the number. Each is the nearest double to the sum of itself and all later ones.
    pub const fn parts(&self) -> [f64; PARTS] {
        self.parts
    }

    /// The nearest double.
    pub const fn nearest(&self) -> f64 {
        self.parts[0]
    }

    /// The value of `sum`, or `leading` if that is not finite. `leading` approximates the sum.
    #[inline(always)]
    fn summed(leading: f64, sum: Sum<PARTS>) -> Self {
        if !leading.is_finite() {
            return Self::plain(leading);
        }
        let parts = sum.parts();
        match parts[0].is_finite() {
            true => Self { parts },
            false => Self::plain(parts[0]),
        }
    }

    /// The value of a double.
    #[inline(always)]
    pub(super) const fn plain(number: f64) -> Self {
        let mut parts = [0.0; PARTS];
        parts[0] = number;
        Self { parts }
    }

    /// The sum of these parts, which must not overlap.
    pub(super) const fn constant_of(parts: [f64; PARTS]) -> Self {
        Self { parts }
    }

    /// The number, rounded to `OTHER` parts.
    pub(super) fn converted<const OTHER: usize>(self) -> Extended<OTHER> {
        if self.parts[0] == 0.0 {
            // 0 keeps its sign.
            return Extended::plain(self.parts[0]);
        }
        let mut sum = Sum::<OTHER>::of(&[0.0; OTHER]);
        for (level, part) in self.parts.into_iter().enumerate() {
            sum.add(part, level.min(OTHER));
        }
        Extended::summed(self.parts[0], sum)
    }

    /// The number times a power of two.
    pub(super) fn scaled(self, power: f64) -> Self {
        let parts = self.parts.map(|part| part * power);
        match parts[0].is_finite() {
            true => Self { parts },
            false => Self::plain(parts[0]),
        }
    }

    /// `self b + c`, with one rounding to `PARTS` parts.
    #[inline]
    pub(super) fn fused(self, b: Self, c: Self) -> Self {
        let mut sum = Sum::of(&c.parts);
        for (i, x) in self.parts.into_iter().enumerate() {
            if x == 0.0 {
                continue;
            }
            for (j, y) in b.parts[..PARTS.min(PARTS + 1 - i)].iter().enumerate() {
                if *y != 0.0 {
                    sum.add_product(x, *y, i + j);
                }
            }
        }
        Self::summed(self.parts[0] * b.parts[0] + c.parts[0], sum)
    }

    /// The square root, one part after the other.
    #[inline]
    pub(super) fn root(self) -> Self {
        let first = math::sqrt(self.parts[0]);
        if !(first > 0.0 && first.is_finite()) {
            return Self::plain(first);
        }
        let mut root = Self::plain(first);
        for _ in 0..PARTS {
            let left = (-root).fused(root, self);
            root = root + Self::plain(left.parts[0] / (2.0 * first));
        }
        root
    }

    pub(super) fn is_negative(self) -> bool {
        self.parts[0] < 0.0
    }

    /// A function, computed in 6 parts and rounded.
    fn by(self, function: impl FnOnce(Wide) -> Wide) -> Self {
        function(self.converted()).converted()
    }
}

impl<const PARTS: usize> fmt::Debug for Extended<PARTS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Extended").field(&self.parts).finish()
    }
}

impl<const PARTS: usize> From<f64> for Extended<PARTS> {
    #[inline(always)]
    fn from(number: f64) -> Self {
        Self::plain(number)
    }
}

impl<const PARTS: usize> PartialOrd for Extended<PARTS> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let [one, two] = [self.parts[0], other.parts[0]];
        match one == two && one.is_finite() {
            true => (*self - *other).parts[0].partial_cmp(&0.0),
            false => one.partial_cmp(&two),
        }
    }
}

impl<const PARTS: usize> Add for Extended<PARTS> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let mut sum = Sum::of(&self.parts);
        for (level, part) in other.parts.into_iter().enumerate() {
            sum.add(part, level);
        }
        Self::summed(self.parts[0] + other.parts[0], sum)
    }
}

impl<const PARTS: usize> Sub for Extended<PARTS> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const PARTS: usize> Mul for Extended<PARTS> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = self.fused(other, Self::plain(0.0));
        match product.parts[0] == 0.0 {
            // The sign of 0 is that of the product of doubles.
            true => Self::plain(self.parts[0] * other.parts[0]),
            false => product,
        }
    }
}

impl<const PARTS: usize> Div for Extended<PARTS> {
    type Output = Self;

    /// Long division, one part of the quotient after the other.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.parts[0] / other.parts[0];
        if first == 0.0 || !first.is_finite() || !other.parts[0].is_finite() {
            return Self::plain(first);
        }
        let mut quotient = Sum::of(&[0.0; PARTS]);
        let mut left = self;
        for level in 0..=PARTS {
            let next = left.parts[0] / other.parts[0];
            quotient.add(next, level);
            if next == 0.0 {
                break;
            }
            left = other.fused(Self::plain(-next), left);
        }
        Self::summed(first, quotient)
    }
}

impl<const PARTS: usize> Neg for Extended<PARTS> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            parts: self.parts.map(|part| -part),
        }
    }
}

/// Functions of one number, each computed in 6 parts.
macro_rules! functions_in_more_parts {
    ($($name:ident)+) => {$(
        fn $name(self) -> Self {
            self.by(functions::$name)
        }
    )+};
}

impl<const PARTS: usize> Numbers for Extended<PARTS> {
    const LANES: usize = 1;
    const ZERO: Self = {
        assert!(
            PARTS >= 1 && PARTS <= MOST_PARTS,
            "extended numbers have 1 to 4 parts"
        );
        Self::plain(0.0)
    };

    #[inline(always)]
    fn of(number: f64) -> Self {
        Self::plain(number)
    }

    fn constant(parts: [f64; MOST_PARTS]) -> Self {
        Extended { parts }.converted()
    }

    fn inverse(k: usize) -> Self {
        Self::plain(1.0) / Self::plain(k as f64)
    }

    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        Self::plain(of_lane(0))
    }

    fn lane(&self, _: usize) -> f64 {
        self.parts[0]
    }

    fn is_below_zero(&self) -> Option<bool> {
        crate::numbers::sign_of(self.parts[0])
    }

    #[inline]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.fused(b, c)
    }

    fn sqrt(self) -> Self {
        self.root()
    }

    fn abs(self) -> Self {
        self.turned(self)
    }

    fn max(self, other: Self) -> Self {
        match self.parts[0].is_nan() || self < other {
            true => other,
            false => self,
        }
    }

    fn turned(self, sign: Self) -> Self {
        match sign.is_negative() {
            true => -self,
            false => self,
        }
    }

    fn atan2(self, x: Self) -> Self {
        functions::atan2(self.converted(), x.converted()).converted()
    }

    fn powf(self, exponent: f64) -> Self {
        self.by(|base| functions::power(base, Wide::plain(exponent)))
    }

    fn power(self, exponent: Self) -> Self {
        self.by(|base| functions::power(base, exponent.converted()))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = functions::sin_cos(self.converted());
        (sine.converted(), cosine.converted())
    }

    crate::functions_of_one_number!(functions_in_more_parts);
}
