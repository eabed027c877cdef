//! Lowering of expressions to operations.
//!
//! Nodes are lowered in increasing id, so operands come first and depth costs no stack. Sums are factored:
//! a factor that several terms share is multiplied once (`a*b + a*c` becomes `a*(b + c)`), the most frequent
//! first. Powers are products; negative powers of one product share one division.

use std::collections::{HashMap, HashSet};

use dalembert_expr::{ExprId, Node, Pool, Rational, SymbolId, WordHash};

use super::builder::Builder;
use super::{Input, Op, Value};

/// A term of a sum: coefficient and factors with their exponents.
type Term = (Rational, Vec<(ExprId, Rational)>);

/// Operation on the value of the remaining terms of a sum.
enum Pending {
    Times(Value),
    Plus(Value),
}

/// Lowers expressions of one pool into one function.
#[derive(Debug)]
pub struct Expressions<'a> {
    pool: &'a Pool,
    values: HashMap<ExprId, Value, WordHash>,
    /// Lowered expressions that depend on anything but parameters and numbers.
    moving: HashSet<ExprId, WordHash>,
    bindings: HashMap<SymbolId, Value, WordHash>,
}

impl<'a> Expressions<'a> {
    /// Nothing bound yet.
    pub fn new(pool: &'a Pool) -> Self {
        Self {
            pool,
            values: HashMap::default(),
            moving: HashSet::default(),
            bindings: HashMap::default(),
        }
    }

    /// Binds a symbol to its value.
    pub fn bind(&mut self, symbol: SymbolId, value: Value) {
        self.bindings.insert(symbol, value);
    }

    /// The value of a symbol, if it has one.
    pub fn bound(&self, symbol: SymbolId) -> Option<Value> {
        self.bindings.get(&symbol).copied()
    }

    /// The value of an expression all of whose symbols are bound. A symbol that is not bound counts as zero;
    /// the kernel binds all that a function may use before it lowers anything.
    pub fn lower(&mut self, builder: &mut Builder, root: ExprId) -> Value {
        for id in self.pending(root) {
            let value = self.lower_node(builder, id);
            self.values.insert(id, value);
            if self.is_moving(builder, id) {
                self.moving.insert(id);
            }
        }
        self.values[&root]
    }

    /// The nodes below `root` that have no value yet, operands first.
    fn pending(&self, root: ExprId) -> Vec<ExprId> {
        let mut found = Vec::new();
        let mut stack = vec![root];
        let mut seen = HashSet::<ExprId, WordHash>::default();
        while let Some(id) = stack.pop() {
            if self.values.contains_key(&id) || !seen.insert(id) {
                continue;
            }
            found.push(id);
            self.pool
                .node(id)
                .for_each_operand(|operand| stack.push(operand));
        }
        found.sort_unstable();
        found
    }

    fn lower_node(&mut self, builder: &mut Builder, id: ExprId) -> Value {
        match self.pool.node(id) {
            Node::Number(number) => builder.number(number.clone()),
            Node::Pi => builder.pi(),
            Node::Symbol(symbol) => match self.bindings.get(symbol) {
                Some(&value) => value,
                None => builder.zero(),
            },
            Node::Sum { constant, terms } => {
                let terms = terms
                    .iter()
                    .map(|(coefficient, id)| (coefficient.clone(), self.factors(*id)))
                    .collect();
                let sum = self.lower_sum(builder, terms);
                let constant = builder.number(constant.clone());
                builder.add(sum, constant)
            }
            Node::Product(factors) => {
                let factors = factors.to_vec();
                self.lower_product(builder, &factors)
            }
            Node::Call(function, argument) => {
                let value = builder.call(*function, self.values[argument]);
                if let Node::Symbol(symbol) = self.pool.node(*argument) {
                    let name = format!("{}_{}", function.name(), self.pool.symbol_name(*symbol));
                    builder.name(value, name);
                }
                value
            }
            Node::Atan2(y, x) => builder.atan2(self.values[y], self.values[x]),
        }
    }

    /// The factors of a term of a sum.
    fn factors(&self, id: ExprId) -> Vec<(ExprId, Rational)> {
        match self.pool.node(id) {
            Node::Product(factors) => factors.to_vec(),
            _ => vec![(id, Rational::from(1))],
        }
    }

    /// Factors that several terms share are taken out, the most frequent first, unless a coefficient is
    /// [extreme](is_extreme): its term then needs its powers whole.
    fn lower_sum(&self, builder: &mut Builder, mut terms: Vec<Term>) -> Value {
        let mut pending = Vec::new();
        while let Some(shared) = most_frequent_factor(&terms) {
            let (mut inside, mut outside) = (Vec::new(), Vec::new());
            for (coefficient, mut factors) in terms {
                match take_factor(&mut factors, shared) {
                    true => inside.push((coefficient, factors)),
                    false => outside.push((coefficient, factors)),
                }
            }
            // NOTE: the function recurses for a proper part of the terms only. Otherwise high powers would overflow the
            // stack.
            if outside.is_empty() {
                pending.push(Pending::Times(self.values[&shared]));
                terms = inside;
            } else {
                let cofactor = self.lower_sum(builder, inside);
                pending.push(Pending::Plus(builder.mul(self.values[&shared], cofactor)));
                terms = outside;
            }
        }
        let rest = self.lower_plain_sum(builder, terms);
        pending
            .into_iter()
            .rev()
            .fold(rest, |rest, pending| match pending {
                Pending::Times(factor) => builder.mul(factor, rest),
                Pending::Plus(term) => builder.add(term, rest),
            })
    }

    /// A sum whose terms share no factor; a coefficient that all terms share up to sign is applied once.
    fn lower_plain_sum(&self, builder: &mut Builder, terms: Vec<Term>) -> Value {
        let size = terms.first().map(|(coefficient, _)| coefficient.abs());
        let common = size.filter(|size| {
            terms.len() > 1 && !is_extreme(size) && terms.iter().all(|(c, _)| c.abs() == *size)
        });
        let mut total = builder.zero();
        for (coefficient, factors) in terms {
            let (coefficient, product) = self.lower_term(builder, coefficient, &factors);
            let weight = match &common {
                Some(_) => Rational::from(if coefficient.is_negative() { -1 } else { 1 }),
                None => coefficient,
            };
            if weight.is_negative() {
                let weight = builder.number(-weight);
                total = builder.sub_product(total, weight, product);
            } else {
                let weight = builder.number(weight);
                total = builder.add_product(total, weight, product);
            }
        }
        match common {
            Some(size) => {
                let size = builder.number(size);
                builder.mul(size, total)
            }
            None => total,
        }
    }

    /// Coefficient and product of a term. An [extreme](is_extreme) coefficient `c` of a power is divided among its
    /// factors: `c*b^n` becomes `(c/2^(k n))*(2^k b)^n`, which is the same number without overflow on the way.
    fn lower_term(
        &self,
        builder: &mut Builder,
        coefficient: Rational,
        factors: &[(ExprId, Rational)],
    ) -> (Rational, Value) {
        let balanced = Some(&coefficient)
            .filter(|coefficient| is_extreme(coefficient))
            .and_then(|coefficient| balance(coefficient, factors));
        let Some((position, scale, coefficient)) = balanced else {
            return (coefficient, self.lower_product(builder, factors));
        };
        let (base, exponent) = &factors[position];
        let rest = [&factors[..position], &factors[position + 1..]].concat();
        let rest = self.lower_product(builder, &rest);
        let scale = builder.number(scale);
        let base = builder.mul(scale, self.values[base]);
        let power = positive_power(builder, base, &exponent.abs());
        let product = match exponent.is_negative() {
            true => builder.div(rest, power),
            false => builder.mul(rest, power),
        };
        (coefficient, product)
    }

    /// Parameters are multiplied and divided first: products then share the part that depends only on parameters.
    fn lower_product(&self, builder: &mut Builder, factors: &[(ExprId, Rational)]) -> Value {
        let mut ordered: Vec<&(ExprId, Rational)> = factors.iter().collect();
        let is_symbol = |base| matches!(self.pool.node(base), Node::Symbol(_));
        ordered.sort_by_key(|&&(base, _)| (self.moving.contains(&base), !is_symbol(base), base));
        let (mut above, mut denominator) = (Vec::new(), builder.integer(1));
        let mut steady = 0;
        for (base, exponent) in ordered {
            let power = positive_power(builder, self.values[base], &exponent.abs());
            match exponent.is_negative() {
                true => denominator = builder.mul(denominator, power),
                false => above.push(power),
            }
            if !self.moving.contains(base) {
                steady = above.len();
            }
        }
        // If the quotient of a factor by the denominator exists already, no division is needed.
        for factor in &mut above {
            if let Some(quotient) = builder.existing_quotient(*factor, denominator) {
                (*factor, denominator) = (quotient, builder.integer(1));
                break;
            }
        }
        let is_steady = |(base, exponent): &(ExprId, Rational)| {
            !exponent.is_negative() || !self.moving.contains(base)
        };
        let one = builder.integer(1);
        let mut numerator = one;
        for (position, factor) in above.into_iter().enumerate() {
            if position == steady && position > 0 && factors.iter().all(is_steady) {
                numerator = builder.div(numerator, denominator);
                denominator = one;
            }
            numerator = builder.mul(numerator, factor);
        }
        builder.div(numerator, denominator)
    }

    /// True if an expression whose operands are lowered depends on anything but parameters and numbers.
    fn is_moving(&self, builder: &Builder, id: ExprId) -> bool {
        let node = self.pool.node(id);
        if let Node::Symbol(symbol) = node {
            let value = self.bindings.get(symbol);
            let is_parameter = |value| matches!(builder.op(value), Op::Input(Input::Parameter(_)));
            return !value.is_some_and(|&value| is_parameter(value));
        }
        let mut found = false;
        node.for_each_operand(|operand| found |= self.moving.contains(&operand));
        found
    }
}

/// `base^exponent` for a positive exponent: products, square roots, or a general power.
pub fn positive_power(builder: &mut Builder, base: Value, exponent: &Rational) -> Value {
    let doubled = exponent.clone() + exponent.clone();
    match (exponent.to_i64(), doubled.to_i64()) {
        (Some(integer), _) => integer_power(builder, base, integer),
        (None, Some(odd)) => {
            let root = builder.sqrt(base);
            let rest = integer_power(builder, base, odd / 2);
            builder.mul(root, rest)
        }
        _ => builder.power(base, exponent.clone()),
    }
}

/// True for a number that may exceed the range of `f64`, or bring a product with a high power out of it. Half of the
/// range is left for the power.
fn is_extreme(number: &Rational) -> bool {
    number.log2().abs() > 500
}

/// The position of the power whose base takes over most of a coefficient, the power of two that multiplies the base, and
/// the coefficient that is left; `None` if no factor has an integer exponent of absolute value 2 or more.
fn balance(
    coefficient: &Rational,
    factors: &[(ExprId, Rational)],
) -> Option<(usize, Rational, Rational)> {
    const MOST: i64 = 1 << 10;
    let integers = factors.iter().enumerate().filter_map(|(position, factor)| {
        let exponent = factor.1.to_i64()?;
        (exponent.abs() > 1).then_some((position, exponent))
    });
    let (position, exponent) = integers.max_by_key(|(_, exponent)| exponent.abs())?;
    let two = |shift: i64| Rational::from(2).pow_i(i32::try_from(shift).ok()?);
    // With the nearest shift, the coefficient that is left is between about `2^(-n/2)` and `2^(n/2)`, `n = |exponent|`.
    let shift = (coefficient.log2() as f64 / exponent as f64).round() as i64;
    let (mut rest, mut taken) = (coefficient.clone(), -shift * exponent);
    while taken != 0 {
        // The length of a power is limited.
        let part = taken.clamp(-MOST, MOST);
        rest = &rest * &two(part)?;
        taken -= part;
    }
    Some((position, two(shift)?, rest))
}

/// Largest number of factors in a sum for which shared factors are sought. The time of the search grows with the square
/// of this number.
const SEARCHED: usize = 1 << 13;

/// The base that occurs with a positive integer exponent in the most terms, at least two.
fn most_frequent_factor(terms: &[Term]) -> Option<ExprId> {
    let length: usize = terms.iter().map(|(_, factors)| factors.len()).sum();
    if terms.len() < 2 || length > SEARCHED || terms.iter().any(|(c, _)| is_extreme(c)) {
        return None;
    }
    let shareable = || {
        let factors = terms.iter().flat_map(|(_, factors)| factors);
        let whole = factors.filter(|(_, exponent)| exponent.is_integer() && exponent.is_positive());
        whole.map(|(base, _)| *base)
    };
    let mut counts: HashMap<ExprId, usize, WordHash> = HashMap::default();
    for base in shareable() {
        *counts.entry(base).or_default() += 1;
    }
    let best = shareable().map(|base| counts[&base]).max()?;
    // The first of the most frequent bases: the order of the terms decides, never the order of the map.
    shareable().find(|base| best > 1 && counts[base] == best)
}

/// Lowers the exponent of `base` by one, if it is a positive integer.
fn take_factor(factors: &mut Vec<(ExprId, Rational)>, base: ExprId) -> bool {
    let found = factors
        .iter()
        .position(|(b, e)| *b == base && e.is_integer() && e.is_positive());
    let Some(position) = found else { return false };
    match factors[position].1.is_one() {
        true => drop(factors.remove(position)),
        false => factors[position].1 = factors[position].1.clone() - Rational::from(1),
    }
    true
}

/// `base^n` by squaring; 1 for `n = 0`.
fn integer_power(builder: &mut Builder, base: Value, n: i64) -> Value {
    let (mut result, mut square, mut left) = (builder.integer(1), base, n);
    while left > 0 {
        if left & 1 == 1 {
            result = builder.mul(result, square);
        }
        left >>= 1;
        if left > 0 {
            square = builder.mul(square, square);
        }
    }
    result
}
