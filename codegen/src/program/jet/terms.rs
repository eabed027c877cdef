//! Coefficient `k` of a value as an expression of the coefficients that it depends on.
//!
//! These expressions fix the range of each sum and the order of the factors of a product. All code that computes series
//! uses them, except the reference in `interpret.rs`.

use dalembert_expr::Rational;

use super::degree::Degree;
use super::{History, Jet, Recurrence};
use crate::program::Value;

/// Largest number of stored series for which values of order `k` are locals and sums are computed side by side. A
/// larger expansion calls one shared function for sums and keeps its values in memory, because a compiler would use
/// stack for every local of such a long function.
const LARGE: usize = 128;

/// An expression of coefficients, at order `k`.
#[derive(Debug, Clone, PartialEq)]
pub enum Term {
    /// 0
    Zero,
    /// The unit of time at order 1; 0 at higher orders.
    Time,
    /// A constant.
    Number(Rational),
    /// `k`
    Order,
    /// `1 / k`
    InverseOrder,
    /// Coefficient `k` of a value.
    Next(Value),
    /// Coefficient 0 of a value.
    First(Value),
    /// The reciprocal of coefficient 0 of a value.
    Inverse(Value),
    /// `-a`
    Neg(Box<Term>),
    /// `a + b`
    Add(Box<[Term; 2]>),
    /// `a - b`
    Sub(Box<[Term; 2]>),
    /// `a b`
    Mul(Box<[Term; 2]>),
    /// `a b + c`, with the rounding of `Numbers::mul_add`.
    MulAdd(Box<[Term; 3]>),
    /// `a`, negated if `b` is negative.
    Turned(Box<[Term; 2]>),
    /// `sum a_j b_(k-j)` for `j` in `1..k`.
    Middle(History, History),
    /// Half of `sum a_j a_(k-j)` for `j` in `1..k`.
    Half(Value),
    /// `sum a_j b_(k-j)` for `j` in `1..=k`, where `a_j` vanishes beyond an order.
    Short(History, History, usize),
    /// `a_1 b_(k-1)`: the same sum for a value `a` that is affine in time.
    Steady(Value, Value),
}

impl Term {
    /// Calls `see` for the term and all its subterms.
    pub fn walk(&self, see: &mut impl FnMut(&Self)) {
        see(self);
        match self {
            Self::Neg(a) => a.walk(see),
            Self::Add(operands)
            | Self::Sub(operands)
            | Self::Mul(operands)
            | Self::Turned(operands) => operands.iter().for_each(|operand| operand.walk(see)),
            Self::MulAdd(operands) => operands.iter().for_each(|operand| operand.walk(see)),
            _ => {}
        }
    }
}

fn neg(a: Term) -> Term {
    Term::Neg(Box::new(a))
}

fn add(a: Term, b: Term) -> Term {
    Term::Add(Box::new([a, b]))
}

fn sub(a: Term, b: Term) -> Term {
    Term::Sub(Box::new([a, b]))
}

fn mul(a: Term, b: Term) -> Term {
    Term::Mul(Box::new([a, b]))
}

fn mul_add(a: Term, b: Term, c: Term) -> Term {
    Term::MulAdd(Box::new([a, b, c]))
}

fn signed(negative: bool, a: Term) -> Term {
    match negative {
        true => neg(a),
        false => a,
    }
}

impl Jet {
    /// True if the number of stored series exceeds `LARGE`, so that values are kept in memory.
    pub fn is_large(&self) -> bool {
        self.histories.len() > LARGE
    }

    /// Coefficient `k` of a value. For a component of the state the result is [`Term::Zero`]; its coefficient is known
    /// from the previous order.
    pub fn term(&self, value: Value) -> Term {
        let (next, first, inverse) = (Term::Next, Term::First, Term::Inverse);
        match &self.recurrences[value.index()] {
            Recurrence::Constant | Recurrence::Component(_) => Term::Zero,
            Recurrence::Time => Term::Time,
            Recurrence::Same(a) => next(*a),
            Recurrence::Neg(a) => neg(next(*a)),
            Recurrence::Add(a, b) => add(next(*a), next(*b)),
            Recurrence::Sub(a, b) => sub(next(*a), next(*b)),
            Recurrence::Scaled(a, b) => mul(first(*a), next(*b)),
            Recurrence::Divided(a, b) => mul(next(*a), inverse(*b)),
            Recurrence::Product(a, b) => self.product(*a, *b),
            Recurrence::Square(a) => {
                let two = Term::Number(Rational::from(2));
                mul(two, mul_add(first(*a), next(*a), Term::Half(*a)))
            }
            Recurrence::Quotient(a, b) => {
                let known = self.upper_sum(*b, value);
                let numerator = match a {
                    Some(a) => sub(next(*a), known),
                    None => neg(known),
                };
                mul(numerator, inverse(*b))
            }
            Recurrence::Root(a) => {
                let half = mul(Term::Number(Rational::new(1, 2)), next(*a));
                mul(sub(half, Term::Half(value)), inverse(value))
            }
            Recurrence::Power(a, exponent) => {
                let rising = mul(Term::Number(exponent.clone()), self.weighted_sum(*a, value));
                let known = Term::Middle(History::weighted(value), History::plain(*a));
                let sum = mul(sub(rising, known), Term::InverseOrder);
                mul(sum, inverse(*a))
            }
            Recurrence::Integral { of, by, negative } => signed(*negative, self.integral(*of, *by)),
            Recurrence::IntegralQuotient { of, by, negative } => {
                let known = Term::Middle(History::weighted(value), History::plain(*by));
                let of = signed(*negative, next(*of));
                mul(sub(of, mul(Term::InverseOrder, known)), inverse(*by))
            }
            Recurrence::Angle { y, x, squared } => self.angle(value, [*y, *x, *squared]),
            Recurrence::Absolute(a) => Term::Turned(Box::new([next(*a), first(*a)])),
        }
    }

    fn degree_of(&self, value: Value) -> Degree {
        self.degrees[value.index()]
    }

    /// `sum a_j b_(k-j)` for `j` in `0..=k`.
    fn product(&self, a: Value, b: Value) -> Term {
        // The factor that is computed last comes second.
        let (a, b) = match (self.degree_of(a), a.index()) > (self.degree_of(b), b.index()) {
            true => (b, a),
            false => (a, b),
        };
        let (first, next) = (Term::First(a), Term::Next(b));
        if self.degree_of(a) == Degree::Endless && self.is_early(a) && self.is_early(b) {
            let middle = Term::Middle(History::plain(a), History::plain(b));
            let other = mul(Term::Next(a), Term::First(b));
            return add(mul_add(first, next, other), middle);
        }
        mul_add(first, next, self.upper_sum(a, b))
    }

    /// True if coefficient `k` of a value is known at the start of order `k`, before the sums over lower orders.
    fn is_early(&self, value: Value) -> bool {
        matches!(
            self.recurrences[value.index()],
            Recurrence::Component(_) | Recurrence::Time
        )
    }

    fn angle(&self, value: Value, [y, x, squared]: [Value; 3]) -> Term {
        let (rise, fall) = (self.weighted_sum(y, x), self.weighted_sum(x, y));
        let known = Term::Middle(History::weighted(value), History::plain(squared));
        let sum = sub(sub(rise, fall), known);
        mul(mul(sum, Term::InverseOrder), Term::Inverse(squared))
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`.
    fn upper_sum(&self, a: Value, b: Value) -> Term {
        if let Some(product) = self.product_with_constant(a, b) {
            return product;
        }
        let (rising, other) = (History::plain(a), History::plain(b));
        self.short(rising, other)
            .unwrap_or_else(|| mul_add(Term::Next(a), Term::First(b), Term::Middle(rising, other)))
    }

    /// The sum of `a_j b_(k-j)` for `j` in `1..=k` if `a` or `b` is constant: 0 for a constant `a`, `a_k b_0` for a
    /// constant `b`.
    fn product_with_constant(&self, a: Value, b: Value) -> Option<Term> {
        let is_constant = |value: Value| self.recurrences[value.index()] == Recurrence::Constant;
        match (is_constant(a), is_constant(b)) {
            (true, _) => Some(Term::Zero),
            (false, true) => Some(mul(Term::Next(a), Term::First(b))),
            (false, false) => None,
        }
    }

    /// `sum j a_j b_(k-j)` for `j` in `1..=k`.
    fn weighted_sum(&self, a: Value, b: Value) -> Term {
        if let Some(product) = self.product_with_constant(a, b) {
            return mul(Term::Order, product);
        }
        let (rising, other) = (History::weighted(a), History::plain(b));
        self.short(rising, other).unwrap_or_else(|| {
            let newest = mul(Term::Order, Term::Next(a));
            mul_add(newest, Term::First(b), Term::Middle(rising, other))
        })
    }

    /// `sum j/k a_j b_(k-j)` for `j` in `1..=k`.
    fn integral(&self, a: Value, b: Value) -> Term {
        if let Some(product) = self.product_with_constant(a, b) {
            return product;
        }
        let (rising, other) = (History::weighted(a), History::plain(b));
        if let Some(short) = self.short(rising, other) {
            return mul(Term::InverseOrder, short);
        }
        let newest = mul(Term::Next(a), Term::First(b));
        mul_add(Term::InverseOrder, Term::Middle(rising, other), newest)
    }

    /// `sum a_j b_(k-j)` for `j` in `1..=k`, if the series of `a` ends.
    fn short(&self, a: History, b: History) -> Option<Term> {
        match self.degree_of(a.value) {
            Degree::Endless => None,
            // NOTE: above order 0, `a` has a coefficient of order 1 only. Its weight is 1 in weighted sums as well.
            Degree::AtMost(1) if !self.is_large() => Some(Term::Steady(a.value, b.value)),
            Degree::AtMost(degree) => Some(Term::Short(a, b, degree as usize)),
        }
    }
}
