//! Elementary functions of Taylor models: by their series about the middle, or over intervals if that is sharper.

use super::{Expansion, ROUNDING, TaylorModel};
use crate::interval::Interval;
use crate::math;
use crate::numbers::Numbers;
use crate::rated::Rated;

/// Lower bound of an argument; `None` if it reaches the singularity at 0.
#[inline(always)]
pub(super) fn positive(least: f64) -> Option<f64> {
    let least = least * (1.0 - ROUNDING);
    (least > 0.0).then_some(least)
}

impl Numbers for TaylorModel {
    const LANES: usize = 1;
    const ZERO: Self = Self::exact([0.0; 4]);

    crate::numbers::constants_of_intervals!();

    /// The value of the cubic in the middle. It does not bound the values on the stretch.
    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        self.powers[0]
    }

    fn is_below_zero(&self) -> Option<bool> {
        self.range().is_below_zero()
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn square(self) -> Self {
        match self.is_steady() {
            true => Self::steady(self.range().square()),
            false => self.times(self, true),
        }
    }

    fn sqrt(self) -> Self {
        self.function(
            |c, reach| {
                let (root, inverse) = (math::sqrt(c), 1.0 / c);
                let first = 0.5 * root * inverse;
                let second = -0.25 * first * inverse;
                Expansion {
                    terms: [root, first, second, -0.5 * second * inverse],
                    fourth: match positive(reach.lo) {
                        Some(least) => {
                            let square = least * least;
                            (5.0 / 128.0) / (square * least * math::sqrt(least))
                        }
                        None => f64::INFINITY,
                    },
                }
            },
            Rated::sqrt,
            Interval::sqrt,
        )
        .nonnegative()
    }

    fn abs(self) -> Self {
        let range = self.range();
        let absolute = match (range.lo < 0.0, range.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => self.enclosed(Rated::abs, Interval::abs),
        };
        absolute.nonnegative()
    }

    fn max(self, other: Self) -> Self {
        let ahead = (self - other).range();
        match (ahead.lo >= 0.0, ahead.hi <= 0.0) {
            (true, _) => self,
            (_, true) => other,
            _ => {
                let middle = |model: Self| Interval::point(model.powers[0]).widened(model.error);
                Self::of_rated(
                    Numbers::max(self.rated(), other.rated()),
                    Numbers::max(middle(self), middle(other)),
                )
            }
        }
    }

    /// Values jump where the sign changes: the rates are unbounded there.
    fn turned(self, sign: Self) -> Self {
        let range = sign.range();
        match (range.lo < 0.0, range.hi < 0.0) {
            (false, _) => self,
            (_, true) => -self,
            _ => Self {
                slope: f64::INFINITY,
                ..Self::steady(self.range().hull(-self.range()))
            },
        }
    }

    fn atan2(self, x: Self) -> Self {
        let middle = |model: Self| Interval::point(model.powers[0]).widened(model.error);
        Self::of_rated(self.rated().atan2(x.rated()), middle(self).atan2(middle(x)))
    }

    fn powf(self, exponent: f64) -> Self {
        let range = self.range();
        if self.is_steady() {
            return Self::steady(range.powf(exponent));
        }
        let rate = self.rates() * (Interval::point(exponent) * range.powf_below(exponent));
        let middle = Interval::point(self.powers[0]).widened(self.error);
        let enclosed = Self::of_rated(
            Rated {
                value: range.powf(exponent),
                rate,
            },
            middle.powf(exponent),
        );
        let c = self.powers[0];
        let reach = self.reach();
        let Some(least) = positive(reach.lo) else {
            return enclosed.nonnegative();
        };
        let inverse = 1.0 / c;
        let value = libm::pow(c, exponent);
        let first = exponent * value * inverse;
        let second = 0.5 * (exponent - 1.0) * first * inverse;
        let third = (exponent - 2.0) / 3.0 * second * inverse;
        let factor = exponent * (exponent - 1.0) * (exponent - 2.0) * (exponent - 3.0) / 24.0;
        let at = |x: f64| libm::pow(x, exponent - 4.0);
        let fourth = (1.0 + 1e-9) * factor.abs() * at(least).max(at(reach.hi));
        let composed = self.change().summed(Expansion {
            terms: [value, first, second, third],
            fourth,
        });
        composed.or_enclosed(enclosed).nonnegative()
    }

    fn power(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }

    fn sin_cos(self) -> (Self, Self) {
        if self.is_steady() {
            let (sine, cosine) = self.range().sin_cos();
            return (Self::steady(sine), Self::steady(cosine));
        }
        let change = self.change();
        let (sine, cosine) = libm::sincos(self.powers[0]);
        let summed = |terms| {
            let fourth = 1.0 / 24.0;
            change.summed(Expansion { terms, fourth })
        };
        let [mut sines, mut cosines] = [
            summed([sine, cosine, -0.5 * sine, -cosine / 6.0]),
            summed([cosine, -sine, -0.5 * cosine, sine / 6.0]),
        ];
        // Next to an extremum of the sine, its model is not sharp, but that of the cosine is; and vice versa. If neither
        // model is sharp, the stretch is too long for the series.
        if !sines.is_sharp() && !cosines.is_sharp() {
            sines = sines.or_enclosed(self.enclosed(Rated::sin, Interval::sin));
            cosines = cosines.or_enclosed(self.enclosed(Rated::cos, Interval::cos));
        }
        (sines, cosines)
    }

    fn sin(self) -> Self {
        self.sin_cos().0
    }

    fn cos(self) -> Self {
        self.sin_cos().1
    }

    fn tan(self) -> Self {
        let most = self.range().tan().magnitude();
        self.function(
            |c, _| {
                let tangent = libm::tan(c);
                let (square, most_squared) = (tangent * tangent, most * most);
                let first = 1.0 + square;
                Expansion {
                    terms: [
                        tangent,
                        first,
                        tangent * first,
                        first * (1.0 + 3.0 * square) / 3.0,
                    ],
                    fourth: most * (2.0 + 3.0 * most_squared) * (1.0 + most_squared) / 3.0,
                }
            },
            Rated::tan,
            Interval::tan,
        )
    }

    fn asin(self) -> Self {
        self.function(
            |c, reach| {
                let first = 1.0 / math::sqrt((1.0 - c) * (1.0 + c));
                let square = first * first;
                let most = reach.magnitude();
                let fourth = match positive(1.0 - most) {
                    Some(least) => {
                        let square = least * (1.0 + most);
                        most * (3.0 + 2.0 * most * most)
                            / (8.0 * square * square * square * math::sqrt(square))
                    }
                    None => f64::INFINITY,
                };
                Expansion {
                    terms: [
                        libm::asin(c),
                        first,
                        0.5 * c * first * square,
                        (1.0 + 2.0 * c * c) / 6.0 * first * square * square,
                    ],
                    fourth,
                }
            },
            Rated::asin,
            Interval::asin,
        )
    }

    fn acos(self) -> Self {
        Self::steady(Interval::pi() * Interval::point(0.5)) - self.asin()
    }

    fn atan(self) -> Self {
        self.function(
            |c, _| {
                let first = 1.0 / (1.0 + c * c);
                Expansion {
                    terms: [
                        libm::atan(c),
                        first,
                        -c * first * first,
                        (3.0 * c * c - 1.0) / 3.0 * first * first * first,
                    ],
                    // `|d^n atan| <= (n - 1)!`
                    fourth: 0.25,
                }
            },
            Rated::atan,
            Interval::atan,
        )
    }

    fn exp(self) -> Self {
        self.function(
            |c, reach| {
                let power = libm::exp(c);
                let most = (1.0 + 1e-9) * libm::exp(reach.hi) + f64::MIN_POSITIVE;
                Expansion {
                    terms: [power, power, 0.5 * power, power / 6.0],
                    fourth: most / 24.0,
                }
            },
            Rated::exp,
            Interval::exp,
        )
        .nonnegative()
    }

    fn ln(self) -> Self {
        self.function(
            |c, reach| {
                let inverse = 1.0 / c;
                let fourth = match positive(reach.lo) {
                    Some(least) => 0.25 / (least * least * least * least),
                    None => f64::INFINITY,
                };
                Expansion {
                    terms: [
                        libm::log(c),
                        inverse,
                        -0.5 * inverse * inverse,
                        inverse * inverse * inverse / 3.0,
                    ],
                    fourth,
                }
            },
            Rated::ln,
            Interval::ln,
        )
    }

    fn log1p(self) -> Self {
        self.function(
            |c, reach| {
                let inverse = 1.0 / (1.0 + c);
                let fourth = match positive(1.0 + reach.lo) {
                    Some(least) => 0.25 / (least * least * least * least),
                    None => f64::INFINITY,
                };
                Expansion {
                    terms: [
                        libm::log1p(c),
                        inverse,
                        -0.5 * inverse * inverse,
                        inverse * inverse * inverse / 3.0,
                    ],
                    fourth,
                }
            },
            Rated::log1p,
            Interval::log1p,
        )
    }

    fn sinh(self) -> Self {
        let most = self.range().sinh().magnitude();
        self.function(
            |c, _| {
                let (sine, cosine) = (libm::sinh(c), libm::cosh(c));
                Expansion {
                    terms: [sine, cosine, 0.5 * sine, cosine / 6.0],
                    fourth: most / 24.0,
                }
            },
            Rated::sinh,
            Interval::sinh,
        )
    }

    fn cosh(self) -> Self {
        let most = self.range().cosh().magnitude();
        self.function(
            |c, _| {
                let (sine, cosine) = (libm::sinh(c), libm::cosh(c));
                Expansion {
                    terms: [cosine, sine, 0.5 * cosine, sine / 6.0],
                    fourth: most / 24.0,
                }
            },
            Rated::cosh,
            Interval::cosh,
        )
        .nonnegative()
    }

    fn tanh(self) -> Self {
        self.function(
            |c, _| {
                let (tangent, cosine) = (libm::tanh(c), libm::cosh(c));
                let first = 1.0 / (cosine * cosine);
                Expansion {
                    terms: [
                        tangent,
                        first,
                        -tangent * first,
                        first * (3.0 * tangent * tangent - 1.0) / 3.0,
                    ],
                    // Bound of `|t (2 - 3 t^2) (1 - t^2)| / 3`, with `t = tanh x`.
                    fourth: 0.26,
                }
            },
            Rated::tanh,
            Interval::tanh,
        )
    }

    fn asinh(self) -> Self {
        self.function(
            |c, _| {
                let square = 1.0 / (1.0 + c * c);
                let first = math::sqrt(square);
                Expansion {
                    terms: [
                        libm::asinh(c),
                        first,
                        -0.5 * c * first * square,
                        (2.0 * c * c - 1.0) / 6.0 * first * square * square,
                    ],
                    // `|x| |9 - 6 x^2| (1 + x^2)^(-7/2) / 24`, which is largest at 0.3615.
                    fourth: 0.081,
                }
            },
            Rated::asinh,
            Interval::asinh,
        )
    }
}
