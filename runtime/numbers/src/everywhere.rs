//! Numbers at all states at once: the interval of all values that they have, and whether they can be sharp there.
//!
//! A function of the state is sharp if it may change within a range of its arguments that is small beside the range in
//! which they change. Polynomials of low degree, sines and cosines of the state are not sharp. A quotient is not sharp while its
//! denominator stays within a small factor, as that of an inverted inertia does; nor is a power of such a number.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::numbers::Numbers;

/// Largest ratio of the values of a denominator that leaves its quotients as steady as the denominator.
const MOST_RATIO: f64 = 4.0;

/// Power from which on a quantity need not change as steadily as the quantity.
const SHARP_POWER: u32 = 8;

/// All values of a number.
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
    /// Power to which some part of the number is raised.
    power: u32,
}

impl Everywhere {
    /// A component of the state, or the time.
    pub const ANY: Self = Self {
        values: Interval::WHOLE,
        varies: true,
        is_sharp: false,
        power: 1,
    };

    /// A number that does not depend on the state.
    #[inline(always)]
    const fn steady(values: Interval) -> Self {
        Self {
            values,
            varies: false,
            is_sharp: false,
            power: 1,
        }
    }

    /// True if the number may change within a small range of the state.
    pub fn is_sharp(&self) -> bool {
        self.is_sharp
    }

    /// A function of this number with these values, which makes it sharp or not.
    fn under(self, values: Interval, makes_sharp: bool) -> Self {
        Self {
            values,
            is_sharp: self.is_sharp || (self.varies && makes_sharp),
            ..self
        }
    }

    /// This power, with these values.
    fn raised(self, values: Interval, exponent: u32) -> Self {
        let power = self.power.saturating_mul(exponent);
        Self {
            power,
            ..self.under(values, power >= SHARP_POWER)
        }
    }

    /// A function of two numbers with these values, which is as sharp as the sharper of the two.
    fn joined(self, other: Self, values: Interval) -> Self {
        Self {
            values,
            varies: self.varies || other.varies,
            is_sharp: self.is_sharp || other.is_sharp,
            power: self.power.max(other.power),
        }
    }

    /// True if all values are of one sign and within a small factor of each other.
    fn is_of_one_size(self) -> bool {
        let (least, most) = (self.values.mignitude(), self.values.magnitude());
        self.values.excludes_zero() && most <= MOST_RATIO * least
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
        self.joined(other, self.values * other.values)
    }
}

impl Div for Everywhere {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let divisor = other.under(other.values, !other.is_of_one_size());
        self.joined(divisor, self.values / other.values)
    }
}

impl Numbers for Everywhere {
    const LANES: usize = 1;
    const ZERO: Self = Self::steady(Interval::ZERO);

    crate::numbers::constants_of_intervals!();

    /// A number inside. It says nothing about the others.
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
        self.raised(self.values.square(), 2)
    }

    fn sqrt(self) -> Self {
        self.under(self.values.sqrt(), !self.is_of_one_size())
    }

    fn abs(self) -> Self {
        self.under(self.values.abs(), true)
    }

    fn max(self, other: Self) -> Self {
        let larger = self.joined(other, Numbers::max(self.values, other.values));
        larger.under(larger.values, true)
    }

    /// Jumps where the sign may change.
    fn turned(self, sign: Self) -> Self {
        let turned = self.joined(sign, self.values.turned(sign.values));
        turned.under(turned.values, sign.values.is_below_zero().is_none())
    }

    fn atan2(self, x: Self) -> Self {
        let angle = self.joined(x, self.values.atan2(x.values));
        angle.under(angle.values, true)
    }

    fn powf(self, exponent: f64) -> Self {
        let values = self.values.powf(exponent);
        match exponent >= 0.0 && crate::math::floor(exponent) == exponent {
            // NOTE: the conversion saturates.
            true => self.raised(values, exponent as u32),
            false => self.under(values, !self.is_of_one_size()),
        }
    }

    fn power(self, exponent: Self) -> Self {
        let power = self.joined(exponent, self.values.power(exponent.values));
        power.under(power.values, exponent.varies || !self.is_of_one_size())
    }

    crate::functions_of_one_number!(functions_at_all_states);
}

/// Sines and cosines change everywhere, so that every step sees it; other functions may be flat but for a place.
const SEEN_EVERYWHERE: [&str; 2] = ["sin", "cos"];

macro_rules! functions_at_all_states {
    ($($name:ident)+) => {$(
        fn $name(self) -> Self {
            Self {
                power: 1,
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
        assert!(!inertia.powf(-1.5).is_sharp());
        assert!(!Everywhere::ANY.powf(3.0).is_sharp());
        assert!(Everywhere::ANY.powf(40.0).is_sharp());
        assert!(!Everywhere::of(0.3).powf(40.0).is_sharp());
        let sine = Everywhere::ANY.powf(3.0).sin();
        assert!(!sine.square().square().is_sharp());
        assert!(sine.square().square().square().is_sharp());
        assert!(Everywhere::ANY.powf(-3.0).is_sharp());
        assert!(
            (Everywhere::of(1.0) + Everywhere::ANY.cos())
                .sqrt()
                .is_sharp()
        );
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
