//! Evaluation in double precision, in one pass over the shared nodes.

use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

impl Pool {
    /// The values of `roots`, in their order. Undefined values are infinite or NaN. `symbol` gives the value of each
    /// symbol.
    pub fn eval(&self, roots: &[ExprId], symbol: &dyn Fn(SymbolId) -> f64) -> Vec<f64> {
        let values = self.eval_ordered(&self.reachable(roots), symbol);
        roots.iter().map(|root| values[root.index()]).collect()
    }

    /// The values of all expressions in `order`, indexed by id.
    pub(crate) fn eval_ordered(
        &self,
        order: &[ExprId],
        symbol: &dyn Fn(SymbolId) -> f64,
    ) -> Vec<f64> {
        let mut values = vec![0.0; order.last().map_or(0, |id| id.index() + 1)];
        for id in order {
            values[id.index()] = self.eval_node(*id, symbol, &values);
        }
        values
    }

    /// The value of an expression, and its magnitude before cancellation. `symbol` gives the values of symbols.
    ///
    /// The magnitude of a sum is the sum of the magnitudes of its terms. Magnitudes are propagated through functions and
    /// quotients to first order. The unit roundoff times the magnitude bounds the error of the value, up to a small
    /// factor.
    pub fn eval_magnitude(&self, id: ExprId, symbol: &dyn Fn(SymbolId) -> f64) -> (f64, f64) {
        let order = self.reachable(&[id]);
        let mut values = vec![0.0; id.index() + 1];
        let mut magnitudes = vec![0.0; id.index() + 1];
        for part in order {
            values[part.index()] = self.eval_node(part, symbol, &values);
            magnitudes[part.index()] = self.magnitude_of_node(part, &values, &magnitudes);
        }
        (values[id.index()], magnitudes[id.index()])
    }

    fn eval_node(&self, id: ExprId, symbol: &dyn Fn(SymbolId) -> f64, values: &[f64]) -> f64 {
        let value = |id: ExprId| values[id.index()];
        match self.node(id) {
            Node::Number(number) => number.to_f64(),
            Node::Pi => std::f64::consts::PI,
            Node::Symbol(name) => symbol(*name),
            Node::Sum { constant, terms } => {
                terms.iter().fold(constant.to_f64(), |sum, (c, term)| {
                    sum + scaled(c, value(*term))
                })
            }
            Node::Product(factors) => factors
                .iter()
                .fold(1.0, |product, (base, e)| product * power(value(*base), e)),
            Node::Call(function, argument) => function.value(value(*argument)),
            Node::Atan2(y, x) => value(*y).atan2(value(*x)),
        }
    }

    /// The magnitude of a node. `values` are known for the node and its operands, `magnitudes` for its operands.
    fn magnitude_of_node(&self, id: ExprId, values: &[f64], magnitudes: &[f64]) -> f64 {
        let size = values[id.index()].abs();
        let value = |id: ExprId| values[id.index()];
        // Excess of an operand's magnitude over its value, due to cancellation.
        let excess = |id: ExprId| magnitudes[id.index()] - values[id.index()].abs();
        match self.node(id) {
            Node::Number(_) | Node::Pi | Node::Symbol(_) => size,
            Node::Sum { constant, terms } => terms
                .iter()
                .fold(constant.to_f64().abs(), |sum, (c, term)| {
                    sum + scaled(&c.abs(), magnitudes[term.index()])
                }),
            Node::Product(factors) => factors.iter().fold(1.0, |product, (base, e)| {
                product * power_magnitude(value(*base).abs(), magnitudes[base.index()], e)
            }),
            Node::Call(function, argument) => {
                size + function.slope(value(*argument)).abs() * excess(*argument)
            }
            Node::Atan2(y, x) => {
                let square = value(*y) * value(*y) + value(*x) * value(*x);
                size + (value(*x).abs() * excess(*y) + value(*y).abs() * excess(*x)) / square
            }
        }
    }
}

fn scaled(coefficient: &Rational, value: f64) -> f64 {
    coefficient.to_f64() * value
}

/// Magnitude of a power: `|base|^exponent`, times `magnitude/|base|` to the power `max(|exponent|, 1)`. For the base 0,
/// `magnitude^exponent`.
fn power_magnitude(base: f64, magnitude: f64, exponent: &Rational) -> f64 {
    if base == 0.0 {
        return power(magnitude, exponent);
    }
    let loss = (magnitude / base).powf(exponent.to_f64().abs().max(1.0));
    power(base, exponent) * loss
}

/// `base^exponent`: by multiplication for integers, by a square root for halves of integers.
pub(crate) fn power(base: f64, exponent: &Rational) -> f64 {
    match exponent.to_small() {
        Some((n, 1)) => integer_power(base, n),
        Some((n, 2)) => integer_power(base.sqrt(), n),
        _ => base.powf(exponent.to_f64()),
    }
}

fn integer_power(base: f64, exponent: i64) -> f64 {
    let mut rest = exponent.unsigned_abs();
    let (mut square, mut result) = (base, 1.0);
    while rest > 0 {
        if rest % 2 == 1 {
            result *= square;
        }
        square *= square;
        rest /= 2;
    }
    if exponent < 0 { 1.0 / result } else { result }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn values_agree_with_direct_evaluation() {
        let mut fixture = Fixture::new();
        let id =
            fixture.read("(x^2 - 3*y)/(1 + exp(-x)) + sqrt(m)*abs(y)^(1/3) + atan2(x, -y) + pi");
        let (x, y, m) = (1.5f64, -0.25f64, 2.0f64);
        let (sx, sy) = (fixture.symbol("x"), fixture.symbol("y"));
        let value = fixture.pool.eval(&[id], &|s| {
            if s == sx {
                x
            } else if s == sy {
                y
            } else {
                m
            }
        })[0];
        let expected = (x * x - 3.0 * y) / (1.0 + (-x).exp())
            + m.sqrt() * y.abs().cbrt()
            + x.atan2(-y)
            + std::f64::consts::PI;
        assert!((value - expected).abs() < 1e-14 * expected.abs());
    }

    #[test]
    fn magnitude_is_the_size_before_cancellation() {
        let mut fixture = Fixture::new();
        let id = fixture.read("x^2 + y - 5");
        let x = fixture.symbol("x");
        let (value, magnitude) = fixture
            .pool
            .eval_magnitude(id, &|s| if s == x { 2.0 } else { 1.0 });
        assert_eq!((value, magnitude), (0.0, 10.0));
    }

    #[test]
    fn undefined_values_are_not_finite() {
        let mut fixture = Fixture::new();
        for text in ["1/x", "ln(x)", "sqrt(x - 1)", "0*(1/x)"] {
            let id = fixture.read(text);
            assert!(!fixture.pool.eval(&[id], &|_| 0.0)[0].is_finite(), "{text}");
        }
    }
}
