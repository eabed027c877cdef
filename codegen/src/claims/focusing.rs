//! Instantaneous constraints of a surface: the projection onto `D' = ker(eta, psi)` that comes before the law.
//!
//! ```text
//! qdot' = qdot - W^b m_ba (0, psi(qdot) + psi_0)^a,   W = g^-1 (eta, psi),   m^ab = (eta, psi)^a(W^b)
//! ```
//!
//! If the motion still approaches after the projection, the law acts, with `pi_D'` in place of `pi_D`. Where
//! `psi(pi_D grad h) = 0` the projection keeps the gap rate, and the law acts in every impact. J. Cortes and
//! A. M. Vinogradov (2006), 4.2.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint};

use super::collision::{AtImpact, evidence_at_impact};
use super::dynamics::Number;
use super::hybrid::Surroundings;
use super::wall::Wall;
use crate::model::Model;

/// The change of the gap rate by the projection.
struct Turn<'t>(&'t Wall);

impl AtImpact for Turn<'_> {
    fn roots(&self) -> Vec<ExprId> {
        Vec::new()
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        _: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let [before, focused] = self.0.gap_rates(model, point)?;
        Some(vec![focused, point.field().neg(before)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, _: &[f64]) -> Option<f64> {
        let rates = self.0.gap_rates(model, point)?;
        Some(rates.iter().map(|rate| rate.abs()).sum())
    }

    fn shown(&self, _: &[f64], _: f64) -> Vec<(String, f64)> {
        Vec::new()
    }
}

/// True if the surface has no instantaneous constraints, or they are proved to leave the gap rate as it is.
pub(super) fn leaves_gap_rate(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    wall: &Wall,
) -> bool {
    model.surfaces[surface].instantaneous.is_empty()
        || evidence_at_impact(model, wall, around.dynamics, &Turn(wall), around.seed)
            .shows_that_it_vanishes()
}

/// Reason for which impacts stay open if the projection may turn the motion away from the surface.
pub(super) const TURNED: &str = "its instantaneous constraints change the gap rate";
