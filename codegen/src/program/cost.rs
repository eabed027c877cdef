//! Operation counts.

use std::fmt;

use super::Op;

/// Counts of the operations of a function.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// Additions, subtractions and negations.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions and square roots.
    pub divisions: usize,
    /// Elementary functions and powers.
    pub calls: usize,
}

impl Cost {
    pub(super) fn of(ops: &[Op]) -> Self {
        let mut cost = Self::default();
        for op in ops {
            match op {
                Op::Input(_) | Op::Number(_) | Op::Pi | Op::Guard(_) => {}
                Op::Neg(_) | Op::Add(..) | Op::Sub(..) => cost.additions += 1,
                Op::Mul(..) => cost.multiplications += 1,
                Op::Div(..) | Op::Sqrt(_) => cost.divisions += 1,
                Op::Power(..) | Op::Call(..) | Op::Atan2(..) => cost.calls += 1,
            }
        }
        cost
    }

    /// Number of multiplications that take about as long as all these operations.
    pub fn multiplications_alike(&self) -> usize {
        self.additions + self.multiplications + 4 * self.divisions + 16 * self.calls
    }

    /// All operations together.
    pub fn total(&self) -> usize {
        self.additions + self.multiplications + self.divisions + self.calls
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} operations: {} additions, {} multiplications, {} divisions and roots, {} function calls",
            self.total(),
            self.additions,
            self.multiplications,
            self.divisions,
            self.calls
        )
    }
}
