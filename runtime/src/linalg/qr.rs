//! Orthogonalisation of the rows of a wide matrix, and least-norm solutions.
//!
//! Let `A x = b` be M equations in N unknowns, with the rows `a_i`. Modified Gram-Schmidt on the rows, with two passes,
//! gives `a_i = sum_j r_ij q_j`. Then `x = sum_j z_j q_j` with `R z = b` is the solution of least norm.

use crate::math;

/// Fraction of a row's norm that must remain after orthogonalisation. Below it the row counts as dependent on earlier
/// ones.
const DEPENDENT: f64 = 1e-12;

/// Overwrites `rows` (row by row, each of length `width`) by orthonormal rows, zero where a row depends on earlier
/// ones, and writes the least-norm solution of `rows x = values` to `solution`.
///
/// Equations whose rows depend on earlier ones are skipped; the caller checks them.
pub(crate) fn least_norm(rows: &mut [f64], width: usize, values: &[f64], solution: &mut [f64]) {
    solution.fill(0.0);
    if width == 0 {
        return;
    }
    for (i, value) in values.iter().enumerate() {
        let (earlier, rest) = rows.split_at_mut(i * width);
        let Some(row) = rest.get_mut(..width) else {
            return;
        };
        let before = math::sqrt(dot(row, row));
        // Left side of this equation at the solution so far, which is a combination of the earlier rows.
        let reached = dot(row, solution);
        for _ in 0..2 {
            for direction in earlier.chunks_exact(width) {
                let along = dot(row, direction);
                add(row, -along, direction);
            }
        }
        let after = math::sqrt(dot(row, row));
        if after > DEPENDENT * before {
            row.iter_mut().for_each(|entry| *entry /= after);
            add(solution, (value - reached) / after, row);
        } else {
            row.fill(0.0);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a += size * b`.
fn add(a: &mut [f64], size: f64, b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += size * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solution_is_the_shortest_one() {
        let mut rows = [1.0, 1.0, 1.0, 0.0, 1.0, -1.0];
        let mut solution = [0.0; 3];
        least_norm(&mut rows, 3, &[6.0, 0.0], &mut solution);
        for value in solution {
            assert!((value - 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn dependent_rows_are_left_out() {
        let mut rows = [1.0, 2.0, 2.0, 4.0];
        let mut solution = [0.0; 2];
        least_norm(&mut rows, 2, &[5.0, 10.0], &mut solution);
        assert!((solution[0] - 1.0).abs() < 1e-14 && (solution[1] - 2.0).abs() < 1e-14);
    }
}
