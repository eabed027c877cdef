//! Closed intervals of doubles. Each operation rounds outwards, so an interval contains every value that it encloses.
//!
//! Sums, products, quotients and square roots of doubles are correctly rounded, so one step outwards encloses them.
//! Elementary functions are those of `libm`. Their errors may exceed one unit in the last place: up to 1.6 units at
//! random arguments (`sinh`), and more at arguments found by searches for the largest error (P. Zimmermann, *Accuracy
//! of Mathematical Functions in Single, Double, Extended Double and Quadruple Precision*, 2021). Their results are
//! therefore widened by [`STEPS`] steps. Endpoints may be infinite.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Mul, Neg};

use crate::rational::Rational;

/// Number of steps outwards after an elementary function; a step leads to the next double.
const STEPS: usize = 4;
/// For arguments with a larger absolute value, sin and cos give the range `[-1, 1]`.
const FAR: f64 = 1e9;

/// All numbers from `lo` to `hi`.
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// All real numbers.
    pub const WHOLE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// Interval between two numbers.
    pub fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// The interval that contains one number only.
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Enclosure of an exact number.
    pub fn rational(value: &Rational) -> Self {
        match value.to_i64() {
            Some(integer) if integer.unsigned_abs() < 1 << 53 => Self::point(integer as f64),
            _ => outwards(value.to_f64(), value.to_f64(), 1),
        }
    }

    /// Enclosure of pi.
    pub fn pi() -> Self {
        Self::new(PI, PI.next_up())
    }

    /// True if 0 is outside.
    pub fn excludes_zero(self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }

    /// The largest absolute value.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest absolute value.
    pub fn mignitude(self) -> f64 {
        match self.excludes_zero() {
            true => self.lo.abs().min(self.hi.abs()),
            false => 0.0,
        }
    }

    /// `1 / a`; `None` if 0 is inside.
    pub fn inverse(self) -> Option<Self> {
        self.excludes_zero()
            .then(|| outwards(1.0 / self.hi, 1.0 / self.lo, 1))
    }

    /// `a^exponent`; `None` if the power may be undefined somewhere in the interval.
    pub fn power(self, exponent: &Rational) -> Option<Self> {
        if exponent.is_negative() {
            return self.power(&-exponent)?.inverse();
        }
        match exponent.to_i64() {
            Some(steps) => Some(self.integer_power(steps.unsigned_abs())),
            None if self.lo < 0.0 => None,
            None if *exponent == Rational::HALF => {
                let root = outwards(self.lo.sqrt(), self.hi.sqrt(), 1);
                Some(Self::new(root.lo.max(0.0), root.hi))
            }
            None => {
                let power = |x: f64| libm::pow(x, exponent.to_f64());
                // NOTE: the exponent `e` is rounded too, with a relative error `u`. For doubles `x`, the factor `x^(e
                // u)` differs from 1 by less than `746 u e`.
                let (lo, hi) = (power(self.lo), power(self.hi));
                let slack = 2e-13 * (1.0 + exponent.to_f64());
                Some(Self::new(
                    (lo * (1.0 - slack)).max(0.0),
                    (hi * (1.0 + slack)).next_up(),
                ))
            }
        }
    }

    fn integer_power(self, steps: u64) -> Self {
        let base = match steps.is_multiple_of(2) {
            true => self.abs(),
            false => self,
        };
        // Odd powers are increasing; even powers are increasing for a nonnegative base.
        let (mut lo, mut hi) = (Self::point(1.0), Self::point(1.0));
        for _ in 0..steps.min(64) {
            lo = lo * Self::point(base.lo);
            hi = hi * Self::point(base.hi);
        }
        match steps > 64 {
            true => Self::WHOLE,
            false => Self::new(lo.lo, hi.hi),
        }
    }

    /// `|a|`
    pub fn abs(self) -> Self {
        match (self.lo >= 0.0, self.hi <= 0.0) {
            (true, _) => self,
            (_, true) => -self,
            _ => Self::new(0.0, self.magnitude()),
        }
    }

    /// Range of a nondecreasing function.
    pub fn increasing(self, f: impl Fn(f64) -> f64) -> Self {
        outwards(f(self.lo), f(self.hi), STEPS)
    }

    /// `sin a`
    pub fn sin(self) -> Self {
        match self == Self::point(0.0) {
            true => self,
            false => self.wave(libm::sin, FRAC_PI_2),
        }
    }

    /// `cos a`
    pub fn cos(self) -> Self {
        self.wave(libm::cos, 0.0)
    }

    /// Range of a sine wave `f` with its maximum at `crest`.
    fn wave(self, f: fn(f64) -> f64, crest: f64) -> Self {
        // An interval of nearly a full period gives the whole range. On a shorter one, an extreme value is assumed if
        // its place lies in the interval widened by a margin, for the rounding of `place` and of multiples of 2 pi.
        if self.magnitude() > FAR || self.hi - self.lo > 6.2 {
            return Self::new(-1.0, 1.0);
        }
        let margin = 1e-6;
        let meets = |place: f64| {
            let turns = ((self.lo - margin - place) / (2.0 * PI)).ceil();
            place + turns * 2.0 * PI <= self.hi + margin
        };
        let (a, b) = (f(self.lo), f(self.hi));
        let ends = outwards(a.min(b), a.max(b), STEPS);
        Self::new(
            if meets(crest + PI) {
                -1.0
            } else {
                ends.lo.max(-1.0)
            },
            if meets(crest) { 1.0 } else { ends.hi.min(1.0) },
        )
    }

    /// `cosh a`
    pub fn cosh(self) -> Self {
        let range = self.abs().increasing(libm::cosh);
        Self::new(range.lo.max(1.0), range.hi)
    }

    /// The intersection with `[lo, hi]`, which must not be empty.
    pub fn within(self, lo: f64, hi: f64) -> Self {
        Self::new(self.lo.clamp(lo, hi), self.hi.clamp(lo, hi))
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self == Self::ZERO, other == Self::ZERO) {
            (true, _) => other,
            (_, true) => self,
            _ => outwards(self.lo + other.lo, self.hi + other.hi, 1),
        }
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let ends = [
            product(self.lo, other.lo),
            product(self.lo, other.hi),
            product(self.hi, other.lo),
            product(self.hi, other.hi),
        ];
        let is_unit = |factor: Self| factor == Self::point(1.0) || factor == Self::point(-1.0);
        let is_exact = is_unit(self) || is_unit(other);
        let lo = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        outwards(lo, hi, usize::from(!is_exact))
    }
}

fn outwards(mut lo: f64, mut hi: f64, steps: usize) -> Interval {
    if lo.is_nan() || hi.is_nan() {
        return Interval::WHOLE;
    }
    for _ in 0..steps {
        (lo, hi) = (lo.next_down(), hi.next_up());
    }
    Interval::new(lo, hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that an interval contains a value.
    fn contains(range: Interval, value: f64, what: &str) {
        assert!(
            range.lo <= value && value <= range.hi,
            "{what}: {value} is not in {range:?}"
        );
    }

    #[test]
    fn values_inside_lie_in_the_ranges() {
        type Enclosed = (fn(Interval) -> Interval, fn(f64) -> f64);
        let functions: [Enclosed; 6] = [
            (Interval::sin, f64::sin),
            (Interval::cos, f64::cos),
            (Interval::cosh, f64::cosh),
            (Interval::abs, f64::abs),
            (|x| x.increasing(libm::tanh), f64::tanh),
            (|x| x.power(&Rational::from(3)).unwrap(), |x| x * x * x),
        ];
        for start in -40..40 {
            for width in [0.0, 0.01, 0.3, 2.0, 7.0] {
                let lo = f64::from(start) * 0.37;
                let range = Interval::new(lo, lo + width);
                for (enclose, f) in functions {
                    for k in 0..=16 {
                        let x = (lo + width * f64::from(k) / 16.0).clamp(range.lo, range.hi);
                        contains(enclose(range), f(x), "a function");
                    }
                }
            }
        }
    }

    #[test]
    fn extreme_values_are_met_inside() {
        let bump = Interval::new(1.0, 2.0).sin();
        assert!(bump.hi == 1.0 && bump.lo > 0.8);
        let dip = Interval::new(3.0, 4.0).cos();
        assert!(dip.lo == -1.0 && dip.hi < -0.6);
    }

    #[test]
    fn infinite_ends_are_carried() {
        let ray = Interval::new(2.0, f64::INFINITY);
        assert_eq!(ray * Interval::ZERO, Interval::ZERO);
        let square = ray.power(&Rational::from(2)).unwrap();
        assert!(square.lo > 3.99 && square.hi == f64::INFINITY);
        assert!(ray.inverse().unwrap().lo <= 0.0);
        assert_eq!(Interval::new(-1.0, 1.0).inverse(), None);
    }
}
