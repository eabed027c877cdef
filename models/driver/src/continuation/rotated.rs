//! Underdetermined linear equations: solutions of least norm, and kernels, by one-sided Jacobi rotations (Hestenes). A
//! matrix is a list of columns.

use crate::linear::{add, dot};

/// Singular values below this multiple of the largest one (or of 1, if the largest one is below 1) count as 0.
const RANK: f64 = 1e-7;

/// Maximum number of sweeps over all pairs of columns.
const SWEEPS: usize = 60;

/// A matrix `A` and an orthogonal matrix `V` such that the columns of `A V` are orthogonal.
pub(super) struct Rotated {
    columns: Vec<Vec<f64>>,
    directions: Vec<Vec<f64>>,
    /// Largest square of a singular value, at least 1.
    largest: f64,
}

impl Rotated {
    pub(super) fn of(mut columns: Vec<Vec<f64>>) -> Self {
        let count = columns.len();
        let mut directions: Vec<Vec<f64>> = (0..count).map(|k| unit(count, k)).collect();
        for _ in 0..SWEEPS {
            let mut is_done = true;
            for i in 0..count {
                for j in i + 1..count {
                    let (a, b) = (square(&columns[i]), square(&columns[j]));
                    let c = dot(&columns[i], &columns[j]);
                    if c.abs() <= f64::EPSILON * (a * b).sqrt() {
                        continue;
                    }
                    is_done = false;
                    let zeta = (b - a) / (2.0 * c);
                    let tangent =
                        1.0_f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                    turn(&mut columns, [i, j], [cosine, cosine * tangent]);
                    turn(&mut directions, [i, j], [cosine, cosine * tangent]);
                }
            }
            if is_done {
                break;
            }
        }
        let largest = columns
            .iter()
            .map(|column| square(column))
            .fold(1.0, f64::max);
        Self {
            columns,
            directions,
            largest,
        }
    }

    fn counts(&self, column: &[f64]) -> bool {
        square(column) > RANK * RANK * self.largest
    }

    /// The shortest of the vectors `x` that minimise `|A x - b|`.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut solution = vec![0.0; self.directions.len()];
        for (column, direction) in self.columns.iter().zip(&self.directions) {
            if self.counts(column) {
                add(&mut solution, dot(column, b) / square(column), direction);
            }
        }
        solution
    }

    /// Orthonormal directions that `A` maps to 0.
    pub(super) fn kernel(&self) -> impl Iterator<Item = &[f64]> {
        let pairs = self.columns.iter().zip(&self.directions);
        let kept = pairs.filter(|(column, _)| !self.counts(column));
        kept.map(|(_, direction)| direction.as_slice())
    }
}

/// Rotates two columns by the angle with this cosine and sine.
fn turn(columns: &mut [Vec<f64>], [i, j]: [usize; 2], [cosine, sine]: [f64; 2]) {
    for k in 0..columns[i].len() {
        let (x, y) = (columns[i][k], columns[j][k]);
        columns[i][k] = cosine * x - sine * y;
        columns[j][k] = sine * x + cosine * y;
    }
}

fn unit(size: usize, index: usize) -> Vec<f64> {
    let mut vector = vec![0.0; size];
    vector[index] = 1.0;
    vector
}

fn square(a: &[f64]) -> f64 {
    dot(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::norm;

    #[test]
    fn the_shortest_solution_lies_at_right_angles_to_the_kernel() {
        // x + 2 y + 2 z = 9, y - z = 0.
        let rotated = Rotated::of(vec![vec![1.0, 0.0], vec![2.0, 1.0], vec![2.0, -1.0]]);
        let solution = rotated.solve(&[9.0, 0.0]);
        for (found, expected) in solution.iter().zip([1.0, 2.0, 2.0]) {
            assert!((found - expected).abs() < 1e-14, "{solution:?}");
        }
        let kernel: Vec<&[f64]> = rotated.kernel().collect();
        assert_eq!(kernel.len(), 1);
        assert!(dot(kernel[0], &solution).abs() < 1e-14);
        assert!((norm(kernel[0]) - 1.0).abs() < 1e-14);
    }
}
