//! Points with real coordinates of 47 digits: where doubles lose what is looked for by cancellation.

use dalembert_numbers::{Extended, Numbers};

use super::arithmetic::Arithmetic;
use super::expand::{ExpansionPoint, RealPoint};
use crate::node::{ExprId, Function, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

/// A number of three doubles.
pub type Real = Extended<3>;

/// Numbers of 47 digits.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct ExtendedReals;

impl ExtendedReals {
    /// Half of a unit in the last place of 1.
    pub const ROUNDING: f64 = Real::ROUNDING;

    /// The circle's half circumference.
    pub fn pi() -> Real {
        Real::constant(dalembert_numbers::numbers::PI)
    }
}

impl Arithmetic for ExtendedReals {
    type Scalar = Real;
    type Sum = Real;

    fn integer(self, value: i64) -> Real {
        // A double, and what it leaves.
        let leading = value as f64;
        let rest = i128::from(value) - leading as i128;
        Real::from(leading) + Real::from(rest as f64)
    }

    fn rational(self, value: &Rational) -> Option<Real> {
        let whole = |n: i64| self.integer(n);
        match value.to_small() {
            Some((n, 1)) => Some(whole(n)),
            Some((n, d)) => Some(whole(n) / whole(d)),
            None => {
                let [n, d] =
                    [value.numer(), value.denom()].map(|own| own.to_string().parse::<Real>());
                Some(n.ok()? / d.ok()?)
            }
        }
    }

    fn add(self, a: Real, b: Real) -> Real {
        a + b
    }

    fn sub(self, a: Real, b: Real) -> Real {
        a - b
    }

    fn mul(self, a: Real, b: Real) -> Real {
        a * b
    }

    fn inv(self, a: Real) -> Option<Real> {
        let is_regular = a.nearest() != 0.0 && a.nearest().is_finite();
        is_regular.then(|| Real::from(1.0) / a)
    }

    fn is_zero(self, a: Real) -> bool {
        a == Real::from(0.0)
    }

    fn size(self, a: Real) -> f64 {
        a.nearest().abs()
    }

    fn empty(self) -> Real {
        Real::from(0.0)
    }

    fn settle(self, sum: Real) -> Real {
        sum
    }

    fn scatter(self, sums: &mut [Real], row: &[u32], factor: Real, terms: &[(u32, Real)]) {
        for (j, b) in terms {
            let Some(k) = row.get(*j as usize) else {
                return;
            };
            let sum = &mut sums[*k as usize];
            *sum = factor.mul_add(*b, *sum);
        }
    }
}

/// A point with coordinates of 47 digits.
#[derive(Clone, Debug, Default)]
pub struct ExtendedPoint {
    values: Vec<Real>,
}

impl ExtendedPoint {
    /// The point whose coordinates are the shortest decimal numbers that round to those of `point`: what is printed of it is exact.
    pub fn of(point: &RealPoint) -> Self {
        let values = point.coordinates().iter();
        let decimal = |value: &f64| value.to_string().parse().unwrap_or(Real::from(*value));
        Self {
            values: values.map(decimal).collect(),
        }
    }

    fn value(&self, symbol: SymbolId) -> Real {
        let found = self.values.get(symbol.index()).copied();
        found.unwrap_or(Real::from(0.0))
    }

    fn node(&self, pool: &Pool, id: ExprId, values: &[Real]) -> Option<Real> {
        let value = |id: ExprId| values[id.index()];
        let field = ExtendedReals;
        Some(match pool.node(id) {
            Node::Number(number) => field.rational(number)?,
            Node::Pi => ExtendedReals::pi(),
            Node::Symbol(symbol) => self.value(*symbol),
            Node::Sum { constant, terms } => {
                let mut sum = field.rational(constant)?;
                for (coefficient, term) in terms {
                    sum = field.rational(coefficient)?.mul_add(value(*term), sum);
                }
                sum
            }
            Node::Product(factors) => {
                let mut product = Real::from(1.0);
                for (base, exponent) in factors {
                    product = product * power(value(*base), exponent)?;
                }
                product
            }
            Node::Call(function, argument) => apply(*function, value(*argument)),
            Node::Atan2(y, x) => value(*y).atan2(value(*x)),
        })
    }
}

impl ExpansionPoint for ExtendedPoint {
    type Field = ExtendedReals;

    fn field(&self) -> ExtendedReals {
        ExtendedReals
    }

    fn symbol(&self, _: &Pool, symbol: SymbolId) -> Real {
        self.value(symbol)
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: Real) {
        if self.values.len() <= symbol.index() {
            self.values.resize(symbol.index() + 1, Real::from(0.0));
        }
        self.values[symbol.index()] = value;
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<Real>> {
        let length = order.last().map_or(0, |id| id.index() + 1);
        let mut values = vec![Real::from(0.0); length];
        for id in order {
            let value = self.node(pool, *id, &values)?;
            if !value.nearest().is_finite() {
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
        values: &[Real],
    ) -> Option<(Real, Real)> {
        let x = values[argument.index()];
        Some(match function {
            Function::Sinh | Function::Cosh => (x.sinh(), x.cosh()),
            _ => x.sin_cos(),
        })
    }

    fn power(&self, value: Real, exponent: &Rational) -> Option<Real> {
        power(value, exponent).filter(|power| power.nearest().is_finite())
    }
}

/// `base^exponent`: by multiplications for integers, by square roots for halves.
fn power(base: Real, exponent: &Rational) -> Option<Real> {
    match exponent.to_small() {
        Some((n, 1)) => Some(integer_power(base, n)),
        Some((n, 2)) => Some(integer_power(base.sqrt(), n)),
        _ => Some(base.power(ExtendedReals.rational(exponent)?)),
    }
}

fn integer_power(base: Real, exponent: i64) -> Real {
    let mut rest = exponent.unsigned_abs();
    let (mut square, mut result) = (base, Real::from(1.0));
    while rest > 0 {
        if rest % 2 == 1 {
            result = result * square;
        }
        square = square * square;
        rest /= 2;
    }
    match exponent < 0 {
        true => Real::from(1.0) / result,
        false => result,
    }
}

fn apply(function: Function, x: Real) -> Real {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.tan(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Tanh => x.tanh(),
        Function::Abs => x.abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    /// The value of a text at `x = 0.3`, `y = -0.7`.
    fn value(text: &str) -> Real {
        let mut fixture = Fixture::new();
        let id = fixture.read(text);
        let mut point = RealPoint::default();
        for (name, value) in [("x", 0.3), ("y", -0.7)] {
            point.set(fixture.symbol(name), value);
        }
        let mut point = ExtendedPoint::of(&point);
        let order = fixture.pool.reachable(&[id]);
        point.values(&fixture.pool, &order).unwrap()[id.index()]
    }

    #[test]
    fn identities_hold_to_45_digits() {
        for text in [
            "sin(x)^2 + cos(x)^2 - 1",
            "exp(x)*exp(y) - exp(x + y)",
            "ln(x^3) - 3*ln(x)",
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
        ] {
            let error = value(text).nearest();
            assert!(error.abs() < 1e-45, "{text}: {error:e}");
        }
        assert!(value("sin(x)").nearest() != 0.0);
    }

    #[test]
    fn small_differences_keep_their_digits() {
        let difference = value("(1 + x/1000000000000000000000)^2 - 1").nearest();
        assert!((difference - 6e-22).abs() < 1e-36, "{difference:e}");
    }
}
