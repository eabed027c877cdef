//! Points with ball coordinates: expressions and series in ball arithmetic of 76 digits, with error bounds.

use std::cmp::Ordering;

use super::arithmetic::Arithmetic;
use super::enclosed::{RangePoint, decimal};
use super::expand::{ExpansionPoint, RealPoint};
use crate::ball::Ball;
use crate::function::Function;
use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

/// Ball arithmetic: 256-bit midpoints with error bounds.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Balls;

impl Arithmetic for Balls {
    type Scalar = Ball;
    type Sum = Ball;

    fn integer(self, value: i64) -> Ball {
        Ball::integer(value)
    }

    fn rational(self, value: &Rational) -> Option<Ball> {
        Some(Ball::rational(value))
    }

    fn add(self, a: Ball, b: Ball) -> Ball {
        a + b
    }

    fn sub(self, a: Ball, b: Ball) -> Ball {
        a - b
    }

    fn mul(self, a: Ball, b: Ball) -> Ball {
        a * b
    }

    fn inv(self, a: Ball) -> Option<Ball> {
        a.inverse()
    }

    fn is_zero(self, a: Ball) -> bool {
        a.is_zero()
    }

    /// Lower bound of the absolute values in the ball. It is 0 for a ball that contains 0, which therefore is never a
    /// pivot.
    fn size(self, a: Ball) -> f64 {
        a.mignitude()
    }

    fn empty(self) -> Ball {
        Ball::ZERO
    }

    fn settle(self, sum: Ball) -> Ball {
        sum
    }

    fn scatter(self, sums: &mut [Ball], row: &[u32], factor: Ball, terms: &[(u32, Ball)]) {
        for (j, b) in terms {
            let Some(k) = row.get(*j as usize) else {
                return;
            };
            let sum = &mut sums[*k as usize];
            *sum = *sum + factor * *b;
        }
    }
}

/// A point with ball coordinates. Symbols without a coordinate are 0, as at a [`RealPoint`].
#[derive(Clone, Debug, Default)]
pub struct BallPoint {
    values: Vec<Ball>,
}

impl BallPoint {
    fn value(&self, symbol: SymbolId) -> Ball {
        let found = self.values.get(symbol.index()).copied();
        found.unwrap_or(Ball::ZERO)
    }

    fn node(&self, pool: &Pool, id: ExprId, values: &[Ball]) -> Option<Ball> {
        let value = |id: ExprId| values[id.index()];
        Some(match pool.node(id) {
            Node::Number(number) => Ball::rational(number),
            Node::Pi => Ball::pi(),
            Node::Symbol(symbol) => self.value(*symbol),
            Node::Sum { constant, terms } => {
                let mut sum = Ball::rational(constant);
                for (coefficient, term) in terms {
                    sum = sum + Ball::rational(coefficient) * value(*term);
                }
                sum
            }
            Node::Product(factors) => {
                let mut product = Ball::integer(1);
                for (base, exponent) in factors {
                    product = product * value(*base).power(exponent)?;
                }
                product
            }
            Node::Call(function, argument) => apply(*function, value(*argument))?,
            Node::Atan2(y, x) => value(*y).atan2(value(*x))?,
        })
    }
}

impl ExpansionPoint for BallPoint {
    type Field = Balls;

    fn field(&self) -> Balls {
        Balls
    }

    fn symbol(&self, _: &Pool, symbol: SymbolId) -> Ball {
        self.value(symbol)
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: Ball) {
        if self.values.len() <= symbol.index() {
            self.values.resize(symbol.index() + 1, Ball::ZERO);
        }
        self.values[symbol.index()] = value;
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<Ball>> {
        let length = order.last().map_or(0, |id| id.index() + 1);
        let mut values = vec![Ball::ZERO; length];
        for id in order {
            let value = self.node(pool, *id, &values)?;
            if !value.is_bounded() {
                return None;
            }
            values[id.index()] = value;
        }
        Some(values)
    }

    fn pair(
        &mut self,
        _: &Pool,
        function: Function,
        argument: ExprId,
        values: &[Ball],
    ) -> Option<(Ball, Ball)> {
        let x = values[argument.index()];
        match function {
            Function::Sinh | Function::Cosh => x.sinh_cosh(),
            _ => Some(x.sin_cos()),
        }
    }

    fn power(&self, value: Ball, exponent: &Rational) -> Option<Ball> {
        value.power(exponent)
    }
}

impl RangePoint for BallPoint {
    fn of(point: &RealPoint) -> Self {
        let range =
            |value: &f64| decimal(*value).map_or(Ball::WHOLE, |number| Ball::rational(&number));
        Self {
            values: point.coordinates().iter().map(range).collect(),
        }
    }

    fn sign(range: Ball) -> Option<Ordering> {
        range.sign()
    }

    fn nearest(range: Ball) -> f64 {
        range.nearest()
    }

    fn radius(range: Ball) -> f64 {
        range.radius()
    }
}

fn apply(function: Function, x: Ball) -> Option<Ball> {
    let ratio = |(above, below): (Ball, Ball)| Some(above * below.inverse()?);
    match function {
        Function::Sin => Some(x.sin_cos().0),
        Function::Cos => Some(x.sin_cos().1),
        Function::Tan => ratio(x.sin_cos()),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Log1p => x.log1p(),
        Function::Sinh => x.sinh_cosh().map(|pair| pair.0),
        Function::Cosh => x.sinh_cosh().map(|pair| pair.1),
        Function::Tanh => ratio(x.sinh_cosh()?),
        Function::Asinh if x.nearest() < 0.0 => Some(-inverse_of_sinh(-x)?),
        Function::Asinh => inverse_of_sinh(x),
        Function::Abs => Some(x.abs()),
    }
}

/// `arsinh(x) = ln(x + sqrt(x^2 + 1))`. For `x < 0` the sum cancels and digits are lost.
fn inverse_of_sinh(x: Ball) -> Option<Ball> {
    (x + (x * x + Ball::integer(1)).sqrt()?).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use crate::interval::Interval;

    /// The value of an expression, given as text, at `x = 0.3`, `y = -0.7`.
    fn value(text: &str) -> Ball {
        let mut fixture = Fixture::new();
        let id = fixture.read(text);
        let mut point = RealPoint::default();
        for (name, value) in [("x", 0.3), ("y", -0.7)] {
            point.set(fixture.symbol(name), value);
        }
        let mut point = BallPoint::of(&point);
        let order = fixture.pool.reachable(&[id]);
        point.values(&fixture.pool, &order).unwrap()[id.index()]
    }

    /// Values of every function at numbers of many sizes lie in its interval enclosure.
    #[test]
    fn ranges_of_single_numbers_hold_the_values() {
        let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
        let mut draw = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for function in Function::ALL {
            for round in 0..2000 {
                let x = match round % 4 {
                    0 => draw(),
                    1 => 5.0 * draw(),
                    2 => 300.0 * draw(),
                    _ => draw() * (20.0 * draw()).exp(),
                };
                let range = function.range(Interval::point(x));
                let (Some(range), Some(value)) = (range, apply(function, Ball::double(x))) else {
                    continue;
                };
                // Some balls are too wide to compare, for example sines of large angles.
                if value.radius() > 0.5 {
                    continue;
                }
                let below = (value - Ball::double(range.lo)).nearest();
                let above = (Ball::double(range.hi) - value).nearest();
                assert!(
                    below >= 0.0 && above >= 0.0,
                    "{}({x:e}): {range:?}, off by {below:e} {above:e}",
                    function.name()
                );
            }
        }
    }

    const IDENTITIES: [&str; 15] = [
        "sin(x)^2 + cos(x)^2 - 1",
        "exp(x)*exp(y) - exp(x + y)",
        "ln(x^3) - 3*ln(x)",
        "log1p(x/1000000) - ln(1 + x/1000000)",
        "sqrt(x)^3 - x^(3/2)",
        "(x^2)^(1/3) - exp(2/3*ln(x))",
        "tan(x) - sin(x)/cos(x)",
        "atan2(x, y) + atan2(y, x) - pi/2",
        "cosh(y)^2 - sinh(y)^2 - 1",
        "tanh(y) - sinh(y)/cosh(y)",
        "asin(x) + acos(x) - pi/2",
        "atan(x) - asin(x/sqrt(1 + x^2))",
        "x/3 + x/7 - 10*x/21",
        "abs(y) + y",
        "10*x + 3*y - 9/10",
    ];

    #[test]
    fn what_vanishes_is_never_told_from_0() {
        for text in IDENTITIES {
            let difference = value(text);
            assert_eq!(difference.sign(), None, "{text}");
            assert!(difference.magnitude() < 1e-70, "{text}");
        }
    }

    #[test]
    fn differences_of_60_digits_are_told_from_0() {
        for text in IDENTITIES {
            for (sign, zeros, side) in [("+", 30, Ordering::Greater), ("-", 60, Ordering::Less)] {
                let planted = format!("{text} {sign} (1 + x)/1{}", "0".repeat(zeros));
                assert_eq!(value(&planted).sign(), Some(side), "{planted}");
            }
        }
        let difference = value("(1 + x/1000000000000000000000)^2 - 1").nearest();
        assert!((difference - 6e-22).abs() < 1e-36, "{difference:e}");
    }

    #[test]
    fn coordinates_are_the_decimals_that_are_printed() {
        assert!(value("10*x - 3").magnitude() < 1e-74);
        assert!(value("y + 7/10").magnitude() < 1e-74);
    }
}
