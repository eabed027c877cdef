//! Truncated series: products, powers, functions.
//!
//! A series is the list of its coefficients, by monomial. Missing coefficients at the end are 0; 0 is the empty list.
//! The Euler operator `E = sum x_v d_v` multiplies the part of degree d by d. With it, every function satisfies a
//! linear recurrence by degree: `E(exp u) = exp(u) E(u)`, `u E(u^r) = r u^r E(u)`, `E(sin u) = cos(u) E(u)`.

use super::arithmetic::Arithmetic;
use super::space::JetSpace;
use crate::rational::Rational;

/// The coefficients of a series, by monomial.
pub type Series<A> = Vec<<A as Arithmetic>::Scalar>;

/// Series over a field, truncated after an order.
#[derive(Copy, Clone, Debug)]
pub struct Jets<'s, A> {
    /// The coefficients' field.
    pub field: A,
    /// The monomials.
    pub space: &'s JetSpace,
    order: usize,
}

/// Pairs of functions. The second derivative of each function is minus or plus the function.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(super) enum Pair {
    /// `sin`, `cos`
    Circular,
    /// `sinh`, `cosh`
    Hyperbolic,
}

impl<'s, A: Arithmetic> Jets<'s, A> {
    /// Series of the highest order of a space.
    pub fn new(field: A, space: &'s JetSpace) -> Self {
        let order = space.order();
        Self {
            field,
            space,
            order,
        }
    }

    /// The order after which series are cut off.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Series of one order less, the order of derivatives; order 0 stays 0.
    pub fn lower(self) -> Self {
        Self {
            order: self.order.saturating_sub(1),
            ..self
        }
    }

    fn limit(&self) -> usize {
        self.space.size(self.order)
    }

    /// A constant.
    pub fn constant(&self, value: A::Scalar) -> Series<A> {
        if self.field.is_zero(value) {
            Vec::new()
        } else {
            vec![value]
        }
    }

    /// `value + x_v`
    pub fn variable(&self, v: usize, value: A::Scalar) -> Series<A> {
        let mut series = vec![value];
        if self.order > 0 {
            series.resize(v + 2, self.field.integer(0));
            series[v + 1] = self.field.integer(1);
        }
        series
    }

    /// The value at the point of expansion.
    pub fn value(&self, a: &[A::Scalar]) -> A::Scalar {
        a.first().copied().unwrap_or(self.field.integer(0))
    }

    /// `a + factor b`
    pub fn add_multiple(&self, a: &[A::Scalar], factor: A::Scalar, b: &[A::Scalar]) -> Series<A> {
        let field = self.field;
        self.combined(a, b, |a, b| field.add(a, field.mul(factor, b)))
    }

    /// `a + b`
    pub fn add(&self, a: &[A::Scalar], b: &[A::Scalar]) -> Series<A> {
        self.combined(a, b, |a, b| self.field.add(a, b))
    }

    /// `a - b`
    pub fn sub(&self, a: &[A::Scalar], b: &[A::Scalar]) -> Series<A> {
        self.combined(a, b, |a, b| self.field.sub(a, b))
    }

    /// Combines coefficients up to the length of `b`; coefficients of `a` beyond it stay as they are.
    fn combined(
        &self,
        a: &[A::Scalar],
        b: &[A::Scalar],
        combine: impl Fn(A::Scalar, A::Scalar) -> A::Scalar,
    ) -> Series<A> {
        let mut sum = a[..a.len().min(self.limit())].to_vec();
        let b = &b[..b.len().min(self.limit())];
        if sum.len() < b.len() {
            sum.resize(b.len(), self.field.integer(0));
        }
        // NOTE: this loop uses an index, because the generator is compiled without optimisation in a user's build,
        // where iterators are slow.
        let mut i = 0;
        while i < b.len() {
            sum[i] = combine(sum[i], b[i]);
            i += 1;
        }
        self.trim(sum)
    }

    /// Subtracts `a b`.
    pub fn subtract_product(&self, from: &mut Series<A>, a: &[A::Scalar], b: &[A::Scalar]) {
        let (a, b) = if a.len() > b.len() { (b, a) } else { (a, b) };
        let &[factor] = a else {
            *from = self.sub(from, &self.mul(a, b));
            return;
        };
        let field = self.field;
        let b = &b[..b.len().min(self.limit())];
        from.truncate(self.limit());
        if from.len() < b.len() {
            from.resize(b.len(), field.integer(0));
        }
        let mut i = 0;
        while i < b.len() {
            from[i] = field.sub(from[i], field.mul(factor, b[i]));
            i += 1;
        }
        self.cut(from);
    }

    /// Multiplies by `factor`.
    pub fn multiply(&self, series: &mut Series<A>, factor: &[A::Scalar]) {
        let &[factor] = factor else {
            *series = self.mul(series, factor);
            return;
        };
        series.truncate(self.limit());
        let mut i = 0;
        while i < series.len() {
            series[i] = self.field.mul(factor, series[i]);
            i += 1;
        }
        self.cut(series);
    }

    /// `factor a`
    pub fn scale(&self, factor: A::Scalar, a: &[A::Scalar]) -> Series<A> {
        self.add_multiple(&[], factor, a)
    }

    /// `a b`
    pub fn mul(&self, a: &[A::Scalar], b: &[A::Scalar]) -> Series<A> {
        let (a, b) = if a.len() > b.len() { (b, a) } else { (a, b) };
        match a {
            [] => Vec::new(),
            [factor] => self.scale(*factor, b),
            _ => {
                let mut sums = vec![self.field.empty(); self.limit()];
                self.accumulate(&mut sums, a, b);
                self.settle(&sums)
            }
        }
    }

    /// `sum of a_i b_i`
    pub fn dot<'v>(
        &self,
        pairs: impl IntoIterator<Item = (&'v [A::Scalar], &'v [A::Scalar])>,
    ) -> Series<A>
    where
        A::Scalar: 'v,
    {
        let mut sums = Vec::new();
        for (a, b) in pairs {
            if a.is_empty() || b.is_empty() {
                continue;
            }
            if sums.is_empty() {
                sums = vec![self.field.empty(); self.limit()];
            }
            self.accumulate(&mut sums, a, b);
        }
        self.settle(&sums)
    }

    fn accumulate(&self, sums: &mut [A::Sum], a: &[A::Scalar], b: &[A::Scalar]) {
        let terms = self.terms(b);
        let length = a.len().min(self.limit());
        let mut i = 0;
        while i < length {
            if !self.field.is_zero(a[i]) {
                self.field.scatter(sums, self.row(i), a[i], &terms);
            }
            i += 1;
        }
    }

    /// The part of a row of products that stays within the order.
    fn row(&self, i: usize) -> &'s [u32] {
        let left = self.order - self.space.degree(i);
        &self.space.row(i)[..self.space.size(left)]
    }

    /// The coefficients other than 0 with their positions.
    fn terms(&self, a: &[A::Scalar]) -> Vec<(u32, A::Scalar)> {
        let mut terms = Vec::with_capacity(a.len());
        let mut i = 0;
        while i < a.len() {
            if !self.field.is_zero(a[i]) {
                terms.push((i as u32, a[i]));
            }
            i += 1;
        }
        terms
    }

    fn settle(&self, sums: &[A::Sum]) -> Series<A> {
        let mut series = Vec::with_capacity(sums.len());
        let mut i = 0;
        while i < sums.len() {
            series.push(self.field.settle(sums[i]));
            i += 1;
        }
        self.trim(series)
    }

    fn trim(&self, mut a: Series<A>) -> Series<A> {
        self.cut(&mut a);
        a
    }

    /// Removes zeros at the end.
    fn cut(&self, a: &mut Series<A>) {
        while a.last().is_some_and(|last| self.field.is_zero(*last)) {
            a.pop();
        }
    }

    /// `d a / d x_v`, correct up to the order below.
    pub fn derivative(&self, a: &[A::Scalar], v: usize) -> Series<A> {
        if self.order == 0 {
            return Vec::new();
        }
        let length = self.space.size(self.order - 1);
        let mut series = Vec::with_capacity(length);
        for i in 0..length {
            let Some(value) = a.get(self.space.raise(i, v)) else {
                series.push(self.field.integer(0));
                continue;
            };
            let multiple = i64::from(self.space.exponent(i, v)) + 1;
            series.push(self.field.mul(self.field.integer(multiple), *value));
        }
        self.trim(series)
    }

    /// `1 / a`; `None` if the value of `a` is 0.
    pub fn inverse(&self, a: &[A::Scalar]) -> Option<Series<A>> {
        let value = self.field.inv(self.value(a))?;
        self.power(a, &Rational::from(-1), value)
    }

    /// The square root of `a` whose value is given; `None` if the value of `a` is 0 and `a` is not constant.
    pub fn root(&self, a: &[A::Scalar], value: A::Scalar) -> Option<Series<A>> {
        match a.len() {
            0 | 1 => Some(self.constant(value)),
            _ => self.power(a, &Rational::HALF, value),
        }
    }

    /// `a^exponent` whose value is given; `None` if the value of `a` is 0.
    pub(super) fn power(
        &self,
        a: &[A::Scalar],
        exponent: &Rational,
        value: A::Scalar,
    ) -> Option<Series<A>> {
        let field = self.field;
        let pivot = field.inv(self.value(a))?;
        let exponent = field.rational(exponent)?;
        let degrees = self.degrees(a.len());
        // u_0 d_k y_k = sum over i > 0 of (r d_i - d_j) u_i y_j
        let weights = |degree: usize| {
            let below = field.integer(degree as i64);
            let weigh = |(i, a): (usize, &A::Scalar)| {
                let rate = field.mul(exponent, field.integer(degrees[i] as i64));
                field.mul(field.sub(rate, below), *a)
            };
            a.iter().enumerate().map(weigh).collect()
        };
        self.solve(value, pivot, weights)
    }

    /// `exp(a)` whose value is given.
    pub(super) fn exponential(&self, a: &[A::Scalar], value: A::Scalar) -> Option<Series<A>> {
        let rate = self.euler(a);
        self.solve(value, self.field.integer(1), |_| rate.clone())
    }

    /// `y` with `y_k = pivot / d_k * sum over i > 0 of weights(d_j)_i y_j` and a given value.
    fn solve(
        &self,
        value: A::Scalar,
        pivot: A::Scalar,
        weights: impl Fn(usize) -> Series<A>,
    ) -> Option<Series<A>> {
        let field = self.field;
        let mut sums = vec![field.empty(); self.limit()];
        let mut series = vec![field.integer(0); self.limit()];
        series[0] = value;
        for degree in 0..=self.order {
            let grade = self.space.grade(degree);
            if degree > 0 {
                let factor = field.mul(pivot, field.inv(field.integer(degree as i64))?);
                for k in grade.clone() {
                    series[k] = field.mul(factor, field.settle(sums[k]));
                }
            }
            if degree == self.order {
                break;
            }
            let mut terms = self.terms(&weights(degree));
            terms.retain(|(i, _)| *i > 0);
            for j in grade {
                if !field.is_zero(series[j]) {
                    field.scatter(&mut sums, self.row(j), series[j], &terms);
                }
            }
        }
        Some(self.trim(series))
    }

    /// `(sin a, cos a)` or `(sinh a, cosh a)` whose values are given.
    pub(super) fn pair(
        &self,
        kind: Pair,
        a: &[A::Scalar],
        values: (A::Scalar, A::Scalar),
    ) -> Option<(Series<A>, Series<A>)> {
        let field = self.field;
        let mut terms = self.terms(&self.euler(a));
        terms.retain(|(i, _)| *i > 0);
        let mut sums = [
            vec![field.empty(); self.limit()],
            vec![field.empty(); self.limit()],
        ];
        let mut series = [
            vec![field.integer(0); self.limit()],
            vec![field.integer(0); self.limit()],
        ];
        (series[0][0], series[1][0]) = values;
        for degree in 0..=self.order {
            let grade = self.space.grade(degree);
            if degree > 0 {
                let factor = field.inv(field.integer(degree as i64))?;
                for k in grade.clone() {
                    series[0][k] = field.mul(factor, field.settle(sums[1][k]));
                    let cosine = field.mul(factor, field.settle(sums[0][k]));
                    series[1][k] = match kind {
                        Pair::Circular => field.neg(cosine),
                        Pair::Hyperbolic => cosine,
                    };
                }
            }
            if degree == self.order {
                break;
            }
            for j in grade {
                for (sums, series) in sums.iter_mut().zip(&series) {
                    if !field.is_zero(series[j]) {
                        field.scatter(sums, self.row(j), series[j], &terms);
                    }
                }
            }
        }
        let [sine, cosine] = series;
        Some((self.trim(sine), self.trim(cosine)))
    }

    /// The series with `E(y) = rate E(a)` and a given value.
    pub(super) fn integral(
        &self,
        rate: &[A::Scalar],
        a: &[A::Scalar],
        value: A::Scalar,
    ) -> Option<Series<A>> {
        self.undo_euler(self.mul(rate, &self.euler(a)), value)
    }

    /// The series with `E(y) = rate` and a given value.
    pub(super) fn undo_euler(&self, mut rate: Series<A>, value: A::Scalar) -> Option<Series<A>> {
        if rate.is_empty() {
            return Some(self.constant(value));
        }
        rate[0] = value;
        let degrees = self.degrees(rate.len());
        for (entry, degree) in rate.iter_mut().zip(degrees).skip(1) {
            let inverse = self.field.inv(self.field.integer(degree as i64))?;
            *entry = self.field.mul(inverse, *entry);
        }
        Some(self.trim(rate))
    }

    /// `E(a)`
    pub(super) fn euler(&self, a: &[A::Scalar]) -> Series<A> {
        let degrees = self.degrees(a.len().min(self.limit()));
        let rate = degrees
            .iter()
            .zip(a)
            .map(|(degree, a)| self.field.mul(self.field.integer(*degree as i64), *a));
        self.trim(rate.collect())
    }

    /// The degrees of the first monomials.
    fn degrees(&self, count: usize) -> Vec<usize> {
        let mut degrees = Vec::with_capacity(count);
        for degree in 0..=self.space.order() {
            for _ in self.space.grade(degree) {
                if degrees.len() == count {
                    return degrees;
                }
                degrees.push(degree);
            }
        }
        degrees
    }
}
