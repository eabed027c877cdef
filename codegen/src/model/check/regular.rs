//! Regular surfaces: `dh` does not vanish where `h` does, so that a gap changes its sign at its surface.
//!
//! Besides gaps without zeros, three kinds of gaps are refused: powers with an exponent of at least 2; gaps whose
//! structure shows that they are never negative or never positive, so that 0 is their extreme value and the gradient,
//! if it exists, vanishes there; and polynomials of positions with a repeated factor. Straight lines reveal a repeated
//! factor: the restriction of `h` to a general line has a multiple root at every zero of the factor. Points and
//! directions are rational, so that each line is decided exactly. A polynomial without a repeated factor practically
//! never has multiple roots on all lines.

use dalembert_expr::{ExprId, Node, Pool, Rational, Sign, SymbolId};

use super::super::degree::degree_bound;
use super::super::polynomial::Polynomial;
use super::super::resolve::Resolver;
use super::super::{Assumption, Coordinate, Topology};
use super::parameters::nearest_rational;
use crate::diagnostics::Location;

/// Polynomials of higher degree are not examined.
const LARGEST_DEGREE: u32 = 8;
/// Number of straight lines, all of which must show a repeated factor.
const LINES: u64 = 6;

impl Resolver<'_> {
    /// Refuses a gap without zeros, and a gap whose gradient vanishes at its zeros.
    pub(super) fn check_regular(&mut self, at: Location, gap: ExprId) -> Option<()> {
        let sign = self.pool.sign(gap);
        if sign.is_nonzero() {
            return self.refuse(at, "surface has no zero set: it is never zero", "");
        }
        if let Some(base) = perfect_power(self, gap) {
            let text = "not regular: the gradient vanishes where the surface is zero";
            let base = self.pool.text(base);
            return self.refuse(at, text, &format!("write `{base} >= 0`"));
        }
        if sign.is_nonnegative() || sign.is_nonpositive() {
            let side = if sign == Sign::NonNegative {
                "negative"
            } else {
                "positive"
            };
            let text = format!("not regular: the gap is never {side}");
            let help = "a gap changes its sign at its surface, as `x - 1` does at `x = 1`";
            return self.refuse(at, text, help);
        }
        match polynomial_fault(self, gap) {
            Some(Fault::NeverZero) => {
                self.refuse(at, "surface has no zero set: it is never zero", "")
            }
            Some(Fault::Repeated) => {
                let text =
                    "not regular: a factor is repeated, and the gradient vanishes where it is zero";
                let help = "write each factor once: `x - 1` for `x^2 - 2*x + 1`";
                self.refuse(at, text, help)
            }
            None => Some(()),
        }
    }
}

/// The first base of a gap whose factors, constants apart, are all powers of at least 2.
fn perfect_power(resolver: &Resolver<'_>, gap: ExprId) -> Option<ExprId> {
    let (_, power) = resolver.pool.as_multiple(gap);
    let Node::Product(factors) = resolver.pool.node(power) else {
        return None;
    };
    let is_multiple = |(base, exponent): &&(ExprId, Rational)| {
        *exponent >= Rational::from(2) || resolver.is_constant(*base)
    };
    let all_multiple = factors.iter().all(|factor| is_multiple(&factor));
    let base = factors
        .iter()
        .find(|(base, _)| !resolver.is_constant(*base))
        .map(|(base, _)| *base);
    base.filter(|_| all_multiple)
}

/// Error of a polynomial gap.
enum Fault {
    /// No zero in the charts.
    NeverZero,
    /// A repeated factor with zeros in the charts.
    Repeated,
}

fn polynomial_fault(resolver: &Resolver<'_>, gap: ExprId) -> Option<Fault> {
    let pool = &resolver.pool;
    let degree = degree_bound(pool, gap, &resolver.symbols.positions())?;
    if !(2..=LARGEST_DEGREE).contains(&degree) {
        return None;
    }
    let symbols = pool.symbols(gap);
    let coordinates: Vec<&Coordinate> = resolver
        .symbols
        .coordinates
        .iter()
        .filter(|coordinate| symbols.contains(&coordinate.q))
        .collect();
    if let ([only], [_]) = (coordinates.as_slice(), symbols.as_slice()) {
        let line = Line::along(resolver, only)?;
        let polynomial = line.restriction(resolver, gap, degree)?;
        if !line.has_root(&polynomial) {
            return Some(Fault::NeverZero);
        }
    }
    let mut is_reached = false;
    for seed in 0..LINES {
        let line = Line::general(resolver, &coordinates, seed)?;
        let repeated = line.restriction(resolver, gap, degree)?.repeated_factor();
        if repeated.degree() == 0 {
            return None;
        }
        is_reached |= line.has_root(&repeated);
    }
    is_reached.then_some(Fault::Repeated)
}

/// A straight line `point + s*direction` through the charts, with fixed values of all other symbols.
struct Line {
    /// Symbol, point, direction.
    coordinates: Vec<(SymbolId, Rational, Rational)>,
    others: Random,
    /// Range of `s` in the charts.
    ends: [Option<Rational>; 2],
}

impl Line {
    /// The axis of a coordinate.
    fn along(resolver: &Resolver<'_>, coordinate: &Coordinate) -> Option<Self> {
        Some(Self {
            coordinates: vec![(coordinate.q, Rational::ZERO, Rational::ONE)],
            others: Random(0),
            ends: chart(resolver, coordinate)?,
        })
    }

    /// A line in general position.
    fn general(resolver: &Resolver<'_>, coordinates: &[&Coordinate], seed: u64) -> Option<Self> {
        let mut random = Random(seed);
        let mut line = Self {
            coordinates: Vec::new(),
            others: Random(seed + LINES),
            ends: [None, None],
        };
        for coordinate in coordinates {
            let chart = chart(resolver, coordinate)?;
            let point = random.between(&chart);
            let direction = random.between(&[None, None]);
            let slope = direction.recip()?;
            for end in chart.iter().flatten() {
                line.shorten(&(&(end - &point) * &slope));
            }
            line.coordinates.push((coordinate.q, point, direction));
        }
        Some(line)
    }

    /// Lets the line end at the parameter `at`, if it extends beyond `at`.
    fn shorten(&mut self, at: &Rational) {
        let [low, high] = &mut self.ends;
        if at.is_negative() {
            if low.as_ref().is_none_or(|low| at > low) {
                *low = Some(at.clone());
            }
        } else if high.as_ref().is_none_or(|high| at < high) {
            *high = Some(at.clone());
        }
    }

    fn has_root(&self, polynomial: &Polynomial) -> bool {
        let [low, high] = &self.ends;
        polynomial.has_root_between(low.as_ref(), high.as_ref())
    }

    /// `expr` on the line, a polynomial of degree at most `degree`.
    fn restriction(
        &self,
        resolver: &Resolver<'_>,
        expr: ExprId,
        degree: u32,
    ) -> Option<Polynomial> {
        let mut values: Vec<(SymbolId, Rational)> = Vec::new();
        let mut random = self.others.clone();
        for symbol in resolver.pool.symbols(expr) {
            values.push((symbol, random.admissible(resolver, symbol)));
        }
        let on_line = (0..=i64::from(degree)).map(|s| {
            let point = |symbol: SymbolId| self.at(&Rational::from(s), symbol, &values);
            exact_value(&resolver.pool, expr, &point)
        });
        let on_line: Option<Vec<Rational>> = on_line.collect();
        on_line.map(|values| Polynomial::through(&values))
    }

    fn at(&self, s: &Rational, symbol: SymbolId, others: &[(SymbolId, Rational)]) -> Rational {
        let coordinate = self.coordinates.iter().find(|(q, ..)| *q == symbol);
        if let Some((_, point, direction)) = coordinate {
            return point + &(s * direction);
        }
        let other = others.iter().find(|(other, _)| *other == symbol);
        other.map_or(Rational::ZERO, |(_, value)| value.clone())
    }
}

/// The ends of the interval of a coordinate.
fn chart(resolver: &Resolver<'_>, coordinate: &Coordinate) -> Option<[Option<Rational>; 2]> {
    let Topology::Interval { low, high } = coordinate.topology else {
        return Some([None, None]);
    };
    let end = |end: ExprId| nearest_rational(resolver.constant_value(end));
    Some([Some(end(low)?), Some(end(high)?)])
}

/// The value of an expression of sums, products and integer powers; `None` for any other expression.
fn exact_value(
    pool: &Pool,
    expr: ExprId,
    point: &dyn Fn(SymbolId) -> Rational,
) -> Option<Rational> {
    let order = pool.reachable(&[expr]);
    let mut values: Vec<Rational> = Vec::with_capacity(order.len());
    for id in &order {
        let of = |operand: ExprId| {
            let index = order.binary_search(&operand).ok()?;
            values.get(index)
        };
        let value = match pool.node(*id) {
            Node::Number(value) => value.clone(),
            // An identity of polynomials in pi holds for any number in place of pi.
            Node::Pi => Rational::new(245_850_922, 78_256_779),
            Node::Symbol(symbol) => point(*symbol),
            Node::Sum { constant, terms } => {
                let mut sum = constant.clone();
                for (factor, term) in terms {
                    sum = &sum + &(factor * of(*term)?);
                }
                sum
            }
            Node::Product(factors) => {
                let mut product = Rational::ONE;
                for (base, exponent) in factors {
                    let exponent = i32::try_from(exponent.to_i64()?).ok()?;
                    product = &product * &of(*base)?.pow_i(exponent)?;
                }
                product
            }
            Node::Call(..) | Node::Atan2(..) => return None,
        };
        values.push(value);
    }
    values.pop()
}

/// Random rational numbers from the high bits of Knuth's linear congruential generator.
#[derive(Clone)]
struct Random(u64);

impl Random {
    /// A number in `(0, 1)`.
    fn unit(&mut self) -> Rational {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let bits = i64::try_from(self.0 >> 43).unwrap_or(0);
        Rational::new(2 * bits + 1, 1 << 22)
    }

    /// A number in an open interval; between -2 and 2 if an end is missing.
    fn between(&mut self, ends: &[Option<Rational>; 2]) -> Rational {
        let default = [Rational::from(-2), Rational::from(2)];
        let [low, high] = match ends {
            [Some(low), Some(high)] => [low, high],
            _ => [&default[0], &default[1]],
        };
        low + &(&(high - low) * &self.unit())
    }

    /// A value that satisfies the assumption of a parameter.
    fn admissible(&mut self, resolver: &Resolver<'_>, symbol: SymbolId) -> Rational {
        let parameters = &resolver.symbols.parameters;
        let parameter = parameters
            .iter()
            .find(|parameter| parameter.symbol == symbol);
        match parameter.map(|parameter| &parameter.assumption) {
            Some(Assumption::Within { low, high }) => {
                self.between(&[Some(low.clone()), Some(high.clone())])
            }
            Some(Assumption::Positive | Assumption::NonNegative) => self.unit(),
            _ => self.between(&[None, None]),
        }
    }
}
