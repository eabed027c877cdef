//! Symmetry groups whose flows are affine in the coordinates, for example translations and rotations.
//!
//! ```text
//! dq/ds = A q + c,   dqdot/ds = A qdot,   [A q + a, B q + b] = (B A - A B) q + B a - A b
//! ```

use dalembert::math::larger;
use dalembert::numbers::Numbers;
use dalembert::variations::Dual;
use dalembert::variations::group::{GENERATORS, Group};

use crate::linear::{add, dot, norm};

/// A field counts as dependent on others if its part orthogonal to them is at most this fraction of its length.
const DEPENDENT: f64 = 1e-10;

/// Maximum number of terms of a power series whose argument is at most 1.
const TERMS: u32 = 30;

/// A vector field that is affine in the coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Generator {
    /// The field as written.
    pub name: String,
    /// The derivative of the field: N rows of N entries.
    pub linear: Vec<Vec<f64>>,
    /// The field at 0.
    pub constant: Vec<f64>,
    /// True if the momentum of the field is conserved.
    pub keeps_momentum: bool,
}

/// The symmetries up to which an orbit closes.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetries {
    generators: Vec<Generator>,
}

/// Reason why fields do not generate a supported group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoGroup {
    /// There are more fields than supported.
    #[error("at most {GENERATORS} fields are followed together")]
    Many,
    /// A field is a combination of those before it.
    #[error("field {0} is a combination of those before it")]
    Dependent(usize),
    /// The commutator of two fields is not a combination of the fields.
    #[error(
        "fields {0} and {1} do not commute, and their commutator is no combination of the fields; add it"
    )]
    NotClosed(usize, usize),
}

impl Symmetries {
    /// The group that these fields generate.
    ///
    /// # Errors
    /// [`NoGroup`]; fields are counted from 1.
    pub fn of(generators: Vec<Generator>) -> Result<Self, NoGroup> {
        if generators.len() > GENERATORS {
            return Err(NoGroup::Many);
        }
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for (k, generator) in generators.iter().enumerate() {
            let entries = generator.entries();
            let left = remainder(&basis, &entries);
            let length = norm(&left);
            if length <= DEPENDENT * norm(&entries) || !length.is_finite() {
                return Err(NoGroup::Dependent(k + 1));
            }
            basis.push(left.iter().map(|entry| entry / length).collect());
        }
        for (k, one) in generators.iter().enumerate() {
            for (l, other) in generators.iter().enumerate().skip(k + 1) {
                let bracket = one.bracket(other);
                let size = norm(&one.entries()) * norm(&other.entries());
                if norm(&remainder(&basis, &bracket)) > DEPENDENT * size {
                    return Err(NoGroup::NotClosed(k + 1, l + 1));
                }
            }
        }
        Ok(Self { generators })
    }

    /// The fields.
    pub fn generators(&self) -> &[Generator] {
        &self.generators
    }
}

impl Generator {
    fn entries(&self) -> Vec<f64> {
        let linear = self.linear.iter().flatten();
        linear.chain(&self.constant).copied().collect()
    }

    /// The entries of the commutator with another field.
    fn bracket(&self, other: &Self) -> Vec<f64> {
        let n = self.constant.len();
        let column = |matrix: &[Vec<f64>], j: usize| -> Vec<f64> {
            matrix.iter().map(|row| row[j]).collect()
        };
        let change =
            |i: usize, [a, b]: [&[f64]; 2]| dot(&other.linear[i], a) - dot(&self.linear[i], b);
        let mut entries = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let columns = [column(&self.linear, j), column(&other.linear, j)];
                entries.push(change(i, [&columns[0], &columns[1]]));
            }
        }
        entries.extend((0..n).map(|i| change(i, [&self.constant, &other.constant])));
        entries
    }

    /// Largest sum of absolute values in a row of the linear part.
    fn size(&self) -> f64 {
        let sums = self.linear.iter();
        let sums = sums.map(|row| row.iter().map(|entry| entry.abs()).sum());
        sums.fold(0.0, larger)
    }
}

/// The part of a vector orthogonal to orthonormal vectors.
fn remainder(basis: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    let mut left = vector.to_vec();
    for _ in 0..2 {
        for direction in basis {
            let along = dot(&left, direction);
            add(&mut left, -along, direction);
        }
    }
    left
}

impl Symmetries {
    /// The rate of a position, or of a velocity, along the combination of the fields with the factors `element`.
    fn rate(&self, element: &[Dual], values: &[Dual], is_position: bool) -> Vec<Dual> {
        let mut rates = vec![Dual::ZERO; values.len()];
        for (factor, generator) in element.iter().zip(&self.generators) {
            let rows = generator.linear.iter().zip(&generator.constant);
            for (rate, (row, constant)) in rates.iter_mut().zip(rows) {
                let start = if is_position { *constant } else { 0.0 };
                let sum = row.iter().zip(values).filter(|(entry, _)| **entry != 0.0);
                let sum = sum.fold(Dual::of(start), |sum, (entry, value)| {
                    sum + Dual::of(*entry) * *value
                });
                *rate = *rate + *factor * sum;
            }
        }
        rates
    }

    /// Moves values along the combination of the fields with the factors `element` for the time 1, in `steps` steps.
    fn follow(&self, element: &[Dual], values: &mut [Dual], is_position: bool, steps: u32) {
        let share = 1.0 / f64::from(steps);
        for _ in 0..steps {
            let mut term = self.rate(element, values, is_position);
            for order in 1..=TERMS {
                let factor = Dual::of(share / f64::from(order));
                for (value, entry) in values.iter_mut().zip(&mut term) {
                    *entry = *entry * factor;
                    *value = *value + *entry;
                }
                term = self.rate(element, &term, false);
                if term.iter().all(is_zero) {
                    break;
                }
            }
        }
    }
}

/// True if a number and its derivatives are 0.
fn is_zero(number: &Dual) -> bool {
    number.value == 0.0 && number.slopes().iter().all(|slope| *slope == 0.0)
}

impl Group for Symmetries {
    fn dimension(&self) -> usize {
        self.generators.len()
    }

    fn act(&self, element: &[Dual; GENERATORS], q: &mut [Dual], qdot: &mut [Dual]) {
        let pairs = element.iter().zip(&self.generators);
        let size: f64 = pairs
            .map(|(factor, generator)| factor.value.abs() * generator.size())
            .sum();
        let steps = size.ceil().clamp(1.0, 1e4) as u32;
        self.follow(element, q, true, steps);
        self.follow(element, qdot, false, steps);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(linear: [[f64; 2]; 2], constant: [f64; 2]) -> Generator {
        Generator {
            name: String::new(),
            linear: linear.iter().map(|row| row.to_vec()).collect(),
            constant: constant.to_vec(),
            keeps_momentum: false,
        }
    }

    const TURN: [[f64; 2]; 2] = [[0.0, -1.0], [1.0, 0.0]];
    const NONE: [[f64; 2]; 2] = [[0.0; 2]; 2];

    #[test]
    fn a_rotation_about_a_point_is_followed_with_its_derivatives() {
        // The rotation about (1, 2): `(x, y)' = (2 - y, x - 1)`.
        let group = Symmetries::of(vec![field(TURN, [2.0, -1.0])]).expect("a group");
        let angle = 5.0_f64;
        let element = std::array::from_fn(|k| match k {
            0 => Dual::new(angle, [1.0, 0.0, 0.0, 0.0]),
            _ => Dual::ZERO,
        });
        let mut q = [Dual::new(4.0, [0.0, 1.0, 0.0, 0.0]), Dual::of(2.0)];
        let mut qdot = [Dual::of(0.5), Dual::of(0.0)];
        group.act(&element, &mut q, &mut qdot);
        let (sin, cos) = angle.sin_cos();
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found}");
        close(q[0].value, 1.0 + 3.0 * cos);
        close(q[1].value, 2.0 + 3.0 * sin);
        close(q[0].slopes()[0], -3.0 * sin);
        close(q[1].slopes()[0], 3.0 * cos);
        close(q[1].slopes()[1], sin);
        close(qdot[0].value, 0.5 * cos);
        close(qdot[1].slopes()[0], 0.5 * cos);
    }

    #[test]
    fn fields_that_generate_more_are_refused() {
        let (turn, x, y) = (
            field(TURN, [0.0; 2]),
            field(NONE, [1.0, 0.0]),
            field(NONE, [0.0, 1.0]),
        );
        let of = |fields: &[&Generator]| {
            let fields = fields.iter().map(|field| (*field).clone()).collect();
            Symmetries::of(fields).map(|_| ())
        };
        assert_eq!(of(&[&turn, &x, &y]), Ok(()));
        assert_eq!(of(&[&turn, &x]), Err(NoGroup::NotClosed(1, 2)));
        assert_eq!(of(&[&x, &x]), Err(NoGroup::Dependent(2)));
        assert_eq!(of(&[&field(NONE, [0.0; 2])]), Err(NoGroup::Dependent(1)));
        assert_eq!(of(&[&x, &y, &turn, &turn, &turn]), Err(NoGroup::Many));
    }
}
