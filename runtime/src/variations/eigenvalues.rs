//! Eigenvalues of a real matrix: Francis's double-shift QR steps on its Hessenberg form.
//!
//! Reference: G. H. Golub, C. F. Van Loan, *Matrix Computations*, sections 7.4 and 7.5.

use crate::math;
use crate::state::StateVector;

/// Maximum number of steps per eigenvalue.
const STEPS: usize = 300;

/// Number of steps without convergence after which an exceptional shift is used.
const PATIENCE: usize = 10;

/// Eigenvalues of a square matrix, with multiplicity, in order of decreasing modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multipliers<S> {
    real: S,
    imaginary: S,
    count: usize,
}

impl<S: StateVector> Multipliers<S> {
    /// Real and imaginary parts, in order of decreasing modulus.
    pub fn iter(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let parts = self.real.as_slice().iter().zip(self.imaginary.as_slice());
        parts.take(self.count).map(|(re, im)| [*re, *im])
    }

    /// Number of eigenvalues.
    pub const fn len(&self) -> usize {
        self.count
    }

    /// True if there are no eigenvalues.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn none() -> Self {
        Self {
            real: S::zeros(S::CAPACITY),
            imaginary: S::zeros(S::CAPACITY),
            count: 0,
        }
    }

    /// Inserts an eigenvalue in order of modulus, after those of equal modulus.
    fn add(&mut self, [re, im]: [f64; 2]) {
        let modulus = |re: f64, im: f64| re * re + im * im;
        let (real, imaginary) = (self.real.as_mut_slice(), self.imaginary.as_mut_slice());
        let mut place = self.count;
        while place > 0 && modulus(real[place - 1], imaginary[place - 1]) < modulus(re, im) {
            real[place] = real[place - 1];
            imaginary[place] = imaginary[place - 1];
            place -= 1;
        }
        (real[place], imaginary[place]) = (re, im);
        self.count += 1;
    }
}

/// A square matrix, stored by columns and overwritten by the algorithm.
struct Square<'a, S> {
    columns: &'a mut [S],
    size: usize,
}

impl<S: StateVector> Square<'_, S> {
    fn at(&self, row: usize, column: usize) -> f64 {
        self.columns[column].as_slice()[row]
    }

    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.columns[column].as_mut_slice()[row]
    }

    /// Replaces `A` by `H A H`, with the Householder reflection `H` of the rows from `first` on that maps `x` to a
    /// multiple of the first unit vector.
    fn reflect(&mut self, first: usize, x: &[f64]) {
        let size = x
            .iter()
            .fold(0.0, |most, entry| math::larger(most, entry.abs()));
        if size == 0.0 {
            return;
        }
        // The squares of small components would be 0.
        let unit = |i: usize| x[i] / size;
        let norm = math::sqrt((0..x.len()).map(|i| unit(i) * unit(i)).sum());
        // `H = 1 - 2 v v^T / v^T v` with `v = x + sign(x_0) |x| e_0`.
        let lead = unit(0) + norm.copysign(x[0]);
        let v = |i: usize| if i == 0 { lead } else { unit(i) };
        let factor = 1.0 / (norm * (norm + unit(0).abs()));
        for column in 0..self.size {
            let sum: f64 = (0..x.len())
                .map(|i| v(i) * self.at(first + i, column))
                .sum();
            for i in 0..x.len() {
                *self.entry(first + i, column) -= factor * sum * v(i);
            }
        }
        for row in 0..self.size {
            let sum: f64 = (0..x.len()).map(|i| v(i) * self.at(row, first + i)).sum();
            for i in 0..x.len() {
                *self.entry(row, first + i) -= factor * sum * v(i);
            }
        }
    }

    /// Reduces the matrix to upper Hessenberg form.
    fn reduce(&mut self) {
        for column in 0..self.size.saturating_sub(2) {
            let x = self.columns[column];
            self.reflect(column + 1, &x.as_slice()[column + 1..self.size]);
            for row in column + 2..self.size {
                *self.entry(row, column) = 0.0;
            }
        }
    }

    /// First row of the unreduced block that ends before row `end`. Sets the negligible subdiagonal entry before it to
    /// 0. An entry is negligible beside its neighbours on the diagonal, or beside `size`.
    ///
    /// NOTE: the diagonal of a skew-symmetric matrix is 0 up to rounding, and shows no size.
    fn start_of_block(&mut self, end: usize, size: f64) -> usize {
        let mut start = end - 1;
        while start > 0 {
            let neighbours = self.at(start - 1, start - 1).abs() + self.at(start, start).abs();
            let size = math::larger(neighbours, size);
            if self.at(start, start - 1).abs() <= f64::EPSILON * size {
                *self.entry(start, start - 1) = 0.0;
                break;
            }
            start -= 1;
        }
        start
    }

    /// Bound of the norm of the block before row and column `end`.
    fn size(&self, end: usize) -> f64 {
        let columns = self.columns[..end].iter();
        let entries = columns.flat_map(|column| &column.as_slice()[..end]);
        let largest = entries.fold(0.0, |most, entry| math::larger(most, entry.abs()));
        end as f64 * largest
    }

    /// One double-shift step on a block of at least three rows.
    fn step(&mut self, start: usize, end: usize, is_exceptional: bool) {
        let (m, n) = (end - 2, end - 1);
        let (mut trace, mut determinant) = (
            self.at(m, m) + self.at(n, n),
            self.at(m, m) * self.at(n, n) - self.at(m, n) * self.at(n, m),
        );
        if is_exceptional {
            let size = self.at(n, m).abs() + self.at(m, m - 1).abs();
            (trace, determinant) = (1.5 * size, size * size);
        }
        let h = |i: usize, j: usize| self.at(start + i, start + j);
        let mut x = [
            h(0, 0) * (h(0, 0) - trace) + h(0, 1) * h(1, 0) + determinant,
            h(1, 0) * (h(0, 0) + h(1, 1) - trace),
            h(1, 0) * h(2, 1),
        ];
        for k in start..n {
            let count = if k + 3 <= end { 3 } else { 2 };
            self.reflect(k, &x[..count]);
            if k > start {
                for row in k + 1..k + count {
                    *self.entry(row, k - 1) = 0.0;
                }
            }
            let below = |i: usize| if k + i < end { self.at(k + i, k) } else { 0.0 };
            x = [below(1), below(2), below(3)];
        }
    }

    /// Eigenvalues of the 2 by 2 block at the rows `m` and `m + 1`.
    fn pair(&self, m: usize) -> [[f64; 2]; 2] {
        let (a, d) = (self.at(m, m), self.at(m + 1, m + 1));
        let product = self.at(m, m + 1) * self.at(m + 1, m);
        let (half, mean) = (0.5 * (a - d), 0.5 * (a + d));
        let square = half * half + product;
        let root = math::sqrt(square.abs());
        if square < 0.0 {
            return [[mean, root], [mean, -root]];
        }
        let far = half + root.copysign(half);
        let near = if far == 0.0 { 0.0 } else { product / far };
        [[d + far, 0.0], [d - near, 0.0]]
    }
}

/// Eigenvalues of the leading `size` by `size` block of a matrix, given by its columns, which are overwritten. `None`
/// if the iteration does not converge, for example for entries that are not finite.
pub fn eigenvalues<S: StateVector>(columns: &mut [S], size: usize) -> Option<Multipliers<S>> {
    let mut found = Multipliers::<S>::none();
    let mut matrix = Square { columns, size };
    matrix.reduce();
    let (mut end, mut steps) = (size, 0);
    while end > 0 {
        let size = if steps < PATIENCE {
            0.0
        } else {
            matrix.size(end)
        };
        let start = matrix.start_of_block(end, size);
        match end - start {
            1 => found.add([matrix.at(start, start), 0.0]),
            2 => matrix
                .pair(start)
                .into_iter()
                .for_each(|root| found.add(root)),
            _ => {
                steps += 1;
                if steps > STEPS {
                    return None;
                }
                matrix.step(start, end, steps % PATIENCE == 0);
                continue;
            }
        }
        (end, steps) = (start, 0);
    }
    let is_finite = found.real.is_finite() && found.imaginary.is_finite();
    is_finite.then_some(found)
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;

    fn check<const D: usize>(rows: [[f64; D]; D], expected: [[f64; 2]; D], bound: f64) {
        let mut columns = [SVector::<f64, D>::repeat(0.0); D];
        for (i, row) in rows.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                columns[j][i] = *entry;
            }
        }
        let found = eigenvalues(&mut columns, D).expect("eigenvalues");
        assert_eq!(found.len(), D);
        for (found, expected) in found.iter().zip(expected) {
            let error = (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs();
            assert!(error <= bound, "{found:?} for {expected:?}");
        }
    }

    #[test]
    fn eigenvalues_are_roots_of_the_characteristic_polynomial() {
        check([[3.0]], [[3.0, 0.0]], 0.0);
        check([[2.0, 1.0], [1.0, 2.0]], [[3.0, 0.0], [1.0, 0.0]], 1e-15);
        check([[0.0, -4.0], [1.0, 0.0]], [[0.0, 2.0], [0.0, -2.0]], 1e-15);
        // The companion matrix of (x^2 + 1)(x - 3)(x + 5)(x - 1/2) = x^5 + 3/2 x^4 - 15 x^3 + 9 x^2 - 16 x + 15/2.
        check(
            [
                [-1.5, 15.0, -9.0, 16.0, -7.5],
                [1.0, 0.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0, 0.0],
            ],
            [[-5.0, 0.0], [3.0, 0.0], [0.0, 1.0], [0.0, -1.0], [0.5, 0.0]],
            1e-13,
        );
        // A cyclic permutation matrix. Its eigenvalues are roots of unity; without exceptional shifts the iteration
        // does not find them.
        let (half, side) = (0.5, 0.75_f64.sqrt());
        let columns = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mut columns = columns.map(SVector::<f64, 3>::from);
        let found = eigenvalues(&mut columns, 3).expect("eigenvalues");
        for root in [[1.0, 0.0], [-half, side], [-half, -side]] {
            let near =
                |found: [f64; 2]| (found[0] - root[0]).abs() + (found[1] - root[1]).abs() < 1e-14;
            assert!(found.iter().any(near), "{found:?}");
        }
    }

    /// The eigenvalues of `W v = w x v` are 0 and `+-i |w|`. Those of a skew-symmetric matrix are imaginary, and half the
    /// sum of their squares is the sum over the entries above the diagonal.
    #[test]
    fn skew_symmetric_matrices_have_imaginary_eigenvalues() {
        let entries = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 0.1];
        let at = |index: usize| entries[index % 8];
        for index in 0..512 {
            let [x, y, z] = [at(index), at(index / 8), at(index / 64)];
            let w = math::sqrt(x * x + y * y + z * z);
            let rows = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
            check(rows, [[0.0, w], [0.0, -w], [0.0, 0.0]], 1e-14);
        }
        for index in 0..4096 {
            let [a, b, c, d] = [index, index / 8, index / 64, index / 512].map(at);
            let rows = [
                [0.0, a, b, c],
                [-a, 0.0, d, b],
                [-b, -d, 0.0, a],
                [-c, -b, -a, 0.0],
            ];
            let mut columns = rows.map(|row| -SVector::<f64, 4>::from(row));
            let found = eigenvalues(&mut columns, 4).unwrap_or_else(|| panic!("{rows:?}"));
            let expected = 2.0 * (2.0 * (a * a + b * b) + c * c + d * d);
            let squares: f64 = found.iter().map(|[_, im]| im * im).sum();
            assert!(
                (squares - expected).abs() < 1e-13 * (1.0 + expected),
                "{rows:?}"
            );
            assert!(found.iter().all(|[re, _]| re.abs() < 1e-14), "{rows:?}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_none() {
        let mut columns = [SVector::<f64, 3>::repeat(f64::NAN); 3];
        assert_eq!(eigenvalues(&mut columns, 3), None);
    }
}
