//! Bounds of an expression of the parameters, from their assumptions: interval arithmetic in double precision.
//!
//! `[low, high]` contains every value up to rounding. It may be too wide if a parameter occurs more than once.

use dalembert_expr::{Course, ExprId, Function, Node, Pool, Rational, SymbolId};

use super::{Assumption, Parameter};

/// Bounds of a quantity, ends included; infinite if there is no bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// The lower bound.
    pub(super) low: f64,
    /// The upper bound.
    pub(super) high: f64,
}

impl Range {
    const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    fn point(value: f64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }

    /// True if every value lies in `[low, high]`.
    pub(super) fn is_within(self, low: f64, high: f64) -> bool {
        low <= self.low && self.high <= high
    }

    fn of_assumption(assumption: &Assumption) -> Self {
        match assumption {
            Assumption::Positive | Assumption::NonNegative => Self {
                low: 0.0,
                ..Self::ALL
            },
            Assumption::Within { low, high } => Self {
                low: low.to_f64(),
                high: high.to_f64(),
            },
            Assumption::Finite | Assumption::NonZero => Self::ALL,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            high: self.high + other.high,
        }
    }

    fn times(self, other: Self) -> Self {
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        Self::hull([
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ])
    }

    fn hull(values: [f64; 4]) -> Self {
        values.into_iter().fold(
            Self {
                low: f64::INFINITY,
                high: f64::NEG_INFINITY,
            },
            |range, value| Self {
                low: range.low.min(value),
                high: range.high.max(value),
            },
        )
    }

    /// Image under an increasing function.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            low: f(self.low),
            high: f(self.high),
        }
    }

    fn magnitude(self) -> Self {
        let low = if self.low <= 0.0 && self.high >= 0.0 {
            0.0
        } else {
            self.low.abs().min(self.high.abs())
        };
        Self {
            low,
            high: self.low.abs().max(self.high.abs()),
        }
    }

    fn power(self, exponent: &Rational) -> Self {
        let double = exponent.to_f64();
        if exponent.is_negative() {
            let inverse = self.power(&exponent.abs());
            return match inverse {
                Self { low, .. } if low > 0.0 => Self {
                    low: 1.0 / inverse.high,
                    high: 1.0 / low,
                },
                Self { low: 0.0, high } => Self {
                    low: 1.0 / high,
                    ..Self::ALL
                },
                _ => Self::ALL,
            };
        }
        let is_odd = exponent.is_integer() && exponent.to_i64().is_some_and(|n| n % 2 != 0);
        if is_odd {
            return self.map(|value| value.abs().powf(double).copysign(value));
        }
        let base = if exponent.is_integer() {
            self.magnitude()
        } else {
            // A root has a value for arguments that are not negative.
            self.map(|value| value.max(0.0))
        };
        base.map(|value| value.powf(double))
    }

    fn call(self, function: Function) -> Self {
        let unit = Self {
            low: -1.0,
            high: 1.0,
        };
        match function.course() {
            Course::Wave => unit,
            Course::Increasing => self.map(|x| function.value(x)),
            Course::Valley => self.magnitude().map(|x| function.value(x)),
            Course::Partial => Self::ALL,
        }
    }
}

/// Bounds of an expression. Symbols that are not parameters have infinite bounds.
pub(super) fn range(pool: &Pool, expr: ExprId, parameters: &[Parameter]) -> Range {
    let order = pool.reachable(&[expr]);
    let mut ranges: Vec<Range> = Vec::with_capacity(order.len());
    for id in &order {
        let range = {
            let of = |operand: ExprId| {
                order
                    .binary_search(&operand)
                    .ok()
                    .and_then(|index| ranges.get(index).copied())
                    .unwrap_or(Range::ALL)
            };
            node_range(pool.node(*id), &of, parameters)
        };
        ranges.push(range);
    }
    ranges.last().copied().unwrap_or(Range::ALL)
}

fn node_range(node: &Node, of: &dyn Fn(ExprId) -> Range, parameters: &[Parameter]) -> Range {
    match node {
        Node::Number(value) => Range::point(value.to_f64()),
        Node::Pi => Range::point(std::f64::consts::PI),
        Node::Symbol(symbol) => symbol_range(*symbol, parameters),
        Node::Sum { constant, terms } => {
            let scaled = terms
                .iter()
                .map(|(factor, term)| of(*term).times(Range::point(factor.to_f64())));
            scaled.fold(Range::point(constant.to_f64()), Range::plus)
        }
        Node::Product(factors) => factors
            .iter()
            .map(|(base, exponent)| of(*base).power(exponent))
            .fold(Range::point(1.0), Range::times),
        Node::Call(function, argument) => of(*argument).call(*function),
        Node::Atan2(..) => Range {
            low: -std::f64::consts::PI,
            high: std::f64::consts::PI,
        },
    }
}

fn symbol_range(symbol: SymbolId, parameters: &[Parameter]) -> Range {
    let parameter = parameters
        .iter()
        .find(|parameter| parameter.symbol == symbol);
    parameter.map_or(Range::ALL, |parameter| {
        Range::of_assumption(&parameter.assumption)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(low: f64, high: f64) -> Range {
        Range { low, high }
    }

    #[test]
    fn ranges_contain_every_value() {
        let (unit, sides) = (between(0.0, 1.0), between(-2.0, 1.0));
        assert_eq!(sides.times(unit), between(-2.0, 1.0));
        assert_eq!(sides.power(&Rational::from(2)), between(0.0, 4.0));
        assert_eq!(sides.power(&Rational::from(3)), between(-8.0, 1.0));
        assert_eq!(sides.power(&Rational::from(-1)), Range::ALL);
        assert_eq!(unit.power(&Rational::from(-1)), between(1.0, f64::INFINITY));
        assert_eq!(unit.power(&Rational::new(1, 2)), unit);
        assert_eq!(
            Range::of_assumption(&Assumption::Positive).times(between(0.0, 0.0)),
            between(0.0, 0.0)
        );
        assert_eq!(sides.call(Function::Abs), between(0.0, 2.0));
    }
}
