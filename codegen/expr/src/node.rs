//! Nodes of expressions: their types, and the identifiers of nodes and symbols.

use crate::function::Function;
use crate::rational::Rational;

/// Identifier of a symbol of a [`Pool`](crate::Pool).
#[derive(Copy, Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Debug)]
pub struct SymbolId(u32);

/// Identifier of an expression of a [`Pool`](crate::Pool). Operands have smaller identifiers than their users.
#[derive(Copy, Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Debug)]
pub struct ExprId(u32);

macro_rules! id {
    ($name:ident) => {
        impl $name {
            /// Position in order of creation.
            pub fn index(self) -> usize {
                self.0 as usize
            }

            /// NOTE: this is the only place where a pool of more than 2^32 items would fail; memory runs out long
            /// before.
            pub(crate) fn from_index(index: usize) -> Self {
                Self(index as u32)
            }
        }
    };
}

id!(SymbolId);
id!(ExprId);

/// Assumption on a symbol. Every symbol is a finite real number.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
pub enum Assumption {
    /// No further condition.
    None,
    /// Greater than 0.
    Positive,
    /// Not less than 0.
    NonNegative,
    /// Not equal to 0.
    NonZero,
}

/// An expression whose operands are expressions of the same pool.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// An exact number.
    Number(Rational),
    /// The circle constant.
    Pi,
    /// A symbol.
    Symbol(SymbolId),
    /// `constant + sum of coefficient * term`.
    ///
    /// Terms are in order of id, each once, and are no numbers. A coefficient is 0 only to keep the domain of its
    /// term. A sum of two or more summands has coefficients without common factor and a positive first
    /// coefficient. A multiple of such a sum is a `Sum` with this sum as its only term. See
    /// [`Pool::add`](crate::Pool::add).
    Sum {
        /// The numeric summand.
        constant: Rational,
        /// Coefficients and their terms.
        terms: Box<[(Rational, ExprId)]>,
    },
    /// Product of `base^exponent`, in order of base and exponent; a single entry is a power.
    ///
    /// Exponents are never 0. Numeric coefficients live in the enclosing sum. A base occurs twice only where
    /// merging would enlarge the domain. See [`Pool::mul`](crate::Pool::mul).
    Product(Box<[(ExprId, Rational)]>),
    /// A function of one argument.
    Call(Function, ExprId),
    /// `atan2(y, x)`, the angle of the point `(x, y)`.
    Atan2(ExprId, ExprId),
}

impl Node {
    /// Calls `visit` with every operand, in order of occurrence.
    pub fn for_each_operand(&self, mut visit: impl FnMut(ExprId)) {
        match self {
            Self::Number(_) | Self::Pi | Self::Symbol(_) => {}
            Self::Sum { terms, .. } => terms.iter().for_each(|(_, term)| visit(*term)),
            Self::Product(factors) => factors.iter().for_each(|(base, _)| visit(*base)),
            Self::Call(_, argument) => visit(*argument),
            Self::Atan2(y, x) => {
                visit(*y);
                visit(*x);
            }
        }
    }

    /// Visits the numbers stored in the node itself.
    fn for_each_number(&self, mut visit: impl FnMut(&Rational)) {
        match self {
            Self::Number(value) => visit(value),
            Self::Sum { constant, terms } => {
                visit(constant);
                terms.iter().for_each(|(coefficient, _)| visit(coefficient));
            }
            Self::Product(factors) => factors.iter().for_each(|(_, exponent)| visit(exponent)),
            Self::Pi | Self::Symbol(_) | Self::Call(..) | Self::Atan2(..) => {}
        }
    }

    /// The bits of the longest number stored in the node itself.
    pub(crate) fn number_bits(&self) -> u64 {
        let mut bits = 0;
        self.for_each_number(|number| bits = bits.max(number.bits()));
        bits
    }

    /// Steps of the pool's budget that the creation of the node costs.
    pub(crate) fn steps(&self) -> u64 {
        let mut steps = 1;
        self.for_each_operand(|_| steps += 1);
        self.for_each_number(|number| steps += number.bits() / 64);
        steps
    }
}
