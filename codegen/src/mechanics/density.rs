//! Terms of the density form and of the divergence.
//!
//! ```text
//! theta_k = m_ab [ W^{a,j} d_j eta^b_k + W^{b,j} d_k eta^a_j - W^b.(d_k g) W^a ]        (= m_ab L_{W^a} eta^b)
//! div     = -theta(qdot) - m_ab W^b(eta_0^a) - m_ab (d_t eta^a)(W^b) + m_ab (d_t g)(W^a, W^b)
//!           + tr(dF/dqdot . pi_D g^{-1})
//! ```
//!
//! `W^a = g^{-1} eta^a` are the vectors of the constraint forms, and `m_ab` is the inverse of the matrix `eta^a(W^b)`.
//! The expression of theta in brackets uses `d_k W^a = g^{-1}(d_k eta^a - (d_k g) W^a)`, so that no inverse is
//! differentiated. W. Clark, thesis, Definition V.23; the divergence has no factor n (docs/conventions.md).

use super::{Coordinates, Entry, MetricDerivatives, gradient};
use crate::model::Model;

/// Derivatives that theta and the divergence need besides those of the constraint forms.
#[derive(Debug)]
pub struct DensityTerms {
    /// Derivatives of the metric; empty without constraints.
    pub metric: MetricDerivatives,
    /// `dF_i/dqdot^j`, index `[i, j]`, all forces added.
    pub force_velocity: Vec<Entry<2>>,
}

/// Collects the terms.
pub(super) fn derive_density(
    model: &mut Model,
    coordinates: &Coordinates,
    metric: MetricDerivatives,
) -> DensityTerms {
    let mut force_velocity = Vec::new();
    for i in 0..coordinates.q.len() {
        let components: Vec<_> = model.forces.iter().map(|named| named.form[i]).collect();
        let force = model.pool.sum(&components);
        for Entry { index: [j], value } in gradient(model, force, &coordinates.qdot) {
            force_velocity.push(Entry {
                index: [i, j],
                value,
            });
        }
    }
    DensityTerms {
        metric,
        force_velocity,
    }
}
