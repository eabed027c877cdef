//! Closed forms of the density: combinations of candidates for `G` with `X_i(G) = c_i`, by linear algebra modulo a
//! prime.
//!
//! The constants `k_b` in `sum k_b X_i(b) = c_i` at random points are computed modulo a prime and reconstructed as
//! rational numbers. A density found is then certified independently of the search, at fresh points modulo other
//! primes.

use dalembert_expr::{
    ExprId, Frozen, JetSpace, Jets, ModularPoint, Modulus, Pool, Rational, SymbolId,
};

use super::exactness::{branches_of, sample_points};
use super::frame::{Demand, frame};
use super::potential::{Allowed, Candidates, Potential, Term};
use super::problem::Problem;
use super::undecided::{LARGEST_CHANCE, Undecided};

/// Largest accepted numerator and denominator of a coefficient.
const LARGEST: i64 = 50;
/// Number of fresh points of a certificate: with a single branch, and for each of several branches.
const CERTIFIED: (usize, usize) = (12, 3);
/// Number of further points at which a solution must hold.
const FRESH_POINTS: usize = 3;
/// Number of equations in excess of the unknowns.
const SURPLUS: usize = 8;

/// Certificate of a density: points, primes and error probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    /// Number of fresh points at which every demand is satisfied.
    pub points: usize,
    /// The primes.
    pub primes: Vec<u64>,
    /// Upper bound of the probability that the result is not a density.
    pub error: f64,
}

/// The combination of candidates with rational coefficients that is a density, if one exists.
pub(super) fn fit(
    pool: &mut Pool,
    problem: &Problem,
    candidates: &Candidates,
    allowed: Allowed,
    seed: u64,
) -> Option<Potential> {
    let terms = candidates.allowed(allowed);
    let coefficients = solve_for_coefficients(pool, problem, &terms, &mut [], seed)?;
    let mut found = Vec::new();
    for (term, (coefficient, field)) in terms.iter().zip(coefficients) {
        if coefficient != 0 {
            let rational = reconstruct(field, coefficient)?;
            found.push((pool.number(rational), *term));
        }
    }
    Some(Potential { terms: found })
}

/// True if points are found at which all candidates have residues. Many independent roots reject almost all points.
pub(super) fn has_points(
    pool: &Pool,
    problem: &Problem,
    candidates: &Candidates,
    allowed: Allowed,
    seed: u64,
) -> bool {
    let terms = candidates.allowed(allowed);
    let roots = roots(problem, &terms);
    let profile = pool.profile_of(&roots);
    let points = sample_points(pool, &roots, &profile, seed);
    points.is_ok_and(|points| {
        let mut points = points.modulo(1);
        points
            .find(pool, |point| equations(pool, problem, &terms, point))
            .is_some()
    })
}

/// Same as [`fit`], with coefficients that are products of powers of parameters.
///
/// Each exponent is read off by doubling a parameter, which multiplies the coefficient by a power of 2.
pub(super) fn fit_with_parameters(
    pool: &mut Pool,
    problem: &Problem,
    candidates: &Candidates,
    allowed: Allowed,
    parameters: &[SymbolId],
    seed: u64,
) -> Option<Potential> {
    if parameters.is_empty() {
        return None;
    }
    let candidates = candidates.allowed(allowed);
    let mut frozen: Vec<_> = parameters
        .iter()
        .map(|parameter| (*parameter, None))
        .collect();
    let solution = solve_for_coefficients(pool, problem, &candidates, &mut frozen, seed)?;
    let field = solution.first()?.1;
    let (terms, before): (Vec<Term>, Vec<u64>) = candidates
        .into_iter()
        .zip(solution.iter().map(|(coefficient, _)| *coefficient))
        .filter(|(_, coefficient)| *coefficient != 0)
        .unzip();
    let mut exponents = vec![Vec::new(); terms.len()];
    for i in 0..frozen.len() {
        let mut doubled = frozen.clone();
        doubled[i].1 = doubled[i].1.map(|value| field.add(value, value));
        let after = solve_for_coefficients(pool, problem, &terms, &mut doubled, seed)?;
        for (exponent, (before, (after, _))) in exponents.iter_mut().zip(before.iter().zip(&after))
        {
            exponent.push(power_of_two(field, *before, *after)?);
        }
    }
    let mut found = Vec::new();
    for ((term, coefficient), exponents) in terms.iter().zip(&before).zip(&exponents) {
        let mut rest = *coefficient;
        let mut factors = Vec::new();
        for ((symbol, value), exponent) in frozen.iter().zip(exponents) {
            let size = field.pow((*value)?, exponent.unsigned_abs());
            let divisor = if *exponent > 0 {
                field.inv(size)?
            } else {
                size
            };
            rest = field.mul(rest, divisor);
            let base = pool.variable(*symbol);
            factors.push(pool.pow(base, Rational::from(*exponent)));
        }
        factors.push(pool.number(reconstruct(field, rest)?));
        found.push((pool.product(&factors), *term));
    }
    Some(Potential { terms: found })
}

/// Exponents of parameters that are tried.
const EXPONENTS: std::ops::RangeInclusive<i64> = -4..=4;

/// The exponent e with `after = 2^e before`, if it is one of [`EXPONENTS`].
fn power_of_two(field: Modulus, before: u64, after: u64) -> Option<i64> {
    EXPONENTS.into_iter().find(|e| {
        let power = field.integer(1 << e.unsigned_abs());
        let (larger, smaller) = if *e < 0 {
            (before, after)
        } else {
            (after, before)
        };
        field.mul(power, smaller) == larger
    })
}

/// The coefficients modulo a prime. Later candidates are used only if earlier ones do not suffice. `None` if there is
/// no solution.
pub(super) fn solve_for_coefficients(
    pool: &Pool,
    problem: &Problem,
    terms: &[Term],
    frozen: &mut [Frozen],
    seed: u64,
) -> Option<Vec<(u64, Modulus)>> {
    let roots = roots(problem, terms);
    let profile = pool.profile_of(&roots);
    let mut points = sample_points(pool, &roots, &profile, seed).ok()?.modulo(1);
    let mut rows: Vec<Vec<u64>> = Vec::new();
    let mut modulus = None;
    let mut at_next = |modulus: &mut Option<Modulus>| {
        points.find_frozen(pool, frozen, |point| {
            *modulus = Some(point.modulus());
            equations(pool, problem, terms, point)
        })
    };
    while rows.len() < terms.len() + SURPLUS {
        rows.extend(at_next(&mut modulus)?);
    }
    let field = modulus?;
    // Some equations at a point may be trivial, so there may be too few to determine all unknowns.
    loop {
        let solution = solve_rows(field, rows.clone(), terms.len())?;
        let mut is_solved = true;
        for _ in 0..FRESH_POINTS {
            let more = at_next(&mut modulus)?;
            is_solved &= more.iter().all(|row| is_satisfied(field, row, &solution));
            rows.extend(more);
        }
        if is_solved {
            return Some(solution.into_iter().map(|k| (k, field)).collect());
        }
        let wanted = rows.len() + terms.len() / 2;
        while rows.len() < wanted {
            rows.extend(at_next(&mut modulus)?);
        }
    }
}

/// True if a solution satisfies the row `(unknowns.. | right)`.
fn is_satisfied(field: Modulus, row: &[u64], solution: &[u64]) -> bool {
    let mut left = 0;
    for (entry, unknown) in row.iter().zip(solution) {
        left = field.add(left, field.mul(*entry, *unknown));
    }
    row.last() == Some(&left)
}

fn roots(problem: &Problem, terms: &[Term]) -> Vec<ExprId> {
    let mut roots = problem.roots();
    roots.extend(terms.iter().filter_map(|term| term.expression()));
    roots
}

/// The equations `[X_i(b) for each term .., c_i]` of all demands at a point.
fn equations(
    pool: &Pool,
    problem: &Problem,
    terms: &[Term],
    point: &mut ModularPoint,
) -> Option<Vec<Vec<u64>>> {
    let field = point.modulus();
    let space = JetSpace::new(problem.variables.len(), 1, usize::MAX)?;
    let frame = frame(pool, problem, &Jets::new(field, &space), point, None)?;
    // A density may depend on coordinates that do not occur in metric, constraints and forces.
    let all = JetSpace::new(problem.components(), 1, usize::MAX)?;
    let expressions: Vec<ExprId> = terms.iter().filter_map(|t| t.expression()).collect();
    let series = pool.taylor(
        &expressions,
        &problem.symbols,
        &Jets::new(field, &all),
        point,
    )?;
    let mut series = series.into_iter();
    let mut gradients = Vec::with_capacity(terms.len());
    for term in terms {
        gradients.push(match term {
            Term::MassDeterminant => of_logarithm(field, &frame.mass_determinant)?,
            Term::MetricDeterminant => of_logarithm(field, &frame.metric_determinant)?,
            Term::DependentDeterminant => of_logarithm(field, &frame.dependent_determinant)?,
            Term::Logarithm(_) => of_logarithm(field, &series.next()?)?,
            Term::Plain(_) => series.next()?.into_iter().skip(1).collect(),
        });
    }
    let row = |demand: &Demand<Modulus>| {
        let value = |series: &Vec<u64>| series.first().copied().unwrap_or(0);
        let along = |(term, gradient): (&Term, &Vec<u64>)| {
            let components = match term.expression() {
                Some(_) => (0..problem.components()).collect(),
                None => problem.variables.clone(),
            };
            let mut sum = 0;
            for (slope, k) in gradient.iter().zip(components) {
                sum = field.add(sum, field.mul(*slope, value(&demand[k])));
            }
            sum
        };
        let mut row: Vec<u64> = terms.iter().zip(&gradients).map(along).collect();
        row.push(demand.last().map_or(0, value));
        row
    };
    Some(frame.demands.iter().map(row).collect())
}

/// Derivatives of `ln |f|`, from the first-order series of `f`.
pub(super) fn of_logarithm(field: Modulus, series: &[u64]) -> Option<Vec<u64>> {
    let (value, slopes) = series.split_first()?;
    let factor = field.inv(*value)?;
    Some(
        slopes
            .iter()
            .map(|slope| field.mul(factor, *slope))
            .collect(),
    )
}

/// Solution of the rows `(unknowns.. | right)`, with free unknowns set to 0; `None` if there is no solution.
fn solve_rows(field: Modulus, mut rows: Vec<Vec<u64>>, unknowns: usize) -> Option<Vec<u64>> {
    let mut pivots = Vec::new();
    for column in 0..=unknowns {
        let Some(found) = (pivots.len()..rows.len()).find(|row| rows[*row][column] != 0) else {
            continue;
        };
        if column == unknowns {
            return None;
        }
        let step = pivots.len();
        rows.swap(step, found);
        let inverse = field.inv(rows[step][column])?;
        for entry in &mut rows[step] {
            *entry = field.mul(inverse, *entry);
        }
        let pivot = rows[step].clone();
        for (position, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if position != step && factor != 0 {
                for (entry, pivot) in row.iter_mut().zip(&pivot) {
                    *entry = field.sub(*entry, field.mul(factor, *pivot));
                }
            }
        }
        pivots.push(column);
    }
    let mut solution = vec![0; unknowns];
    for (row, column) in rows.iter().zip(pivots) {
        solution[column] = row[unknowns];
    }
    Some(solution)
}

/// The rational number with small numerator and denominator that has this residue, if there is one.
pub(super) fn reconstruct(field: Modulus, residue: u64) -> Option<Rational> {
    let size = |value: u64| value.min(field.prime() - value) as i64;
    (1..=LARGEST).find_map(|denominator| {
        let numerator = field.mul(residue, field.integer(denominator));
        let sign = if numerator > field.prime() / 2 { -1 } else { 1 };
        (size(numerator) <= LARGEST).then(|| Rational::new(sign * size(numerator), denominator))
    })
}

/// The certificate of a potential that satisfies every demand at fresh points modulo several primes. `None` if a demand
/// fails.
///
/// # Errors
/// [`Undecided`].
pub(super) fn certify(
    pool: &Pool,
    problem: &Problem,
    potential: &Potential,
    seed: u64,
) -> Result<Option<Certified>, Undecided> {
    let terms: Vec<Term> = potential.terms.iter().map(|(_, term)| *term).collect();
    let coefficients: Vec<ExprId> = potential.terms.iter().map(|(k, _)| *k).collect();
    let mut roots = roots(problem, &terms);
    roots.extend(&coefficients);
    let profile = pool.profile_of(&roots);
    // The points differ from those of the search for every seed.
    let mut points = sample_points(pool, &roots, &profile, seed ^ FRESH)?;
    let branches = branches_of(pool, &roots, &profile, &points).ok_or(Undecided::Branches)?;
    let each = branches.points_of_each(CERTIFIED);
    let mut primes = Vec::new();
    let covered = points
        .cover(pool, &branches, each, |point| {
            for choice in problem.positions.choices() {
                problem.positions.settle(pool, point, choice)?;
                let rows = equations(pool, problem, &terms, point)?;
                let values = pool.modular_eval(&coefficients, point).ok()?;
                primes.push(point.modulus().prime());
                let residuals = residuals(point.modulus(), &rows, &values);
                if residuals.iter().any(|residual| *residual != 0) {
                    return Some(false);
                }
            }
            Some(true)
        })
        .ok_or(Undecided::Degenerate)?;
    if !covered.holds {
        return Ok(None);
    }
    primes.sort_unstable();
    primes.dedup();
    let sizes = (problem.coordinates + problem.forms.len()) as f64;
    let degree = 64.0 * sizes.powi(3) * profile.degree.max(1.0);
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

/// Makes the seed of a certificate from that of the search (fractional digits of the square root of 2).
const FRESH: u64 = 0x6a09_e667_f3bc_c908;

fn residuals(field: Modulus, rows: &[Vec<u64>], coefficients: &[u64]) -> Vec<u64> {
    let residual = |row: &Vec<u64>| {
        let mut sum = 0;
        for (k, entry) in coefficients.iter().zip(row) {
            sum = field.add(sum, field.mul(*k, *entry));
        }
        field.sub(sum, row[coefficients.len()])
    };
    rows.iter().map(residual).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_fractions_are_reconstructed_and_others_are_not() {
        let field = Modulus::MERSENNE;
        for (n, d) in [(0, 1), (1, 2), (-3, 7), (50, 49), (-1, 1)] {
            let value = Rational::new(n, d);
            let residue = field.rational(&value).expect("a residue");
            assert_eq!(reconstruct(field, residue), Some(value));
        }
        assert_eq!(reconstruct(field, 123_456_789_123), None);
    }

    #[test]
    fn later_unknowns_are_used_only_where_earlier_ones_do_not_suffice() {
        let field = Modulus::MERSENNE;
        // The third column is the sum of the first two.
        let rows = vec![vec![1, 0, 1, 5], vec![0, 1, 1, 7], vec![1, 1, 2, 12]];
        assert_eq!(solve_rows(field, rows.clone(), 3), Some(vec![5, 7, 0]));
        let contradiction = vec![vec![1, 0, 1, 5], vec![2, 0, 2, 11]];
        assert_eq!(solve_rows(field, contradiction, 3), None);
    }
}
