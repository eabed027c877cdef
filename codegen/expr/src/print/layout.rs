//! Layout of an expression for printing: quotients, signs, common factors, order of terms.

use std::collections::VecDeque;

use crate::function::Function;
use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::sign::is_even;

/// Largest depth of nesting. Deeper parts are omitted.
const MAX_DEPTH: usize = 120;
/// Largest number of parts. Further parts are omitted.
const MAX_PARTS: usize = 20_000;

/// A layout. Its numbers are not negative; signs are in [`Layout::Sum`] and [`Layout::Negative`].
pub(super) enum Layout {
    Integer(String),
    Pi,
    Symbol(SymbolId),
    /// Summands, each with a flag for subtraction.
    Sum(Vec<(bool, Layout)>),
    /// Numerator and denominator, each a list of factors. An empty list is 1.
    Quotient(Vec<Layout>, Vec<Layout>),
    /// A positive power other than 1 and 1/2.
    Power(Box<Layout>, Rational),
    Root(Box<Layout>),
    Call(Function, Box<Layout>),
    Atan2(Box<Layout>, Box<Layout>),
    Negative(Box<Layout>),
    Omitted,
}

/// Coefficient and powers of `coefficient * product of base^exponent`.
type Term = (Rational, Vec<(ExprId, Rational)>);

/// Base of a factor: an expression, or a sum whose common factors were taken out.
enum Base {
    Expression(ExprId),
    Sum(Vec<Term>),
}

/// Layout of an expression.
pub(super) fn layout(pool: &Pool, id: ExprId) -> Layout {
    Builder {
        pool,
        parts: 0,
        depth: 0,
    }
    .expression(id)
}

struct Builder<'a> {
    pool: &'a Pool,
    parts: usize,
    depth: usize,
}

impl Builder<'_> {
    fn expression(&mut self, id: ExprId) -> Layout {
        if self.depth >= MAX_DEPTH || self.parts >= MAX_PARTS {
            return Layout::Omitted;
        }
        self.depth += 1;
        self.parts += 1;
        let pool = self.pool;
        let layout = match pool.node(id) {
            Node::Pi => Layout::Pi,
            Node::Symbol(symbol) => Layout::Symbol(*symbol),
            Node::Call(function, argument) => {
                Layout::Call(*function, Box::new(self.expression(*argument)))
            }
            Node::Atan2(y, x) => {
                Layout::Atan2(Box::new(self.expression(*y)), Box::new(self.expression(*x)))
            }
            Node::Number(_) | Node::Sum { .. } | Node::Product(_) => self.term(pool.term(id)),
        };
        self.depth -= 1;
        layout
    }

    /// Layout of a product. Common factors are taken out of its sums, and the overall sign is determined.
    fn term(&mut self, (coefficient, factors): Term) -> Layout {
        let mut bases = self.split_sums(factors);
        let mut negative = coefficient.is_negative();
        if negative {
            negative = !flip_one_sum(&mut bases, coefficient == Rational::MINUS_ONE);
        }
        // Numbers and symbols come first, then functions, then sums; within each class the order is kept.
        bases.sort_by_key(|(base, _)| self.rank(base));
        let layout = self.quotient(&coefficient.abs(), &bases);
        if negative {
            Layout::Negative(Box::new(layout))
        } else {
            layout
        }
    }

    /// Takes common factors with integer powers out of sums. A common factor may itself be a sum.
    fn split_sums(&self, factors: Vec<(ExprId, Rational)>) -> Vec<(Base, Rational)> {
        let mut bases: Vec<(Base, Rational)> = Vec::new();
        let mut pending = VecDeque::from(factors);
        while let Some((base, exponent)) = pending.pop_front() {
            if !matches!(self.pool.node(base), Node::Sum { .. }) {
                multiply(&mut bases, base, exponent);
                continue;
            }
            let mut terms = self.pool.sum_terms(base);
            if exponent.is_integer() {
                for (base, power) in take_common_factors(&mut terms) {
                    pending.push_back((base, &power * &exponent));
                }
            }
            bases.push((Base::Sum(terms), exponent));
        }
        bases
    }

    fn rank(&self, base: &Base) -> u8 {
        match base {
            Base::Sum(_) => 3,
            Base::Expression(id) => match self.pool.node(*id) {
                Node::Number(_) | Node::Pi => 0,
                Node::Symbol(_) => 1,
                _ => 2,
            },
        }
    }

    fn quotient(&mut self, coefficient: &Rational, bases: &[(Base, Rational)]) -> Layout {
        let (mut above, mut below) = (Vec::new(), Vec::new());
        let (numer, denom) = (coefficient.numer(), coefficient.denom());
        let has_numerator = bases.iter().any(|(_, exponent)| !exponent.is_negative());
        if numer != 1.into() || !has_numerator {
            above.push(Layout::Integer(numer.to_string()));
        }
        for (base, exponent) in bases {
            let layout = self.power(base, &exponent.abs());
            if exponent.is_negative() {
                below.push(layout)
            } else {
                above.push(layout)
            }
        }
        if denom != 1.into() {
            below.insert(0, Layout::Integer(denom.to_string()));
        }
        match (above.pop(), above.is_empty(), below.is_empty()) {
            (Some(single), true, true) => single,
            (last, ..) => {
                above.extend(last);
                Layout::Quotient(above, below)
            }
        }
    }

    fn power(&mut self, base: &Base, exponent: &Rational) -> Layout {
        let base = match base {
            Base::Expression(id) => self.expression(*id),
            Base::Sum(terms) => self.sum(terms),
        };
        match exponent {
            exponent if exponent.is_one() => base,
            exponent if *exponent == Rational::HALF => Layout::Root(Box::new(base)),
            exponent => Layout::Power(Box::new(base), exponent.clone()),
        }
    }

    /// Layout of a sum. The first positive summand is moved to the front.
    fn sum(&mut self, terms: &[Term]) -> Layout {
        let lead = terms
            .iter()
            .position(|(coefficient, _)| !coefficient.is_negative())
            .unwrap_or(0);
        let order = [lead]
            .into_iter()
            .chain((0..terms.len()).filter(|position| *position != lead));
        let mut summands = Vec::with_capacity(terms.len());
        for position in order {
            let (coefficient, factors) = &terms[position];
            match self.term((coefficient.clone(), factors.clone())) {
                Layout::Negative(layout) => summands.push((true, *layout)),
                Layout::Sum(inner) => summands.extend(inner),
                layout => summands.push((false, layout)),
            }
        }
        match summands.len() {
            1 => match summands.remove(0) {
                (true, layout) => Layout::Negative(Box::new(layout)),
                (false, layout) => layout,
            },
            _ => Layout::Sum(summands),
        }
    }
}

/// Multiplies by `base^exponent`. Integer powers of one base are merged if both are positive or both negative.
fn multiply(bases: &mut Vec<(Base, Rational)>, base: ExprId, exponent: Rational) {
    for (known, power) in bases.iter_mut() {
        let same = matches!(known, Base::Expression(id) if *id == base);
        let integers = power.is_integer() && exponent.is_integer();
        if same && integers && power.is_negative() == exponent.is_negative() {
            *power = &*power + &exponent;
            return;
        }
    }
    bases.push((Base::Expression(base), exponent));
}

/// Changes the sign of the first sum with an odd power that has a negative summand. With `always`, it also changes the
/// sign of a sum that is the only factor. Returns true if a sign was changed.
fn flip_one_sum(bases: &mut [(Base, Rational)], always: bool) -> bool {
    let alone = always && bases.len() == 1;
    for (base, exponent) in bases {
        let Base::Sum(terms) = base else {
            continue;
        };
        let odd = exponent.is_integer() && !is_even(exponent);
        let alone = alone && exponent.is_one();
        if odd
            && (alone
                || terms
                    .iter()
                    .any(|(coefficient, _)| coefficient.is_negative()))
        {
            terms
                .iter_mut()
                .for_each(|(coefficient, _)| *coefficient = -&*coefficient);
            return true;
        }
    }
    false
}

/// Divides all terms by their common powers and returns these.
fn take_common_factors(terms: &mut [Term]) -> Vec<(ExprId, Rational)> {
    let Some((first, others)) = terms.split_first() else {
        return Vec::new();
    };
    let mut common = first.1.clone();
    for (_, factors) in others {
        common.retain_mut(|(base, exponent)| {
            let shared = factors
                .iter()
                .find_map(|(b, e)| shared_power(*b == *base, exponent, e));
            let found = shared.is_some();
            *exponent = shared.unwrap_or(Rational::ZERO);
            found
        });
    }
    for (_, factors) in terms {
        for (base, exponent) in &common {
            let known = factors
                .iter_mut()
                .find(|(b, e)| b == base && e.is_negative() == exponent.is_negative());
            if let Some((_, power)) = known {
                *power = &*power - exponent;
            }
        }
        factors.retain(|(_, exponent)| !exponent.is_zero());
    }
    common
}

/// The common part of two powers of one base: the exponent of smaller size. `None` unless the exponents have the same
/// sign and are equal or integers.
fn shared_power(same_base: bool, a: &Rational, b: &Rational) -> Option<Rational> {
    let alike = same_base && a.is_negative() == b.is_negative();
    let whole = a == b || (a.is_integer() && b.is_integer());
    (alike && whole).then(|| {
        if a.abs() <= b.abs() {
            a.clone()
        } else {
            b.clone()
        }
    })
}

impl Pool {
    /// An expression as a coefficient times powers.
    fn term(&self, id: ExprId) -> Term {
        if let Some(value) = self.as_number(id) {
            return (value.clone(), Vec::new());
        }
        let (coefficient, term) = self.as_multiple(id);
        match self.node(term) {
            Node::Product(factors) => (coefficient, factors.to_vec()),
            _ => (coefficient, vec![(term, Rational::ONE)]),
        }
    }

    /// The terms of a sum. The constant is the last one.
    fn sum_terms(&self, sum: ExprId) -> Vec<Term> {
        let Node::Sum { constant, terms } = self.node(sum) else {
            return vec![self.term(sum)];
        };
        let scaled = |(coefficient, term): &(Rational, ExprId)| {
            let (inner, factors) = self.term(*term);
            (coefficient * &inner, factors)
        };
        let mut terms: Vec<Term> = terms.iter().map(scaled).collect();
        if !constant.is_zero() {
            terms.push((constant.clone(), Vec::new()));
        }
        terms
    }
}
