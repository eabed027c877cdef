//! Symbolic rows of the factorisation `g = L D L^T` that are no larger than the rows of `g`.
//!
//! If the origin of a body is not its centre of mass, elimination removes a term of the metric: `I + m a^2` becomes
//! `I`. Symbolic expressions cancel exactly, numbers only up to rounding. Rows whose expressions would grow are
//! factorised numerically.

use dalembert_expr::{ExprId, Pool};

/// Largest number of coordinates for which rows are sought.
const COORDINATES: usize = 8;

/// A row of the factorisation.
#[derive(Debug, Clone)]
pub struct FactorRow {
    /// `L_ij`, `j < i`.
    pub below: Vec<ExprId>,
    /// `D_i`
    pub pivot: ExprId,
}

/// One entry for each row of `g`: `None` if the row of `L` has no entries below the diagonal, or if it would grow.
pub(super) fn derive_factors(pool: &mut Pool, metric: &[Vec<ExprId>]) -> Vec<Option<FactorRow>> {
    if metric.len() > COORDINATES {
        return vec![None; metric.len()];
    }
    let mut known: Vec<Option<FactorRow>> = Vec::with_capacity(metric.len());
    for i in 0..metric.len() {
        let row = eliminated(pool, &metric[i][..=i], &known);
        known.push(row);
    }
    known
        .into_iter()
        .map(|row| {
            row.filter(|row| {
                row.below
                    .iter()
                    .any(|&entry| !pool.is_syntactic_zero(entry))
            })
        })
        .collect()
}

fn eliminated(pool: &mut Pool, row: &[ExprId], known: &[Option<FactorRow>]) -> Option<FactorRow> {
    let (&diagonal, coupled) = row.split_last()?;
    let mut pivot = vec![diagonal];
    let mut scaled: Vec<ExprId> = Vec::with_capacity(coupled.len());
    let mut below: Vec<ExprId> = Vec::with_capacity(coupled.len());
    for (j, &entry) in coupled.iter().enumerate() {
        let mut terms = vec![entry];
        for k in 0..j {
            if !pool.is_syntactic_zero(scaled[k]) {
                let product = pool.mul(scaled[k], known[j].as_ref()?.below[k]);
                terms.push(pool.neg(product));
            }
        }
        let rest = pool.sum(&terms);
        scaled.push(pool.simplify(rest));
        below.push(match pool.is_syntactic_zero(scaled[j]) {
            true => scaled[j],
            false => pool.div(scaled[j], known[j].as_ref()?.pivot),
        });
        let product = pool.mul(scaled[j], below[j]);
        pivot.push(pool.neg(product));
    }
    let pivot = pool.sum(&pivot);
    let pivot = pool.simplify(pivot);
    let size = |id: ExprId| pool.reachable(&[id]).len();
    let no_larger = |entry: ExprId, of: ExprId| size(entry) <= size(of);
    let pairs = below.iter().zip(coupled);
    let is_small = pairs.into_iter().all(|(&entry, &of)| no_larger(entry, of));
    (is_small && no_larger(pivot, diagonal)).then_some(FactorRow { below, pivot })
}
