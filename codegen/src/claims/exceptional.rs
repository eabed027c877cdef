//! Values of one parameter at which an obstruction may vanish: rational roots and poles of delta.
//!
//! At a point modulo a prime, with all other parameters fixed, delta (see [`super::obstruction`]) is a rational
//! function of the parameter. A few of its values determine it. At a random point, a root or a pole is hardly ever a
//! small fraction by accident. Such a fraction is only a candidate: other obstructions may remain, or the model may be
//! degenerate there.

use dalembert_expr::{ExprId, ModularPoint, Node, Pool, Rational, SymbolId};

use super::elimination::first_relation;
use super::exactness::{Local, sample_points};
use super::fit::reconstruct;
use super::hypersurfaces::PRIME;
use super::obstruction::elements_at;
use super::polynomial::{Polynomial, rational_function, roots};
use super::problem::Problem;

/// Numbers of values of delta after which an interpolation is tried, in order.
const VALUES: [usize; 4] = [8, 16, 32, 48];
/// Number of values beyond the number of coefficients. They check the interpolation.
const SURPLUS: usize = 2;

/// Small fractions at which delta has a root or a pole as a function of `parameter`. The list is empty if delta is not
/// a rational function of `parameter`, or if its degree is too high. `trials` is the number of values that may still be
/// computed; `None` if it is too small.
pub(super) fn exceptional_values(
    pool: &Pool,
    problem: &Problem,
    local: &Local,
    parameter: SymbolId,
    seed: u64,
    trials: &mut usize,
) -> Option<Vec<Rational>> {
    let Some(obstruction) = local.hull.obstruction else {
        return Some(Vec::new());
    };
    let column = Column {
        pool,
        problem,
        local,
        obstruction,
        parameter,
    };
    let Some((base, first)) = column.base(seed).filter(|_| column.is_rational()) else {
        return Some(Vec::new());
    };
    let Some(functions) = column.functions(&base, first, trials)? else {
        return Some(Vec::new());
    };
    let field = base.modulus();
    let roots = functions.iter().flat_map(|function| roots(field, function));
    let mut found: Vec<_> = roots.filter_map(|root| reconstruct(field, root)).collect();
    found.sort();
    found.dedup();
    Some(found)
}

/// Delta as a function of one parameter.
pub(super) struct Column<'c> {
    pub(super) pool: &'c Pool,
    pub(super) problem: &'c Problem,
    pub(super) local: &'c Local,
    /// Index of the obstructed element of the hull.
    pub(super) obstruction: usize,
    pub(super) parameter: SymbolId,
}

impl Column<'_> {
    /// True if neither a root nor a function depends on the parameter.
    pub(super) fn is_rational(&self) -> bool {
        let depends = |id: ExprId| self.pool.depends_on(id, self.parameter);
        let order = self.pool.reachable(&self.problem.roots());
        order.into_iter().all(|id| match self.pool.node(id) {
            Node::Call(_, argument) => !depends(*argument),
            Node::Atan2(y, x) => !depends(*y) && !depends(*x),
            Node::Product(factors) => factors
                .iter()
                .all(|(base, exponent)| exponent.is_integer() || !depends(*base)),
            _ => true,
        })
    }

    /// A point where delta has a value, and the value.
    pub(super) fn base(&self, seed: u64) -> Option<(ModularPoint, u64)> {
        let roots = self.problem.roots();
        let profile = self.pool.profile_of(&roots);
        let points = sample_points(self.pool, &roots, &profile, seed).ok()?;
        let mut points = points.modulo(PRIME);
        points.find(self.pool, |point| {
            let delta = self.delta(&mut point.clone())?;
            Some((point.clone(), delta))
        })
    }

    /// Numerator and denominator of delta; `Some(None)` if their degrees are too high, `None` if `trials` do not
    /// suffice.
    #[expect(
        clippy::option_option,
        reason = "a degree that is too high differs from the end of the trials"
    )]
    pub(super) fn functions(
        &self,
        base: &ModularPoint,
        first: u64,
        trials: &mut usize,
    ) -> Option<Option<[Polynomial; 2]>> {
        let field = base.modulus();
        let assumption = self.pool.symbol_assumption(self.parameter);
        let mut x = base.value(self.parameter, assumption);
        let mut values = vec![(x, first)];
        for count in VALUES {
            while values.len() < count {
                *trials = trials.checked_sub(1)?;
                x = field.add(x, 1);
                let mut point = base.clone();
                point.set(self.parameter, x);
                values.extend(self.delta(&mut point).map(|delta| (x, delta)));
            }
            if let Some((above, below)) = rational_function(field, &values, SURPLUS) {
                return Some(Some([above, below]));
            }
        }
        Some(None)
    }

    /// Demand of the obstructing element minus the demand of the combination of other elements that has the same vector
    /// field.
    fn delta(&self, point: &mut ModularPoint) -> Option<u64> {
        let field = point.modulus();
        let hull = &self.local.hull;
        let dependent = Some(self.local.dependent.as_slice());
        let elements = elements_at(self.pool, self.problem, hull, dependent, point)?;
        let before = hull
            .basis
            .iter()
            .filter(|element| **element < self.obstruction);
        let columns: Vec<usize> = before.copied().chain([self.obstruction]).collect();
        let width = self.problem.components();
        let rows = (0..width)
            .map(|i| columns.iter().map(|column| elements[*column][i]).collect())
            .collect();
        let relation = first_relation(field, rows)?;
        // If the relation ends before the obstructing element, the other elements are dependent at this point.
        if relation.last() != Some(&1) {
            return None;
        }
        let mut delta = 0;
        for (coefficient, element) in relation.iter().zip(&columns) {
            delta = field.add(delta, field.mul(*coefficient, elements[*element][width]));
        }
        Some(delta)
    }
}
