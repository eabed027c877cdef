//! Proofs that an expression has no zero in a box. Intervals enclose it on parts of the box until all are decided.
//!
//! A box may be unbounded. Boxes are halved in the variable `x/(1+|x|)`, in which the whole line has length 2. Where
//! the derivative with respect to a symbol keeps its sign, the values at both ends of the range of this symbol bound
//! the expression. Horner's rule decides the signs of polynomials at large arguments, where terms that are enclosed one
//! by one seem to cancel.

use std::collections::BTreeMap;
use std::ops::{Add, Mul};

use crate::interval::Interval;
use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

/// Largest number of boxes that are examined.
const BOXES: usize = 4096;

/// Ranges of symbols. Every other symbol may be any real number.
pub type Domain = Vec<(SymbolId, Interval)>;

/// The answer of [`Pool::zeros_on`].
#[derive(Clone, PartialEq, Debug)]
pub enum Zeros {
    /// No zero.
    None,
    /// A zero between two points: the value is positive at the first and negative at the second.
    Between(Vec<(SymbolId, f64)>, Vec<(SymbolId, f64)>),
    /// Undecided: a part of the box in which neither was proved.
    Open(Domain),
}

impl Pool {
    /// The ranges of expressions over a box, by index of the expression; `None` where one may have no value. `order` is
    /// [`Pool::reachable`] of some roots.
    pub fn enclose(&self, order: &[ExprId], domain: &Domain) -> Vec<Option<Interval>> {
        let mut ranges = vec![None; order.last().map_or(0, |id| id.index() + 1)];
        for id in order {
            ranges[id.index()] = self.range(*id, &ranges, domain);
        }
        ranges
    }

    fn range(&self, id: ExprId, ranges: &[Option<Interval>], domain: &Domain) -> Option<Interval> {
        match self.node(id) {
            Node::Number(value) => Some(Interval::rational(value)),
            Node::Pi => Some(Interval::pi()),
            Node::Symbol(symbol) => {
                let range = domain.iter().find(|(name, _)| name == symbol);
                Some(range.map_or(Interval::WHOLE, |(_, range)| *range))
            }
            Node::Sum { constant, terms } => {
                let mut sum: Option<Interval> =
                    (!constant.is_zero()).then(|| Interval::rational(constant));
                for (coefficient, term) in terms {
                    let part = Interval::rational(coefficient).mul(ranges[term.index()]?);
                    sum = Some(sum.map_or(part, |sum| sum.add(part)));
                }
                let sum = sum.unwrap_or(Interval::point(0.0));
                Some(self.far_out(constant, terms, ranges, sum))
            }
            Node::Product(factors) => {
                let mut product = Interval::point(1.0);
                for (base, exponent) in factors {
                    product = product.mul(ranges[base.index()]?.power(exponent)?);
                }
                Some(product)
            }
            Node::Call(function, argument) => function.range(ranges[argument.index()]?),
            Node::Atan2(y, x) => {
                let origin = [y, x].map(|part| ranges[part.index()]);
                let [Some(y), Some(x)] = origin else {
                    return None;
                };
                let turn = Interval::pi().hi;
                (y.excludes_zero() || x.excludes_zero()).then(|| Interval::new(-turn, turn))
            }
        }
    }

    /// Narrows the range of a sum by Horner's rule in every unbounded base: the largest power then decides.
    fn far_out(
        &self,
        constant: &Rational,
        terms: &[(Rational, ExprId)],
        ranges: &[Option<Interval>],
        mut range: Interval,
    ) -> Interval {
        for (base, x) in self.unbounded_bases(terms, ranges) {
            let mut powers = BTreeMap::from([(0, Interval::rational(constant))]);
            for (coefficient, term) in terms {
                let Some((power, rest)) = self.power_of(base, *term, ranges) else {
                    return range;
                };
                let part = Interval::rational(coefficient).mul(rest);
                let sum = powers
                    .get(&power)
                    .map_or(part, |sum: &Interval| sum.add(part));
                powers.insert(power, sum);
            }
            if powers.len() > 1
                && let Some(nested) = nested(&powers, x)
            {
                range = Interval::new(range.lo.max(nested.lo), range.hi.min(nested.hi));
            }
        }
        range
    }

    /// Terms and factors of terms that have no bounds, with their ranges.
    fn unbounded_bases(
        &self,
        terms: &[(Rational, ExprId)],
        ranges: &[Option<Interval>],
    ) -> Vec<(ExprId, Interval)> {
        let mut bases = Vec::new();
        for (_, term) in terms {
            match self.node(*term) {
                Node::Product(factors) => bases.extend(factors.iter().map(|(base, _)| *base)),
                _ => bases.push(*term),
            }
        }
        bases.sort_unstable();
        bases.dedup();
        let with_range = bases
            .into_iter()
            .filter_map(|base| Some((base, ranges[base.index()]?)));
        with_range
            .filter(|(_, range)| range.magnitude().is_infinite())
            .collect()
    }

    /// A term as a power of a base times the range of the rest.
    fn power_of(
        &self,
        base: ExprId,
        term: ExprId,
        ranges: &[Option<Interval>],
    ) -> Option<(i64, Interval)> {
        if term == base {
            return Some((1, Interval::point(1.0)));
        }
        let whole = Some((0, ranges[term.index()]?));
        let Node::Product(factors) = self.node(term) else {
            return whole;
        };
        let found = factors.iter().find(|(factor, _)| *factor == base);
        let power = found.and_then(|(_, power)| power.to_i64().filter(|power| *power > 0));
        let Some(power) = power else {
            return whole;
        };
        let mut rest = Interval::point(1.0);
        for (factor, exponent) in factors.iter().filter(|(factor, _)| *factor != base) {
            rest = rest.mul(ranges[factor.index()]?.power(exponent)?);
        }
        Some((power, rest))
    }

    /// Looks for a zero of an expression in a box; `slopes` are its derivatives with respect to the
    /// symbols of the box, in order.
    pub fn zeros_on(&self, id: ExprId, slopes: &[ExprId], domain: &Domain) -> Zeros {
        let mut roots = vec![id];
        roots.extend(slopes);
        let search = Search {
            pool: self,
            order: self.reachable(&[id]),
            all: self.reachable(&roots),
            id,
            slopes,
        };
        search.run(domain)
    }
}

/// `sum of c_k x^k`, by Horner's rule.
fn nested(powers: &BTreeMap<i64, Interval>, x: Interval) -> Option<Interval> {
    let mut falling = powers.iter().rev();
    let (mut power, mut sum) = falling.next().map(|(power, range)| (*power, *range))?;
    for (lower, coefficient) in falling {
        let step = x.power(&Rational::from(power - lower))?;
        sum = sum.mul(step);
        // A coefficient 0 of the lowest power adds nothing, not even rounding.
        if *coefficient != Interval::point(0.0) {
            sum = sum.add(*coefficient);
        }
        power = *lower;
    }
    Some(sum)
}

struct Search<'s> {
    pool: &'s Pool,
    order: Vec<ExprId>,
    all: Vec<ExprId>,
    id: ExprId,
    slopes: &'s [ExprId],
}

impl Search<'_> {
    fn run(&self, domain: &Domain) -> Zeros {
        let mut open = vec![domain.clone()];
        let mut signs: [Option<Vec<(SymbolId, f64)>>; 2] = [None, None];
        let is_continuous = self.range(domain).is_some();
        let mut first_open = None;
        let mut boxes = 0;
        while let Some(part) = open.pop() {
            boxes += 1;
            if self
                .range_by_ends(&part)
                .is_some_and(Interval::excludes_zero)
            {
                continue;
            }
            let middle: Domain = part
                .iter()
                .map(|(symbol, range)| (*symbol, Interval::point(middle(*range))))
                .collect();
            if let Some(range) = self.range(&middle) {
                let point = || middle.iter().map(|(s, x)| (*s, x.lo)).collect();
                if range.lo > 0.0 {
                    signs[0].get_or_insert_with(point);
                }
                if range.hi < 0.0 {
                    signs[1].get_or_insert_with(point);
                }
            }
            if let [Some(above), Some(below)] = &signs
                && is_continuous
            {
                return Zeros::Between(above.clone(), below.clone());
            }
            match halves(&part) {
                Some([left, right]) if boxes < BOXES => open.extend([right, left]),
                _ => {
                    first_open.get_or_insert(part);
                    if boxes >= BOXES {
                        break;
                    }
                }
            }
        }
        match first_open.or(open.pop()) {
            None => Zeros::None,
            Some(part) => match signs {
                [Some(above), Some(below)] if is_continuous => Zeros::Between(above, below),
                _ => Zeros::Open(part),
            },
        }
    }

    fn range(&self, domain: &Domain) -> Option<Interval> {
        self.pool.enclose(&self.order, domain)[self.id.index()]
    }

    /// The range of the expression. In each symbol in which the expression is monotone, only the ends of the symbol's
    /// range are used.
    fn range_by_ends(&self, domain: &Domain) -> Option<Interval> {
        let ranges = self.pool.enclose(&self.all, domain);
        let (mut low, mut high) = (domain.clone(), domain.clone());
        for (i, slope) in self.slopes.iter().enumerate() {
            let Some(slope) = ranges[slope.index()] else {
                continue;
            };
            let range = domain[i].1;
            if slope.lo >= 0.0 {
                low[i].1 = Interval::point(range.lo);
                high[i].1 = Interval::point(range.hi);
            } else if slope.hi <= 0.0 {
                low[i].1 = Interval::point(range.hi);
                high[i].1 = Interval::point(range.lo);
            }
        }
        let whole = ranges[self.id.index()]?;
        let (low, high) = (self.range(&low), self.range(&high));
        Some(Interval::new(
            low.map_or(whole.lo, |low| low.lo.max(whole.lo)),
            high.map_or(whole.hi, |high| high.hi.min(whole.hi)),
        ))
    }
}

fn squeezed(x: f64) -> f64 {
    match x.is_infinite() {
        true => x.signum(),
        false => x / (1.0 + x.abs()),
    }
}

/// A number inside of the range, halfway in `x/(1+|x|)`.
fn middle(range: Interval) -> f64 {
    let place = f64::midpoint(squeezed(range.lo), squeezed(range.hi));
    let x = place / (1.0 - place.abs());
    x.clamp(range.lo, range.hi)
}

/// Both halves in the direction that is widest in `x/(1+|x|)`; `None` if nothing is left to halve.
fn halves(part: &Domain) -> Option<[Domain; 2]> {
    let width = |range: &Interval| squeezed(range.hi) - squeezed(range.lo);
    let widest =
        (0..part.len()).max_by(|a, b| width(&part[*a].1).total_cmp(&width(&part[*b].1)))?;
    let range = part[widest].1;
    let place = middle(range);
    if place <= range.lo || place >= range.hi {
        return None;
    }
    let with = |range: Interval| {
        let mut half = part.clone();
        half[widest].1 = range;
        half
    };
    Some([
        with(Interval::new(range.lo, place)),
        with(Interval::new(place, range.hi)),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    fn zeros(text: &str) -> Zeros {
        let mut fixture = Fixture::new();
        let id = fixture.read(text);
        let symbols = ["x", "y"].map(|name| fixture.symbol(name));
        let slopes = symbols.map(|symbol| fixture.pool.diff(id, symbol));
        let mut domain: Domain = symbols.map(|symbol| (symbol, Interval::WHOLE)).into();
        let occurs = symbols.map(|symbol| fixture.pool.depends_on(id, symbol));
        let slopes: Vec<_> = (0..2).filter(|i| occurs[*i]).map(|i| slopes[i]).collect();
        domain.retain(|(symbol, _)| fixture.pool.depends_on(id, *symbol));
        fixture.pool.zeros_on(id, &slopes, &domain)
    }

    #[test]
    fn expressions_without_zeros_on_the_plane_are_proved_to_have_none() {
        for text in [
            "x^2 + y^2 + 1",
            "x^2 - x + 1",
            "x^4 - x^3 + 2",
            "2 + sin(x)*cos(y)",
            "exp(x) + 1/1000000",
            "x^6 - 3*x^2 + 3",
            "tanh(x) + 2",
            "(x - 700)^4 - (x - 700)^3 + 2",
        ] {
            assert_eq!(zeros(text), Zeros::None, "{text}");
        }
    }

    #[test]
    fn zeros_far_out_are_found() {
        for text in [
            "tanh(x - 40)",
            "1/(1 + exp(-20*(x - 10))) - 1/2",
            "1/(1 + (x - 50)^2) - 1/2",
            "exp(-(x - 50)^2) - 1/2",
            "1000000000000000000000000000000*exp(-x) - 1",
            "x*y - 1",
            "x^2 - 1000000",
        ] {
            assert!(
                matches!(zeros(text), Zeros::Between(..)),
                "{text}: {:?}",
                zeros(text)
            );
        }
    }

    #[test]
    fn a_zero_without_change_of_sign_is_never_denied() {
        for text in ["(x - 1)^2", "x^2 + y^2", "(x - 1/3)^2*(y^2 + 1)"] {
            assert!(matches!(zeros(text), Zeros::Open(_)), "{text}");
        }
    }
}
