//! Taylor models: functions along a stretch of motion, as a cubic and bounds of the remainder.
//!
//! With `s` from -1 at the start of the stretch to 1 at its end, a [`TaylorModel`] with the cubic `p` holds every
//! function `p(s) + r(s)` whose remainder obeys `|r(s)| <= error` and `|r(s) - r(s')| <= slope |s - s'|`. For a
//! function `f` over numbers and a path `x(s)`, `f(x)` holds `f(x(s))`. Halving the stretch divides the error by
//! sixteen. One model locates the root of a gap during a flight; interval arithmetic needs a dozen stretches for this.
//!
//! Reference: K. Makino, M. Berz, *Taylor models and other validated functional inclusion methods*, International
//! Journal of Pure and Applied Mathematics 6 (2003).

mod functions;

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::numbers::Numbers;
use crate::rated::Rated;
use functions::positive;

/// Rounding of a few operations, relative to the sum of the absolute values of the operands.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Rounding of a few operations with elementary functions, whose errors are below four units in the last place.
const CALL: f64 = 32.0 * f64::EPSILON;

// NOTE: operations are not inlined. Otherwise they would be compiled again for every gap of every model.

/// A cubic and a remainder; see the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaylorModel {
    /// Coefficients of the cubic, in powers of `s`.
    pub powers: [f64; 4],
    /// Bound of the remainder.
    pub error: f64,
    /// Bound of the remainder's change per unit of `s`.
    pub slope: f64,
    /// All values lie in it, even where the remainder allows others; the whole line if nothing more is known.
    pub bounds: Interval,
}

/// `f(c)`, `f'(c)`, `f''(c)/2`, `f'''(c)/6`, and a bound of `|f''''|/24`.
struct Expansion {
    terms: [f64; 4],
    fourth: f64,
}

/// Difference between a model and its value in the middle, with its square and cube. Series about the middle use it.
struct Change {
    first: [f64; 3],
    square: [f64; 5],
    cube: [f64; 7],
    spread: f64,
    steepness: f64,
    radius: f64,
    error: f64,
    slope: f64,
}

impl Change {
    /// Sum of a series in the change.
    #[inline(always)]
    fn summed(&self, Expansion { terms, fourth }: Expansion) -> TaylorModel {
        let Self {
            first: [a, b, c],
            square,
            cube,
            spread,
            steepness,
            radius,
            error: inherited,
            slope,
        } = *self;
        let [value, f, g, h] = terms;
        let powers = [
            value,
            f * a,
            f * b + g * square[0],
            f * c + g * square[1] + h * cube[0],
        ];
        let tails = [
            g * square[2] + h * cube[1],
            g * square[3] + h * cube[2],
            g * square[4] + h * cube[3],
            h * cube[4],
            h * cube[5],
            h * cube[6],
        ]
        .map(f64::abs);
        let [f, g, h] = [f.abs(), g.abs(), h.abs()];
        let cubed = radius * radius * radius;
        let mut error = fourth * radius * cubed
            + inherited * (f + g * (spread + radius) + 3.0 * h * radius * radius);
        let mut steep = 4.0 * fourth * cubed * (steepness + slope)
            + f * slope
            + 2.0 * g * (radius * slope + inherited * steepness)
            + 3.0 * h * radius * (radius * slope + 2.0 * inherited * steepness);
        for (k, tail) in tails.into_iter().enumerate() {
            error += tail;
            steep += (k + 4) as f64 * tail;
        }
        let size = value.abs() + spread * (f + spread * (g + spread * h));
        let change = (f + spread * (2.0 * g + 3.0 * spread * h)) * steepness;
        TaylorModel {
            powers,
            error: error * (1.0 + CALL) + (CALL * size + f64::MIN_POSITIVE),
            slope: steep * (1.0 + CALL) + (CALL * change + f64::MIN_POSITIVE),
            bounds: Interval::WHOLE,
        }
    }
}

impl TaylorModel {
    /// Model of a function that may be undefined.
    pub const ANYTHING: Self = Self {
        powers: [0.0; 4],
        error: f64::INFINITY,
        slope: f64::INFINITY,
        bounds: Interval::WHOLE,
    };

    /// A function that equals its cubic.
    pub const fn exact(powers: [f64; 4]) -> Self {
        Self {
            powers,
            error: 0.0,
            slope: 0.0,
            bounds: Interval::WHOLE,
        }
    }

    /// A number that does not change along the stretch.
    pub fn steady(value: Interval) -> Self {
        if value.lo == value.hi && value.lo.is_finite() {
            return Self {
                bounds: value,
                ..Self::exact([value.lo, 0.0, 0.0, 0.0])
            };
        }
        let middle = value.middle();
        Self {
            powers: [middle, 0.0, 0.0, 0.0],
            error: (value.hi - middle).max(middle - value.lo) * (1.0 + ROUNDING),
            slope: 0.0,
            bounds: value,
        }
    }

    /// Enclosure of all values on the stretch.
    pub fn range(&self) -> Interval {
        let [middle, first, second, third] = self.powers;
        let (slope, bend) = (first.abs(), second.abs());
        // Largest changes from the middle by the linear and the quadratic term, on the side to which the parabola opens
        // and on the other one.
        let far = slope + bend;
        let near = match slope < 2.0 * bend {
            true => slope * (slope / (4.0 * bend)),
            false => slope - bend,
        };
        let beyond = third.abs() + self.error;
        let [far, near] = [far, near].map(|change| (change + beyond) * (1.0 + ROUNDING));
        let (down, up) = match second < 0.0 {
            true => (far, near),
            false => (near, far),
        };
        let range = Interval::point(middle).widened_by(down, up);
        let (lo, hi) = (range.lo.max(self.bounds.lo), range.hi.min(self.bounds.hi));
        match lo <= hi && !range.is_whole() {
            true => Interval::new(lo, hi),
            false => range,
        }
    }

    /// Enclosure of all derivatives with respect to `s`, and of all slopes of chords.
    pub fn rates(&self) -> Interval {
        let [_, first, second, third] = self.powers;
        let turns = Interval::new(first + 3.0 * third.min(0.0), first + 3.0 * third.max(0.0));
        turns.widened((2.0 * second.abs() + self.slope) * (1.0 + ROUNDING))
    }

    /// Enclosures of the values and of the derivative with respect to `s`.
    pub fn rated(&self) -> Rated {
        Rated {
            value: self.range(),
            rate: self.rates(),
        }
    }

    /// Bound of the distance of the cubic from its middle value.
    #[inline(always)]
    fn spread(&self) -> f64 {
        self.powers[1].abs() + self.powers[2].abs() + self.powers[3].abs()
    }

    /// Bound of the rate of the cubic.
    #[inline(always)]
    fn steepness(&self) -> f64 {
        self.powers[1].abs() + 2.0 * self.powers[2].abs() + 3.0 * self.powers[3].abs()
    }

    /// True if the quantity does not change along the stretch; its value may be uncertain.
    #[inline(always)]
    fn is_steady(&self) -> bool {
        let [_, first, second, third] = self.powers;
        first == 0.0 && second == 0.0 && third == 0.0 && self.slope == 0.0
    }

    /// True if the bounds of a varying quantity say more than its cubic and remainder.
    #[inline(always)]
    fn is_bounded(&self) -> bool {
        !self.bounds.is_whole() && !self.is_steady()
    }

    /// The bounds of a sum or product. The whole line if cubics and remainders of both operands say everything.
    #[inline(always)]
    fn bounds_with(&self, other: &Self, both: impl Fn(Interval, Interval) -> Interval) -> Interval {
        match self.is_bounded() || other.is_bounded() {
            true => both(self.range(), other.range()),
            false => Interval::WHOLE,
        }
    }

    // NOTE: the rounding error of the constant term is the same along the whole stretch and does not contribute to the
    // slope.
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let sum = Self {
            powers: core::array::from_fn(|k| self.powers[k] + other.powers[k]),
            error: self.error + other.error,
            slope: self.slope + other.slope,
            bounds: self.bounds_with(&other, |a, b| a + b),
        };
        let spread = sum.spread();
        Self {
            error: sum.error * (1.0 + ROUNDING) + ROUNDING * (sum.powers[0].abs() + spread),
            slope: sum.slope * (1.0 + ROUNDING) + 3.0 * ROUNDING * spread,
            ..sum
        }
    }

    /// The product with a number that does not change along the stretch.
    #[inline(always)]
    fn scaled(self, factor: Self) -> Self {
        let (number, doubt) = (factor.powers[0], factor.error);
        let powers = self.powers.map(|power| power * number);
        let (spread, size) = (self.spread(), number.abs() + doubt);
        let most = self.powers[0].abs() + spread + self.error;
        let slope = match self.is_steady() {
            true => 0.0,
            false => {
                self.slope * size + self.steepness() * (doubt + ROUNDING * size) + f64::MIN_POSITIVE
            }
        };
        Self {
            powers,
            error: (self.error * number.abs() + most * doubt) * (1.0 + ROUNDING)
                + (ROUNDING * most * size + f64::MIN_POSITIVE),
            slope: slope * (1.0 + ROUNDING),
            bounds: self.bounds_with(&factor, |a, b| a * b),
        }
    }

    /// The inverse of a number that does not change along the stretch.
    #[inline(always)]
    fn inverted(self) -> Self {
        let (number, doubt) = (self.powers[0], self.error);
        let least = (number.abs() - doubt) * (1.0 - ROUNDING);
        let inverse = 1.0 / number;
        // NaN fails this comparison.
        let error = match least > 0.0 {
            true => inverse.abs() * (doubt / least + ROUNDING) + f64::MIN_POSITIVE,
            false => f64::INFINITY,
        };
        Self {
            error,
            ..Self::exact([inverse, 0.0, 0.0, 0.0])
        }
        .with_sign_of(self)
    }

    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        match other.bounds.lo >= 0.0 || other.is_positive() {
            true => self.nonnegative(),
            false => self,
        }
    }

    /// True if cubic and remainder show that all values are positive.
    #[inline(always)]
    fn is_positive(&self) -> bool {
        self.powers[0] * (1.0 - ROUNDING) > self.radius()
    }

    /// The product of two varying quantities, or the square of one.
    #[inline(always)]
    fn times(self, other: Self, is_square: bool) -> Self {
        let ([a, b], [d, e]) = ([self.powers, other.powers], [self.error, other.error]);
        let fourth = a[1] * b[3] + a[2] * b[2] + a[3] * b[1];
        let fifth = a[2] * b[3] + a[3] * b[2];
        let sixth = a[3] * b[3];
        let [fourth, fifth, sixth] = [fourth.abs(), fifth.abs(), sixth.abs()];
        let [size, other_size] = [self, other].map(|model| model.powers[0].abs() + model.spread());
        let products = d * e;
        // The square of a remainder lies between 0 and its maximum: the middle is half of the maximum.
        let lift = match is_square {
            true => 0.5 * products,
            false => 0.0,
        };
        // Sizes of the products that do not belong to the constant term.
        let changing = self.spread() * other_size + self.powers[0].abs() * other.spread();
        let error = (products - lift) + (d * other_size + e * size) + (fourth + fifth + sixth);
        let slope = (self.steepness() * e + other.steepness() * d)
            + (size * other.slope + other_size * self.slope)
            + (d * other.slope + e * self.slope)
            + (4.0 * fourth + 5.0 * fifth + 6.0 * sixth);
        let product = Self {
            powers: [
                a[0] * b[0] + lift,
                a[0] * b[1] + a[1] * b[0],
                a[0] * b[2] + a[1] * b[1] + a[2] * b[0],
                (a[0] * b[3] + a[3] * b[0]) + (a[1] * b[2] + a[2] * b[1]),
            ],
            error: error * (1.0 + ROUNDING)
                + (ROUNDING * (size * other_size + lift) + f64::MIN_POSITIVE),
            slope: slope * (1.0 + ROUNDING) + (3.0 * ROUNDING * changing + f64::MIN_POSITIVE),
            bounds: match is_square {
                true => self.bounds_with(&other, |a, _| a.square()),
                false => self.bounds_with(&other, |a, b| a * b),
            },
        };
        match is_square {
            true => product.nonnegative(),
            false => product,
        }
    }

    /// Bound of the distance of all values from the middle value of the cubic.
    #[inline(always)]
    fn radius(&self) -> f64 {
        (self.spread() + self.error) * (1.0 + ROUNDING)
    }

    /// Enclosure of all values and of the middle value of the cubic.
    #[inline(always)]
    fn reach(&self) -> Interval {
        let (range, middle) = (self.range(), self.powers[0]);
        Interval::new(range.lo.min(middle), range.hi.max(middle))
    }

    /// The change from the middle, with its powers.
    #[inline(always)]
    fn change(&self) -> Change {
        let [_, a, b, c] = self.powers;
        let mixed = a * c + b * b;
        Change {
            first: [a, b, c],
            square: [a * a, 2.0 * a * b, b * b + 2.0 * a * c, 2.0 * b * c, c * c],
            cube: [
                a * a * a,
                3.0 * a * a * b,
                3.0 * a * mixed,
                b * (b * b + 6.0 * a * c),
                3.0 * c * mixed,
                3.0 * b * c * c,
                c * c * c,
            ],
            spread: self.spread(),
            steepness: self.steepness(),
            radius: self.radius(),
            error: self.error,
            slope: self.slope,
        }
    }

    /// Model from enclosures of the values, of the rates and of the value in the middle: a linear model, or a constant
    /// one if its error is smaller.
    fn of_rated(found: Rated, middle: Interval) -> Self {
        let (rate, value) = (found.rate.middle(), found.value.middle());
        let steady = Self {
            slope: found.rate.magnitude(),
            ..Self::steady(found.value)
        };
        let slope = (found.rate.hi - rate).max(rate - found.rate.lo) * (1.0 + ROUNDING);
        let centre = Self::steady(middle);
        let error = (centre.error + slope) * (1.0 + ROUNDING);
        match error < steady.error {
            true => Self {
                powers: [centre.powers[0], rate, 0.0, 0.0],
                error: error + ROUNDING * value.abs(),
                slope,
                bounds: found.value,
            },
            false => steady,
        }
    }

    /// A function, evaluated over intervals.
    fn enclosed(self, rated: fn(Rated) -> Rated, interval: fn(Interval) -> Interval) -> Self {
        let middle = Interval::point(self.powers[0]).widened(self.error);
        Self::of_rated(rated(self.rated()), interval(middle))
    }

    /// A function, evaluated by its series, or over intervals if their error is smaller.
    fn function(
        self,
        expansion: impl FnOnce(f64, Interval) -> Expansion,
        rated: fn(Rated) -> Rated,
        interval: fn(Interval) -> Interval,
    ) -> Self {
        if self.is_steady() {
            return Self::steady(interval(self.range()));
        }
        let summed = self
            .change()
            .summed(expansion(self.powers[0], self.reach()));
        match summed.is_sharp() {
            true => summed,
            false => summed.or_enclosed(self.enclosed(rated, interval)),
        }
    }

    /// True if the cubic accounts for most of the change.
    #[inline(always)]
    fn is_sharp(&self) -> bool {
        self.error <= 0.5 * self.spread()
    }

    /// The more accurate of two models of the same function, the second of which has bounds.
    #[inline(always)]
    fn or_enclosed(self, enclosed: Self) -> Self {
        // NaN fails this comparison.
        match self.error < enclosed.error {
            true => Self {
                bounds: enclosed.bounds,
                ..self
            },
            false => enclosed,
        }
    }

    /// The same function, which has no negative values.
    // NOTE: bounds that say nothing new would slow all further operations.
    #[inline(always)]
    fn nonnegative(self) -> Self {
        match self.is_positive() {
            true => self,
            false => Self {
                bounds: self.bounds.at_least(0.0),
                ..self
            },
        }
    }
}

impl Add for TaylorModel {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.plus(other)
    }
}

impl Sub for TaylorModel {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.plus(-other)
    }
}

impl Neg for TaylorModel {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            powers: self.powers.map(|power| -power),
            bounds: -self.bounds,
            ..self
        }
    }
}

impl Mul for TaylorModel {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        match (self.is_steady(), other.is_steady()) {
            (true, true) => Self::steady(self.range() * other.range()),
            (_, true) => self.scaled(other),
            (true, _) => other.scaled(self),
            _ => self.times(other, false),
        }
    }
}

impl Div for TaylorModel {
    type Output = Self;

    // A quotient is the product with the inverse.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        if other.is_steady() {
            return self.scaled(other.inverted());
        }
        let inverse = other.function(
            |c, reach| {
                let inverse = 1.0 / c;
                let square = inverse * inverse;
                let fourth = match positive(reach.lo.max(-reach.hi)) {
                    Some(least) => 1.0 / (least * least * least * least * least),
                    None => f64::INFINITY,
                };
                Expansion {
                    terms: [inverse, -square, inverse * square, -square * square],
                    fourth,
                }
            },
            |x| Rated::of(1.0) / x,
            Interval::inverse,
        );
        self * inverse.with_sign_of(other)
    }
}

#[cfg(test)]
mod tests;
