//! Derivatives of the metric: `d_k g_ij` and `d_t g_ij`, as sparse lists over `i <= j`.

use super::{Coordinates, Entry, gradient};
use crate::model::Model;

/// The metric's derivatives; entries with `i <= j` stand for both `(i, j)` and `(j, i)`.
#[derive(Debug, Default)]
pub struct MetricDerivatives {
    /// `d_k g_ij`, index `[i, j, k]`.
    pub by_coordinate: Vec<Entry<3>>,
    /// `d_t g_ij`, index `[i, j]`.
    pub by_time: Vec<Entry<2>>,
}

/// Differentiates the metric. Does nothing without constraints, where no function needs the derivatives.
pub(super) fn derive_metric(model: &mut Model, coordinates: &Coordinates) -> MetricDerivatives {
    let mut derivatives = MetricDerivatives::default();
    if model.constraints.is_empty() {
        return derivatives;
    }
    for i in 0..coordinates.q.len() {
        for j in i..coordinates.q.len() {
            let g_ij = model.lagrangian.metric[i][j];
            for Entry { index: [k], value } in gradient(model, g_ij, &coordinates.q) {
                derivatives.by_coordinate.push(Entry {
                    index: [i, j, k],
                    value,
                });
            }
            for Entry { value, .. } in gradient(model, g_ij, &[coordinates.time]) {
                derivatives.by_time.push(Entry {
                    index: [i, j],
                    value,
                });
            }
        }
    }
    derivatives
}
