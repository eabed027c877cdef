//! Quantities along a stretch of motion, as intervals of their values and of their rates.
//!
//! For a function `f` over numbers and a path `x(s)`, `f(x)` encloses the values and the rates of `f(x(s))` on the
//! stretch. The interval of the rates also holds the slopes of all chords, so that it is valid for functions with
//! kinks. If all rates have one sign, the function has at most one root on the stretch.
//!
//! Reference: R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis* (2009), chapter 6 (centred
//! forms).

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::numbers::Numbers;

/// Values and rates along a stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rated {
    /// All values on the stretch.
    pub value: Interval,
    /// All rates, and all slopes of chords.
    pub rate: Interval,
}

impl Rated {
    /// A number that does not change along the stretch.
    #[inline(always)]
    pub const fn steady(value: Interval) -> Self {
        Self {
            value,
            rate: Interval::point(0.0),
        }
    }

    /// A function of this quantity, with the given enclosures of its value and of its derivative.
    #[inline(always)]
    fn chain(self, value: Interval, derivative: Interval) -> Self {
        // A constant has the rate 0, however steep the function is.
        let rate = match self.rate == Interval::ZERO {
            true => Interval::ZERO,
            false => self.rate * derivative,
        };
        Self { value, rate }
    }
}

impl Add for Rated {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            rate: self.rate + other.rate,
        }
    }
}

impl Sub for Rated {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            rate: self.rate - other.rate,
        }
    }
}

impl Neg for Rated {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            rate: -self.rate,
        }
    }
}

impl Mul for Rated {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let rate = match (self.rate == Interval::ZERO, other.rate == Interval::ZERO) {
            (true, true) => Interval::ZERO,
            (true, false) => self.value * other.rate,
            (false, true) => self.rate * other.value,
            (false, false) => self.rate * other.value + self.value * other.rate,
        };
        Self { value, rate }
    }
}

impl Div for Rated {
    type Output = Self;

    // A quotient is the product with the inverse.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.inverse();
        self * other.chain(inverse, -inverse.square())
    }
}

impl Numbers for Rated {
    const LANES: usize = 1;
    const ZERO: Self = Self::steady(Interval::ZERO);

    crate::numbers::constants_of_intervals!();

    /// A number in the interval of values. It bounds neither values nor rates.
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.value.lane(lane)
    }

    #[inline(always)]
    fn is_below_zero(&self) -> Option<bool> {
        self.value.is_below_zero()
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn square(self) -> Self {
        self.chain(self.value.square(), self.value + self.value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, (root + root).inverse())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        match (self.value.lo < 0.0, self.value.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self {
                value: self.value.abs(),
                rate: self.rate.hull(-self.rate),
            },
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self {
            value: Numbers::max(self.value, other.value),
            rate: self.rate.hull(other.rate),
        }
    }

    /// Values may jump where the sign changes, so the rates are unbounded there.
    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        match (sign.value.lo < 0.0, sign.value.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self {
                value: self.value.hull(-self.value),
                rate: Interval::WHOLE,
            },
        }
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        let (y, x_value) = (self.value, x.value);
        let value = y.atan2(x_value);
        // A motion along the cut stays on its upper side.
        let is_along = y.is_zero() && self.rate.is_zero() && x_value.hi < 0.0;
        let is_off_the_cut = x_value.lo > 0.0 || y.excludes_zero() || is_along;
        let rate = match is_off_the_cut {
            true => {
                let squared = y.square() + x_value.square();
                (x_value * self.rate - y * x.rate) / squared
            }
            false => Interval::WHOLE,
        };
        Self { value, rate }
    }

    #[inline]
    fn powf(self, exponent: f64) -> Self {
        let slope = Interval::point(exponent) * self.value.powf_below(exponent);
        self.chain(self.value.powf(exponent), slope)
    }

    #[inline]
    fn power(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    crate::functions_of_one_number!(crate::functions_by_first_derivatives);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::tests::{FUNCTIONS, Sample};

    /// Values and slopes of chords of every function lie in the intervals that it returns for a stretch of a path.
    #[test]
    fn values_and_slopes_of_chords_lie_in_their_intervals() {
        for function in FUNCTIONS {
            for Sample { from, to } in function.stretches() {
                let stretch = Rated {
                    value: Interval::between(from, to),
                    rate: Interval::point(to - from),
                };
                let found = (function.rated)(stretch);
                let at = |part: f64| {
                    let x = (from + part * (to - from)).clamp(from.min(to), from.max(to));
                    (function.plain)(x)
                };
                for k in 0..16 {
                    let part = f64::from(k) / 16.0;
                    let chord = (at(part + 1.0 / 16.0) - at(part)) * 16.0;
                    let slack = 1e-12 * (1.0 + chord.abs() + found.value.magnitude());
                    let name = function.name;
                    assert!(found.value.contains(Interval::point(at(part))), "{name}");
                    assert!(
                        found.rate.lo - slack <= chord && chord <= found.rate.hi + slack,
                        "{name} from {from} to {to}: {chord} is not in {:?}",
                        found.rate
                    );
                }
            }
        }
    }

    #[test]
    fn a_function_that_may_have_no_value_has_the_whole_line() {
        let stretch = |lo: f64, hi: f64| Rated {
            value: Interval::new(lo, hi),
            rate: Interval::point(hi - lo),
        };
        for outside in [
            stretch(-0.1, 0.2).sqrt(),
            stretch(-0.1, 0.2).ln(),
            stretch(0.9, 1.1).asin(),
            stretch(0.9, 1.1).acos(),
            stretch(1.5, 1.6).tan(),
            Rated::of(1.0) / stretch(-1.0, 1.0),
        ] {
            assert!(outside.value.is_whole(), "{outside:?}");
            assert!((Rated::ZERO * outside).value.is_whole());
        }
    }
}
