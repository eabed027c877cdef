//! Dense output as a polynomial in the nested form of Hairer's codes.

use crate::state::StateVector;

/// The state inside a step: with `s = 1 - theta`,
/// `y(theta) = base + theta (c_0 + s (c_1 + theta (c_2 + s (c_3 + ..))))`.
///
/// The form is exact at both ends and keeps its relative accuracy for `theta` near 0, where roots just after an
/// impact lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<S, const K: usize> {
    /// The state at `theta = 0`.
    pub(super) base: S,
    /// The coefficients `c_0, .., c_{K-1}`.
    pub(super) coefficients: [S; K],
}

impl<S: StateVector, const K: usize> Polynomial<S, K> {
    /// The polynomial 0.
    pub(super) fn zero() -> Self {
        Self {
            base: S::zeros(),
            coefficients: [S::zeros(); K],
        }
    }

    /// Sets the part every scheme shares: a cubic through the ends `y0`, `y1` with `h` times the rates `k0`, `k1`.
    #[inline(always)]
    pub(super) fn set_cubic(&mut self, h: f64, ends: [&S; 2], rates: [&S; 2]) {
        self.base = *ends[0];
        for i in 0..S::LEN {
            let change = ends[1].as_slice()[i] - ends[0].as_slice()[i];
            let start = h * rates[0].as_slice()[i] - change;
            self.coefficients[0].as_mut_slice()[i] = change;
            self.coefficients[1].as_mut_slice()[i] = start;
            self.coefficients[2].as_mut_slice()[i] = change - h * rates[1].as_slice()[i] - start;
        }
    }

    /// `h` times the rate of a stage at a node, component `i`, without that of the cubic.
    ///
    /// The weights of the higher coefficients do not see the rates of a cubic, but for the weights' rounding errors, which
    /// are the same in every step: unless the cubic's part is taken out they add up over a run.
    #[inline(always)]
    pub(super) fn beside_cubic(&self, h: f64, node: f64, rate: &S, i: usize) -> f64 {
        let at = |k: usize| self.coefficients[k].as_slice()[i];
        let slope = at(0) + (1.0 - 2.0 * node) * at(1) + node * (2.0 - 3.0 * node) * at(2);
        h * rate.as_slice()[i] - slope
    }

    /// The state at `theta` in \[0, 1\].
    #[inline(always)]
    pub fn at(&self, theta: f64) -> S {
        let mut value = S::zeros();
        for (k, coefficient) in self.coefficients.iter().enumerate().rev() {
            let factor = if k % 2 == 0 { theta } else { 1.0 - theta };
            for i in 0..S::LEN {
                let sum = value.as_slice()[i] + coefficient.as_slice()[i];
                value.as_mut_slice()[i] = sum * factor;
            }
        }
        for i in 0..S::LEN {
            value.as_mut_slice()[i] += self.base.as_slice()[i];
        }
        value
    }
}
