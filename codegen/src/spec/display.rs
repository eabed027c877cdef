//! Expressions in the notation of the language, for messages and labels.

use std::fmt;

use super::ast::{Binder, Index, Operator, Scalar, ScalarKind};

/// Precedence of the outermost operation of an expression.
#[derive(PartialEq, PartialOrd)]
enum Level {
    Sum,
    Product,
    Unary,
    Power,
    Atom,
}

impl Scalar {
    fn level(&self) -> Level {
        match &self.kind {
            ScalarKind::Sum(_) => Level::Sum,
            ScalarKind::Product(_) => Level::Product,
            ScalarKind::Negative(_) => Level::Unary,
            ScalarKind::Power(..) => Level::Power,
            _ => Level::Atom,
        }
    }

    fn write_at(&self, least: Level, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.level() >= least {
            write!(f, "{self}")
        } else {
            write!(f, "({self})")
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            ScalarKind::Number(_, text) => write!(f, "{text}"),
            ScalarKind::Name(name) => write!(f, "{name}"),
            ScalarKind::Member(name, index) => write!(f, "{}[{index}]", name.text),
            ScalarKind::Negative(inner) => {
                write!(f, "-")?;
                inner.write_at(Level::Unary, f)
            }
            ScalarKind::Sum(terms) => write_sum(terms, f),
            ScalarKind::Product(factors) => write_product(factors, f),
            ScalarKind::Power(base, exponent) => {
                base.write_at(Level::Atom, f)?;
                write!(f, "^")?;
                exponent.write_at(Level::Unary, f)
            }
            ScalarKind::Call(function, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
                write!(f, "{}({})", function.text, arguments.join(", "))
            }
            ScalarKind::SumOver(binder, body) => write!(f, "sum({binder}: {body})"),
        }
    }
}

fn write_sum(terms: &[(bool, Scalar)], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for (position, (negative, term)) in terms.iter().enumerate() {
        if position > 0 {
            write!(f, "{}", if *negative { " - " } else { " + " })?;
        }
        term.write_at(Level::Product, f)?;
    }
    Ok(())
}

fn write_product(factors: &[(Operator, Scalar)], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for (position, (operator, factor)) in factors.iter().enumerate() {
        if position > 0 {
            let sign = match operator {
                Operator::Times => '*',
                Operator::Over => '/',
                Operator::Modulo => '%',
            };
            write!(f, "{sign}")?;
        }
        factor.write_at(Level::Unary, f)?;
    }
    Ok(())
}

impl fmt::Display for Binder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in {}..={}", self.name.text, self.low, self.high)
    }
}

impl fmt::Display for Index {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(index) => write!(f, "[{index}]"),
            Self::Each(binder) => write!(f, "[{binder}]"),
        }
    }
}
