//! Linear combinations of stages, written so that a table known at compile time becomes straight-line code.

use crate::state::StateVector;

/// A non-zero entry of a row of a tableau: the stage it multiplies, and its value.
pub(super) type Term = (usize, f64);

/// `sum over terms of coefficient * stage`, component `i`.
#[inline(always)]
pub(super) fn sum<S: StateVector>(stages: &[S], terms: &[Term], i: usize) -> f64 {
    let mut sum = 0.0;
    for &(stage, coefficient) in terms {
        sum += coefficient * stages[stage].as_slice()[i];
    }
    sum
}

/// `sum over terms of coefficient * value`
#[inline(always)]
pub(super) fn weigh(values: &[f64], terms: &[Term]) -> f64 {
    let mut sum = 0.0;
    for &(stage, coefficient) in terms {
        sum += coefficient * values[stage];
    }
    sum
}

/// `out = base + h * sum over terms of coefficient * stage`.
#[inline(always)]
pub(super) fn combine<S: StateVector>(base: &S, h: f64, stages: &[S], terms: &[Term], out: &mut S) {
    for i in 0..S::LEN {
        out.as_mut_slice()[i] = base.as_slice()[i] + h * sum(stages, terms, i);
    }
}

/// The larger of two sizes; not a number once one is.
///
/// Errors are measured by their largest component, not by their mean: components that are integrated without error, as
/// angles that turn uniformly, must not excuse the others.
#[inline(always)]
pub(super) fn larger(largest: f64, value: f64) -> f64 {
    if value > largest || value.is_nan() {
        value
    } else {
        largest
    }
}

/// Checks of tables, for the tests of the schemes.
#[cfg(test)]
pub(super) mod check {
    use super::Term;

    fn row_sum(row: &[Term]) -> f64 {
        row.iter().map(|&(_, coefficient)| coefficient).sum()
    }

    /// Every row sums to its node: stages are exact for constant rates.
    pub(crate) fn rows_sum_to_nodes(rows: &[&[Term]], nodes: &[f64]) {
        for (row, node) in rows.iter().zip(nodes) {
            assert!(
                (row_sum(row) - node).abs() < 1e-13,
                "{} for {node}",
                row_sum(row)
            );
        }
    }

    /// The order conditions of bushy trees, `sum b_i c_i^(k-1) = 1/k`, and of those with one more edge at the
    /// root, `sum b_i a_ij c_j^(k-1) = 1/(k (k+1))`. `rows[i]` belongs to stage `i`.
    pub(crate) fn weights_have_order(
        order: i32,
        weights: &[Term],
        rows: &[&[Term]],
        nodes: &[f64],
    ) {
        for k in 1..=order {
            let bushy: f64 = weights.iter().map(|&(i, b)| b * nodes[i].powi(k - 1)).sum();
            assert!(
                (bushy - 1.0 / f64::from(k)).abs() < 1e-13,
                "order {k}: {bushy}"
            );
        }
        for k in 1..order {
            let inner = |i: usize| {
                rows[i]
                    .iter()
                    .map(|&(j, a)| a * nodes[j].powi(k - 1))
                    .sum::<f64>()
            };
            let tall: f64 = weights.iter().map(|&(i, b)| b * inner(i)).sum();
            assert!(
                (tall - 1.0 / f64::from(k * (k + 1))).abs() < 1e-12,
                "order {k}: {tall}"
            );
        }
    }

    /// An error estimate vanishes on polynomial motion up to the order of the embedded solution, not beyond.
    pub(crate) fn estimate_has_order(order: i32, estimate: &[Term], nodes: &[f64]) {
        let moment = |k: i32| {
            estimate
                .iter()
                .map(|&(i, e)| e * nodes[i].powi(k - 1))
                .sum::<f64>()
        };
        for k in 1..=order {
            assert!(moment(k).abs() < 1e-13, "order {k}: {}", moment(k));
        }
        assert!(moment(order + 1).abs() > 1e-6);
    }
}
