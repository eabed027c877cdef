//! Gaussian elimination modulo a prime: independent columns of a matrix, and relations between columns.

use dalembert_expr::Modulus;

/// Indices of the columns that do not depend on those before them.
pub(super) fn independent_columns(field: Modulus, mut rows: Vec<Vec<u64>>) -> Vec<usize> {
    let width = rows.first().map_or(0, Vec::len);
    let mut pivots = Vec::new();
    for column in 0..width {
        if eliminate(field, &mut rows, pivots.len(), column).is_some() {
            pivots.push(column);
        }
    }
    pivots
}

/// Coefficients of a vanishing combination of columns. The first column that depends on those before it has coefficient
/// 1, later columns have 0. `None` if all columns are independent.
pub(super) fn first_relation(field: Modulus, mut rows: Vec<Vec<u64>>) -> Option<Vec<u64>> {
    let width = rows.first().map_or(0, Vec::len);
    let mut inverses = Vec::new();
    // Every column before the dependent one has a pivot. The pivot of column j is in row j.
    let column = (0..width).find(|column| {
        let inverse = eliminate(field, &mut rows, *column, *column);
        inverses.extend(inverse);
        inverse.is_none()
    })?;
    let mut relation = vec![0; width];
    relation[column] = 1;
    for step in (0..column).rev() {
        let mut sum = 0;
        for later in step + 1..=column {
            sum = field.add(sum, field.mul(rows[step][later], relation[later]));
        }
        relation[step] = field.neg(field.mul(inverses[step], sum));
    }
    Some(relation)
}

/// Finds a pivot in a column from row `step` on, moves it to row `step`, and clears the column below. Returns the
/// inverse of the pivot; `None` if there is none.
fn eliminate(field: Modulus, rows: &mut [Vec<u64>], step: usize, column: usize) -> Option<u64> {
    let found = (step..rows.len()).find(|row| rows[*row][column] != 0)?;
    rows.swap(step, found);
    let (above, below) = rows.split_at_mut(step + 1);
    let pivot = &above[step];
    let inverse = field.inv(pivot[column])?;
    for row in below {
        if row[column] == 0 {
            continue;
        }
        let factor = field.mul(row[column], inverse);
        for later in column..row.len() {
            row[later] = field.sub(row[later], field.mul(factor, pivot[later]));
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_dependent_column_is_written_by_those_before_it() {
        let field = Modulus::MERSENNE;
        // The third column is twice the first plus three times the second. The last is the sum of the first two.
        let rows = vec![vec![1, 4, 14, 5], vec![2, 1, 7, 3], vec![0, 1, 3, 1]];
        assert_eq!(independent_columns(field, rows.clone()), vec![0, 1]);
        let minus = |value| field.neg(value);
        assert_eq!(
            first_relation(field, rows.clone()),
            Some(vec![minus(2), minus(3), 1, 0])
        );
        let square = rows.iter().map(|row| row[..2].to_vec()).collect();
        assert_eq!(first_relation(field, square), None);
    }

    #[test]
    fn a_column_of_zeros_depends_on_none() {
        let field = Modulus::MERSENNE;
        let rows = vec![vec![3, 0], vec![1, 0]];
        assert_eq!(first_relation(field, rows), Some(vec![0, 1]));
    }
}
