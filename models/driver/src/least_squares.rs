//! Linear equations, square or overdetermined, by Householder reflections.

use crate::linear::norm;
use dalembert::math::larger;

/// Pivots up to this fraction of the largest length of a column count as 0.
const SINGULAR: f64 = 1e-13;

/// The vector `x` that minimises `|A x - b|`, with the columns of `A`; `None` if its columns are dependent.
pub(crate) fn solve(columns: &[Vec<f64>], b: &[f64]) -> Option<Vec<f64>> {
    let (rows, unknowns) = (b.len(), columns.len());
    if rows < unknowns {
        return None;
    }
    let mut a: Vec<Vec<f64>> = columns.to_vec();
    let mut b = b.to_vec();
    let mut pivots = Vec::with_capacity(unknowns);
    for k in 0..unknowns {
        let length = norm(&a[k][k..]);
        let pivot = if a[k][k] > 0.0 { -length } else { length };
        let mut reflector = a[k][k..].to_vec();
        reflector[0] -= pivot;
        for column in a[k + 1..].iter_mut() {
            reflect(&reflector, &mut column[k..]);
        }
        reflect(&reflector, &mut b[k..]);
        pivots.push(pivot);
    }
    let largest = columns.iter().map(|column| norm(column)).fold(0.0, larger);
    if pivots
        .iter()
        .any(|pivot| pivot.abs() <= SINGULAR * largest || !pivot.is_finite())
    {
        return None;
    }
    let mut x = vec![0.0; unknowns];
    for k in (0..unknowns).rev() {
        let later: f64 = (k + 1..unknowns).map(|j| a[j][k] * x[j]).sum();
        x[k] = (b[k] - later) / pivots[k];
    }
    x.iter().all(|value| value.is_finite()).then_some(x)
}

/// The vector `x` that minimises `|J x - r|^2 + damping^2 |x|^2`, with the columns of `J` and the residuals `r`.
pub(crate) fn damped(columns: &[Vec<f64>], residuals: &[f64], damping: f64) -> Option<Vec<f64>> {
    let count = columns.len();
    let rows: Vec<Vec<f64>> = (columns.iter().enumerate())
        .map(|(j, column)| {
            let mut column = column.clone();
            column.extend((0..count).map(|k| if j == k { damping } else { 0.0 }));
            column
        })
        .collect();
    let mut right = residuals.to_vec();
    right.resize(residuals.len() + count, 0.0);
    solve(&rows, &right)
}

/// Reflects a vector at the plane orthogonal to `reflector`.
fn reflect(reflector: &[f64], vector: &mut [f64]) {
    let square: f64 = reflector.iter().map(|value| value * value).sum();
    if square == 0.0 {
        return;
    }
    let product: f64 = reflector
        .iter()
        .zip(vector.iter())
        .map(|(r, v)| r * v)
        .sum();
    for (entry, r) in vector.iter_mut().zip(reflector) {
        *entry -= 2.0 * product / square * r;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_of_small_systems() {
        let columns = vec![vec![2.0, 1.0, 0.0], vec![-1.0, 3.0, 0.0]];
        let x = solve(&columns, &[0.0, 7.0, 5.0]).expect("a solution");
        assert!(
            (x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15,
            "{x:?}"
        );
        assert_eq!(solve(&[vec![1.0, 1.0], vec![2.0, 2.0]], &[1.0, 0.0]), None);
        assert_eq!(solve(&columns, &[1.0]), None);
    }
}
