//! Elementary functions of balls.
//!
//! ```text
//! exp x     t = x/2^s, |t| <= 1/256;  sum of t^k/k!, squared s times
//! sin, cos  t = x/2^s, |t| <= 1/256;  sums of t (-t^2)^k/(2k+1)! and (-t^2)^k/(2k)!;  s doublings of the angle
//! ln x      y by Newton's method;  ln x - y = ln(x exp(-y)),   |ln(1 + r)| <= 2|r| for |r| <= 1/2
//! log1p x   ln(1 + x);  for |x| <= 2^-16,  sum of -(-x)^k/k
//! atan x    y by Newton's method;  atan x - y = atan u,  u = (x cos y - sin y)/(cos y + x sin y),   |atan u| <= |u|
//! ```
//!
//! The omitted terms of a sum add up to at most twice the absolute value of the first of them, since each term is at
//! most half of the previous one.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use super::bound;
use super::number::{Ball, NEWTON_STEPS};
use super::wide::Wide;

/// Arguments of sums are halved until they are below `2^-SMALL`.
const SMALL: i32 = 8;
/// Numbers of terms of sums in `t^k` and in `t^(2k)`. Omitted terms are below `2^-256`.
const TERMS: u64 = 22;
const SQUARES: u64 = 11;
/// The series of `log1p` is summed for arguments up to `2^-LITTLE`, with `LITTLE_TERMS` terms. Omitted terms are below
/// `2^-256` of the sum.
const LITTLE: i32 = 16;
const LITTLE_TERMS: u64 = 17;
/// Largest absolute value of arguments. Beyond it `exp` gives `None`, and sines and cosines have the bounds -1 and 1.
const FAR: f64 = 1e6;

impl Ball {
    /// `exp(self)`; `None` if the argument or the result is too large.
    pub fn exp(self) -> Option<Self> {
        let (small, halvings) = self.reduced()?;
        let one = Self::integer(1);
        let mut sum = one;
        for k in (1..=TERMS).rev() {
            sum = one.add(small.mul(sum).divided(k));
        }
        sum = sum.widened(left_out(small, TERMS + 1));
        for _ in 0..halvings {
            sum = sum.mul(sum);
        }
        sum.is_bounded().then_some(sum)
    }

    /// `(sin(self), cos(self))`
    pub fn sin_cos(self) -> (Self, Self) {
        let Some((small, halvings)) = self.reduced() else {
            let between = Self::ZERO.widened(1.0);
            return (between, between);
        };
        let one = Self::integer(1);
        let square = small.mul(small).neg();
        let (mut sine, mut cosine) = (one, one);
        for k in (1..=SQUARES).rev() {
            sine = one.add(square.mul(sine).divided(2 * k * (2 * k + 1)));
            cosine = one.add(square.mul(cosine).divided(2 * k * (2 * k - 1)));
        }
        sine = small.mul(sine).widened(left_out(small, 2 * SQUARES + 3));
        cosine = cosine.widened(left_out(small, 2 * SQUARES + 2));
        for _ in 0..halvings {
            let product = sine.mul(cosine);
            cosine = cosine.mul(cosine).sub(sine.mul(sine));
            sine = product.add(product);
        }
        (sine, cosine)
    }

    /// `(sinh(self), cosh(self))`; `None` if the argument or a result is too large.
    pub fn sinh_cosh(self) -> Option<(Self, Self)> {
        let (above, below) = (self.exp()?, self.neg().exp()?);
        Some((above.sub(below).shifted(-1), above.add(below).shifted(-1)))
    }

    /// `ln(self)`; `None` if the ball may contain numbers that are not positive, is too wide, or is beyond the range of
    /// doubles.
    pub fn ln(self) -> Option<Self> {
        if self.sign()? == Ordering::Less {
            return None;
        }
        let one = Self::integer(1);
        let middle = self.midpoint();
        let start = libm::log(middle.nearest());
        if !start.is_finite() {
            return None;
        }
        let mut logarithm = Self::double(start);
        for _ in 0..NEWTON_STEPS {
            let rest = middle.mul(logarithm.neg().exp()?).sub(one);
            logarithm = logarithm.add(rest).midpoint();
        }
        let rest = self.mul(logarithm.neg().exp()?).sub(one).magnitude();
        (rest <= 0.5).then(|| logarithm.widened(bound::product(2.0, rest)))
    }

    /// `ln(1 + self)`, to all digits for small arguments; `None` if the ball may contain numbers without a value.
    pub fn log1p(self) -> Option<Self> {
        let (one, size) = (Self::integer(1), self.magnitude());
        if size > bound::power_of_two(-LITTLE) {
            return one.add(self).ln();
        }
        let mut sum = Self::ZERO;
        for k in (1..=LITTLE_TERMS).rev() {
            sum = one.divided(k).sub(self.mul(sum));
        }
        let omitted = (0..=LITTLE_TERMS).fold(2.0, |term, _| bound::product(term, size));
        Some(self.mul(sum).widened(omitted))
    }

    /// `atan(self)`; `None` if it cannot be enclosed.
    pub fn atan(self) -> Option<Self> {
        if self.is_zero() {
            return Some(self);
        }
        let middle = self.midpoint();
        let start = libm::atan(middle.nearest());
        if !start.is_finite() {
            return None;
        }
        // `u`; `None` unless the angles certainly differ by less than a quarter turn.
        let rest = |tangent: Self, angle: Self| {
            let (sine, cosine) = angle.sin_cos();
            let below = cosine.add(tangent.mul(sine));
            let above = tangent.mul(cosine).sub(sine);
            match below.sign()? {
                Ordering::Greater => Some(above.mul(below.inverse()?)),
                _ => None,
            }
        };
        let mut angle = Self::double(start);
        for _ in 0..NEWTON_STEPS {
            angle = angle.add(rest(middle, angle)?).midpoint();
        }
        let radius = rest(self, angle)?.magnitude();
        // A larger angle could be wrong by a full turn.
        (angle.magnitude() < 1.6).then(|| angle.widened(radius))
    }

    /// `asin(self)`; `None` unless all numbers of the ball are strictly between -1 and 1.
    pub fn asin(self) -> Option<Self> {
        let below = Self::integer(1).sub(self.mul(self)).sqrt()?;
        self.mul(below.inverse()?).atan()
    }

    /// `acos(self)`; `None` unless all numbers of the ball are strictly between -1 and 1.
    pub fn acos(self) -> Option<Self> {
        Some(Self::pi().shifted(-1).sub(self.asin()?))
    }

    /// The angle of the point `(x, self)`; `None` if a point of the balls may lie where the angle jumps.
    pub fn atan2(self, x: Self) -> Option<Self> {
        let quarter = Self::pi().shifted(-1);
        match (x.sign(), self.sign()) {
            (Some(Ordering::Greater), _) => self.mul(x.inverse()?).atan(),
            (_, Some(side)) => {
                let rest = x.mul(self.inverse()?).atan()?;
                let quarter = match side {
                    Ordering::Less => quarter.neg(),
                    _ => quarter,
                };
                Some(quarter.sub(rest))
            }
            (Some(Ordering::Less), _) if self.is_zero() => Some(Self::pi()),
            _ => None,
        }
    }

    /// The ball divided by a power of 2 so that it is small, and the exponent; `None` if the ball is larger than
    /// [`FAR`].
    fn reduced(self) -> Option<(Self, i32)> {
        let size = self.magnitude();
        if size > FAR || !size.is_finite() {
            return None;
        }
        let order = Wide::double(size).order();
        let halvings = match size == 0.0 {
            true => 0,
            false => (order + SMALL).max(0),
        };
        Some((self.shifted(-halvings), halvings))
    }
}

/// Upper bound of `2 |t|^k/k!` for every `t` in the ball.
fn left_out(ball: Ball, k: u64) -> f64 {
    let size = ball.magnitude();
    let mut term = 2.0;
    for factor in 1..=k {
        term = bound::quotient(bound::product(term, size), factor as f64);
    }
    term
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::Rational;

    /// Fractions in `(-1, 1)`.
    fn arguments() -> Vec<Ball> {
        let fractions = (-12..=12).map(|k| Ball::rational(&Rational::new(2 * k + 1, 26)));
        fractions.collect()
    }

    /// Asserts that a difference encloses 0 and is smaller than 1e-70.
    fn vanishes(difference: Ball, what: &str) {
        assert_eq!(
            difference.sign(),
            None,
            "{what} is {}",
            difference.nearest()
        );
        let size = difference.magnitude();
        assert!(size < 1e-70, "{what} is only known to {size:e}");
    }

    #[test]
    fn identities_are_enclosed() {
        let one = Ball::integer(1);
        let arguments = arguments();
        for (x, y) in arguments.iter().zip(arguments.iter().rev().skip(3)) {
            let (sine, cosine) = x.sin_cos();
            vanishes(
                sine.mul(sine).add(cosine.mul(cosine)).sub(one),
                "1 - sin^2 - cos^2",
            );
            let product = x.exp().unwrap().mul(y.exp().unwrap());
            vanishes(product.sub(x.add(*y).exp().unwrap()), "exp x exp y");
            vanishes(x.exp().unwrap().ln().unwrap().sub(*x), "ln exp x");
            vanishes(sine.asin().unwrap().sub(*x), "asin sin x");
            let tangent = sine.mul(cosine.inverse().unwrap());
            vanishes(tangent.atan().unwrap().sub(*x), "atan tan x");
            vanishes(sine.atan2(cosine).unwrap().sub(*x), "atan2");
            let (sine, cosine) = x.sinh_cosh().unwrap();
            vanishes(
                cosine.mul(cosine).sub(sine.mul(sine)).sub(one),
                "cosh^2 - sinh^2",
            );
            let (first, second) = (x.abs(), y.abs());
            let sum = first.ln().unwrap().add(second.ln().unwrap());
            vanishes(sum.sub(first.mul(second).ln().unwrap()), "ln x + ln y");
        }
    }

    #[test]
    fn known_values_are_enclosed() {
        let one = Ball::integer(1);
        vanishes(
            one.atan().unwrap().shifted(2).sub(Ball::pi()),
            "4 atan 1 - pi",
        );
        let (sine, cosine) = Ball::pi().sin_cos();
        vanishes(sine, "sin pi");
        vanishes(cosine.add(one), "cos pi + 1");
        // A published value: 50 digits of e.
        let e = Rational::from_decimal("2.71828182845904523536028747135266249775724709369995");
        let difference = one.exp().unwrap().sub(Ball::rational(&e.unwrap()));
        assert!(difference.magnitude() < 1e-50);
        let half = Ball::rational(&Rational::HALF);
        let turn = half.acos().unwrap().mul(Ball::integer(3));
        vanishes(turn.sub(Ball::pi()), "3 acos(1/2) - pi");
        let back = one.atan2(one.neg()).unwrap().shifted(2);
        vanishes(
            back.sub(Ball::pi().mul(Ball::integer(3))),
            "4 atan2(1, -1) - 3 pi",
        );
        let down = one.neg().atan2(one.neg()).unwrap().shifted(2);
        vanishes(
            down.add(Ball::pi().mul(Ball::integer(3))),
            "4 atan2(-1, -1) + 3 pi",
        );
    }

    #[test]
    fn functions_agree_with_those_of_doubles() {
        type Function = (&'static str, fn(Ball) -> Option<Ball>, fn(f64) -> f64);
        let functions: [Function; 9] = [
            ("exp", Ball::exp, libm::exp),
            ("ln", Ball::ln, libm::log),
            ("log1p", Ball::log1p, libm::log1p),
            ("sin", |x| Some(x.sin_cos().0), libm::sin),
            ("cos", |x| Some(x.sin_cos().1), libm::cos),
            ("sinh", |x| Some(x.sinh_cosh()?.0), libm::sinh),
            ("atan", Ball::atan, libm::atan),
            ("asin", Ball::asin, libm::asin),
            ("acos", Ball::acos, libm::acos),
        ];
        for (name, of_ball, of_double) in functions {
            for value in [-300.0, -40.3, -0.999, -0.2, 1e-20, 0.3, 0.99, 7.0, 512.25] {
                let wanted: f64 = of_double(value);
                let Some(found) = of_ball(Ball::double(value)) else {
                    assert!(wanted.is_nan(), "{name}({value})");
                    continue;
                };
                let error = (found.nearest() - wanted).abs();
                assert!(error <= 4e-16 * wanted.abs(), "{name}({value}): {error:e}");
                assert!(found.radius() <= 1e-55 * wanted.abs(), "{name}({value})");
            }
        }
    }

    #[test]
    fn balls_of_some_size_contain_the_values_inside() {
        let wide = Ball::rational(&Rational::HALF).widened(0.2);
        let functions: [fn(Ball) -> Option<Ball>; 7] = [
            Ball::exp,
            Ball::ln,
            |x| x.shifted(-20).log1p(),
            Ball::atan,
            Ball::asin,
            |x| Some(x.sin_cos().0),
            |x| Some(x.sin_cos().1),
        ];
        for function in functions {
            let range = function(wide).unwrap();
            for k in -6..=6 {
                let inside = Ball::double(0.5 + f64::from(k) / 32.0);
                let distance = range.midpoint().sub(function(inside).unwrap());
                assert!(distance.mignitude() <= range.radius());
            }
        }
    }

    #[test]
    fn values_that_may_not_exist_are_none() {
        let around = Ball::ZERO.widened(1e-60);
        assert_eq!(around.ln(), None);
        assert_eq!(Ball::integer(-1).ln(), None);
        assert_eq!(Ball::integer(-1).log1p(), None);
        assert_eq!(Ball::integer(2).asin(), None);
        assert_eq!(around.atan2(Ball::integer(-1)), None);
        assert_eq!(Ball::integer(10_000_000).exp(), None);
        let (sine, _) = Ball::integer(10_000_000).sin_cos();
        assert_eq!(sine.sign(), None);
    }
}
