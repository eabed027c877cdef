//! The second-order test of an extremal: it is a local minimum if the cost of neighbouring motions with the same start
//! is larger.
//!
//! Over a stretch of time the derivative of the flow is `(dx', dp') = (A dx + B dp, C dx + D dp)`. The least cost of a
//! stretch as a function of its ends has the second derivatives `S_xx = -B^-1 A`, `S_xx' = B^-1`, `S_x'x' = -D B^-1`.
//! The test runs backwards from the second derivative `K` of the terminal cost. In each step, `S_x'x' + K` must be
//! positive, and the second derivative of the cost to go becomes `S_xx - S_xx' (S_x'x' + K)^-1 S_x'x`. Given components
//! of the end do not vary. This is the Riccati equation in steps. It remains finite up to a focal point, and stretches
//! may contain impacts.
//!
//! The derivatives of every stretch are computed from its own start. Derivatives with respect to the start of the whole
//! motion would lose digits: over a short time, an input hardly moves the states on which it acts through other states.

use crate::least_squares::solve;
use dalembert::math::larger;

/// The result of the second-order test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SecondOrder {
    /// The extremal is a strict local minimum among motions with its sequence of impacts.
    Minimum,
    /// The extremal is not a minimum: near this time the second variation takes negative values.
    Fails {
        /// The time.
        t: f64,
    },
    /// The test is inconclusive: some directions of the state are not controlled, or the derivatives have lost their
    /// digits.
    Open,
}

/// The derivatives of the flow over a stretch of time.
#[derive(Debug, Clone)]
pub(super) struct Flow {
    /// The end time of the stretch.
    pub t: f64,
    /// One column per component of state and costate at the start of the stretch.
    pub columns: Vec<Vec<f64>>,
}

/// Largest residual of `A D^T - B C^T = 1`.
const CANONICAL: f64 = 1e-5;

/// Relative error of the derivatives.
const ROUNDING: f64 = 1e-12;

/// Largest accepted relative error of the inverse of `B`.
const RESOLVED: f64 = 1e-2;

/// A matrix, row by row.
type Matrix = Vec<Vec<f64>>;

/// Tests an extremal by the flows of its stretches, in order of time. `terminal` is the second derivative of the
/// terminal cost; `free` lists the components that vary at the end.
pub(super) fn test(flows: &[Flow], terminal: &Matrix, free: &[usize]) -> SecondOrder {
    let everything: Vec<usize> = (0..terminal.len()).collect();
    let mut cost = terminal.clone();
    let mut varied = free;
    for flow in flows.iter().rev() {
        let Some(stretch) = Stretch::of(flow) else {
            return SecondOrder::Open;
        };
        match stretch.before(&cost, varied) {
            Step::Cost(before) => cost = before,
            Step::Negative => return SecondOrder::Fails { t: flow.t },
            Step::Open => return SecondOrder::Open,
        }
        varied = &everything;
    }
    SecondOrder::Minimum
}

/// Second derivatives of the least cost of a stretch with respect to its ends.
struct Stretch {
    first: Matrix,
    mixed: Matrix,
    last: Matrix,
}

/// Result of a step backwards.
enum Step {
    /// Second derivative of the cost to go.
    Cost(Matrix),
    /// The second variation takes negative values.
    Negative,
    Open,
}

/// Result of the Cholesky factorisation of a symmetric matrix.
enum Factor {
    Of(Matrix),
    NotPositive,
    /// The matrix is not finite.
    Unknown,
}

impl Stretch {
    /// The derivatives of a stretch; `None` if it does not control the state, or if digits are lost.
    fn of(flow: &Flow) -> Option<Self> {
        let n = flow.columns.len() / 2;
        let block = |row: usize, column: usize| -> Matrix {
            let entry = |i: usize, j: usize| flow.columns[column * n + j][row * n + i];
            (0..n)
                .map(|i| (0..n).map(|j| entry(i, j)).collect())
                .collect()
        };
        let [a, b, c, d] = [block(0, 0), block(0, 1), block(1, 0), block(1, 1)];
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
        let mixed = resolved_inverse(&b)?;
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

    /// The second derivative of the cost to go at the start of the stretch.
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
        let factor = match factor(&chosen(&sum)) {
            Factor::Of(factor) => factor,
            Factor::NotPositive => return Step::Negative,
            Factor::Unknown => return Step::Open,
        };
        let mixed: Matrix = self
            .mixed
            .iter()
            .map(|row| varied.iter().map(|&j| row[j]).collect())
            .collect();
        let mut before = self.first.clone();
        for (column, row) in mixed.iter().enumerate() {
            let answer = solved(&factor, row);
            for (i, left) in mixed.iter().enumerate() {
                before[i][column] -= left.iter().zip(&answer).map(|(l, r)| l * r).sum::<f64>();
            }
        }
        Step::Cost(before)
    }
}

/// The Cholesky factor `L` of a positive definite matrix `L L^T`.
fn factor(matrix: &Matrix) -> Factor {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest: f64 = matrix[i][j] - known;
            if !rest.is_finite() {
                return Factor::Unknown;
            }
            if i == j && rest <= 0.0 {
                return Factor::NotPositive;
            }
            factor[i][j] = match i == j {
                true => rest.sqrt(),
                false => rest / factor[j][j],
            };
        }
    }
    Factor::Of(factor)
}

/// The solution of `L L^T x = b`.
fn solved(factor: &Matrix, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = b.to_vec();
    for i in 0..n {
        let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    x
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

/// The inverse of a matrix; `None` if errors of the entries may change it. Components have different units, so that
/// rows and columns are scaled to make the diagonal 1.
fn resolved_inverse(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let units: Vec<f64> = (0..n).map(|i| matrix[i][i].abs().sqrt()).collect();
    let scaled = |matrix: &Matrix| -> Matrix {
        let row = |i: usize| {
            (0..n)
                .map(|j| matrix[i][j] / (units[i] * units[j]))
                .collect()
        };
        (0..n).map(row).collect()
    };
    let size = |matrix: &Matrix| {
        let sums = matrix.iter().map(|row| row.iter().map(|it| it.abs()).sum());
        sums.fold(0.0, larger)
    };
    let inverse = inverse(&scaled(matrix))?;
    // NaN fails this comparison.
    let is_resolved = ROUNDING * size(&scaled(matrix)) * size(&inverse) < RESOLVED;
    is_resolved.then(|| scaled(&inverse))
}

/// The inverse of a matrix; `None` if it is singular.
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

    /// Flows of `x' = -p, p' = -k x`, the extremals of the cost `u^2/2 + k x^2/2`. For `k = -1` the cost is the action
    /// of an oscillator.
    fn flows(k: f64, time: f64) -> Vec<Flow> {
        let t = time / 40.0;
        let columns = match k < 0.0 {
            // x'' = -x
            true => vec![vec![t.cos(), t.sin()], vec![-t.sin(), t.cos()]],
            false => vec![vec![t.cosh(), -t.sinh()], vec![-t.sinh(), t.cosh()]],
        };
        repeated(columns, time, 40)
    }

    fn repeated(columns: Vec<Vec<f64>>, time: f64, count: u32) -> Vec<Flow> {
        let flow = |index: u32| Flow {
            t: time * f64::from(index) / f64::from(count),
            columns: columns.clone(),
        };
        (1..=count).map(flow).collect()
    }

    #[test]
    fn a_fixed_end_fails_behind_its_conjugate_point_at_pi() {
        let terminal = vec![vec![0.0]];
        assert_eq!(
            test(&flows(-1.0, 3.1), &terminal, &[]),
            SecondOrder::Minimum
        );
        let SecondOrder::Fails { t } = test(&flows(-1.0, 3.3), &terminal, &[]) else {
            panic!("passes");
        };
        // The test runs backwards and fails at the time pi before the end.
        assert!((t - (3.3 - std::f64::consts::PI)).abs() < 0.1, "{t}");
        assert_eq!(test(&flows(1.0, 9.0), &terminal, &[]), SecondOrder::Minimum);
    }

    #[test]
    fn a_free_end_fails_behind_half_pi_and_sees_the_terminal_cost() {
        let flat = vec![vec![0.0]];
        assert_eq!(test(&flows(-1.0, 1.5), &flat, &[0]), SecondOrder::Minimum);
        assert!(matches!(
            test(&flows(-1.0, 1.7), &flat, &[0]),
            SecondOrder::Fails { .. }
        ));
        // The extremal is a minimum if the second derivative of the terminal cost exceeds tan(1.7 - pi/2) = 0.13.
        assert_eq!(
            test(&flows(-1.0, 1.7), &vec![vec![0.2]], &[0]),
            SecondOrder::Minimum
        );
        assert!(matches!(
            test(&flows(-1.0, 1.7), &vec![vec![0.1]], &[0]),
            SecondOrder::Fails { .. }
        ));
    }

    /// The exponential of an 8 by 8 matrix, by its series.
    fn exponential(matrix: &Matrix, time: f64) -> Matrix {
        let unit = |size: f64| -> Matrix {
            (0..8)
                .map(|i| (0..8).map(|j| if i == j { size } else { 0.0 }).collect())
                .collect()
        };
        let (mut sum, mut term) = (unit(1.0), unit(1.0));
        for k in 1..120 {
            term = product(&product(&term, matrix), &unit(time / f64::from(k)));
            sum = combined(&sum, &term, 1.0);
        }
        sum
    }

    /// A chain of four integrators: the input is the fourth derivative of `x`, and the cost is `u^2/2 - k x^2/2`. Over
    /// a 128th of the time, the effect of the input on `x` is below the rounding of its effect on the third derivative.
    #[test]
    fn a_long_chain_behind_an_input_is_tested_too() {
        let chain = |k: f64| -> Matrix {
            let mut matrix = vec![vec![0.0; 8]; 8];
            for i in 0..3 {
                matrix[i][i + 1] = 1.0;
                matrix[5 + i][4 + i] = -1.0;
            }
            matrix[3][7] = -1.0;
            matrix[4][0] = k;
            matrix
        };
        let flows = |k: f64, time: f64| {
            let flow = exponential(&chain(k), time / 128.0);
            repeated(transposed(&flow), time, 128)
        };
        let terminal = vec![vec![0.0; 4]; 4];
        assert_eq!(test(&flows(0.0, 2.0), &terminal, &[]), SecondOrder::Minimum);
        // At the conjugate point, a change of the costate at the start does not change the state at the end.
        let reach = |time: f64| {
            let flow = exponential(&chain(1.0), time);
            let block = flow[..4].iter().map(|row| row[4..].to_vec()).collect();
            crate::linear::determinant(block)
        };
        let sign = reach(2.0).signum();
        let mut times = (20..200).map(|k| 0.1 * f64::from(k));
        let conjugate = times.find(|time| reach(*time) * sign < 0.0);
        let conjugate = conjugate.expect("a conjugate point");
        assert_eq!(
            test(&flows(1.0, 0.95 * conjugate), &terminal, &[]),
            SecondOrder::Minimum
        );
        assert!(matches!(
            test(&flows(1.0, 1.1 * conjugate), &terminal, &[]),
            SecondOrder::Fails { .. }
        ));
    }

    #[test]
    fn a_state_that_is_not_controlled_stays_open() {
        let still = repeated(vec![vec![1.0, 0.0], vec![0.0, 1.0]], 1.0, 2);
        assert_eq!(test(&still, &vec![vec![0.0]], &[0]), SecondOrder::Open);
    }
}
