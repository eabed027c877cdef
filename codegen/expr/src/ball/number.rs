//! Balls and their arithmetic.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;

use super::bound;
use super::wide::{BITS, Wide};
use crate::rational::Rational;

/// A ball with a middle above `2^LARGEST` becomes the whole real line, one with a middle below `2^-LARGEST` a ball
/// around 0.
const LARGEST: i32 = 1100;
/// Newton steps from the 50 bits of doubles to 256.
pub(super) const NEWTON_STEPS: usize = 3;
/// Largest absolute value of an integer exponent that is evaluated.
const HIGHEST_POWER: u64 = 1 << 16;

/// All numbers whose distance from the middle is at most the radius, which may be infinite.
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct Ball {
    pub(super) middle: Wide,
    pub(super) radius: f64,
}

impl Ball {
    /// The number 0.
    pub const ZERO: Self = Self {
        middle: Wide::ZERO,
        radius: 0.0,
    };

    /// All real numbers.
    pub const WHOLE: Self = Self {
        middle: Wide::ZERO,
        radius: f64::INFINITY,
    };

    /// The number pi.
    pub fn pi() -> Self {
        let words = [
            0xC90F_DAA2_2168_C234,
            0xC4C6_628B_80DC_1CD1,
            0x2902_4E08_8A67_CC74,
            0x020B_BEA6_3B13_9B22,
        ];
        // The digits of pi, truncated.
        Self {
            middle: Wide::of_words(words, 2 - BITS),
            radius: bound::power_of_two(2 - BITS),
        }
    }

    /// An integer.
    pub fn integer(value: i64) -> Self {
        Self::exact(Wide::integer(value))
    }

    /// A finite double, exactly.
    pub fn double(value: f64) -> Self {
        Self::exact(Wide::double(value))
    }

    /// A rational number.
    pub fn rational(value: &Rational) -> Self {
        if let Some(integer) = value.to_i64() {
            return Self::integer(integer);
        }
        let (numer, denom) = (value.numer(), value.denom());
        // The quotient has at least 256 bits.
        let shift = (BITS + 1 + denom.bits() as i32 - numer.bits() as i32).max(0);
        let shifted = numer << shift;
        let quotient = &shifted / &denom;
        let rest = shifted - &quotient * denom;
        let (middle, mut error) = Wide::scaled(&quotient, -shift);
        if rest != BigInt::from(0) {
            error = bound::sum(error, bound::power_of_two(-shift));
        }
        Self::of(middle, error)
    }

    /// The same ball with `radius` added to its radius.
    pub fn widened(self, radius: f64) -> Self {
        Self::of(self.middle, bound::sum(self.radius, radius))
    }

    /// The middle as a ball of radius 0.
    pub fn midpoint(self) -> Self {
        Self::exact(self.middle)
    }

    /// A double near the middle.
    pub fn nearest(self) -> f64 {
        self.middle.nearest()
    }

    /// Upper bound of the distance between the numbers in the ball and the middle.
    pub fn radius(self) -> f64 {
        self.radius
    }

    /// The least and the largest number of the ball, each as a ball.
    pub fn ends(self) -> [Self; 2] {
        let (middle, radius) = (self.midpoint(), Self::double(self.radius));
        [middle - radius, middle + radius]
    }

    /// True if the radius is finite.
    pub fn is_bounded(self) -> bool {
        self.radius.is_finite()
    }

    /// True for the number 0 alone.
    pub fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// Common sign of all numbers in the ball; `None` if it contains 0 or numbers of both signs.
    pub fn sign(self) -> Option<Ordering> {
        match (self.mignitude() > 0.0, self.middle.is_negative) {
            (false, _) => None,
            (true, true) => Some(Ordering::Less),
            (true, false) => Some(Ordering::Greater),
        }
    }

    /// Upper bound of the largest absolute value.
    pub fn magnitude(self) -> f64 {
        bound::sum(self.middle.at_most(), self.radius)
    }

    /// Lower bound of the smallest absolute value; 0 if that is too small for doubles.
    pub fn mignitude(self) -> f64 {
        bound::difference(self.middle.at_least(), self.radius)
    }

    pub(super) fn exact(middle: Wide) -> Self {
        Self {
            middle,
            radius: 0.0,
        }
    }

    /// A ball whose middle stays within the range of exponents.
    pub(super) fn of(middle: Wide, radius: f64) -> Self {
        match middle.is_zero() {
            true => Self { middle, radius },
            false if radius == f64::INFINITY || middle.order() > LARGEST => Self::WHOLE,
            false if middle.order() < -LARGEST => Self {
                middle: Wide::ZERO,
                radius: bound::sum(radius, f64::MIN_POSITIVE),
            },
            false => Self { middle, radius },
        }
    }

    /// `self / divisor`
    pub(super) fn divided(self, divisor: u64) -> Self {
        let (middle, error) = self.middle.divided(divisor);
        let radius = bound::quotient(self.radius, divisor as f64);
        Self::of(middle, bound::sum(radius, error))
    }

    /// `self * 2^shift`
    pub(super) fn shifted(self, shift: i32) -> Self {
        let radius = bound::product(self.radius, bound::power_of_two(shift));
        Self::of(self.middle.shifted(shift), radius)
    }

    /// `1 / self`; `None` if 0 is inside.
    ///
    /// For every `x` inside and any `y`: `|1/x - y| = |1 - x y|/|x|`.
    pub fn inverse(self) -> Option<Self> {
        self.sign()?;
        let order = self.middle.order();
        // `scaled` is in [1/2, 1).
        let scaled = Self::exact(self.middle.shifted(-order));
        let one = Self::integer(1);
        let mut inverse = Self::double(1.0 / scaled.nearest());
        for _ in 0..NEWTON_STEPS {
            let rest = one.sub(scaled.mul(inverse));
            inverse = inverse.add(inverse.mul(rest)).midpoint();
        }
        let inverse = Self::exact(inverse.middle.shifted(-order));
        let residual = one.sub(self.mul(inverse)).magnitude();
        Some(Self::of(
            inverse.middle,
            bound::quotient(residual, self.mignitude()),
        ))
    }

    /// `sqrt(self)`; `None` if the ball may contain negative numbers, or 0 beside others.
    ///
    /// For every `x` inside and any `y > 0`: `|sqrt(x) - y| = |x - y^2|/(sqrt(x) + y) <= |x - y^2|/y`.
    pub fn sqrt(self) -> Option<Self> {
        if self.is_zero() {
            return Some(self);
        }
        if self.sign()? == Ordering::Less {
            return None;
        }
        let half = self.middle.order().div_euclid(2);
        // `scaled` is in [1/2, 2).
        let scaled = Self::exact(self.middle.shifted(-2 * half));
        let one = Self::integer(1);
        let mut inverse = Self::double(1.0 / scaled.nearest().sqrt());
        for _ in 0..NEWTON_STEPS {
            let rest = one.sub(scaled.mul(inverse.mul(inverse)));
            inverse = inverse.add(inverse.mul(rest).shifted(-1)).midpoint();
        }
        let root = Self::exact(scaled.mul(inverse).middle.shifted(half));
        if root.sign()? == Ordering::Less {
            return None;
        }
        let residual = self.sub(root.mul(root)).magnitude();
        Some(Self::of(
            root.middle,
            bound::quotient(residual, root.mignitude()),
        ))
    }

    /// `self^exponent`: by multiplications for integers, by square roots for halves, else by the logarithm. `None` if a
    /// number in the ball may have no power, or if an integer exponent is too large.
    pub fn power(self, exponent: &Rational) -> Option<Self> {
        match exponent.to_small() {
            Some((n, 1)) => self.integer_power(n),
            Some((n, 2)) => self.sqrt()?.integer_power(n),
            _ if self.is_zero() && exponent.is_positive() => Some(self),
            _ => self.ln()?.mul(Self::rational(exponent)).exp(),
        }
    }

    fn integer_power(self, exponent: i64) -> Option<Self> {
        let mut rest = exponent.unsigned_abs();
        if rest > HIGHEST_POWER {
            return None;
        }
        let (mut square, mut result) = (self, Self::integer(1));
        while rest > 0 {
            if rest % 2 == 1 {
                result = result.mul(square);
            }
            rest /= 2;
            if rest > 0 {
                square = square.mul(square);
            }
        }
        match exponent < 0 {
            true => result.inverse(),
            false => Some(result),
        }
    }

    /// `|self|`
    pub fn abs(self) -> Self {
        match self.sign() {
            Some(Ordering::Less) => self.neg(),
            Some(_) => self,
            None if self.is_zero() => self,
            None => Self::of(Wide::ZERO, self.magnitude()),
        }
    }
}

impl Add for Ball {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (middle, error) = self.middle.add(other.middle);
        let radius = bound::sum(self.radius, other.radius);
        Self::of(middle, bound::sum(radius, error))
    }
}

impl Neg for Ball {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            middle: self.middle.neg(),
            ..self
        }
    }
}

impl Sub for Ball {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }
}

impl Mul for Ball {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        let (middle, mut radius) = self.middle.mul(other.middle);
        if self.radius > 0.0 {
            let part = bound::product(self.radius, other.middle.at_most());
            radius = bound::sum(radius, part);
        }
        if other.radius > 0.0 {
            radius = bound::sum(radius, bound::product(other.radius, self.magnitude()));
        }
        Self::of(middle, radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that a number in `value` is at most one radius away from the middle of the ball.
    fn contains(ball: Ball, value: Ball, what: &str) {
        let distance = ball.midpoint().sub(value);
        assert!(
            distance.mignitude() <= ball.radius(),
            "{what}: {} is not {}",
            ball.nearest(),
            value.nearest()
        );
    }

    #[test]
    fn quotients_and_roots_are_enclosed() {
        for value in [3.0, 0.7, 1e-200, 1e200, 1.0, 123_456_789.0, 1.0 - 1e-16] {
            let ball = Ball::double(value);
            let inverse = ball.inverse().unwrap();
            contains(ball.mul(inverse), Ball::integer(1), "a quotient");
            let root = ball.sqrt().unwrap();
            contains(root.mul(root), ball, "a root");
            for found in [inverse, root] {
                // Radii are doubles, so radii of tiny numbers stop at the smallest doubles.
                let bound = (1e-74 * found.nearest()).max(1e-300);
                assert!(found.radius() <= bound, "{value}: {:e}", found.radius());
            }
        }
        assert_eq!(Ball::double(4.0).sqrt(), Some(Ball::integer(2)));
        assert_eq!(Ball::double(0.25).inverse(), Some(Ball::integer(4)));
    }

    #[test]
    fn balls_of_some_size_contain_the_values_inside() {
        let wide = Ball::double(2.0).widened(0.5);
        for inside in [1.5, 1.75, 2.25, 2.5] {
            let value = Ball::double(inside);
            contains(wide.inverse().unwrap(), value.inverse().unwrap(), "1/x");
            contains(wide.sqrt().unwrap(), value.sqrt().unwrap(), "sqrt(x)");
            contains(wide.mul(wide), value.mul(value), "x^2");
            let exponent = Rational::new(-7, 3);
            let [of_wide, of_value] = [wide, value].map(|base| base.power(&exponent).unwrap());
            contains(of_wide, of_value, "x^(-7/3)");
        }
        let around = Ball::ZERO.widened(1.0);
        assert_eq!(around.inverse(), None);
        assert_eq!(around.sqrt(), None);
        assert_eq!(around.sign(), None);
        contains(around.abs(), Ball::integer(1), "|x|");
    }

    #[test]
    fn fractions_are_enclosed_and_integers_exact() {
        for (n, d) in [(1, 3), (-36, 100), (i64::MAX, 7), (5, i64::MAX), (3, 8)] {
            let ball = Ball::rational(&Rational::new(n, d));
            let product = ball.mul(Ball::integer(d));
            contains(product, Ball::integer(n), "a fraction");
            assert!(ball.radius() <= 1e-75 * ball.nearest().abs());
        }
        assert_eq!(Ball::rational(&Rational::new(3, 8)).radius(), 0.0);
        let long = Rational::from_decimal(&format!("0.{}", "7".repeat(300))).unwrap();
        let sevenths = Ball::rational(&long).mul(Ball::integer(9));
        contains(sevenths, Ball::integer(7), "0.777...");
    }

    #[test]
    fn numbers_beyond_the_range_have_no_bounds() {
        let mut large = Ball::double(1e300);
        for _ in 0..40 {
            large = large.mul(large);
        }
        assert!(!large.is_bounded() && large.sign().is_none());
        let mut small = Ball::double(1e-300);
        for _ in 0..40 {
            small = small.mul(small);
        }
        assert!(small.is_bounded() && small.sign().is_none());
        assert!(!small.add(Ball::WHOLE).is_bounded());
        assert!(Ball::ZERO.mul(Ball::WHOLE).is_zero());
        assert!(!Ball::WHOLE.mul(Ball::integer(3)).is_bounded());
    }
}
