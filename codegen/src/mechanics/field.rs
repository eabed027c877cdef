//! Terms of the global field: `p_k = dL/dqdot^k`, `f_k = d_k L + F_k`, `drift_k = (gdot qdot + Adot)_k`.

use dalembert_expr::ExprId;

use super::Coordinates;
use crate::model::Model;

/// Expressions of coordinates, velocities, parameters and time; N entries each.
#[derive(Debug)]
pub struct FieldTerms {
    /// `f_k = d_k L + F_k`, every named force added.
    pub force: Vec<ExprId>,
    /// `d/dt` of `dL/dqdot^k` at fixed velocity: `gdot qdot + Adot`.
    pub drift: Vec<ExprId>,
}

/// Derives forces and drift. Differentiating `L` itself instead of its expanded metric keeps the
/// structure that the author wrote, so that an N-link chain costs O(N^2) operations and not O(N^3).
pub(super) fn derive_field(model: &mut Model, coordinates: &Coordinates) -> FieldTerms {
    let motion = coordinates.motion(model);
    let whole = model.lagrangian.whole;
    let mut terms = FieldTerms {
        force: Vec::new(),
        drift: Vec::new(),
    };
    for k in 0..coordinates.q.len() {
        let mut force = vec![model.pool.diff(whole, coordinates.q[k])];
        force.extend(model.forces.iter().map(|named| named.form[k]));
        terms.force.push(model.pool.sum(&force));
        let momentum = model.pool.diff(whole, coordinates.qdot[k]);
        terms
            .drift
            .push(model.pool.derivative_along(momentum, &motion));
    }
    terms
}
