//! Sign and finiteness of an expression, as far as its structure shows them.
//!
//! A sign holds wherever the expression is defined: `1/x` is [`Sign::NonZero`], because it is undefined where `x`
//! is 0. Finiteness is total: it holds for all values of the symbols that satisfy their assumptions.

use crate::function::{Arguments, Function};
use crate::node::{Assumption, ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;

/// The sign of an expression wherever it is defined.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
pub enum Sign {
    /// Greater than 0.
    Positive,
    /// Not less than 0.
    NonNegative,
    /// Not equal to 0.
    NonZero,
    /// Less than 0.
    Negative,
    /// Not greater than 0.
    NonPositive,
    /// Equal to 0.
    Zero,
    /// Not known.
    Unknown,
}

impl Sign {
    /// The sign of a number.
    pub fn of(value: &Rational) -> Self {
        match value {
            value if value.is_zero() => Self::Zero,
            value if value.is_negative() => Self::Negative,
            _ => Self::Positive,
        }
    }

    /// True if it excludes 0.
    pub fn is_nonzero(self) -> bool {
        matches!(self, Self::Positive | Self::Negative | Self::NonZero)
    }

    /// True if it excludes negative values.
    pub fn is_nonnegative(self) -> bool {
        matches!(self, Self::Positive | Self::NonNegative | Self::Zero)
    }

    /// True if it excludes positive values.
    pub fn is_nonpositive(self) -> bool {
        matches!(self, Self::Negative | Self::NonPositive | Self::Zero)
    }

    pub(crate) fn known(nonzero: bool, nonnegative: bool, nonpositive: bool) -> Self {
        match (nonzero, nonnegative, nonpositive) {
            (_, true, true) => Self::Zero,
            (true, true, false) => Self::Positive,
            (true, false, true) => Self::Negative,
            (true, false, false) => Self::NonZero,
            (false, true, false) => Self::NonNegative,
            (false, false, true) => Self::NonPositive,
            (false, false, false) => Self::Unknown,
        }
    }

    fn times(self, other: Self) -> Self {
        if self == Self::Zero || other == Self::Zero {
            return Self::Zero;
        }
        let alike = (self.is_nonnegative() && other.is_nonnegative())
            || (self.is_nonpositive() && other.is_nonpositive());
        let opposite = (self.is_nonnegative() && other.is_nonpositive())
            || (self.is_nonpositive() && other.is_nonnegative());
        Self::known(self.is_nonzero() && other.is_nonzero(), alike, opposite)
    }

    fn plus(self, other: Self) -> Self {
        let nonnegative = self.is_nonnegative() && other.is_nonnegative();
        let nonpositive = self.is_nonpositive() && other.is_nonpositive();
        let nonzero = self.is_nonzero() || other.is_nonzero();
        Self::known(
            nonzero && (nonnegative || nonpositive),
            nonnegative,
            nonpositive,
        )
    }

    /// The sign of `x^exponent` where it is defined: a non-integer power needs `x >= 0`, a negative one `x != 0`.
    fn to_power(self, exponent: &Rational) -> Self {
        let nonzero = self.is_nonzero() || exponent.is_negative();
        if !exponent.is_integer() {
            return Self::known(nonzero, true, self == Self::Zero && !nonzero);
        }
        if is_even(exponent) {
            return Self::known(nonzero, true, self == Self::Zero && !nonzero);
        }
        Self::known(nonzero, self.is_nonnegative(), self.is_nonpositive())
    }
}

/// True if an integer is even.
pub(crate) fn is_even(value: &Rational) -> bool {
    (value * &Rational::HALF).is_integer()
}

impl Pool {
    pub(crate) fn derive_sign(&self, node: &Node) -> Sign {
        match node {
            Node::Number(value) => Sign::of(value),
            Node::Pi => Sign::Positive,
            Node::Symbol(symbol) => match self.symbol_assumption(*symbol) {
                Assumption::None => Sign::Unknown,
                Assumption::Positive => Sign::Positive,
                Assumption::NonNegative => Sign::NonNegative,
                Assumption::NonZero => Sign::NonZero,
            },
            Node::Sum { constant, terms } => self.sum_sign(constant, terms),
            Node::Product(factors) => factors
                .iter()
                .fold(Sign::Positive, |sign, (base, exponent)| {
                    sign.times(self.sign(*base).to_power(exponent))
                }),
            Node::Call(function, argument) => function.sign(self.sign(*argument)),
            Node::Atan2(..) => Sign::Unknown,
        }
    }

    fn sum_sign(&self, constant: &Rational, terms: &[(Rational, ExprId)]) -> Sign {
        let scaled = |(coefficient, term): &(Rational, ExprId)| {
            Sign::of(coefficient).times(self.sign(*term))
        };
        match terms {
            [term] if constant.is_zero() => scaled(term),
            _ => terms
                .iter()
                .map(scaled)
                .fold(Sign::of(constant), Sign::plus),
        }
    }

    /// The sign of `id + shift`.
    pub fn sign_of_shifted(&self, id: ExprId, shift: u8) -> Sign {
        if shift == 0 {
            return self.sign(id);
        }
        let (constant, terms) = self.linear_form(id);
        self.sum_sign(&(&constant + &Rational::from(i64::from(shift))), &terms)
    }

    pub(crate) fn derive_finiteness(&self, node: &Node) -> bool {
        match node {
            Node::Number(_) | Node::Pi | Node::Symbol(_) => true,
            Node::Sum { terms, .. } => terms.iter().all(|(_, term)| self.is_finite(*term)),
            Node::Product(factors) => factors.iter().all(|(base, exponent)| {
                let sign = self.sign(*base);
                self.is_finite(*base)
                    && (!exponent.is_negative() || sign.is_nonzero())
                    && (exponent.is_integer() || sign.is_nonnegative())
            }),
            Node::Call(function, argument) => {
                self.is_finite(*argument) && self.has_value(*function, *argument) == Some(true)
            }
            Node::Atan2(y, x) => {
                let off_origin = self.sign(*y).is_nonzero() || self.sign(*x).is_nonzero();
                self.is_finite(*y) && self.is_finite(*x) && off_origin
            }
        }
    }

    /// True if the function has a value wherever its argument has one, false if it has a value nowhere. `None` if the
    /// structure shows neither.
    fn has_value(&self, function: Function, argument: ExprId) -> Option<bool> {
        let is_positive = |sign: Sign| match sign {
            Sign::Positive => Some(true),
            sign => sign.is_nonpositive().then_some(false),
        };
        match function.arguments() {
            Arguments::All => Some(true),
            Arguments::OffPoles => {
                let multiple = self.multiple_of_pi(argument)?;
                let is_half = (&multiple * &Rational::from(2)).is_integer();
                Some(multiple.is_integer() || !is_half)
            }
            Arguments::Positive => is_positive(self.sign(argument)),
            Arguments::AboveMinusOne => is_positive(self.sign_of_shifted(argument, 1)),
            Arguments::Unit => Some(self.as_number(argument)?.abs() <= Rational::ONE),
        }
    }

    /// True if the form of a subexpression shows that it has no real value: a negative power of 0, a root of a negative
    /// expression, `ln` of an expression that is nowhere positive, `log1p` of one that is nowhere above -1, `asin` or
    /// `acos` of a number outside `[-1, 1]`, `tan` of an odd multiple of `pi/2`.
    pub fn is_undefined_constant(&self, id: ExprId) -> bool {
        self.reachable(&[id])
            .into_iter()
            .any(|part| match self.node(part) {
                Node::Product(factors) => factors.iter().any(|(base, exponent)| {
                    let sign = self.sign(*base);
                    (sign == Sign::Zero && exponent.is_negative())
                        || (sign == Sign::Negative && !exponent.is_integer())
                }),
                Node::Call(function, argument) => {
                    self.has_value(*function, *argument) == Some(false)
                }
                _ => false,
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    #[test]
    fn signs_follow_structure_and_assumptions() {
        let mut fixture = Fixture::new();
        for (text, sign) in [
            ("m*l^2", Sign::Positive),
            ("-m*w", Sign::NonPositive),
            ("x^2 + m", Sign::Positive),
            ("x^2 + y^2", Sign::NonNegative),
            ("-x^2 - 1", Sign::Negative),
            ("1/x", Sign::NonZero),
            ("1/x^2", Sign::Positive),
            ("sqrt(x)", Sign::NonNegative),
            ("exp(x)*n", Sign::NonZero),
            ("m - l", Sign::Unknown),
            ("cos(x) + 2", Sign::Unknown),
            ("abs(n)", Sign::Positive),
            ("0*ln(x)", Sign::Zero),
        ] {
            let id = fixture.read(text);
            assert_eq!(fixture.pool.sign(id), sign, "{text}");
        }
    }

    #[test]
    fn finiteness_is_total() {
        let mut fixture = Fixture::new();
        for text in [
            "x/m",
            "sqrt(w)",
            "1/(x^2 + m)",
            "ln(m)",
            "atan2(m, x)",
            "sin(x)*exp(y)",
            "sqrt(x^2)",
            "log1p(w)",
            "log1p(x^2 - 1/2)",
        ] {
            let id = fixture.read(text);
            assert!(fixture.pool.is_finite(id), "{text}");
        }
        for text in [
            "1/x",
            "sqrt(x)",
            "1/w",
            "ln(w)",
            "tan(x)",
            "atan2(x, y)",
            "asin(x)",
            "x + 1/x",
            "w^(-1/2)",
            "log1p(x)",
            "log1p(w - 1)",
        ] {
            let id = fixture.read(text);
            assert!(!fixture.pool.is_finite(id), "{text}");
        }
    }
}
