//! Series over boxes: the coefficients are intervals that contain the coefficients at every point of the box.

use std::cmp::Ordering;

use super::arithmetic::Arithmetic;
use super::expand::{ExpansionPoint, RealPoint};
use crate::enclose::Domain;
use crate::function::Function;
use crate::interval::Interval;
use crate::node::{ExprId, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

/// A point whose numbers are ranges. Each range contains the exact number.
pub trait RangePoint: ExpansionPoint + Clone {
    /// The point whose coordinates are the shortest decimal numbers that round to those of `point`. Printed coordinates
    /// are therefore exact.
    fn of(point: &RealPoint) -> Self;

    /// Common sign of all numbers in the range; `None` if it contains 0 or numbers of both signs.
    fn sign(range: Range<Self>) -> Option<Ordering>;

    /// A double near the middle.
    fn nearest(range: Range<Self>) -> f64;

    /// Upper bound of the distance between numbers in the range and one near the middle.
    fn radius(range: Range<Self>) -> f64;
}

type Range<P> = <<P as ExpansionPoint>::Field as Arithmetic>::Scalar;

/// The shortest decimal number that rounds to `value`, as printed; `None` if `value` is not finite.
pub(super) fn decimal(value: f64) -> Option<Rational> {
    let size = Rational::from_decimal(&value.abs().to_string())?;
    Some(if value < 0.0 { -size } else { size })
}

/// Intervals of doubles, rounded outwards.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Enclosures;

impl Arithmetic for Enclosures {
    type Scalar = Interval;
    type Sum = Interval;

    fn integer(self, value: i64) -> Interval {
        Interval::rational(&Rational::from(value))
    }

    fn rational(self, value: &Rational) -> Option<Interval> {
        Some(Interval::rational(value))
    }

    fn add(self, a: Interval, b: Interval) -> Interval {
        a + b
    }

    fn sub(self, a: Interval, b: Interval) -> Interval {
        a + -b
    }

    fn mul(self, a: Interval, b: Interval) -> Interval {
        a * b
    }

    fn inv(self, a: Interval) -> Option<Interval> {
        a.inverse()
    }

    /// The smallest absolute value in the interval. It is 0 for an interval that contains 0, which therefore is never a
    /// pivot.
    fn size(self, a: Interval) -> f64 {
        a.mignitude()
    }

    fn empty(self) -> Interval {
        Interval::ZERO
    }

    fn settle(self, sum: Interval) -> Interval {
        sum
    }

    fn scatter(
        self,
        sums: &mut [Interval],
        row: &[u32],
        factor: Interval,
        terms: &[(u32, Interval)],
    ) {
        for (j, b) in terms {
            let Some(k) = row.get(*j as usize) else {
                return;
            };
            let sum = &mut sums[*k as usize];
            *sum = *sum + factor * *b;
        }
    }
}

/// A box: a range for each symbol. A symbol without a range may have any real value.
#[derive(Clone, Debug, Default)]
pub struct EnclosedPoint {
    ranges: Domain,
}

impl EnclosedPoint {
    /// The box of these ranges.
    pub fn new(ranges: Domain) -> Self {
        Self { ranges }
    }
}

impl ExpansionPoint for EnclosedPoint {
    type Field = Enclosures;

    fn field(&self) -> Enclosures {
        Enclosures
    }

    fn symbol(&self, _: &Pool, symbol: SymbolId) -> Interval {
        let found = self.ranges.iter().find(|(name, _)| *name == symbol);
        found.map_or(Interval::WHOLE, |(_, range)| *range)
    }

    fn set_symbol(&mut self, symbol: SymbolId, value: Interval) {
        match self.ranges.iter_mut().find(|(name, _)| *name == symbol) {
            Some((_, range)) => *range = value,
            None => self.ranges.push((symbol, value)),
        }
    }

    fn values(&mut self, pool: &Pool, order: &[ExprId]) -> Option<Vec<Interval>> {
        let ranges = pool.enclose(order, &self.ranges);
        let is_known = |id: &ExprId| ranges[id.index()].is_some();
        order.iter().all(is_known).then(|| {
            let values = ranges.into_iter();
            values
                .map(|range| range.unwrap_or(Interval::WHOLE))
                .collect()
        })
    }

    fn pair(
        &mut self,
        _: &Pool,
        function: Function,
        argument: ExprId,
        values: &[Interval],
    ) -> Option<(Interval, Interval)> {
        let x = values[argument.index()];
        Some(match function {
            Function::Sinh | Function::Cosh => (x.increasing(libm::sinh), x.cosh()),
            _ => (x.sin(), x.cos()),
        })
    }

    fn power(&self, value: Interval, exponent: &Rational) -> Option<Interval> {
        value.power(exponent)
    }
}

impl RangePoint for EnclosedPoint {
    fn of(point: &RealPoint) -> Self {
        let range = |value: &f64| {
            decimal(*value).map_or(Interval::WHOLE, |number| Interval::rational(&number))
        };
        let ranges = point.coordinates().iter().map(range);
        Self {
            ranges: (0..).map(SymbolId::from_index).zip(ranges).collect(),
        }
    }

    fn sign(range: Interval) -> Option<Ordering> {
        match (range.lo > 0.0, range.hi < 0.0) {
            (true, _) => Some(Ordering::Greater),
            (_, true) => Some(Ordering::Less),
            _ => None,
        }
    }

    fn nearest(range: Interval) -> f64 {
        f64::midpoint(range.lo, range.hi)
    }

    fn radius(range: Interval) -> f64 {
        (range.hi - range.lo).next_up()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use crate::taylor::{JetSpace, Jets, RealPoint, Reals};

    #[test]
    fn series_at_points_of_a_box_lie_in_that_of_the_box() {
        let mut fixture = Fixture::new();
        let texts = [
            "sin(x)*exp(y)/(2 + cos(x))",
            "sqrt(1 + x^2)*ln(3 + y) + atan(x*y)",
            "tanh(x) - 1/(4 + x)^3",
        ];
        let roots: Vec<ExprId> = texts.iter().map(|text| fixture.read(text)).collect();
        let symbols = ["x", "y"].map(|name| fixture.symbol(name));
        let space = JetSpace::new(2, 3, usize::MAX).unwrap();
        let ranges: Domain = symbols
            .into_iter()
            .zip([Interval::new(0.2, 0.3), Interval::new(-0.1, 0.1)])
            .collect();
        let mut all = EnclosedPoint::new(ranges.clone());
        let enclosures = Jets::new(Enclosures, &space);
        let pool = &fixture.pool;
        let wide = pool
            .taylor(&roots, &symbols, &enclosures, &mut all)
            .unwrap();
        for k in 0..=10 {
            let part = f64::from(k) / 10.0;
            let mut point = RealPoint::default();
            for (symbol, range) in &ranges {
                point.set(*symbol, range.lo + part * (range.hi - range.lo));
            }
            let reals = Jets::new(Reals, &space);
            let thin = pool.taylor(&roots, &symbols, &reals, &mut point).unwrap();
            for (thin, wide) in thin.iter().zip(&wide) {
                for (i, value) in thin.iter().enumerate() {
                    let range = wide.get(i).copied().unwrap_or(Interval::ZERO);
                    let slack = 1e-13 * (1.0 + value.abs());
                    assert!(range.lo <= value + slack && value - slack <= range.hi);
                }
            }
        }
    }
}
