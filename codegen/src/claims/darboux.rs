//! Density factors that depend on velocities: Darboux polynomials of the motion, linear in the velocities on D.
//!
//! `f mu_C` is invariant iff `X(ln f) = c` on D. Here `c = c_0 + c_i u^i` is minus the divergence, given by the
//! right-hand sides `c_i` of [`super::frame`] (`demands`). For `f = (det m)^k |l|^s` the condition is
//!
//! ```text
//! s X(l) = (c - k X(ln det m)) l        on D
//! ```
//!
//! For given `s` and `k` the equation is linear in `l`. Its solutions form a null space modulo a prime, over terms
//! `function of q * velocity or momentum`, at random points of D with fixed (frozen) parameters. Coefficients are
//! reconstructed as rational numbers, or as polynomials in the parameters. A factor found is certified independently of
//! the search, at fresh points modulo other primes.

use dalembert_expr::{
    ExprId, Frozen, JetSpace, Jets, ModularPoint, Modulus, Pool, Rational, SymbolId,
};

use super::ansatz::{combination, parameter_monomials};
use super::dynamics::Dynamics;
use super::elimination::{first_relation, independent_columns};
use super::exactness::{branches_of, sample_points};
use super::fit::{Certified, of_logarithm, reconstruct};
use super::frame::frame;
use super::problem::Problem;
use super::undecided::{LARGEST_CHANCE, Undecided};
use crate::model::Model;

/// Exponents `s` of the factor, as numerator and denominator. The first one is that of an inverse Jacobi multiplier.
const EXPONENTS: [(i64, i64); 5] = [(-1, 1), (-2, 1), (-1, 2), (1, 1), (2, 1)];
/// Exponents `k` of `det m`.
const MASS_EXPONENTS: [(i64, i64); 3] = [(0, 1), (1, 2), (1, 1)];
/// Largest number of terms for which all exponents `s` are tried. For more terms only the first `s` is tried.
const FEW: usize = 80;
/// Largest number of unknowns of a search with coefficients that depend on parameters.
const UNKNOWNS: usize = 160;
/// Number of equations in excess of the unknowns.
const SURPLUS: usize = 8;
/// Number of fresh points of a certificate: with a single branch, and for each of several branches.
const CERTIFIED: (usize, usize) = (12, 3);
/// Makes the seed of a certificate from that of the search (fractional digits of the square root of 3).
const FRESH: u64 = 0xbb67_ae85_84ca_a73b;

/// The exponents `s` and `k`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) exponent: Rational,
    pub(super) mass_exponent: Rational,
}

/// Values at a point of D.
struct Observation {
    field: Modulus,
    /// Value and rate of each term.
    terms: Vec<[u64; 2]>,
    /// `c`
    demand: u64,
    /// `X(ln det m)`
    mass_rate: u64,
}

impl Observation {
    /// `s X(b) - (c - k X(ln det m)) b` for each term `b`.
    fn row(&self, shape: &Shape) -> Option<Vec<u64>> {
        let field = self.field;
        let exponent = field.rational(&shape.exponent)?;
        let mass_exponent = field.rational(&shape.mass_exponent)?;
        let demand = field.sub(self.demand, field.mul(mass_exponent, self.mass_rate));
        let entry = |[value, rate]: &[u64; 2]| {
            field.sub(field.mul(exponent, *rate), field.mul(demand, *value))
        };
        Some(self.terms.iter().map(entry).collect())
    }
}

/// Terms of a factor. Each has its coefficient at frozen parameters if that is a small rational number.
pub(super) type Support = Vec<(ExprId, Option<Rational>)>;

/// Input of a search.
pub(super) struct Search<'s> {
    pub(super) problem: &'s Problem,
    pub(super) dynamics: &'s Dynamics,
    pub(super) seed: u64,
}

impl Search<'_> {
    /// The factors at frozen parameters that solve the equation, with their shapes.
    pub(super) fn factors(
        &self,
        model: &Model,
        terms: &[ExprId],
    ) -> Result<Vec<(Shape, Support)>, Undecided> {
        let parameters: Vec<_> = model
            .parameters
            .iter()
            .map(|parameter| parameter.symbol)
            .collect();
        let count = terms.len() + SURPLUS;
        let seen = self.observe(&model.pool, terms, &parameters, count)?;
        let Some(field) = seen.first().map(|first| first.field) else {
            return Ok(Vec::new());
        };
        // Combinations of terms that vanish on D are removed.
        let values = seen
            .iter()
            .map(|observation| observation.terms.iter().map(|[value, _]| *value).collect())
            .collect();
        let independent = independent_columns(field, values);
        let mut found = Vec::new();
        for shape in shapes(terms.len()) {
            let rows: Option<Vec<Vec<u64>>> = seen
                .iter()
                .map(|observation| {
                    let row = observation.row(&shape)?;
                    Some(independent.iter().map(|column| row[*column]).collect())
                })
                .collect();
            let Some(relation) = rows.and_then(|rows| first_relation(field, rows)) else {
                continue;
            };
            let support = independent
                .iter()
                .zip(&relation)
                .filter(|(_, coefficient)| **coefficient != 0)
                .map(|(column, coefficient)| (terms[*column], reconstruct(field, *coefficient)))
                .collect();
            found.push((shape, support));
        }
        Ok(found)
    }

    /// Observations at random points modulo one prime. `frozen` symbols have the same value at all points.
    fn observe(
        &self,
        pool: &Pool,
        terms: &[ExprId],
        frozen: &[SymbolId],
        count: usize,
    ) -> Result<Vec<Observation>, Undecided> {
        let roots = self.roots(terms);
        let profile = pool.profile_of(&roots);
        let mut points = sample_points(pool, &roots, &profile, self.seed)?.modulo(1);
        let mut frozen: Vec<Frozen> = frozen.iter().map(|symbol| (*symbol, None)).collect();
        let mut seen = Vec::with_capacity(count);
        while seen.len() < count {
            let next = points.find_frozen(pool, &mut frozen, |point| {
                self.observation(pool, terms, point)
            });
            seen.push(next.ok_or(Undecided::Degenerate)?);
        }
        Ok(seen)
    }

    fn roots(&self, terms: &[ExprId]) -> Vec<ExprId> {
        let mut roots = self.problem.roots();
        roots.extend(self.dynamics.roots());
        roots.extend(terms);
        roots
    }

    fn observation(
        &self,
        pool: &Pool,
        terms: &[ExprId],
        point: &mut ModularPoint,
    ) -> Option<Observation> {
        let field = point.modulus();
        let motion = self.dynamics.motion(pool, point, None)?;
        let terms = self
            .dynamics
            .values_and_rates(pool, terms, &motion, point)?;
        let space = JetSpace::new(self.problem.variables.len(), 1, usize::MAX)?;
        let frame = frame(pool, self.problem, &Jets::new(field, &space), point, None)?;
        let mut direction = motion.qdot.clone();
        direction.push(1);
        let mut mass_rate = 0;
        let slopes = of_logarithm(field, &frame.mass_determinant)?;
        for (slope, component) in slopes.iter().zip(&self.problem.variables) {
            mass_rate = field.add(mass_rate, field.mul(*slope, direction[*component]));
        }
        // The drift comes first, with coefficient 1. The independent velocities follow.
        let free = (0..self.problem.coordinates).filter(|i| !frame.dependent.contains(i));
        let mut coordinates: Vec<u64> = free.map(|i| motion.qdot[i]).collect();
        if coordinates.len() < frame.demands.len() {
            coordinates.insert(0, 1);
        }
        let mut demand = 0;
        for (series, u) in frame.demands.iter().zip(coordinates) {
            let value = series.last().and_then(|series| series.first().copied());
            demand = field.add(demand, field.mul(value.unwrap_or(0), u));
        }
        Some(Observation {
            field,
            terms,
            demand,
            mass_rate,
        })
    }

    /// The factor for all parameters. Its coefficients are small rational numbers if such numbers suffice, otherwise
    /// polynomials in the parameters.
    pub(super) fn reconstruct(
        &self,
        model: &mut Model,
        shape: &Shape,
        support: &Support,
    ) -> Result<Option<ExprId>, Undecided> {
        let one = model.pool.one();
        let numbers: Option<Vec<_>> = support
            .iter()
            .map(|(term, coefficient)| Some((coefficient.clone()?, one, *term)))
            .collect();
        if let Some(numbers) = numbers {
            return Ok(Some(combination(&mut model.pool, &numbers)));
        }
        let mut parts = Vec::new();
        let parameters = self.parameters(model);
        for monomial in parameter_monomials(&mut model.pool, &parameters) {
            parts.extend(support.iter().map(|(term, _)| (monomial, *term)));
        }
        parts.truncate(UNKNOWNS);
        let terms: Vec<_> = parts
            .iter()
            .map(|(monomial, term)| model.pool.mul(*monomial, *term))
            .collect();
        let seen = self.observe(&model.pool, &terms, &[], terms.len() + SURPLUS)?;
        let field = seen[0].field;
        let rows: Option<Vec<_>> = seen
            .iter()
            .map(|observation| observation.row(shape))
            .collect();
        let Some(relation) = rows.and_then(|rows| first_relation(field, rows)) else {
            return Ok(None);
        };
        let coefficients: Option<Vec<_>> = parts
            .iter()
            .zip(&relation)
            .filter(|(_, coefficient)| **coefficient != 0)
            .map(|((monomial, term), coefficient)| {
                Some((reconstruct(field, *coefficient)?, *monomial, *term))
            })
            .collect();
        Ok(coefficients.map(|parts| combination(&mut model.pool, &parts)))
    }

    /// The parameters on which the motion depends.
    fn parameters(&self, model: &Model) -> Vec<SymbolId> {
        let roots = self.dynamics.roots();
        let occurs = |symbol: &SymbolId| {
            roots
                .iter()
                .any(|root| model.pool.depends_on(*root, *symbol))
        };
        let symbols = model.parameters.iter().map(|parameter| parameter.symbol);
        symbols.filter(occurs).collect()
    }

    /// The certificate of a factor that solves the equation at fresh points. `None` if the factor does not solve it at
    /// one of them, or is 0 at all of them.
    pub(super) fn certify(
        &self,
        pool: &Pool,
        shape: &Shape,
        factor: ExprId,
    ) -> Result<Option<Certified>, Undecided> {
        let roots = self.roots(&[factor]);
        let profile = pool.profile_of(&roots);
        let mut points = sample_points(pool, &roots, &profile, self.seed ^ FRESH)?;
        let branches = branches_of(pool, &roots, &profile, &points).ok_or(Undecided::Branches)?;
        let each = branches.points_of_each(CERTIFIED);
        let mut primes = Vec::new();
        let mut is_zero = true;
        let covered = points
            .cover(pool, &branches, each, |point| {
                let seen = self.observation(pool, &[factor], point)?;
                primes.push(seen.field.prime());
                is_zero &= seen.terms[0][0] == 0;
                Some(seen.row(shape) == Some(vec![0]))
            })
            .ok_or(Undecided::Degenerate)?;
        if !covered.holds {
            return Ok(None);
        }
        if is_zero {
            return Ok(None);
        }
        primes.sort_unstable();
        primes.dedup();
        // The bound is that for a density of the configuration, doubled: the rates along the motion have degrees as
        // large as that of `c`.
        let sizes = (self.problem.coordinates + self.problem.forms.len()) as f64;
        let degree = 128.0 * sizes.powi(3) * profile.degree.max(1.0);
        let error = covered.error(&branches, degree / 2f64.powi(60));
        if error > LARGEST_CHANCE {
            return Err(Undecided::Chance);
        }
        Ok(Some(Certified {
            points: covered.points,
            primes,
            error,
        }))
    }
}

fn shapes(terms: usize) -> Vec<Shape> {
    let count = if terms > FEW { 1 } else { EXPONENTS.len() };
    let mut shapes = Vec::new();
    for (n, d) in &EXPONENTS[..count] {
        for (mass_n, mass_d) in MASS_EXPONENTS {
            shapes.push(Shape {
                exponent: Rational::new(*n, *d),
                mass_exponent: Rational::new(mass_n, mass_d),
            });
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test may stop at the first surprise

    use super::*;

    /// Flat metric with `dz = (x + y) dx`: `sqrt(det m)/|xdot + ydot|` is invariant.
    const PARTICLE: &str = "Particle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { blade: d(z) - (x + y)*d(x) = 0; }
        outputs { factor: dot(x) + dot(y); other: dot(x); none: dot(z) - (x + y)*dot(x); }
    }";

    /// For each output: true if it is certified as a factor with the exponents `s` and `k`.
    fn certified(s: (i64, i64), k: (i64, i64)) -> Vec<bool> {
        let (mut model, derivation) = crate::claims::derived(PARTICLE);
        let problem = Problem::of(&mut model, &derivation);
        let dynamics = Dynamics::of(&mut model, &derivation);
        let search = Search {
            problem: &problem,
            dynamics: &dynamics,
            seed: 5,
        };
        let shape = Shape {
            exponent: Rational::new(s.0, s.1),
            mass_exponent: Rational::new(k.0, k.1),
        };
        let outputs = model.outputs.iter();
        outputs
            .map(|output| {
                let certified = search.certify(&model.pool, &shape, output.value).unwrap();
                certified.is_some()
            })
            .collect()
    }

    #[test]
    fn the_factor_is_certified_others_and_what_vanishes_on_d_are_not() {
        assert_eq!(certified((-1, 1), (1, 2)), [true, false, false]);
    }

    #[test]
    fn wrong_exponents_are_refused() {
        for (s, k) in [
            ((-2, 1), (1, 2)),
            ((1, 1), (1, 2)),
            ((-1, 1), (0, 1)),
            ((-1, 1), (1, 1)),
        ] {
            assert_eq!(certified(s, k), [false; 3], "{s:?} {k:?}");
        }
    }
}
