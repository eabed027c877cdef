//! Terms of the global field: `p_k = dL/dqdot^k`, `f_k = d_k L + F_k`, `drift_k = (gdot qdot + Adot)_k`.

use dalembert_expr::{ExprId, Pool, Rational, Verdict};

use super::Coordinates;
use crate::model::Model;

/// Expressions of coordinates, velocities, parameters and time; N entries each.
#[derive(Debug)]
pub struct FieldTerms {
    /// `f_k = d_k L + F_k`, every named force added.
    pub force: Vec<ExprId>,
    /// `d/dt` of `dL/dqdot^k` at fixed velocity: `gdot qdot + Adot`.
    pub drift: Vec<ExprId>,
    /// True for coordinates where force and drift were proved equal.
    pub cancels: Vec<bool>,
    /// `d_t L` if there are named forces; else zero.
    pub by_time: ExprId,
}

/// Number of subexpressions beyond which force and drift are not compared.
const PARTS: usize = 400;

/// Number of coordinates up to which the expanded metric is differentiated too.
const COORDINATES: usize = 4;

/// Derives forces and drift. Differentiating `L` itself instead of its expanded metric keeps the
/// structure that the author wrote, so that an N-link chain costs O(N^2) operations and not O(N^3). With few
/// coordinates both are tried: terms that cancel in the metric do not occur in its derivatives.
pub(super) fn derive_field(model: &mut Model, coordinates: &Coordinates) -> FieldTerms {
    let whole = model.lagrangian.whole;
    let mut terms = FieldTerms {
        force: Vec::new(),
        drift: Vec::new(),
        cancels: Vec::new(),
        by_time: match model.forces.is_empty() {
            true => model.pool.zero(),
            false => model.pool.diff(whole, coordinates.time),
        },
    };
    let (gradient, drift) = gradient_and_drift(model, coordinates);
    for (k, (&gradient, &drift)) in gradient.iter().zip(&drift).enumerate() {
        let mut force = vec![gradient];
        force.extend(model.forces.iter().map(|named| named.form[k]));
        let force = model.pool.sum(&force);
        terms.cancels.push(cancel(&mut model.pool, force, drift));
        terms.force.push(force);
        terms.drift.push(drift);
    }
    terms
}

/// True if two expressions are finite everywhere and proved equal.
fn cancel(pool: &mut Pool, a: ExprId, b: ExprId) -> bool {
    if !pool.is_finite(a) || !pool.is_finite(b) || pool.reachable(&[a, b]).len() > PARTS {
        return false;
    }
    let difference = pool.sub(a, b);
    pool.zero_test(difference) == Verdict::Proved
}

/// `d_k L` and `d/dt dL/dqdot^k` at fixed velocity. Each is derived from `L` as written and from its expanded form; the
/// pair with the fewest subexpressions is returned.
fn gradient_and_drift(model: &mut Model, coordinates: &Coordinates) -> (Vec<ExprId>, Vec<ExprId>) {
    let whole = model.lagrangian.whole;
    let written = (
        gradient(model, coordinates, whole),
        drift(model, coordinates, whole),
    );
    if coordinates.q.len() > COORDINATES {
        return written;
    }
    let parts = expanded(model, coordinates);
    let expanded = (
        gradient(model, coordinates, parts),
        drift(model, coordinates, parts),
    );
    let pairs = [
        written.clone(),
        (expanded.0.clone(), written.1.clone()),
        (written.0, expanded.1.clone()),
        expanded,
    ];
    // Of pairs of equal size, `min_by_key` returns the first, which is as written.
    let pairs = pairs.into_iter().min_by_key(|(gradient, drift)| {
        let both: Vec<ExprId> = gradient.iter().chain(drift).copied().collect();
        model.pool.reachable(&both).len()
    });
    pairs.unwrap_or_default()
}

/// The derivatives with respect to the coordinates.
fn gradient(model: &mut Model, coordinates: &Coordinates, lagrangian: ExprId) -> Vec<ExprId> {
    let symbols = coordinates.q.iter();
    symbols.map(|&q| model.pool.diff(lagrangian, q)).collect()
}

/// `d/dt dL/dqdot^k` at fixed velocity.
pub(super) fn drift(
    model: &mut Model,
    coordinates: &Coordinates,
    lagrangian: ExprId,
) -> Vec<ExprId> {
    let motion = coordinates.motion(model);
    let along = |&velocity| {
        let momentum = model.pool.diff(lagrangian, velocity);
        model.pool.derivative_along(momentum, &motion)
    };
    coordinates.qdot.iter().map(along).collect()
}

/// `1/2 qdot^T g qdot + A.qdot - V`
fn expanded(model: &mut Model, coordinates: &Coordinates) -> ExprId {
    let (metric, linear) = (
        model.lagrangian.metric.clone(),
        model.lagrangian.linear.clone(),
    );
    let qdot: Vec<ExprId> = coordinates
        .qdot
        .iter()
        .map(|&symbol| model.pool.variable(symbol))
        .collect();
    let pool = &mut model.pool;
    let mut terms = vec![(Rational::MINUS_ONE, model.lagrangian.potential)];
    for i in 0..qdot.len() {
        terms.push((Rational::ONE, pool.mul(linear[i], qdot[i])));
        for j in 0..=i {
            let weight = if i == j {
                Rational::HALF
            } else {
                Rational::ONE
            };
            terms.push((weight, pool.product(&[metric[i][j], qdot[i], qdot[j]])));
        }
    }
    pool.combine(&terms)
}
