//! The second-order test of an extremal: with its endpoint fixed, is the cost of neighbouring motions larger?
//!
//! Between two times the derivative of the flow is `(dx', dp') = (A dx + B dp, C dx + D dp)`. The least cost of a stretch as a
//! function of its ends has the second derivatives `S_xx = -B^-1 A`, `S_xx' = B^-1`, `S_x'x' = -D B^-1`. Backwards from the second derivative
//! `K` of the terminal cost, `S_x'x' + K` must be positive, and the second derivative of the cost to go becomes
//! `S_xx - S_xx' (S_x'x' + K)^-1 S_x'x`. Given components of the end do not vary. This is the Riccati equation in
//! steps, in which nothing becomes infinite before a focal point, and impacts are parts of stretches.

use crate::least_squares::solve;

/// The result of the second-order test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SecondOrder {
    /// The extremal is a strict local minimum among motions with its sequence of impacts.
    Minimum,
    /// It is not: near this time the second variation takes negative values.
    Fails {
        /// The time.
        t: f64,
    },
    /// The test does not tell: some directions of the state are not controlled, or the derivatives have lost their digits.
    Open,
}

/// The derivative of state and costate by those at the start.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub t: f64,
    /// A column for each component of state and costate at the start.
    pub columns: Vec<Vec<f64>>,
}

/// Largest residual of `A D^T - B C^T = 1`.
const CANONICAL: f64 = 1e-5;

/// Rows of a matrix.
type Matrix = Vec<Vec<f64>>;

/// Tests an extremal; `terminal` is the second derivative of the terminal cost, `free` are the components that vary at the end.
pub(super) fn test(nodes: &[Node], terminal: &Matrix, free: &[usize]) -> SecondOrder {
    let Some(last) = nodes.last() else {
        return SecondOrder::Open;
    };
    let n = last.columns.len() / 2;
    let everything: Vec<usize> = (0..n).collect();
    let mut cost = terminal.clone();
    let mut varied = free;
    for pair in nodes.windows(2).rev() {
        let Some(stretch) = Stretch::between(&pair[0], &pair[1], n) else {
            return SecondOrder::Open;
        };
        match stretch.before(&cost, varied) {
            Step::Cost(before) => cost = before,
            Step::Negative => return SecondOrder::Fails { t: pair[1].t },
            Step::Open => return SecondOrder::Open,
        }
        varied = &everything;
    }
    SecondOrder::Minimum
}

/// Second derivatives of the least cost of a stretch by its ends.
struct Stretch {
    first: Matrix,
    mixed: Matrix,
    last: Matrix,
}

/// Result of a step backwards.
enum Step {
    /// Second derivative of the cost to go.
    Cost(Matrix),
    /// There is no minimum.
    Negative,
    Open,
}

impl Stretch {
    /// `None` if a stretch does not control the state, or digits are lost.
    fn between(from: &Node, to: &Node, n: usize) -> Option<Self> {
        let block = |node: &Node, row: usize, column: usize| -> Matrix {
            let entry = |i: usize, j: usize| node.columns[column * n + j][row * n + i];
            (0..n)
                .map(|i| (0..n).map(|j| entry(i, j)).collect())
                .collect()
        };
        // The inverse of a canonical matrix is (d^T, -b^T; -c^T, a^T).
        let part = |row: usize, column: usize| {
            let left = product(&block(to, row, 0), &transposed(&block(from, 1 - column, 1)));
            let right = product(&block(to, row, 1), &transposed(&block(from, 1 - column, 0)));
            let difference = combined(&left, &right, -1.0);
            match column {
                0 => difference,
                _ => difference
                    .iter()
                    .map(|row| row.iter().map(|it| -it).collect())
                    .collect(),
            }
        };
        let [a, b, c, d] = [part(0, 0), part(0, 1), part(1, 0), part(1, 1)];
        let one = combined(
            &product(&a, &transposed(&d)),
            &product(&b, &transposed(&c)),
            -1.0,
        );
        let is_canonical = (0..n)
            .all(|i| (0..n).all(|j| (one[i][j] - f64::from(u8::from(i == j))).abs() < CANONICAL));
        if !is_canonical {
            return None;
        }
        let mixed = inverse(&b)?;
        let scaled = |matrix: Matrix| -> Matrix {
            matrix
                .iter()
                .map(|row| row.iter().map(|it| -it).collect())
                .collect()
        };
        Some(Self {
            first: scaled(product(&mixed, &a)),
            last: scaled(product(&d, &mixed)),
            mixed,
        })
    }

    /// The second derivative of the cost to go at the first end.
    fn before(&self, after: &Matrix, varied: &[usize]) -> Step {
        let sum = combined(&self.last, after, 1.0);
        let chosen = |matrix: &Matrix| -> Matrix {
            let row = |&i: &usize| {
                varied
                    .iter()
                    .map(|&j| 0.5 * (matrix[i][j] + matrix[j][i]))
                    .collect()
            };
            varied.iter().map(row).collect()
        };
        let hessian = chosen(&sum);
        match is_positive(&hessian) {
            Some(true) => {}
            Some(false) => return Step::Negative,
            None => return Step::Open,
        }
        let mixed: Matrix = self
            .mixed
            .iter()
            .map(|row| varied.iter().map(|&j| row[j]).collect())
            .collect();
        let mut before = self.first.clone();
        for (column, row) in mixed.iter().enumerate() {
            let Some(answer) = solve(&transposed(&hessian), row) else {
                return Step::Open;
            };
            for (i, left) in mixed.iter().enumerate() {
                before[i][column] -= left.iter().zip(&answer).map(|(l, r)| l * r).sum::<f64>();
            }
        }
        Step::Cost(before)
    }
}

/// True if a symmetric matrix is positive, by its factors; `None` if it is not finite.
fn is_positive(matrix: &Matrix) -> Option<bool> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest: f64 = matrix[i][j] - known;
            if !rest.is_finite() {
                return None;
            }
            if i == j && rest <= 0.0 {
                return Some(false);
            }
            factor[i][j] = match i == j {
                true => rest.sqrt(),
                false => rest / factor[j][j],
            };
        }
    }
    Some(true)
}

fn transposed(matrix: &Matrix) -> Matrix {
    let width = matrix.first().map_or(0, Vec::len);
    (0..width)
        .map(|j| matrix.iter().map(|row| row[j]).collect())
        .collect()
}

fn product(left: &Matrix, right: &Matrix) -> Matrix {
    let columns = transposed(right);
    let entry =
        |row: &Vec<f64>, column: &Vec<f64>| row.iter().zip(column).map(|(l, r)| l * r).sum();
    left.iter()
        .map(|row| columns.iter().map(|column| entry(row, column)).collect())
        .collect()
}

/// `left + factor*right`
fn combined(left: &Matrix, right: &Matrix, factor: f64) -> Matrix {
    let row = |(left, right): (&Vec<f64>, &Vec<f64>)| {
        left.iter()
            .zip(right)
            .map(|(l, r)| l + factor * r)
            .collect()
    };
    left.iter().zip(right).map(row).collect()
}

/// `None` for a singular matrix.
fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let columns = transposed(matrix);
    let unit = |index: usize| {
        (0..n)
            .map(|i| f64::from(u8::from(i == index)))
            .collect::<Vec<f64>>()
    };
    let inverse: Option<Matrix> = (0..n).map(|index| solve(&columns, &unit(index))).collect();
    inverse.map(|columns| transposed(&columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `x' = -p, p' = -k x`: extremals of the cost `u^2/2 + k x^2/2`, with `k = -1` those of a spring that is short.
    fn nodes(k: f64, time: f64) -> Vec<Node> {
        let node = |index: u32| {
            let t = time * f64::from(index) / 40.0;
            let columns = match k < 0.0 {
                // x'' = -x
                true => vec![vec![t.cos(), t.sin()], vec![-t.sin(), t.cos()]],
                false => vec![vec![t.cosh(), -t.sinh()], vec![-t.sinh(), t.cosh()]],
            };
            Node { t, columns }
        };
        (0..=40).map(node).collect()
    }

    #[test]
    fn a_fixed_end_fails_behind_its_conjugate_point_at_pi() {
        let terminal = vec![vec![0.0]];
        assert_eq!(
            test(&nodes(-1.0, 3.1), &terminal, &[]),
            SecondOrder::Minimum
        );
        let SecondOrder::Fails { t } = test(&nodes(-1.0, 3.3), &terminal, &[]) else {
            panic!("passes");
        };
        // Backwards from the end, pi before it.
        assert!((t - (3.3 - std::f64::consts::PI)).abs() < 0.1, "{t}");
        assert_eq!(test(&nodes(1.0, 9.0), &terminal, &[]), SecondOrder::Minimum);
    }

    #[test]
    fn a_free_end_fails_behind_half_pi_and_sees_the_terminal_cost() {
        let flat = vec![vec![0.0]];
        assert_eq!(test(&nodes(-1.0, 1.5), &flat, &[0]), SecondOrder::Minimum);
        assert!(matches!(
            test(&nodes(-1.0, 1.7), &flat, &[0]),
            SecondOrder::Fails { .. }
        ));
        // tan(1.7 - pi/2) is 0.13: a second derivative of the terminal cost above it helps.
        assert_eq!(
            test(&nodes(-1.0, 1.7), &vec![vec![0.2]], &[0]),
            SecondOrder::Minimum
        );
        assert!(matches!(
            test(&nodes(-1.0, 1.7), &vec![vec![0.1]], &[0]),
            SecondOrder::Fails { .. }
        ));
    }

    #[test]
    fn a_state_that_is_not_controlled_stays_open() {
        let still = |t| Node {
            t,
            columns: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
        };
        assert_eq!(
            test(&[still(0.0), still(1.0)], &vec![vec![0.0]], &[0]),
            SecondOrder::Open
        );
    }
}
