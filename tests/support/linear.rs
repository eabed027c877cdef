//! Small linear systems and determinants in double precision, by elimination with pivots.

/// The solution of a square system with as many unknowns as `right` has entries. Further entries of a row are ignored.
///
/// # Panics
/// If a pivot is 0.
pub fn solve(matrix: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    solve_regular(matrix, right, 0.0).expect("a regular matrix")
}

/// Same as [`solve`]; `None` if the absolute value of a pivot is at most `least`.
pub fn solve_regular(matrix: &[Vec<f64>], right: &[f64], least: f64) -> Option<Vec<f64>> {
    let n = right.len();
    let mut rows: Vec<Vec<f64>> = matrix
        .iter()
        .zip(right)
        .map(|(row, right)| row[..n].iter().copied().chain([*right]).collect())
        .collect();
    for step in 0..n {
        let largest = largest_pivot(&rows, step);
        rows.swap(step, largest);
        let pivot = rows[step].clone();
        if pivot[step].abs() <= least {
            return None;
        }
        for (i, row) in rows.iter_mut().enumerate() {
            if i != step {
                eliminate(row, &pivot, step);
            }
        }
    }
    Some((0..n).map(|i| rows[i][n] / rows[i][i]).collect())
}

/// The determinant of a square matrix.
pub fn determinant(matrix: &[Vec<f64>]) -> f64 {
    let mut rows = matrix.to_vec();
    let mut product = 1.0;
    for step in 0..rows.len() {
        let largest = largest_pivot(&rows, step);
        if largest != step {
            rows.swap(step, largest);
            product = -product;
        }
        let pivot = rows[step].clone();
        product *= pivot[step];
        for row in &mut rows[step + 1..] {
            eliminate(row, &pivot, step);
        }
    }
    product
}

/// The row from `step` on with the largest entry in column `step`.
fn largest_pivot(rows: &[Vec<f64>], step: usize) -> usize {
    let size = |row: usize| rows[row][step].abs();
    let largest = (step..rows.len()).max_by(|a, b| size(*a).total_cmp(&size(*b)));
    largest.unwrap_or(step)
}

/// Subtracts a multiple of the pivot row, so that column `step` of the row becomes 0.
fn eliminate(row: &mut [f64], pivot: &[f64], step: usize) {
    let factor = row[step] / pivot[step];
    for (entry, pivot) in row.iter_mut().zip(pivot) {
        *entry -= factor * pivot;
    }
}
