//! Elementary functions of intervals.

use super::{CALL, Interval, ULP, outwards, widest};
use crate::math;
use crate::numbers::Numbers;

impl Numbers for Interval {
    const LANES: usize = 1;
    const ZERO: Self = Self::point(0.0);

    #[inline(always)]
    fn of(number: f64) -> Self {
        match number.is_nan() {
            true => Self::WHOLE,
            false => Self::point(number),
        }
    }

    #[inline(always)]
    fn constant(parts: [f64; 4]) -> Self {
        match parts[1] == 0.0 {
            true => Self::point(parts[0]),
            false => widest(parts[0], parts[0], ULP),
        }
    }

    #[inline(always)]
    fn inverse(k: usize) -> Self {
        Self::point(k as f64).inverse()
    }

    #[inline(always)]
    fn gathered(mut of_lane: impl FnMut(usize) -> f64) -> Self {
        Self::of(of_lane(0))
    }

    /// The middle of the interval, which bounds nothing.
    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        self.middle()
    }

    #[inline(always)]
    fn is_below_zero(&self) -> Option<bool> {
        match (self.hi < 0.0, self.lo >= 0.0) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn square(self) -> Self {
        let size = self.abs();
        let (lo, hi) = (size.lo * size.lo, size.hi * size.hi);
        match hi < f64::INFINITY {
            true => {
                let square = widest(lo, hi, ULP);
                Self::new(square.lo.max(0.0), square.hi)
            }
            false => {
                let below = lo - lo * ULP;
                let is_double = below < f64::MAX;
                Self::new(if is_double { below } else { f64::MAX }, f64::INFINITY)
            }
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        match self.lo >= 0.0 {
            true => {
                let root = outwards(math::sqrt(self.lo), math::sqrt(self.hi), ULP);
                Self::new(root.lo.max(0.0), root.hi)
            }
            false => Self::WHOLE,
        }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        match self.lo <= 0.0 && self.hi >= 0.0 {
            true => Self::new(0.0, a.max(b)),
            false => Self::between(a, b),
        }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.max(other.hi))
    }

    /// The whole line where `sign` may have either sign, because no series exists across a kink.
    #[inline(always)]
    fn turned(self, sign: Self) -> Self {
        match (sign.lo < 0.0, sign.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self::WHOLE,
        }
    }

    #[inline]
    fn atan2(self, x: Self) -> Self {
        // The cut belongs to the upper half plane.
        let is_off_the_cut = x.lo > 0.0 || self.excludes_zero() || self.lo >= 0.0;
        if !is_off_the_cut {
            return Self::new(-Self::pi().hi, Self::pi().hi);
        }
        // The angle is monotone in each argument along each edge, so that its extremes are at corners.
        let corners = [
            (self.lo, x.lo),
            (self.lo, x.hi),
            (self.hi, x.lo),
            (self.hi, x.hi),
        ];
        let angles = corners.map(|(y, x)| libm::atan2(y + 0.0, x + 0.0));
        let lo = angles.into_iter().fold(f64::INFINITY, f64::min);
        let hi = angles.into_iter().fold(f64::NEG_INFINITY, f64::max);
        widest(lo, hi, CALL)
    }

    #[inline]
    fn powf(self, exponent: f64) -> Self {
        if self.lo < 0.0 {
            return Self::WHOLE;
        }
        let at = |x: f64| libm::pow(x, exponent);
        match exponent >= 0.0 {
            true => self.increasing(at),
            false => (-self).increasing(|x| at(-x)),
        }
        .within(0.0, f64::INFINITY)
    }

    #[inline]
    fn power(self, exponent: Self) -> Self {
        match self.lo > 0.0 {
            true => (exponent * self.ln()).exp(),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn sin(self) -> Self {
        match self == Self::ZERO {
            true => self,
            false => self.wave(libm::sin, core::f64::consts::FRAC_PI_2),
        }
    }

    #[inline]
    fn cos(self) -> Self {
        self.wave(libm::cos, 0.0)
    }

    #[inline]
    fn tan(self) -> Self {
        let cosine = self.cos();
        match cosine.excludes_zero() {
            true => self.increasing(libm::tan),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn asin(self) -> Self {
        match self.lo >= -1.0 && self.hi <= 1.0 {
            true => self.increasing(libm::asin),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn acos(self) -> Self {
        match self.lo >= -1.0 && self.hi <= 1.0 {
            true => (-self).increasing(|x| libm::acos(-x)),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn atan(self) -> Self {
        self.increasing(libm::atan)
    }

    #[inline]
    fn exp(self) -> Self {
        self.increasing(libm::exp).within(0.0, f64::INFINITY)
    }

    #[inline]
    fn ln(self) -> Self {
        match self.lo > 0.0 {
            true => self.increasing(libm::log),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn log1p(self) -> Self {
        match self.lo > -1.0 {
            true => self.increasing(libm::log1p),
            false => Self::WHOLE,
        }
    }

    #[inline]
    fn sinh(self) -> Self {
        self.increasing(libm::sinh)
    }

    #[inline]
    fn cosh(self) -> Self {
        self.abs().increasing(libm::cosh).within(1.0, f64::INFINITY)
    }

    #[inline]
    fn tanh(self) -> Self {
        self.increasing(libm::tanh).within(-1.0, 1.0)
    }

    #[inline]
    fn asinh(self) -> Self {
        self.increasing(libm::asinh)
    }
}

impl Interval {
    /// The power with the exponent `exponent - 1`, for derivatives of powers.
    #[inline]
    pub(crate) fn powf_below(self, exponent: f64) -> Self {
        // Rounding of the exponent changes the power by the fraction `u |ln power|`, less than `746 u`, with the unit
        // roundoff `u`.
        const SLACK: f64 = 1e-12;
        let power = self.powf(exponent - 1.0);
        power * Self::new(1.0 - SLACK, 1.0 + SLACK)
    }
}
