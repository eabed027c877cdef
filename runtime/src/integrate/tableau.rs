//! Linear combinations of Runge-Kutta stages. A tableau known at compile time becomes straight-line code.

use crate::state::StateVector;

/// A non-zero entry of a row of a tableau: index of the stage, and coefficient.
pub(super) type Term = (usize, f64);

/// `sum over terms of coefficient * stage`, component `i`, without the first stage.
///
/// Stages after the first hold the differences between their rates and the rate of the first stage. A row adds up to
/// its node, so the node times the first rate plus this sum is the combination of the rates. Coefficients are rounded,
/// and large relative to their sum: a sum over the rates themselves would give a motion with almost constant rates an
/// error of the same sign in every step.
#[inline(always)]
pub(super) fn sum<S: StateVector>(stages: &[S], terms: &[Term], i: usize) -> f64 {
    let mut sum = 0.0;
    for &(stage, coefficient) in terms {
        if stage > 0 {
            sum += coefficient * stages[stage].padded()[i];
        }
    }
    sum
}

/// Bound of the rounding errors of a sum with these coefficients, for values up to `size`.
#[inline(always)]
pub(super) fn rounding(size: f64, terms: &[Term]) -> f64 {
    let weights = terms
        .iter()
        .fold(0.0, |sum, (_, weight)| sum + weight.abs());
    0.5 * f64::EPSILON * size * weights
}

/// `sum over terms of coefficient * value`, or 0 if its absolute value is at most the bound of [`rounding`].
#[inline(always)]
pub(super) fn weigh_beyond_rounding(values: &[f64], terms: &[Term], size: f64) -> f64 {
    let mut sum = 0.0;
    for &(stage, coefficient) in terms {
        sum += coefficient * values[stage];
    }
    match sum.abs() <= rounding(size, terms) {
        true => 0.0,
        false => sum,
    }
}

/// `out = base + h * (node * rate + sum over terms of coefficient * difference)`, from the rate of the first stage and
/// the differences of the others.
#[inline(always)]
pub(super) fn combine<S: StateVector>(
    base: &S,
    h: f64,
    stages: &[S],
    (node, terms): (f64, &[Term]),
    out: &mut S,
) {
    base.for_each_place(|i| {
        let rate = node * stages[0].padded()[i] + sum(stages, terms, i);
        out.padded_mut()[i] = base.padded()[i] + h * rate;
    });
}

/// Replaces the rate of a stage by its difference from that of the first stage.
#[inline(always)]
pub(super) fn subtract_first<S: StateVector>(stages: &mut [S], stage: usize) {
    let first = stages[0];
    first.for_each_place(|i| stages[stage].padded_mut()[i] -= first.padded()[i]);
}

/// The larger of two numbers; NaN if either is NaN.
///
/// The norm of the error is its largest component, not a mean: components without error, for example angles that
/// increase uniformly, must not hide the others.
#[inline(always)]
pub(super) fn larger(largest: f64, value: f64) -> f64 {
    if value > largest || value.is_nan() {
        value
    } else {
        largest
    }
}

/// Computes stages one after the other, each from its row of the tableau. `inside` is storage for one state.
macro_rules! make_stages {
    ($field:ident, ($t:expr, $h:expr, $start:expr), $stages:ident, $inside:expr, $nodes:ident: $($index:literal $row:ident)*) => {$(
        combine($start, $h, $stages, ($nodes[$index], &$row), $inside);
        $field.rate($t + $nodes[$index] * $h, $inside, &mut $stages[$index])?;
        subtract_first($stages, $index);
    )*};
}
pub(super) use make_stages;

/// Checks of the coefficients, for the tests of the schemes.
#[cfg(test)]
pub(super) mod check {
    use super::Term;

    fn row_sum(row: &[Term]) -> f64 {
        row.iter().map(|&(_, coefficient)| coefficient).sum()
    }

    /// Every row sums to its node, so that stages are exact for constant rates.
    pub(crate) fn rows_sum_to_nodes(rows: &[&[Term]], nodes: &[f64]) {
        for (row, node) in rows.iter().zip(nodes) {
            assert!(
                (row_sum(row) - node).abs() < 1e-13,
                "{} for {node}",
                row_sum(row)
            );
        }
    }

    /// The order conditions of bushy trees, `sum b_i c_i^(k-1) = 1/k`, and of the trees with one more edge at the root,
    /// `sum b_i a_ij c_j^(k-1) = 1/(k (k+1))`. `rows[i]` belongs to stage `i`.
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

    /// `sum b_i c_i` equals 1/2 to a hundredth of a rounding error. The sum is computed with the exact rounding errors
    /// of all products and sums.
    pub(crate) fn constant_forces_shift_no_step(weights: &[Term], nodes: &[f64]) {
        let (mut sum, mut lost) = (-0.5, 0.0);
        for &(i, b) in weights {
            let product = b * nodes[i];
            let after: f64 = sum + product;
            let gained = after - sum;
            lost += (sum - (after - gained)) + (product - gained) + b.mul_add(nodes[i], -product);
            sum = after;
        }
        let error = 2.0 * (sum + lost);
        assert!(error.abs() < 0.01 * f64::EPSILON, "{error:e}");
    }

    /// An error estimate vanishes for polynomial motion up to the order of the embedded solution, and not for the next
    /// order.
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
