//! Differentials of the impact surfaces: `dh`, `d_t h` and the gap rate `dh(qdot) + d_t h`.
//!
//! Every law is an impulse along `pi_D^* dh`; its size is the runtime's affair, so that a caller may choose
//! another law without new code.

use dalembert_expr::ExprId;

use super::Coordinates;
use crate::model::Model;

/// One surface, differentiated.
#[derive(Debug)]
pub struct SurfaceForm {
    /// `h(t, q)`.
    pub gap: ExprId,
    /// `dh`, N entries.
    pub form: Vec<ExprId>,
    /// `d_t h`.
    pub rate: ExprId,
    /// `dh(qdot) + d_t h`.
    pub gap_rate: ExprId,
    /// The rate of `gap_rate` at fixed velocity: what `d^2h/dt^2` is besides `dh(qddot)`.
    pub curvature: ExprId,
    /// The functions that must be positive for the surface to count.
    pub conditions: Vec<ExprId>,
}

/// Differentiates every surface.
pub(super) fn derive_surfaces(model: &mut Model, coordinates: &Coordinates) -> Vec<SurfaceForm> {
    let motion = coordinates.motion(model);
    (0..model.surfaces.len())
        .map(|s| {
            let gap = model.surfaces[s].gap;
            let gap_rate = model.pool.derivative_along(gap, &motion);
            SurfaceForm {
                gap,
                form: coordinates
                    .q
                    .iter()
                    .map(|&q| model.pool.diff(gap, q))
                    .collect(),
                rate: model.pool.diff(gap, coordinates.time),
                curvature: model.pool.derivative_along(gap_rate, &motion),
                gap_rate,
                conditions: model.surfaces[s].conditions.clone(),
            }
        })
        .collect()
}
