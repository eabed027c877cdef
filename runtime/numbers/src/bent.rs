//! Numbers along straight lines through a box: enclosures of values, first and second derivatives along the line.
//!
//! Every coordinate has an interval of values (the box) and an interval of rates. For such arguments `f(x)` encloses
//! the value, the rate and the second derivative (bend) of `f` along every line with these rates. It therefore bounds
//! the first and second derivatives of `f` in all directions at once.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::numbers::Numbers;

/// Enclosures of a function and of its first two derivatives along lines through a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bent {
    /// Encloses all values.
    pub value: Interval,
    /// Encloses all first derivatives along the lines.
    pub rate: Interval,
    /// Encloses all second derivatives along the lines.
    pub bend: Interval,
}

impl Bent {
    /// No information, for functions that may be undefined in the box.
    pub const ANYTHING: Self = Self {
        value: Interval::WHOLE,
        rate: Interval::WHOLE,
        bend: Interval::WHOLE,
    };

    /// A coordinate along straight lines: its interval of values, and rates of absolute value up to `rate`.
    pub const fn line(value: Interval, rate: f64) -> Self {
        Self {
            value,
            rate: Interval::new(-rate, rate),
            bend: Interval::ZERO,
        }
    }

    #[inline(always)]
    fn is_steady(&self) -> bool {
        self.rate == Interval::ZERO && self.bend == Interval::ZERO
    }

    #[inline(always)]
    const fn steady(value: Interval) -> Self {
        Self {
            value,
            rate: Interval::ZERO,
            bend: Interval::ZERO,
        }
    }

    /// Chain rule: a function with this value and these first two derivatives, applied to `self`.
    #[inline(always)]
    fn chain(self, value: Interval, first: Interval, second: impl FnOnce() -> Interval) -> Self {
        match self.is_steady() {
            true => Self::steady(value),
            false => Self {
                value,
                rate: first * self.rate,
                bend: second() * self.rate.square() + first * self.bend,
            },
        }
    }
}

impl Add for Bent {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            rate: self.rate + other.rate,
            bend: self.bend + other.bend,
        }
    }
}

impl Sub for Bent {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            rate: self.rate - other.rate,
            bend: self.bend - other.bend,
        }
    }
}

impl Neg for Bent {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            value: -self.value,
            rate: -self.rate,
            bend: -self.bend,
        }
    }
}

impl Mul for Bent {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        match (self.is_steady(), other.is_steady()) {
            (true, true) => Self::steady(value),
            (true, false) => Self {
                value,
                rate: self.value * other.rate,
                bend: self.value * other.bend,
            },
            (false, true) => Self {
                value,
                rate: self.rate * other.value,
                bend: self.bend * other.value,
            },
            (false, false) => {
                let mixed = self.rate * other.rate;
                Self {
                    value,
                    rate: self.rate * other.value + self.value * other.rate,
                    bend: self.bend * other.value + (mixed + mixed) + self.value * other.bend,
                }
            }
        }
    }
}

impl Div for Bent {
    type Output = Self;

    // A quotient is the product with the inverse.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.inverse();
        let square = inverse.square();
        let second = square * inverse;
        self * other.chain(inverse, -square, || second + second)
    }
}

impl Numbers for Bent {
    const LANES: usize = 1;
    const ZERO: Self = Self::steady(Interval::ZERO);

    crate::numbers::constants_of_intervals!();

    /// One number inside the interval of values, which bounds nothing.
    fn lane(&self, lane: usize) -> f64 {
        self.value.lane(lane)
    }

    fn is_below_zero(&self) -> Option<bool> {
        self.value.is_below_zero()
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn square(self) -> Self {
        let two = Interval::point(2.0);
        self.chain(self.value.square(), self.value + self.value, || two)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let first = (root + root).inverse();
        let cubed = self.value * root;
        let four = Interval::point(4.0);
        self.chain(root, first, || -(four * cubed).inverse())
    }

    /// At a change of the sign the result has a kink: its derivatives are unbounded.
    fn abs(self) -> Self {
        match (self.value.lo < 0.0, self.value.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self {
                value: self.value.abs(),
                ..Self::ANYTHING
            },
        }
    }

    fn max(self, other: Self) -> Self {
        let ahead = self.value - other.value;
        match (ahead.lo >= 0.0, ahead.hi <= 0.0) {
            (true, _) => self,
            (_, true) => other,
            _ => Self {
                value: Numbers::max(self.value, other.value),
                ..Self::ANYTHING
            },
        }
    }

    /// At a change of the sign the result jumps: its derivatives are unbounded.
    fn turned(self, sign: Self) -> Self {
        match (sign.value.lo < 0.0, sign.value.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self {
                value: self.value.hull(-self.value),
                ..Self::ANYTHING
            },
        }
    }

    fn atan2(self, x: Self) -> Self {
        let value = self.value.atan2(x.value);
        let is_still = self.value.is_zero() && self.rate.is_zero() && self.bend.is_zero();
        // A motion along the cut stays on its upper side.
        let is_along = is_still && x.value.hi < 0.0;
        let is_off_the_cut = x.value.lo > 0.0 || self.value.excludes_zero() || is_along;
        if !is_off_the_cut {
            return Self {
                value,
                ..Self::ANYTHING
            };
        }
        // The rate of an angle is the quotient `across / squared`; the bend is the derivative of this quotient.
        let squared = self.value.square() + x.value.square();
        let across = x.value * self.rate - self.value * x.rate;
        let along = x.value * x.rate + self.value * self.rate;
        let rate = across / squared;
        let change = x.value * self.bend - self.value * x.bend;
        Self {
            value,
            rate,
            bend: (change - (rate + rate) * along) / squared,
        }
    }

    fn powf(self, exponent: f64) -> Self {
        let factor = Interval::point(exponent);
        let below = Interval::point(exponent) - Interval::point(1.0);
        let first = factor * self.value.powf_below(exponent);
        let second = first * below * self.value.inverse();
        self.chain(self.value.powf(exponent), first, || second)
    }

    fn power(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (
            self.chain(sine, cosine, || -sine),
            self.chain(cosine, -sine, || -cosine),
        )
    }

    crate::functions_of_one_number!(crate::functions_by_derivatives);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::tests::{FUNCTIONS, Sample};

    #[test]
    fn differences_lie_in_their_intervals() {
        for function in FUNCTIONS {
            for Sample { from, to } in function.stretches() {
                let width = (to - from).abs();
                if width < 1e-3 {
                    continue;
                }
                let found = (function.bent)(Bent::line(Interval::between(from, to), 1.0));
                let h = 1e-3 * width;
                let at = |x: f64| (function.plain)(x.clamp(from.min(to), from.max(to)));
                for k in 1..16 {
                    let x = from + (to - from) * f64::from(k) / 16.0;
                    let [before, here, after] = [x - h, x, x + h].map(at);
                    let size = 1.0 + here.abs().max(before.abs()).max(after.abs());
                    let rate = (after - before) / (2.0 * h);
                    let bend = (after - 2.0 * here + before) / (h * h);
                    let name = function.name;
                    assert!(found.value.contains(Interval::point(here)), "{name}");
                    let rounding = 1e-14 * size;
                    assert!(
                        found
                            .rate
                            .widened(rounding / h)
                            .contains(Interval::point(rate)),
                        "{name} from {from} to {to}: {rate} is not in {:?}",
                        found.rate
                    );
                    assert!(
                        found
                            .bend
                            .widened(4.0 * rounding / (h * h))
                            .contains(Interval::point(bend)),
                        "{name} from {from} to {to}: {bend} is not in {:?}",
                        found.bend
                    );
                }
            }
        }
    }
}
