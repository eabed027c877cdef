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

#[cfg(test)]
mod tests {
    use crate::{Compiled, compile};

    fn factors(source: &str) -> Compiled {
        compile(source.parse().expect("tokens")).expect("a model")
    }

    #[test]
    fn rows_that_elimination_simplifies_are_written_out() {
        let body = factors(
            "pub Body {
                coordinates { x; y; theta: angle; }
                parameters { m > 0 = 1; I > 0 = 1; a = 1; }
                let v_x = dot(x) - a*sin(theta)*dot(theta);
                let v_y = dot(y) + a*cos(theta)*dot(theta);
                lagrangian = m/2*(v_x^2 + v_y^2) + I/2*dot(theta)^2;
            }",
        );
        let [None, None, Some(row)] = &body.derivation.factors[..] else {
            panic!("a row of the angle: {:?}", body.derivation.factors);
        };
        let pool = &body.model.pool;
        assert_eq!(pool.text(row.pivot), "I");
        let below: Vec<String> = row.below.iter().map(|&entry| pool.text(entry)).collect();
        assert_eq!(below, ["-a*sin(theta)", "a*cos(theta)"]);
    }

    #[test]
    fn rows_that_grow_are_factorised_numerically() {
        let pendulum = factors(
            "pub Pendulum {
                coordinates { a: angle; b: angle; }
                parameters { m > 0 = 1; M > 0 = 1; l > 0 = 1; }
                lagrangian = (m + M)*l^2/2*dot(a)^2 + m*l^2/2*dot(b)^2 + m*l^2*cos(a - b)*dot(a)*dot(b);
            }",
        );
        assert!(pendulum.derivation.factors.iter().all(Option::is_none));
    }
}
