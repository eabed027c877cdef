//! Constructors of products and powers: `product of base^exponent` in the normal form of [`Node::Product`].
//!
//! Exponents of one base are added. The demands of the single powers on the base are recorded beside the sum of the
//! exponents: `x^-1` demands that `x` is not 0, `x^(1/2)` that `x` is not negative. If the power with the summed
//! exponent demands less, and the base is not known to meet the demands, a guard keeps the domain; see
//! [`Pool::settle`].

use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::sign::is_even;

/// Demands of powers on their base.
#[derive(Copy, Clone, Default)]
struct Demand {
    nonzero: bool,
    nonnegative: bool,
}

impl Demand {
    /// Demand of `x^exponent` on `x`.
    fn of(exponent: &Rational) -> Self {
        Self {
            nonzero: exponent.is_negative(),
            nonnegative: !exponent.is_integer(),
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            nonzero: self.nonzero || other.nonzero,
            nonnegative: self.nonnegative || other.nonnegative,
        }
    }
}

/// A product under construction.
struct Factors {
    coefficient: Rational,
    entries: Vec<Entry>,
}

struct Entry {
    base: ExprId,
    exponent: Rational,
    demand: Demand,
}

impl Factors {
    fn new() -> Self {
        Self {
            coefficient: Rational::ONE,
            entries: Vec::new(),
        }
    }

    fn push(&mut self, base: ExprId, exponent: Rational, demand: Demand) {
        let demand = demand.and(Demand::of(&exponent));
        self.entries.push(Entry {
            base,
            exponent,
            demand,
        });
    }

    /// Merges the entries of equal base, and sorts them by base.
    fn merge(&mut self) {
        self.entries.sort_by_key(|entry| entry.base);
        self.entries.dedup_by(|entry, total| {
            let same = entry.base == total.base;
            if same {
                total.exponent = &total.exponent + &entry.exponent;
                total.demand = total.demand.and(entry.demand);
            }
            same
        });
    }
}

impl Pool {
    /// `a * b`
    pub fn mul(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == self.one() {
            return b;
        }
        if b == self.one() {
            return a;
        }
        self.product(&[a, b])
    }

    /// `a / b`
    pub fn div(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.power_product(&[(a, Rational::ONE), (b, Rational::MINUS_ONE)])
    }

    /// The product of all; 1 if there is none.
    pub fn product(&mut self, factors: &[ExprId]) -> ExprId {
        let factors: Vec<_> = factors.iter().map(|id| (*id, Rational::ONE)).collect();
        self.power_product(&factors)
    }

    /// `base^exponent`. `x^0` is 1, also for `x = 0`. A term `0*x` keeps the domain of `x` unless `x` is known to be
    /// finite.
    pub fn pow(&mut self, base: ExprId, exponent: Rational) -> ExprId {
        if exponent.is_zero() {
            let vanishing = self.scale(&exponent, base);
            let one = self.one();
            return self.add(one, vanishing);
        }
        if exponent.abs() == Rational::HALF
            && let Some(root) = self.denested_root(base)
        {
            return match exponent.is_negative() {
                true => self.power_product(&[(root, Rational::MINUS_ONE)]),
                false => root,
            };
        }
        self.power_product(&[(base, exponent)])
    }

    /// The non-negative square root.
    pub fn sqrt(&mut self, a: ExprId) -> ExprId {
        self.pow(a, Rational::HALF)
    }

    /// The product of `base^exponent`; exponents are not 0.
    pub fn power_product(&mut self, powers: &[(ExprId, Rational)]) -> ExprId {
        let mut factors = Factors::new();
        for (base, exponent) in powers {
            self.expand(&mut factors, *base, exponent);
        }
        let settled = loop {
            factors.merge();
            let mut settled = Vec::with_capacity(factors.entries.len());
            for entry in std::mem::take(&mut factors.entries) {
                self.settle(&mut factors.coefficient, &mut settled, entry);
            }
            if !settled
                .iter()
                .any(|(base, exponent)| self.is_expandable(*base, exponent))
            {
                break settled;
            }
            // Merging has completed a root of a product. The factors of that product join the others.
            for (base, exponent) in settled {
                self.expand(&mut factors, base, &exponent);
            }
        };
        let product = self.build_product(settled);
        self.scale(&factors.coefficient, product)
    }

    fn build_product(&mut self, mut factors: Vec<(ExprId, Rational)>) -> ExprId {
        factors.sort();
        match factors.as_slice() {
            [] => self.one(),
            [(base, exponent)] if exponent.is_one() => *base,
            _ => self.intern(Node::Product(factors.into())),
        }
    }

    /// True if [`Pool::expand`] splits `base^exponent` into factors. Guards `sqrt(x)^n` and plain powers stay.
    fn is_expandable(&self, base: ExprId, exponent: &Rational) -> bool {
        exponent.is_integer()
            && match self.node(base) {
                Node::Product(factors) => {
                    !matches!(&**factors, [(_, inner)] if *inner == Rational::HALF)
                }
                Node::Sum { .. } => {
                    let (coefficient, _) = self.as_multiple(base);
                    !coefficient.is_one()
                        && !coefficient.is_zero()
                        && number_power(&coefficient, exponent).1.is_none()
                }
                _ => false,
            }
    }

    /// Multiplies `factors` by `base^exponent`.
    fn expand(&mut self, factors: &mut Factors, base: ExprId, exponent: &Rational) {
        match self.node(base) {
            Node::Number(value) => {
                let (coefficient, rest) = number_power(value, exponent);
                factors.coefficient = &factors.coefficient * &coefficient;
                if let Some((value, exponent)) = rest {
                    let base = self.number(value);
                    factors.push(base, exponent, Demand::default());
                }
            }
            Node::Sum { .. } => self.expand_multiple(factors, base, exponent),
            Node::Product(inner) => {
                let inner = inner.clone();
                if exponent.is_integer() {
                    for (base, power) in &inner {
                        self.expand_nested(factors, *base, power, exponent);
                    }
                } else {
                    self.expand_root(factors, base, &inner, exponent);
                }
            }
            _ => factors.push(base, exponent.clone(), Demand::default()),
        }
    }

    /// `(base^power)^exponent` for an integer `exponent`.
    fn expand_nested(
        &mut self,
        factors: &mut Factors,
        base: ExprId,
        power: &Rational,
        exponent: &Rational,
    ) {
        let total = power * exponent;
        match self.node(base) {
            // The guard sqrt(x)^n is a power of x with the demands x >= 0, and x != 0 for n < 0.
            Node::Product(inner) if power.is_integer() => {
                for (base, root) in inner.clone() {
                    factors.push(
                        base,
                        &root * &total,
                        Demand::of(&root).and(Demand::of(power)),
                    );
                }
            }
            Node::Number(value) if value.is_positive() => self.expand(factors, base, &total),
            _ => factors.push(base, total, Demand::of(power)),
        }
    }

    /// `(c x)^exponent`
    fn expand_multiple(&mut self, factors: &mut Factors, base: ExprId, exponent: &Rational) {
        let (coefficient, term) = self.as_multiple(base);
        let vanishes = coefficient.is_zero() && (exponent.is_negative() || !exponent.is_integer());
        if term == base || vanishes {
            return factors.push(base, exponent.clone(), Demand::default());
        }
        match number_power(&coefficient, exponent) {
            (power, None) => {
                factors.coefficient = &factors.coefficient * &power;
                self.expand(factors, term, exponent);
            }
            _ => factors.push(base, exponent.clone(), Demand::default()),
        }
    }

    /// `(product)^exponent` for a fraction `exponent`.
    fn expand_root(
        &mut self,
        factors: &mut Factors,
        product: ExprId,
        inner: &[(ExprId, Rational)],
        exponent: &Rational,
    ) {
        if let [(base, power)] = inner {
            let invertible = !power.is_integer() || !is_even(power);
            if invertible || self.sign(*base).is_nonnegative() {
                let demand = Demand {
                    nonnegative: true,
                    ..Demand::of(power)
                };
                return factors.push(*base, power * exponent, demand);
            }
        }
        let comes_out = |(base, power): &&(ExprId, Rational)| {
            (power * exponent).is_integer() && self.sign(*base) == crate::Sign::Positive
        };
        let (outside, inside): (Vec<_>, Vec<_>) = inner.iter().partition(comes_out);
        if outside.is_empty() || inside.is_empty() {
            return factors.push(product, exponent.clone(), Demand::default());
        }
        for (base, power) in outside {
            factors.push(*base, power * exponent, Demand::default());
        }
        let inside = self.build_product(inside.into_iter().cloned().collect());
        self.expand(factors, inside, exponent);
    }

    /// Appends `base^exponent` with the guards that keep the demand on the base.
    ///
    /// | missing | total | appended |
    /// |---|---|---|
    /// | `x != 0` | `t >= 0` | `x^(t+1) x^-1` |
    /// | `x >= 0` | integer `t != 0` | `sqrt(x)^(2 t)` |
    /// | both, or `x >= 0` with `t = 0` | integer `t` | `x^(t+1/2) x^(-1/2)` |
    fn settle(
        &mut self,
        coefficient: &mut Rational,
        settled: &mut Vec<(ExprId, Rational)>,
        entry: Entry,
    ) {
        let Entry {
            base,
            exponent,
            demand,
        } = entry;
        let sign = self.sign(base);
        let given = Demand::of(&exponent);
        let nonzero = demand.nonzero && !given.nonzero && !sign.is_nonzero();
        let nonnegative = demand.nonnegative && !given.nonnegative && !sign.is_nonnegative();
        if let (Node::Number(value), false, false) = (self.node(base), nonzero, nonnegative) {
            let (power, rest) = number_power(value, &exponent);
            *coefficient = &*coefficient * &power;
            if let Some((value, exponent)) = rest {
                settled.push((self.number(value), exponent));
            }
            return;
        }
        let half = Rational::HALF;
        match (nonzero, nonnegative) {
            (false, false) if exponent.is_zero() => {
                if !self.is_finite(base) {
                    settled.push((base, Rational::ONE));
                    settled.push((base, Rational::MINUS_ONE));
                }
            }
            (false, false) => settled.push((base, exponent)),
            (true, false) => {
                settled.push((base, &exponent + &Rational::ONE));
                settled.push((base, Rational::MINUS_ONE));
            }
            (false, true) if !exponent.is_zero() => {
                let root = self.intern(Node::Product([(base, half)].into()));
                settled.push((root, &exponent + &exponent));
            }
            _ => {
                settled.push((base, &exponent + &half));
                settled.push((base, -half));
            }
        }
    }
}

/// `value^exponent` as a number times an optional power. The power is left if it is irrational, too large or undefined.
fn number_power(value: &Rational, exponent: &Rational) -> (Rational, Option<(Rational, Rational)>) {
    let whole = exponent.floor();
    let fraction = exponent - &whole;
    let unevaluated = || (Rational::ONE, Some((value.clone(), exponent.clone())));
    if exponent.is_zero() {
        return (Rational::ONE, None);
    }
    if value.is_zero() && exponent.is_positive() {
        return (Rational::ZERO, None);
    }
    if !value.is_positive() && !fraction.is_zero() {
        return unevaluated();
    }
    let power = whole
        .to_i64()
        .and_then(|n| value.pow_i(i32::try_from(n).ok()?));
    match power {
        Some(power) if fraction.is_zero() => (power, None),
        Some(power) => match rational_power(value, &fraction) {
            Some(root) => (&power * &root, None),
            None => (power, Some((value.clone(), fraction))),
        },
        None => unevaluated(),
    }
}

/// `value^fraction` for a positive value and a fraction in `(0, 1)`; `None` if it is irrational or its root is too
/// high.
fn rational_power(value: &Rational, fraction: &Rational) -> Option<Rational> {
    const MAX_DEGREE: i64 = 64;
    let (power, degree) = fraction.to_small()?;
    if degree > MAX_DEGREE {
        return None;
    }
    let root = value.exact_root(u32::try_from(degree).ok()?)?;
    root.pow_i(i32::try_from(power).ok()?)
}
