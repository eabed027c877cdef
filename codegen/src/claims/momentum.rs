//! Densities that depend on velocities: `f = (det m)^k |l|^s` relative to `mu_C`, `l` linear in the velocities on D.
//!
//! They are singular or 0 where `l = 0`. This set may attract the motion. [`super::darboux`] describes the search.

use dalembert_expr::{ExprId, Pool, Rational};

use super::ansatz::stages;
use super::darboux::Search;
use super::dynamics::Dynamics;
use super::exactness::Exactness;
use super::fit::Certified;
use super::global::Global;
use super::problem::Problem;
use super::undecided::Undecided;
use crate::mechanics::Derivation;
use crate::mechanics::constraint::regular_minor;
use crate::model::Model;

/// A density relative to `mu_C` that is singular or 0 where a factor linear in the velocities vanishes.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentumDensity {
    /// `l`: an expression of coordinates, velocities and parameters.
    pub factor: ExprId,
    /// `s`, the exponent of `|l|`.
    pub exponent: Rational,
    /// `k`, the exponent of `det m^{ab}`.
    pub mass_exponent: Rational,
    /// Result of the certification.
    pub certified: Certified,
}

impl MomentumDensity {
    /// `sqrt(det m)/abs(dot(phi))`
    pub fn text(&self, pool: &Pool) -> String {
        let base = format!("abs({})", pool.text(self.factor));
        let size = match self.exponent.abs().to_small() {
            Some((1, 1)) => base,
            Some((1, 2)) => format!("sqrt({base})"),
            _ => format!("{base}^{}", self.exponent.abs()),
        };
        let mass = match self.mass_exponent.to_small() {
            Some((0, _)) => None,
            Some((1, 1)) => Some("det m".to_owned()),
            Some((1, 2)) => Some("sqrt(det m)".to_owned()),
            _ => Some(format!("(det m)^({})", self.mass_exponent)),
        };
        match (mass, self.exponent.is_negative()) {
            (None, false) => size,
            (None, true) => format!("1/{size}"),
            (Some(mass), false) => format!("{mass}*{size}"),
            (Some(mass), true) => format!("{mass}/{size}"),
        }
    }
}

/// A density that depends on velocities, for a model without a density of the configuration on all of Q; `None` if no
/// density of the forms tried exists. `exactness`: the decision about densities of the configuration. `seed` determines
/// the random points.
///
/// # Errors
/// [`Undecided`], if there are no sample points.
pub fn find_momentum_density(
    model: &mut Model,
    derivation: &Derivation,
    problem: &Problem,
    exactness: &Exactness,
    seed: u64,
) -> Result<Option<MomentumDensity>, Undecided> {
    if exactness.global == Some(Global::Exists) {
        return Ok(None);
    }
    let dynamics = Dynamics::of(model, derivation);
    for terms in stages(model, problem, &dynamics) {
        let search = Search {
            problem,
            dynamics: &dynamics,
            seed,
        };
        for (shape, support) in search.factors(model, &terms)? {
            let Some(factor) = search.reconstruct(model, &shape, &support)? else {
                continue;
            };
            let factor = shortest(model, derivation, factor);
            if let Some(certified) = search.certify(&model.pool, &shape, factor)? {
                return Ok(Some(MomentumDensity {
                    factor,
                    exponent: shape.exponent,
                    mass_exponent: shape.mass_exponent,
                    certified,
                }));
            }
        }
    }
    Ok(None)
}

/// The shortest known form of an expression on D: as it is, or without the dependent velocities.
fn shortest(model: &mut Model, derivation: &Derivation, factor: ExprId) -> ExprId {
    let mut free = factor;
    for (a, j) in regular_minor(&model.pool, &derivation.constraints)
        .unwrap_or_default()
        .into_iter()
        .rev()
    {
        let (constraint, qdot) = (&derivation.constraints[a], model.coordinates[j].qdot);
        let zero = model.pool.zero();
        let rest = model.pool.substitute(constraint.residual, &[(qdot, zero)]);
        let quotient = model.pool.div(rest, constraint.form[j]);
        let velocity = model.pool.neg(quotient);
        free = model.pool.substitute(free, &[(qdot, velocity)]);
    }
    let mut best = factor;
    for candidate in [model.pool.simplify(factor), free, model.pool.simplify(free)] {
        if model.pool.text(candidate).len() < model.pool.text(best).len() {
            best = candidate;
        }
    }
    best
}
