//! Rectangles of complex numbers about the real axis. They bound analytic functions off the axis.
//!
//! A rectangle holds all `x + i y` with `x` in an interval and `|y| <= height`. For a function `f` over numbers that is
//! analytic on the rectangles of its arguments, `f` of these rectangles encloses all values of `f` on them. A function
//! that may have a singularity there gives [`ComplexInterval::ANYTHING`].
//!
//! Such bounds serve for power series of functions along a step. The arguments are polynomials `p(z)` that stay in
//! their rectangles for all complex `|z| <= R`. If `|Im f| <= h` there and `f` is real on the real axis, coefficient
//! `k >= 1` of its series is at most `2 h / R^k` (Borel and Caratheodory). The heights of results, and the rounding
//! errors of all coefficients but the constant one, are at most proportional to the heights of the arguments: if all
//! heights shrink by a factor, these bounds shrink by at least this factor.
//!
//! Reference: E. C. Titchmarsh, *The Theory of Functions* (1939), section 5.5.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;
use crate::math;
use crate::numbers::Numbers;

/// Bound of the rounding error of a sum of up to 33 products, relative to the sum of their absolute values. Recurrences
/// compute every coefficient of a series by such sums.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Ratio of the sum of the coefficients of a series to the bound of the function. The function is bounded on a disk,
/// the series is summed on a disk whose radius is smaller by the factor [`ComplexInterval::LEAST_RATIO`].
const SPREAD: f64 = 3.0;

/// Ratio of the sum of the coefficients above the constant one to the bound of the imaginary part, on the same disks.
const SWAY: f64 = 4.0;

/// Outward rounding of a few operations.
const UP: f64 = 1.0 + 32.0 * f64::EPSILON;

/// Degree of a function that is not a polynomial.
const NO_POLYNOMIAL: u32 = u32::MAX;

/// A rectangle of complex numbers (see the module), with bounds of the rounding errors of the function's series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplexInterval {
    /// Real parts.
    pub real: Interval,
    /// Largest absolute value of an imaginary part.
    pub height: f64,
    /// Bound of the rounding error of the constant coefficient of the function's series.
    pub floor: f64,
    /// Bound of the sum of the rounding errors of its other coefficients.
    pub rounding: f64,
    /// Upper bound of the degree of the function as a polynomial of the varying quantities.
    degree: u32,
}

/// Bounds of a function of one argument on a rectangle.
struct Analytic {
    real: Interval,
    height: f64,
    /// Bound of its first derivative.
    slope: f64,
    /// Bound of its second derivative.
    bend: f64,
    /// Factor by which the error of one coefficient is amplified in later coefficients.
    growth: f64,
}

impl ComplexInterval {
    /// No information, for functions that may be singular.
    pub const ANYTHING: Self = Self {
        real: Interval::WHOLE,
        height: f64::INFINITY,
        floor: f64::INFINITY,
        rounding: f64::INFINITY,
        degree: NO_POLYNOMIAL,
    };

    /// The bounds of rounding errors hold if the radius of the disk on which functions are bounded is at least this
    /// multiple of the length of the step.
    pub const LEAST_RATIO: f64 = 1.5;

    /// A quantity that is a polynomial of time along the step. Its degree counts as 1.
    #[inline(always)]
    pub fn varying(real: Interval, height: f64) -> Self {
        Self {
            real,
            height,
            floor: ROUNDING * real.magnitude(),
            rounding: ROUNDING * SWAY * height,
            degree: 1,
        }
    }

    /// A real number that does not change along the step.
    #[inline(always)]
    pub fn steady(value: Interval) -> Self {
        Self {
            real: value,
            height: 0.0,
            floor: ROUNDING * value.magnitude() + value.width(),
            rounding: 0.0,
            degree: 0,
        }
    }

    /// The largest absolute value; not finite if nothing is known.
    #[inline(always)]
    pub fn magnitude(self) -> f64 {
        (self.real.magnitude() + self.height) * UP
    }

    /// Upper bound of the degree as a polynomial of the varying quantities; `None` if the function is not a polynomial.
    #[inline(always)]
    pub fn degree(self) -> Option<u32> {
        (self.degree != NO_POLYNOMIAL).then_some(self.degree)
    }

    #[inline(always)]
    fn is_steady(self) -> bool {
        self.degree == 0
    }

    /// Bound of the sum of all coefficients.
    #[inline(always)]
    fn sum(self) -> f64 {
        self.real.magnitude() + self.sway()
    }

    /// Bound of the sum of the coefficients above the constant one.
    #[inline(always)]
    fn sway(self) -> f64 {
        SWAY * self.height
    }

    /// A function of one argument, from its bounds on the rectangle.
    #[inline(always)]
    fn analytic(self, function: Analytic) -> Self {
        let Analytic {
            real,
            height,
            slope,
            bend,
            growth,
        } = function;
        let size = real.magnitude();
        let local = ROUNDING * SPREAD * (size + height + slope) * self.sway();
        let carried = SPREAD * slope * self.rounding + SWAY * bend * self.height * self.floor;
        Self {
            real,
            height,
            floor: (slope * self.floor + ROUNDING * size) * UP,
            rounding: (carried + SPREAD * growth * local) * UP,
            degree: NO_POLYNOMIAL,
        }
        .or_anything()
    }

    /// A function of one argument, from its values on the real axis and bounds of its first two derivatives on the
    /// rectangle.
    #[inline(always)]
    fn carried(self, value: Interval, [slope, bend]: [f64; 2], growth: f64) -> Self {
        if self.is_steady() {
            return Self::steady(value);
        }
        let reach = self.height * slope * UP;
        self.analytic(Analytic {
            real: value.widened(reach),
            height: reach,
            slope,
            bend,
            growth,
        })
    }

    /// A function of one argument, from its values on the real axis and its derivative as a function of the rectangle.
    #[inline(always)]
    fn by_slope(self, value: Interval, slope: impl FnOnce(Self) -> Self) -> Self {
        if self.is_steady() {
            return Self::steady(value);
        }
        let derivative = slope(self);
        let slope = derivative.magnitude();
        // The height of the derivative bounds its variation, and with it the effect of the argument's rounding error.
        let bend = match self.height > 0.0 {
            true => derivative.height / self.height,
            false => 0.0,
        };
        self.carried(value, [slope, bend], slope)
    }

    /// The product of two numbers that vary, with the real parts of the product.
    #[inline(always)]
    fn product(self, other: Self, real: Interval) -> Self {
        let [size, other_size] = [self, other].map(|factor| factor.real.magnitude());
        let [sum, other_sum] = [self, other].map(Self::sum);
        let [sway, other_sway] = [self, other].map(Self::sway);
        let floor = size * other.floor + other_size * self.floor + ROUNDING * size * other_size;
        let rounding = sum * other.rounding
            + other_sum * self.rounding
            + self.floor * other_sway
            + other.floor * sway
            + ROUNDING * (sum * other_sway + other_sum * sway);
        Self {
            real,
            height: (size * other.height + other_size * self.height) * UP,
            floor: floor * UP,
            rounding: rounding * UP,
            degree: self.degree.saturating_add(other.degree),
        }
        .or_anything()
    }

    /// The rectangle if all its bounds are finite, otherwise [`ComplexInterval::ANYTHING`].
    #[inline(always)]
    fn or_anything(self) -> Self {
        // This form of the comparison is false for NaN.
        match self.rounding + self.floor < f64::INFINITY && self.magnitude() < f64::INFINITY {
            true => self,
            false => Self::ANYTHING,
        }
    }

    /// `1 / a`
    #[inline(always)]
    fn inverted(self) -> Self {
        let value = self.real.inverse();
        if self.is_steady() {
            return Self::steady(value);
        }
        if !(self.real.excludes_zero() && self.height < f64::INFINITY) {
            return Self::ANYTHING;
        }
        // `1 / (x + i y) = (x - i y) / (x^2 + y^2)`
        let square = Interval::new(0.0, self.height).square();
        let share = (Interval::point(1.0) + square / self.real.square()).inverse();
        let inverse = value.magnitude() * UP;
        let slope = inverse * inverse * UP;
        self.analytic(Analytic {
            real: value * share,
            height: self.height * slope * UP,
            slope,
            bend: 2.0 * slope * inverse,
            growth: inverse,
        })
    }

    /// `f(x) cosh y + i g(x) sinh y`, from the values of `f` and `g` on the real axis and bounds of `cosh y` and
    /// `sinh y`.
    #[inline(always)]
    fn wave(self, [real, across]: [Interval; 2], [cosh, sinh]: [f64; 2]) -> Self {
        self.analytic(Analytic {
            real: real * Interval::new(1.0, cosh),
            height: across.magnitude() * sinh * UP,
            slope: cosh,
            bend: cosh,
            growth: SPREAD * cosh * cosh,
        })
    }

    /// `f(x) cos y + i g(x) sin y`, from the values of `f` and `g` on the real axis. The larger of `|f|` and `|g|`
    /// bounds the derivatives.
    fn turning(self, [real, across]: [Interval; 2]) -> Self {
        if self.is_steady() {
            return Self::steady(real);
        }
        let turn = Interval::new(-self.height, self.height);
        let slope = real.magnitude().max(across.magnitude());
        // Divided by its constant term, the series of an exponential is at most the exponential of the sway. Its
        // inverse has the same bound.
        let growth = math::exp(2.0 * self.sway()) * UP;
        self.analytic(Analytic {
            real: real * turn.cos(),
            height: across.magnitude() * self.height * UP,
            slope,
            bend: slope,
            growth,
        })
    }

    fn one() -> Self {
        Self::steady(Interval::point(1.0))
    }
}

impl Add for ComplexInterval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let floor = self.floor + other.floor;
        let sizes = self.real.magnitude() + other.real.magnitude();
        let height = (self.height + other.height) * UP;
        let rounding = self.rounding + other.rounding + ROUNDING * SWAY * height;
        Self {
            real: self.real + other.real,
            height,
            floor: (floor + ROUNDING * sizes) * UP,
            rounding: rounding * UP,
            degree: self.degree.max(other.degree),
        }
    }
}

impl Sub for ComplexInterval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for ComplexInterval {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            real: -self.real,
            ..self
        }
    }
}

impl Mul for ComplexInterval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let value = self.real * other.real;
        match self.is_steady() && other.is_steady() {
            true => Self::steady(value),
            false => self.product(other, value.widened(self.height * other.height * UP)),
        }
    }
}
impl Div for ComplexInterval {
    type Output = Self;

    // A quotient is the product with the inverse.
    #[allow(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        self * other.inverted()
    }
}

impl Numbers for ComplexInterval {
    const LANES: usize = 1;
    const ZERO: Self = Self {
        real: Interval::ZERO,
        height: 0.0,
        floor: 0.0,
        rounding: 0.0,
        degree: 0,
    };

    crate::numbers::constants_of_intervals!();

    /// One real number inside the rectangle, which bounds nothing.
    fn lane(&self, lane: usize) -> f64 {
        self.real.lane(lane)
    }

    /// The sign, if the number does not vary along the step.
    fn is_below_zero(&self) -> Option<bool> {
        match self.is_steady() {
            true => self.real.is_below_zero(),
            false => None,
        }
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn square(self) -> Self {
        let value = self.real.square();
        match self.is_steady() {
            true => Self::steady(value),
            false => self.product(self, value - Interval::new(0.0, self.height).square()),
        }
    }

    fn sqrt(self) -> Self {
        let root = self.real.sqrt();
        match self.is_steady() || self.real.lo > 0.0 {
            true => {
                // The derivatives are at most `1 / (2 sqrt |z|)` and `1 / (4 |z| sqrt |z|)`.
                let slope = 0.5 / root.lo * UP;
                let bend = 0.5 * slope / self.real.lo * UP;
                self.carried(root, [slope, bend], slope)
            }
            false => Self::ANYTHING,
        }
    }

    /// The absolute value is not analytic across its kink.
    fn abs(self) -> Self {
        match (self.real.lo < 0.0, self.real.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ if self.is_steady() => Self::steady(self.real.abs()),
            _ => Self::ANYTHING,
        }
    }

    /// The maximum is not analytic across a kink.
    fn max(self, other: Self) -> Self {
        let ahead = self.real - other.real;
        match (ahead.lo >= 0.0, ahead.hi <= 0.0) {
            (true, _) => self,
            (_, true) => other,
            _ if self.is_steady() && other.is_steady() => {
                Self::steady(Numbers::max(self.real, other.real))
            }
            _ => Self::ANYTHING,
        }
    }

    /// A change of sign is not analytic across the kink.
    fn turned(self, sign: Self) -> Self {
        match (sign.real.lo < 0.0, sign.real.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ if self.is_steady() && sign.is_steady() => Self::steady(self.real.hull(-self.real)),
            _ => Self::ANYTHING,
        }
    }

    fn atan2(self, x: Self) -> Self {
        let value = self.real.atan2(x.real);
        if self.is_steady() && x.is_steady() {
            return Self::steady(value);
        }
        // A motion along the cut stays on its upper side.
        let is_along = self.is_steady() && self.real.is_zero() && x.real.hi < 0.0;
        let is_off_the_cut = x.real.lo > 0.0 || self.real.excludes_zero() || is_along;
        if !is_off_the_cut {
            return Self::ANYTHING;
        }
        // `d angle = (x dy - y dx) / (x^2 + y^2)`
        let inverse = (self.square() + x.square()).inverted();
        let [across, along] = [x * inverse, self * inverse];
        let reach = (across.magnitude() * self.height + along.magnitude() * x.height) * UP;
        let size = value.magnitude();
        let carried = SPREAD
            * (across.magnitude() * self.rounding + along.magnitude() * x.rounding)
            + SWAY * (across.height * self.floor + along.height * x.floor);
        let local = ROUNDING
            * SPREAD
            * (size + reach + across.magnitude() + along.magnitude())
            * (self.sway() + x.sway());
        let growth =
            SPREAD * SPREAD * inverse.magnitude() * (1.0 + self.magnitude() + x.magnitude());
        let floor = across.magnitude() * self.floor + along.magnitude() * x.floor + ROUNDING * size;
        Self {
            real: value.widened(reach),
            height: reach,
            floor: floor * UP,
            rounding: (carried + growth * local) * UP,
            degree: NO_POLYNOMIAL,
        }
        .or_anything()
    }

    fn powf(self, exponent: f64) -> Self {
        match self.is_steady() {
            true => Self::steady(self.real.powf(exponent)),
            false => (Self::of(exponent) * self.ln()).exp(),
        }
    }

    fn power(self, exponent: Self) -> Self {
        match self.is_steady() && exponent.is_steady() {
            true => Self::steady(self.real.power(exponent.real)),
            false => (exponent * self.ln()).exp(),
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.real.sin_cos();
        if self.is_steady() {
            return (Self::steady(sine), Self::steady(cosine));
        }
        // `sin(x + i y) = sin x cosh y + i cos x sinh y`, `cos(x + i y) = cos x cosh y - i sin x sinh y`
        let swell = [math::cosh, math::sinh].map(|function| function(self.height) * UP);
        (
            self.wave([sine, cosine], swell),
            self.wave([cosine, sine], swell),
        )
    }

    fn sin(self) -> Self {
        self.sin_cos().0
    }

    fn cos(self) -> Self {
        self.sin_cos().1
    }

    fn tan(self) -> Self {
        let (sine, cosine) = self.sin_cos();
        sine / cosine
    }

    fn asin(self) -> Self {
        self.by_slope(self.real.asin(), |z| {
            (Self::one() - z.square()).sqrt().inverted()
        })
    }

    fn acos(self) -> Self {
        self.by_slope(self.real.acos(), |z| {
            (Self::one() - z.square()).sqrt().inverted()
        })
    }

    fn atan(self) -> Self {
        self.by_slope(self.real.atan(), |z| (Self::one() + z.square()).inverted())
    }

    fn exp(self) -> Self {
        let value = self.real.exp();
        self.turning([value, value])
    }

    fn ln(self) -> Self {
        let value = self.real.ln();
        match self.is_steady() || self.real.lo > 0.0 {
            true => {
                let slope = 1.0 / self.real.lo * UP;
                self.carried(value, [slope, slope * slope], slope)
            }
            false => Self::ANYTHING,
        }
    }

    fn log1p(self) -> Self {
        let value = self.real.log1p();
        let least = (Interval::point(1.0) + self.real).lo;
        match self.is_steady() || least > 0.0 {
            true => {
                let slope = 1.0 / least * UP;
                self.carried(value, [slope, slope * slope], slope)
            }
            false => Self::ANYTHING,
        }
    }

    fn sinh(self) -> Self {
        self.turning([self.real.sinh(), self.real.cosh()])
    }

    fn cosh(self) -> Self {
        self.turning([self.real.cosh(), self.real.sinh()])
    }

    fn tanh(self) -> Self {
        self.sinh() / self.cosh()
    }

    fn asinh(self) -> Self {
        self.by_slope(self.real.asinh(), |z| {
            (Self::one() + z.square()).sqrt().inverted()
        })
    }
}

#[cfg(test)]
mod tests;
