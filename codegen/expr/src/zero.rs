//! Zero tests of expressions, with three answers.
//!
//! The decision is made by values at random points modulo primes; see [`Pool::modular_eval`].
//! - 0 at enough points: [`Verdict::Proved`]. The probability of an accidental zero is at most `degree / p` per point
//!   (Schwartz, Zippel); there are enough points to make it less than 2^-60 in all. Where roots or absolute values
//!   occur, all their branches are tested; see [`crate::branch`]. With too many branches the answer stays open.
//! - not 0 at one point: [`Verdict::Refuted`] for rational functions of symbols, sin, cos, exp. This case involves no
//!   probability. With other functions, the atoms may satisfy relations that do not hold modulo the prime, or the
//!   branches may differ from the real ones. Then values in double precision must be clearly different from 0.
//!   Otherwise the answer is [`Verdict::Undecided`].

use crate::branch::Branches;
use crate::field::{Modulus, PRIMES, mix};
use crate::node::{Assumption, ExprId, SymbolId};
use crate::point::ModularPoint;
use crate::pool::Pool;
use crate::profile::Profile;
use crate::squares::Squares;

/// The answer of a zero test.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// The expression is 0 wherever it is defined.
    Proved,
    /// The expression is not identically 0 where it is defined.
    Refuted,
    /// Neither was proved.
    Undecided,
}

/// Minimum and maximum number of points drawn for one value: each independent root rejects half of them. The maximum
/// applies to small expressions.
const DRAWS: (usize, usize) = (64, 1024);
/// Largest number of nodes that are evaluated for one value. It limits the number of draws, within the bounds of
/// [`DRAWS`].
const DRAW_WORK: usize = 1 << 18;
/// Number of real points that are tried.
const REAL_DRAWS: u64 = 96;
/// Number of real points with a defined value that suffice.
const REAL_POINTS: usize = 64;
/// Number of values that must be clearly different from 0.
const REAL_WITNESSES: usize = 3;
/// Scales of the real points, used in turn.
const SCALES: [f64; 6] = [1.0, 1.0, 1.0, 1.0, 8.0, 64.0];
/// A value is clearly different from 0 if it exceeds this multiple of its magnitude before cancellation. The multiple is
/// about 1e9 times the rounding error.
pub(crate) const CLEAR: f64 = 1e-6;
/// Largest number of distinct subexpressions of a tested expression.
const MAX_NODES: usize = 1 << 20;

impl Pool {
    /// Tests if an expression is 0 wherever it is defined, for all values of its symbols that satisfy their assumptions.
    pub fn zero_test(&self, id: ExprId) -> Verdict {
        if self.is_syntactic_zero(id) {
            return Verdict::Proved;
        }
        if self.is_finite(id) && self.sign(id).is_nonzero() {
            return Verdict::Refuted;
        }
        let order = self.reachable(&[id]);
        if order.len() > MAX_NODES {
            return Verdict::Undecided;
        }
        let profile = self.profile(&order);
        match self.vanishes_modularly(id, &order, &profile) {
            Some(true) if profile.is_exact() => Verdict::Proved,
            Some(false) if profile.is_exact() => Verdict::Refuted,
            // NOTE: real values are checked even if all residues are 0, because this costs little.
            _ if self.is_clearly_nonzero(id) => Verdict::Refuted,
            Some(true) => Verdict::Proved,
            _ => Verdict::Undecided,
        }
    }

    /// True if all sampled residues are 0, false if one is not. `None` if there are too few points, or if zeros prove
    /// nothing.
    fn vanishes_modularly(&self, id: ExprId, order: &[ExprId], profile: &Profile) -> Option<bool> {
        let wanted = sample_count(profile);
        let mut points = SamplePoints::new(self, order, profile, 0)?;
        let branches = match profile.branches {
            true => self.branches(&[id], &points),
            false => Some(Branches::default()),
        };
        // With a degree near the prime, or with too many branches, zeros prove nothing.
        let is_worth = wanted.is_some() && branches.is_some();
        let each = if is_worth { wanted? } else { 1 };
        let covered = points.cover(self, &branches.unwrap_or_default(), each, |point| {
            let value = self.modular_eval_ordered(order, &[id], point).ok()?;
            Some(value[0] == 0)
        })?;
        (!covered.holds || is_worth).then_some(covered.holds)
    }

    /// True if real values differ from 0 by more than any rounding error.
    fn is_clearly_nonzero(&self, id: ExprId) -> bool {
        let (mut valid, mut witnesses) = (0, 0);
        for seed in 0..REAL_DRAWS {
            let (value, magnitude) =
                self.eval_magnitude(id, &|symbol| self.real_sample(symbol, seed));
            if value.is_finite() && magnitude.is_finite() {
                valid += 1;
                witnesses += usize::from(value.abs() > CLEAR * magnitude);
            }
            if witnesses == REAL_WITNESSES || valid == REAL_POINTS {
                break;
            }
        }
        witnesses == REAL_WITNESSES
    }

    /// A value that satisfies the symbol's assumption: in `[-2, 2]` for most seeds, in a wider range for the others.
    /// Equal seeds give equal values.
    pub(crate) fn real_sample(&self, symbol: SymbolId, seed: u64) -> f64 {
        let word = mix(mix(seed + 1) ^ mix(symbol.index() as u64 + 1));
        let unit = ((word >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let scale = SCALES[(seed % SCALES.len() as u64) as usize];
        match self.symbol_assumption(symbol) {
            Assumption::None | Assumption::NonZero => scale * (4.0 * unit - 2.0),
            Assumption::Positive | Assumption::NonNegative => scale * 2.0 * unit,
        }
    }
}

/// Number of points for an error probability below 2^-60; `None` if the degree is too large.
fn sample_count(profile: &Profile) -> Option<usize> {
    let bits = 60.0 - profile.degree.max(1.0).log2();
    if bits < 10.0 {
        return None;
    }
    Some((60.0 / bits).ceil().max(3.0) as usize)
}

/// A symbol, and its common residue at all points once that is known.
pub type Frozen = (SymbolId, Option<u64>);

/// Random points. The primes are used in turn.
#[derive(Clone, Debug)]
pub struct SamplePoints {
    seed: u64,
    denominator: i64,
    moduli: [Modulus; PRIMES],
    /// Position of the only prime in use, if there is only one.
    only: Option<usize>,
    drawn: usize,
    limit: usize,
    squares: Squares,
}

impl SamplePoints {
    /// Points of a seed at which the subexpressions of some roots are likely to be defined. `profile` is the profile of
    /// these roots. `None` if the coefficients inside sin, cos and exp have no common denominator of moderate size.
    pub fn seeded(pool: &Pool, roots: &[ExprId], profile: &Profile, seed: u64) -> Option<Self> {
        Self::new(pool, &pool.reachable(roots), profile, seed)
    }

    /// Same as [`SamplePoints::seeded`] for the expressions in `order`, the result of [`Pool::reachable`] for the
    /// roots.
    pub(crate) fn new(pool: &Pool, order: &[ExprId], profile: &Profile, seed: u64) -> Option<Self> {
        let limit = (DRAW_WORK / order.len().max(1)).clamp(DRAWS.0, DRAWS.1);
        Some(Self {
            seed: mix(pool.seed()) ^ seed,
            denominator: profile.denominator?,
            moduli: pool.moduli(),
            only: None,
            drawn: 0,
            limit,
            squares: Squares::of(pool, order),
        })
    }

    /// The primes that are used in turn.
    pub fn moduli(&self) -> &[Modulus] {
        match self.only {
            Some(position) => &self.moduli[position..=position],
            None => &self.moduli,
        }
    }

    /// The same points, all modulo the prime at this position (taken modulo the number of primes).
    pub fn modulo(mut self, position: usize) -> Self {
        self.only = Some(position % PRIMES);
        self
    }

    /// The same points, without the search for points at which roots are defined.
    pub(crate) fn unsettled(mut self) -> Self {
        self.squares = Squares::default();
        self
    }

    /// The first result of `f` other than `None` at the next points; `None` if `f` fails at all points allowed for one
    /// value.
    pub fn find<T>(
        &mut self,
        pool: &Pool,
        f: impl FnMut(&mut ModularPoint) -> Option<T>,
    ) -> Option<T> {
        self.find_frozen(pool, &mut [], f)
    }

    /// Same as [`SamplePoints::find`], for points of one prime (see [`SamplePoints::modulo`]). `frozen` symbols keep
    /// their given values. A frozen symbol without a value gets that of the point that is found.
    pub fn find_frozen<T>(
        &mut self,
        pool: &Pool,
        frozen: &mut [Frozen],
        mut f: impl FnMut(&mut ModularPoint) -> Option<T>,
    ) -> Option<T> {
        (0..self.limit).find_map(|_| {
            let modulus = self.moduli[self.only.unwrap_or(self.drawn % PRIMES)];
            self.drawn += 1;
            let seed = mix(mix(self.seed).wrapping_add(self.drawn as u64));
            let mut point = ModularPoint::with_denominator(modulus, seed, self.denominator);
            for (symbol, value) in frozen.iter() {
                value.map(|value| point.set(*symbol, value));
            }
            self.squares.settle(pool, &mut point, seed)?;
            let found = f(&mut point)?;
            for (symbol, value) in frozen.iter_mut() {
                value.get_or_insert_with(|| point.value(*symbol, pool.symbol_assumption(*symbol)));
            }
            Some(found)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    fn expect(verdict: Verdict, texts: &[&str]) {
        let mut fixture = Fixture::new();
        for text in texts {
            let id = fixture.read(text);
            assert_eq!(fixture.pool.zero_test(id), verdict, "{text}");
        }
    }

    #[test]
    fn rational_identities_are_proved() {
        expect(
            Verdict::Proved,
            &[
                "0",
                "(x + y)^2 - x^2 - 2*x*y - y^2",
                "(x^2 - y^2)/(x - y) - x - y",
                "x/x - 1",
                "1/(x*y) - 1/x*1/y",
                "(pi + 1)^2 - pi^2 - 2*pi - 1",
                "0*ln(x)",
            ],
        );
    }

    #[test]
    fn circular_and_exponential_identities_are_proved() {
        expect(
            Verdict::Proved,
            &[
                "cos(x)^2 + sin(x)^2 - 1",
                "sin(2*x) - 2*sin(x)*cos(x)",
                "cos(x + y) - cos(x)*cos(y) + sin(x)*sin(y)",
                "cos(x) - 2*cos(x/2)^2 + 1",
                "sin(x/3)*(3 - 4*sin(x/3)^2) - sin(x)",
                "tan(x/2) - sin(x)/(1 + cos(x))",
                "tan(x) - sin(x)/cos(x)",
                "sin(x + pi/4) - (sin(x) + cos(x))*sqrt(2)/2",
                "cos(pi/12) - (sqrt(6) + sqrt(2))/4",
                "sin(pi/3)^2 - 3/4",
                "cos(x + pi/3) - cos(x)/2 + sin(x)*sin(pi/3)",
                "exp(x + y) - exp(x)*exp(y)",
                "exp(x/2)^2 - exp(x)",
                "cosh(x)^2 - sinh(x)^2 - 1",
                "tanh(x)*cosh(x) - sinh(x)",
                "sin(0.1*x)*2*cos(0.1*x) - sin(0.2*x)",
                "sin(k*t)^2 + cos(k*t)^2 - 1",
                "sin(1)^2 + cos(1)^2 - 1",
            ],
        );
    }

    #[test]
    fn root_identities_are_proved_where_both_sides_are_defined() {
        expect(
            Verdict::Proved,
            &[
                "sqrt(x)^2 - x",
                "sqrt(x*y) - sqrt(x)*sqrt(y)",
                "sqrt(2)*sqrt(3) - sqrt(6)",
                "sqrt(4*m^2*l^2) - 2*m*l",
                "(sqrt(x^2 + 1) - x)*(sqrt(x^2 + 1) + x) - 1",
                "1/sqrt(x + y) - sqrt(x + y)/(x + y)",
                "abs(x)*abs(y) - abs(x*y)",
                "sqrt(w)*sqrt(27*x/8) - 3*sqrt(3*w*x/2)/2",
                "sqrt(x^2) - abs(x)",
                "exp(ln(x)) - x",
                "exp(log1p(x)/2) - sqrt(1 + x)",
                "log1p(x)*(abs(1 + x) - 1 - x)",
                "log1p(x) + log1p(y) + log1p(x*y) + log1p(z) - ln(1 + x) - ln(1 + y) - ln(1 + x*y) - ln(1 + z)",
                "acos(x) + asin(x) - pi/2",
                "atan(x - y) + atan(y - x)",
                "x^(1/3)*x^(2/3) - x",
                "sqrt(x - 1)*sqrt(y - 1)*sqrt(x + y)*sqrt(x - y)*(1 + z) - sqrt(x - 1)*sqrt(y - 1)*sqrt(x + y)*sqrt(x - y)*z - sqrt(x - 1)*sqrt(y - 1)*sqrt(x^2 - y^2)",
            ],
        );
    }

    #[test]
    fn what_is_not_zero_is_refuted() {
        expect(
            Verdict::Refuted,
            &[
                "1",
                "m",
                "x - y",
                "x^2 - 1",
                "sin(x)",
                "sin(x) - x + x^3/6 - x^5/120",
                "cos(x)^2 - sin(x)^2 - 1",
                "sin(x/2) - sin(x)/2",
                "exp(x) - 1",
                "pi - 355/113",
                "x/1000000000000000000000000000000",
                "sin(pi/5)",
                "sqrt(x^2) - x",
                "sqrt(x) - x",
                "abs(x) - x",
                "(sqrt(x^2) - x)*(sqrt(y^2) - y)",
                "(abs(x) + x)*(abs(y) + y)*(abs(z) + z)",
                "ln(m*l) - ln(m) + ln(l)",
                "atan(x) - x",
                "log1p(x) - ln(x)",
                "sin(k*t) - k*t",
                "sqrt(2) - 1.41421",
            ],
        );
    }

    #[test]
    fn hidden_relations_are_never_refuted() {
        expect(
            Verdict::Undecided,
            &[
                "ln(m*l) - ln(m) - ln(l)",
                "sin(asin(x)) - x",
                "sin(x*(y + 1)) - sin(x*y + x)",
                "atan(x) + atan(1/x^2*x) - pi/2*abs(x)/x",
                "sqrt(x^4 + 2*x^2 + 1) - x^2 - 1",
                "sin(pi/5)^2 - (5 - sqrt(5))/8",
                "1/(x - x)",
            ],
        );
    }

    /// Each ramp is 0 at half of all points; the product of all ramps is 0 at almost all points.
    #[test]
    fn products_of_ramps_are_never_proved_to_be_zero() {
        let ramp = |u: &str| format!("(abs({u}) + {u})");
        let mut product = "1".to_owned();
        for u in ["x - 5", "6 - x", "y - 5", "6 - y", "z", "1/2 - z"] {
            product = format!("{product}*{}", ramp(u));
            let mut fixture = Fixture::new();
            let id = fixture.read(&product);
            assert_ne!(fixture.pool.zero_test(id), Verdict::Proved, "{product}");
            let twice = fixture.read(&format!("{product} + {product} - 2*{product}"));
            assert_eq!(fixture.pool.zero_test(twice), Verdict::Proved, "{product}");
        }
    }

    #[test]
    fn large_degrees_are_decided_or_left_open_at_once() {
        let mut fixture = Fixture::new();
        let x = fixture.read("x");
        let one = fixture.pool.one();
        let mut tower = x;
        for _ in 0..200 {
            let square = fixture.pool.mul(tower, tower);
            tower = fixture.pool.add(square, one);
        }
        let product = fixture.pool.mul(tower, tower);
        let other = fixture.pool.add(tower, x);
        let (a, b) = (fixture.pool.mul(other, other), fixture.pool.mul(tower, x));
        let square = fixture.pool.mul(x, x);
        let two = crate::Rational::from(-2);
        let difference = fixture.pool.combine(&[
            (crate::Rational::ONE, a),
            (two, b),
            (crate::Rational::MINUS_ONE, product),
            (crate::Rational::MINUS_ONE, square),
        ]);
        assert_eq!(fixture.pool.zero_test(difference), Verdict::Undecided);
        assert_eq!(fixture.pool.zero_test(other), Verdict::Refuted);
    }
}
