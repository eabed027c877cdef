//! Alternatives where no density of the configuration exists on all of Q: conditions on the parameters, and densities
//! that depend on velocities.

use super::conditions::{Scan, find_conditions};
use super::exactness::Exactness;
use super::global::Global;
use super::momentum::{MomentumDensity, find_momentum_density};
use super::problem::Problem;
use crate::mechanics::Derivation;
use crate::model::Model;

/// Remarks on a model without a density on all of Q; none if such a density exists, or if its existence is undecided.
pub(super) fn alternatives(
    model: &mut Model,
    derivation: &Derivation,
    problem: &Problem,
    exactness: &Exactness,
    seed: u64,
) -> Vec<String> {
    let mut remarks = Vec::new();
    if matches!(
        exactness.global,
        Some(Global::Exists | Global::Undecided(_))
    ) {
        return remarks;
    }
    if let Ok(scan) = find_conditions(model, problem, exactness, seed) {
        remarks.extend(conditions(model, &scan, exactness.local.exists));
    }
    if !exactness.local.exists {
        remarks.push(near_rest(model, problem));
    }
    let singular = find_momentum_density(model, derivation, problem, exactness, seed);
    if let Ok(Some(found)) = singular {
        remarks.push(singular_density(model, &found));
    }
    remarks
}

/// Result of the scan as text; `None` if there was nothing to scan. If a local density exists, the scan was for a
/// density on all of Q.
fn conditions(model: &Model, scan: &Scan, is_local: bool) -> Option<String> {
    let what = match is_local {
        true => "a density on all of Q",
        false => "a density",
    };
    let cut = match scan.is_complete {
        true => String::new(),
        false => format!("; the scan was cut off after {} trials", scan.trials),
    };
    match scan.found.is_empty() {
        true if scan.trials == 0 => None,
        true => Some(format!(
            "none of the conditions on parameters that were scanned gives {what}{cut}"
        )),
        false => Some(format!("{what} exists where {}{cut}", scan.text(model))),
    }
}

/// Consequence of the absence of a density of `q` for densities of `q` and `qdot`.
///
/// Let `f(q, qdot)` be a density: `X(f) = -f div X`. Without potential, terms of the Lagrangian that are linear in the
/// velocities, other forces and drift, the part of this equation of first order in `qdot` is the equation of a density
/// of `q` for `f(q, 0)`. No such density exists.
fn near_rest(model: &Model, problem: &Problem) -> String {
    let pool = &model.pool;
    let potential = model.lagrangian.potential;
    let is_free = !problem.has_drift(pool)
        && model.forces.is_empty()
        && model
            .coordinates
            .iter()
            .all(|coordinate| !pool.depends_on(potential, coordinate.q))
        && model
            .lagrangian
            .linear
            .iter()
            .all(|id| pool.is_syntactic_zero(*id));
    match is_free {
        true => "only inertia moves the system: no positive density that is C^1 near rest depends on velocities either",
        false => "nothing is said of smooth densities that depend on velocities: more than inertia moves the system",
    }
    .to_owned()
}

fn singular_density(model: &Model, found: &MomentumDensity) -> String {
    let (text, factor) = (found.text(&model.pool), model.pool.text(found.factor));
    let what = match found.exponent.is_negative() {
        true => "is singular",
        false => "is 0",
    };
    format!("{text}*mu_C is invariant; it {what} where {factor} = 0, which may attract the motion")
}
