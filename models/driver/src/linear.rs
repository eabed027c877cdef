//! Vectors and determinants. A matrix is a list of columns.

use dalembert::math::larger;

/// The determinant of a square matrix, by Gaussian elimination with pivoting.
pub(crate) fn determinant(mut columns: Vec<Vec<f64>>) -> f64 {
    let n = columns.len();
    let mut value = 1.0;
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| columns[k][i].abs().total_cmp(&columns[k][j].abs()));
        let row = largest.unwrap_or(k);
        if row != k {
            value = -value;
            columns.iter_mut().for_each(|column| column.swap(k, row));
        }
        let pivot = columns[k][k];
        value *= pivot;
        if pivot == 0.0 {
            return 0.0;
        }
        for j in k + 1..n {
            let factor = columns[j][k] / pivot;
            for i in k + 1..n {
                let change = factor * columns[k][i];
                columns[j][i] -= change;
            }
        }
    }
    value
}

/// The Euclidean length, without overflow or underflow of squares.
pub(crate) fn norm(values: &[f64]) -> f64 {
    let largest = values
        .iter()
        .fold(0.0, |most, value| larger(most, value.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let squares = values.iter().map(|value| (value / largest).powi(2));
    largest * squares.sum::<f64>().sqrt()
}

/// The product of two vectors.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Adds `factor * direction`.
pub(crate) fn add(sum: &mut [f64], factor: f64, direction: &[f64]) {
    for (entry, component) in sum.iter_mut().zip(direction) {
        *entry += factor * component;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn determinants_of_products_and_of_swapped_columns() {
        let matrix = vec![
            vec![0.0, 2.0, 1.0],
            vec![3.0, 1.0, 0.0],
            vec![1.0, 1.0, 4.0],
        ];
        assert!((determinant(matrix.clone()) + 22.0).abs() < 1e-13);
        let swapped = vec![matrix[1].clone(), matrix[0].clone(), matrix[2].clone()];
        assert!((determinant(swapped) - 22.0).abs() < 1e-13);
        assert_eq!(determinant(vec![vec![1.0, 2.0], vec![2.0, 4.0]]), 0.0);
    }
}
