//! Linear systems over series. Pivots are chosen by the values at the point of expansion.

use dalembert_expr::{Arithmetic, Jets, Series};

/// A matrix of series, by rows.
pub(super) type Matrix<A> = Vec<Vec<Series<A>>>;

/// A system that was solved.
#[derive(Debug)]
pub(super) struct Solution<A: Arithmetic> {
    /// The unknowns, one row for each row of the matrix.
    pub(super) unknowns: Matrix<A>,
    /// The determinant of the matrix.
    pub(super) determinant: Series<A>,
}

/// Solves `matrix * unknowns = right`; `None` if the matrix is singular at the point.
pub(super) fn solve<A: Arithmetic>(
    jets: &Jets<'_, A>,
    mut matrix: Matrix<A>,
    mut right: Matrix<A>,
) -> Option<Solution<A>> {
    let field = jets.field;
    let mut determinant = jets.constant(field.integer(1));
    for step in 0..matrix.len() {
        let size = |row: &usize| field.size(jets.value(&matrix[*row][step]));
        let pivot_row = largest(step..matrix.len(), size)?;
        if pivot_row != step {
            matrix.swap(step, pivot_row);
            right.swap(step, pivot_row);
            determinant = jets.scale(field.integer(-1), &determinant);
        }
        determinant = jets.mul(&determinant, &matrix[step][step]);
        let inverse = jets.inverse(&matrix[step][step])?;
        let scaled = |mut row: Vec<Series<A>>| {
            row.iter_mut()
                .for_each(|entry| jets.multiply(entry, &inverse));
            row
        };
        let pivot = scaled(std::mem::take(&mut matrix[step]));
        let pivot_right = scaled(std::mem::take(&mut right[step]));
        for row in 0..matrix.len() {
            if row == step || matrix[row][step].is_empty() {
                continue;
            }
            let factor = std::mem::take(&mut matrix[row][step]);
            subtract(
                jets,
                &mut matrix[row][step + 1..],
                &factor,
                &pivot[step + 1..],
            );
            subtract(jets, &mut right[row], &factor, &pivot_right);
        }
        matrix[step] = pivot;
        right[step] = pivot_right;
    }
    Some(Solution {
        unknowns: right,
        determinant,
    })
}

/// The candidate of largest size; `None` if all are 0.
pub(super) fn largest(
    candidates: impl IntoIterator<Item = usize>,
    size: impl Fn(&usize) -> f64,
) -> Option<usize> {
    let mut best = (0.0, None);
    for candidate in candidates {
        let size = size(&candidate);
        if size > best.0 {
            best = (size, Some(candidate));
        }
    }
    best.1
}

/// `row -= factor * other`
fn subtract<A: Arithmetic>(
    jets: &Jets<'_, A>,
    row: &mut [Series<A>],
    factor: &[A::Scalar],
    other: &[Series<A>],
) {
    for (entry, other) in row.iter_mut().zip(other) {
        if !other.is_empty() {
            jets.subtract_product(entry, factor, other);
        }
    }
}

/// `sum over i of a_i b_i` for two rows.
pub(super) fn dot<A: Arithmetic>(
    jets: &Jets<'_, A>,
    a: &[Series<A>],
    b: &[Series<A>],
) -> Series<A> {
    jets.dot(a.iter().map(Vec::as_slice).zip(b.iter().map(Vec::as_slice)))
}

/// The transpose of a matrix.
pub(super) fn transpose<T: Clone>(rows: &[Vec<T>]) -> Vec<Vec<T>> {
    let columns = rows.first().map_or(0, Vec::len);
    (0..columns)
        .map(|j| rows.iter().map(|row| row[j].clone()).collect())
        .collect()
}
