//! Polynomial conditions on parameters under which an obstruction vanishes.
//!
//! At a random point modulo a prime, delta (see [`super::obstruction`]) is a rational function of one parameter. Each
//! root or pole of delta is a candidate. If a density exists at another configuration with the same parameters, the
//! point lies on a hypersurface of parameters over which a density exists. Such points, for several values of the other
//! parameters, determine the polynomial of low degree that vanishes at all of them.

use dalembert_expr::{ExprId, ModularPoint, Rational, SymbolId};

use super::ansatz::{combination, monomials};
use super::elimination::first_relation;
use super::exactness::{Local, exists_at, sample_points};
use super::exceptional::Column;
use super::fit::reconstruct;
use super::polynomial::roots;
use super::problem::Problem;
use crate::model::Model;

/// Largest degree of the polynomials that are tried.
const DEGREE: usize = 3;
/// Number of points beyond the number of coefficients.
const SURPLUS: usize = 2;
/// Number of parameters that a condition may relate.
const RELATED: usize = 3;
/// Number of parameters up to which conditions are sought.
const PARAMETERS: usize = 6;

/// The polynomials, each once. `trials` is the number of values of delta that may still be computed; `None` if it did
/// not suffice.
pub(super) fn hypersurfaces(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    positions: &[usize],
    seed: u64,
    trials: &mut usize,
) -> Option<Vec<ExprId>> {
    let mut found: Vec<ExprId> = Vec::new();
    if positions.len() > PARAMETERS {
        return Some(found);
    }
    let symbols: Vec<SymbolId> = positions
        .iter()
        .map(|position| model.parameters[*position].symbol)
        .collect();
    let Some(obstruction) = local.hull.obstruction else {
        return Some(found);
    };
    for parameter in &symbols {
        let column = Column {
            pool: &model.pool,
            problem,
            local,
            obstruction,
            parameter: *parameter,
        };
        let search = Search {
            column,
            symbols: &symbols,
            known: &found,
        };
        let points = search.points(seed, trials)?;
        let Some((related, points)) = points else {
            continue;
        };
        let polynomial = polynomial(model, &related, &points);
        found.extend(polynomial.filter(|polynomial| !found.contains(polynomial)));
    }
    Some(found)
}

/// A search for roots of delta in one parameter.
struct Search<'s> {
    column: Column<'s>,
    symbols: &'s [SymbolId],
    /// Polynomials that were found.
    known: &'s [ExprId],
}

impl Search<'_> {
    /// Points of a hypersurface, and the parameters that it relates.
    #[expect(
        clippy::option_option,
        reason = "the outer `None` is the end of the trials, the inner one the absence of a hypersurface"
    )]
    fn points(
        &self,
        seed: u64,
        trials: &mut usize,
    ) -> Option<Option<(Vec<SymbolId>, Vec<ModularPoint>)>> {
        if !self.column.is_rational() {
            return Some(None);
        }
        let Some(first) = self.roots(seed, trials)?.into_iter().next() else {
            return Some(None);
        };
        let related = self.related(&first, seed);
        if related.len() > RELATED {
            return Some(None);
        }
        let mut points = vec![first.clone()];
        let mut drawn = seed;
        while points.len() < needed(related.len(), DEGREE) {
            drawn = drawn.wrapping_add(1);
            let roots = self.roots(drawn, trials)?;
            if roots.is_empty() {
                return Some(None);
            }
            points.extend(roots);
        }
        Some(Some((related, points)))
    }

    /// Points over which a density exists: a base with the parameter at a root or pole of delta.
    fn roots(&self, seed: u64, trials: &mut usize) -> Option<Vec<ModularPoint>> {
        let Some((base, delta)) = self.column.base(seed) else {
            return Some(Vec::new());
        };
        let Some(functions) = self.column.functions(&base, delta, trials)? else {
            return Some(Vec::new());
        };
        let field = base.modulus();
        let mut points = Vec::new();
        for root in functions.iter().flat_map(|function| roots(field, function)) {
            let is_simple = reconstruct(field, root).is_some()
                || self.others().any(|other| self.value(&base, other) == root);
            if is_simple {
                continue;
            }
            let mut point = base.clone();
            point.set(self.column.parameter, root);
            if !self.is_known(&point) && self.has_density(&point, seed) {
                points.push(point);
            }
        }
        Some(points)
    }

    /// True if a polynomial that was found is 0 at a point.
    fn is_known(&self, point: &ModularPoint) -> bool {
        let values = self
            .column
            .pool
            .modular_eval(self.known, &mut point.clone());
        values.is_ok_and(|values| values.contains(&0))
    }

    fn others(&self) -> impl Iterator<Item = SymbolId> {
        let parameter = self.column.parameter;
        self.symbols
            .iter()
            .copied()
            .filter(move |symbol| *symbol != parameter)
    }

    fn value(&self, point: &ModularPoint, symbol: SymbolId) -> u64 {
        point.value(symbol, self.column.pool.symbol_assumption(symbol))
    }

    /// Parameters that a condition relates: those whose change alone destroys the density, and the one whose roots are
    /// sought.
    fn related(&self, point: &ModularPoint, seed: u64) -> Vec<SymbolId> {
        let field = point.modulus();
        let cannot_change = |symbol: &SymbolId| {
            let mut changed = point.clone();
            // Positive values are squares modulo the prime. The factor is a square, so the product is one, too.
            changed.set(
                *symbol,
                field.mul(self.value(point, *symbol), field.integer(9)),
            );
            !self.has_density(&changed, seed)
        };
        let symbols = self.symbols.iter().copied();
        symbols
            .filter(|symbol| *symbol == self.column.parameter || cannot_change(symbol))
            .collect()
    }

    /// True if a density exists at another configuration, with the parameters of a point.
    fn has_density(&self, point: &ModularPoint, seed: u64) -> bool {
        let (pool, problem) = (self.column.pool, self.column.problem);
        let roots = problem.roots();
        let profile = pool.profile_of(&roots);
        let Ok(points) = sample_points(pool, &roots, &profile, seed ^ OTHER) else {
            return false;
        };
        let at = |other: &mut ModularPoint| {
            for symbol in self.symbols {
                other.set(*symbol, self.value(point, *symbol));
            }
            exists_at(pool, problem, other)
        };
        points.modulo(PRIME).find(pool, at) == Some(true)
    }
}

/// Index of the prime of all points.
pub(super) const PRIME: usize = 1;
/// Turns the seed of a point into that of another configuration: the fractional digits of the square root of 5.
const OTHER: u64 = 0x3c6e_f372_fe94_f82b;

/// Number of points that determine a polynomial of a degree.
fn needed(parameters: usize, degree: usize) -> usize {
    let monomials = (1..=parameters).fold(1, |count, k| count * (degree + k) / k);
    monomials + SURPLUS
}

/// The polynomial of lowest degree that vanishes at points, if its coefficients are small numbers.
fn polynomial(model: &mut Model, related: &[SymbolId], points: &[ModularPoint]) -> Option<ExprId> {
    let field = points.first()?.modulus();
    let pool = &mut model.pool;
    (1..=DEGREE).find_map(|degree| {
        let monomials = monomials(pool, related, degree);
        if points.len() < monomials.len() + SURPLUS {
            return None;
        }
        let rows: Option<Vec<Vec<u64>>> = points
            .iter()
            .map(|point| pool.modular_eval(&monomials, &mut point.clone()).ok())
            .collect();
        let relation = first_relation(field, rows?)?;
        let one = pool.one();
        let parts: Option<Vec<(Rational, ExprId, ExprId)>> = monomials
            .iter()
            .zip(&relation)
            .filter(|(_, coefficient)| **coefficient != 0)
            .map(|(monomial, coefficient)| {
                Some((reconstruct(field, *coefficient)?, one, *monomial))
            })
            .collect();
        let mut parts = parts?;
        parts.reverse();
        Some(combination(pool, &parts))
    })
}
