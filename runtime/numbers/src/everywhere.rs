//! Numbers at all states at once: the interval of all values, and a flag for sharp variation.
//!
//! A function of the state is sharp if it may vary strongly within a small fraction of the range in which its arguments
//! vary. Polynomials of low degree, sines and cosines of the state are not sharp. A
//! quotient is not sharp while its denominator varies by a small factor only, as in the inverse of a moderate inertia.
//! The same holds for powers of such a number.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::numbers::Numbers;

/// Largest ratio of the absolute values of a divisor, or of the base of a power, that does not count as sharp. The
/// ratios of the factors of a product multiply.
const MOST_RATIO: f64 = 4.0;

/// Largest number of varying factors of a product that does not count as sharp.
const MOST_FACTORS: u32 = 12;

/// All values of a number, at all states.
///
/// # Examples
///
/// ```
/// use dalembert_numbers::{Everywhere, Numbers};
///
/// let inverse = |inertia: f64| {
///     let x = Everywhere::ANY;
///     Everywhere::of(1.0) / (Everywhere::of(1.0) + Everywhere::of(inertia) * x.sin().square())
/// };
/// assert!(!inverse(1.0).is_sharp());
/// assert!(inverse(100.0).is_sharp());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Everywhere {
    values: Interval,
    /// True if the number depends on the state.
    varies: bool,
    is_sharp: bool,
    /// Largest number of varying factors that one product of the expression has.
    factors: u32,
    /// Largest product of the ratios (largest to smallest absolute value) of the divisors and bases in one product.
    ratio: f64,
}

impl Everywhere {
    /// A component of the state, or the time.
    pub const ANY: Self = Self {
        values: Interval::WHOLE,
        varies: true,
        is_sharp: false,
        factors: 1,
        ratio: 1.0,
    };

    /// A number that does not depend on the state.
    #[inline(always)]
    const fn steady(values: Interval) -> Self {
        Self {
            values,
            varies: false,
            is_sharp: false,
            factors: 0,
            ratio: 1.0,
        }
    }

    /// True if the number may vary strongly within a small range of the state.
    pub fn is_sharp(&self) -> bool {
        self.is_sharp
    }

    /// A function of this number with the given values. `makes_sharp`: the function is sharp if its argument varies.
    fn under(self, values: Interval, makes_sharp: bool) -> Self {
        Self {
            values,
            is_sharp: self.is_sharp || (self.varies && makes_sharp),
            ..self
        }
    }

    /// The power with an exponent that is a whole number and not negative; `values` are the values of the power.
    fn raised(self, values: Interval, exponent: f64) -> Self {
        // NOTE: the conversion to `u32` saturates.
        let factors = self.factors.saturating_mul(exponent as u32);
        Self {
            factors,
            ratio: crate::math::powf(self.ratio, exponent),
            ..self.under(values, false)
        }
        .judged()
    }

    /// The product, with the given values. Numbers of factors add up, ratios multiply.
    fn multiplied(self, other: Self, values: Interval) -> Self {
        Self {
            factors: self.factors.saturating_add(other.factors),
            ratio: self.ratio * other.ratio,
            ..self.joined(other, values)
        }
        .judged()
    }

    /// The same number as a divisor (exponent 1), or as the base of a power with this exponent.
    fn as_base(self, exponent: f64) -> Self {
        let (least, most) = (self.values.mignitude(), self.values.magnitude());
        let ratio = match self.values.excludes_zero() {
            true => crate::math::powf(most / least, exponent),
            false => f64::INFINITY,
        };
        Self {
            ratio: match self.varies {
                true => self.ratio * ratio,
                false => 1.0,
            },
            ..self
        }
        .judged()
    }

    /// Marks the number as sharp if it has too many factors or too large a ratio.
    fn judged(self) -> Self {
        let is_steady = self.ratio <= MOST_RATIO && self.factors <= MOST_FACTORS;
        self.under(self.values, !is_steady)
    }

    /// A function of two numbers, with the given values. It is sharp if one of them is.
    fn joined(self, other: Self, values: Interval) -> Self {
        Self {
            values,
            varies: self.varies || other.varies,
            is_sharp: self.is_sharp || other.is_sharp,
            factors: self.factors.max(other.factors),
            ratio: self.ratio.max(other.ratio),
        }
    }
}

impl Add for Everywhere {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.joined(other, self.values + other.values)
    }
}

impl Sub for Everywhere {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.joined(other, self.values - other.values)
    }
}

impl Neg for Everywhere {
    type Output = Self;

    fn neg(self) -> Self {
        self.under(-self.values, false)
    }
}

impl Mul for Everywhere {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.multiplied(other, self.values * other.values)
    }
}

impl Div for Everywhere {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.multiplied(other.as_base(1.0), self.values / other.values)
    }
}

impl Numbers for Everywhere {
    const LANES: usize = 1;
    const ZERO: Self = Self::steady(Interval::ZERO);

    crate::numbers::constants_of_intervals!();

    /// One number of the interval, which bounds nothing.
    fn lane(&self, lane: usize) -> f64 {
        self.values.lane(lane)
    }

    fn is_below_zero(&self) -> Option<bool> {
        self.values.is_below_zero()
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn square(self) -> Self {
        self.raised(self.values.square(), 2.0)
    }

    fn sqrt(self) -> Self {
        self.powf(0.5)
    }

    fn abs(self) -> Self {
        self.under(self.values.abs(), true)
    }

    fn max(self, other: Self) -> Self {
        let larger = self.joined(other, Numbers::max(self.values, other.values));
        larger.under(larger.values, true)
    }

    /// The result jumps where the sign may change.
    fn turned(self, sign: Self) -> Self {
        let turned = self.joined(sign, self.values.turned(sign.values));
        turned.under(turned.values, sign.values.is_below_zero().is_none())
    }

    fn atan2(self, x: Self) -> Self {
        let angle = self.joined(x, self.values.atan2(x.values));
        angle.under(angle.values, true)
    }

    fn powf(self, exponent: f64) -> Self {
        let values = match exponent == 0.5 {
            true => self.values.sqrt(),
            false => self.values.powf(exponent),
        };
        match exponent >= 0.0 && crate::math::floor(exponent) == exponent {
            true => self.raised(values, exponent),
            false => self
                .as_base(crate::math::abs(exponent))
                .under(values, false),
        }
    }

    fn power(self, exponent: Self) -> Self {
        let power = self.joined(exponent, self.values.power(exponent.values));
        power.under(power.values, true)
    }

    crate::functions_of_one_number!(functions_at_all_states);
}

/// Sines and cosines vary at every state, so every step samples the variation. Other functions may be flat except in a
/// small region.
const SEEN_EVERYWHERE: [&str; 2] = ["sin", "cos"];

macro_rules! functions_at_all_states {
    ($($name:ident)+) => {$(
        fn $name(self) -> Self {
            Self {
                factors: self.factors.min(1),
                ..self.under(self.values.$name(), !SEEN_EVERYWHERE.contains(&stringify!($name)))
            }
        }
    )+};
}
use functions_at_all_states;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::tests::FUNCTIONS;

    /// `1 / (1 + inertia sin(x)^2)`
    fn inverse_inertia(inertia: f64) -> Everywhere {
        let swing = Everywhere::of(inertia) * Everywhere::ANY.sin().square();
        Everywhere::of(1.0) / (Everywhere::of(1.0) + swing)
    }

    #[test]
    fn quotients_are_sharp_where_their_denominators_change_much() {
        assert!(!inverse_inertia(2.9).is_sharp());
        assert!(inverse_inertia(3.1).is_sharp());
        assert!(inverse_inertia(-0.9).is_sharp());
        let distance = Everywhere::of(1.0) / (Everywhere::of(1e-6) + Everywhere::ANY.square());
        assert!(distance.is_sharp());
        assert!((distance - distance).sin().is_sharp());
    }

    #[test]
    fn powers_are_sharp_where_their_bases_change_much() {
        let inertia = Everywhere::of(2.0) + Everywhere::ANY.cos();
        assert!(!inertia.sqrt().is_sharp());
        assert!(!inertia.powf(-1.2).is_sharp());
        assert!(inertia.powf(-1.5).is_sharp());
        assert!(inertia.powf(-500.5).is_sharp());
        assert!(!Everywhere::ANY.powf(3.0).is_sharp());
        assert!(Everywhere::ANY.powf(40.0).is_sharp());
        assert!(!Everywhere::of(0.3).powf(40.0).is_sharp());
        let sine = Everywhere::ANY.powf(3.0).sin();
        assert!(!sine.square().square().is_sharp());
        assert!(sine.square().square().square().square().is_sharp());
        assert!(Everywhere::ANY.powf(-3.0).is_sharp());
        assert!(
            (Everywhere::of(1.0) + Everywhere::ANY.cos())
                .sqrt()
                .is_sharp()
        );
    }

    #[test]
    fn products_are_sharp_where_many_factors_change() {
        let cosine = Everywhere::ANY.cos();
        let sixth = cosine.square() * cosine.square() * cosine.square();
        assert!(!sixth.is_sharp());
        assert!((sixth * sixth * cosine).is_sharp());
        assert!(!(inverse_inertia(0.9) * inverse_inertia(0.9)).is_sharp());
        assert!((inverse_inertia(1.5) * inverse_inertia(1.5)).is_sharp());
        assert!((inverse_inertia(2.9) / (Everywhere::of(2.0) + cosine)).is_sharp());
    }

    #[test]
    fn functions_of_the_parameters_are_never_sharp() {
        let parameter = Everywhere::of(1e6);
        assert!(!(Everywhere::ANY * (-parameter).exp()).is_sharp());
        assert!(!(Everywhere::ANY / Everywhere::of(1e-9)).is_sharp());
        assert!(!Everywhere::ANY.turned(-parameter).is_sharp());
        assert!(Everywhere::ANY.turned(Everywhere::ANY).is_sharp());
    }

    #[test]
    fn every_other_function_but_sine_and_cosine_is_sharp() {
        let steady = ["square", "sin", "cos", "fused"];
        for function in FUNCTIONS {
            let is_steady = steady.contains(&function.name);
            let found = (function.everywhere)(Everywhere::ANY);
            assert_eq!(found.is_sharp(), !is_steady, "{}", function.name);
        }
    }

    #[test]
    fn values_are_those_of_intervals() {
        for function in FUNCTIONS {
            let found = (function.everywhere)(Everywhere::ANY).values;
            let known = (function.interval)(Interval::WHOLE);
            assert_eq!(found, known, "{}", function.name);
        }
    }
}
