//! Constraints that are not linear in the velocities, solved for one velocity each: `a v^2 + b v + c = 0`.
//!
//! D contains the states of both roots. A sum that vanishes on D vanishes for each choice of roots.

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, Pool, Rational, SymbolId, Verdict as Zero,
};

use super::dynamics::Number;
use crate::mechanics::Derivation;
use crate::model::Model;

/// Largest number of nonlinear constraints whose combinations of roots are examined.
const MOST: usize = 4;

/// A constraint with the velocity that it is solved for, and its coefficients `c`, `b`, `a`, evaluated where that
/// velocity is 0.
#[derive(Debug, Clone)]
pub(super) struct Branch {
    pub(super) velocity: SymbolId,
    coefficients: [ExprId; 3],
    /// True for the second root.
    pub(super) is_second: bool,
}

/// One branch for each nonlinear constraint of a model. `None` unless every such constraint is a polynomial of degree 1
/// or 2 in a velocity that no other constraint contains, with a leading coefficient that is never 0.
pub(super) fn branches(model: &mut Model, derivation: &Derivation) -> Option<Vec<Branch>> {
    let nonlinear: Vec<ExprId> = model
        .constraints
        .iter()
        .filter_map(|constraint| constraint.nonlinear)
        .collect();
    if nonlinear.len() > MOST {
        return None;
    }
    let linear = derivation.constraints.iter().zip(&model.constraints);
    let linear: Vec<ExprId> = linear
        .filter(|(_, constraint)| constraint.nonlinear.is_none())
        .map(|(form, _)| form.residual)
        .collect();
    let velocities: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    let mut branches = Vec::new();
    for (a, phi) in nonlinear.iter().enumerate() {
        let others = nonlinear.iter().enumerate().filter(|(b, _)| *b != a);
        let others: Vec<ExprId> = others.map(|(_, phi)| *phi).chain(linear.clone()).collect();
        let is_own = |velocity: &&SymbolId| {
            let is_free = |phi: &ExprId| !model.pool.depends_on(*phi, **velocity);
            others.iter().all(is_free) && !is_free(phi)
        };
        let candidates: Vec<SymbolId> = velocities.iter().filter(is_own).copied().collect();
        let mut candidates = candidates.into_iter();
        branches.push(candidates.find_map(|velocity| branch(&mut model.pool, *phi, velocity))?);
    }
    Some(branches)
}

fn branch(pool: &mut Pool, phi: ExprId, velocity: SymbolId) -> Option<Branch> {
    let first = pool.diff(phi, velocity);
    let second = pool.diff(first, velocity);
    let third = pool.diff(second, velocity);
    let is_linear = pool.zero_test(second) == Zero::Proved;
    let leading = if is_linear { first } else { second };
    let is_unit = pool.sign(leading).is_nonzero() && pool.is_finite(leading);
    if pool.zero_test(third) != Zero::Proved || !is_unit {
        return None;
    }
    let half = pool.scale(&Rational::HALF, second);
    let zero = pool.zero();
    let coefficients = [phi, first, half].map(|part| pool.substitute(part, &[(velocity, zero)]));
    Some(Branch {
        velocity,
        coefficients,
        is_second: false,
    })
}

impl Branch {
    /// Expressions to be evaluated.
    pub(super) fn roots(&self) -> impl Iterator<Item = ExprId> {
        self.coefficients.into_iter()
    }

    /// The branch with parameters replaced.
    pub(super) fn substituted(&self, pool: &mut Pool, replacements: &[(SymbolId, ExprId)]) -> Self {
        let coefficients = self.coefficients;
        Self {
            coefficients: coefficients.map(|part| pool.substitute(part, replacements)),
            ..self.clone()
        }
    }

    /// Sets the velocity of a point to the root of the branch; `None` where the root does not exist.
    pub(super) fn settle<P: ExpansionPoint>(&self, pool: &Pool, point: &mut P) -> Option<()> {
        let field = point.field();
        let values = point.values(pool, &pool.reachable(&self.coefficients))?;
        let [c, b, a] = self.coefficients.map(|part| values[part.index()]);
        let solution = match field.is_zero(a) {
            true => field.neg(field.mul(c, field.inv(b)?)),
            false => self.root(point, [c, b, a])?,
        };
        point.set_symbol(self.velocity, solution);
        Some(())
    }

    /// `(-b +- sqrt(b^2 - 4 a c))/(2 a)`
    fn root<P: ExpansionPoint>(&self, point: &P, [c, b, a]: [Number<P>; 3]) -> Option<Number<P>> {
        let field = point.field();
        let four = field.mul(field.integer(4), field.mul(a, c));
        let root = point.power(field.sub(field.mul(b, b), four), &Rational::HALF)?;
        let root = if self.is_second {
            field.neg(root)
        } else {
            root
        };
        let twice = field.inv(field.mul(field.integer(2), a))?;
        Some(field.mul(field.sub(root, b), twice))
    }
}
