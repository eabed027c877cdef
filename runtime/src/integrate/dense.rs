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

/// Where the slopes inside are prescribed by [`Polynomial::set_inner`]: here and at one minus it, the outer nodes of
/// Gauss's rule of three points. Lobatto's, where `a (1 - a) = 1/5`, would not determine the quintic.
pub(super) const INNER: f64 = 0.112_701_665_379_258_31;

impl<S: StateVector> Polynomial<S, 5> {
    /// Raises the cubic through the ends to the quintic that has `h` times these rates for slopes at [`INNER`] and at
    /// `1 - INNER`.
    pub(super) fn set_inner(&mut self, h: f64, rates: [&S; 2]) {
        const A: f64 = INNER;
        const B: f64 = 1.0 - INNER;
        // The slopes of theta^2 s^2 and theta^3 s^2 at A; at B that of the first has the opposite sign.
        const FOURTH: f64 = 2.0 * A * B * (1.0 - 2.0 * A);
        const FIFTH: [f64; 2] = [A * A * B * (3.0 - 5.0 * A), B * B * A * (3.0 - 5.0 * B)];
        for i in 0..S::LEN {
            let missing = [(0, A), (1, B)].map(|(k, node)| self.beside_cubic(h, node, rates[k], i));
            let fifth = (missing[0] + missing[1]) / (FIFTH[0] + FIFTH[1]);
            self.coefficients[3].as_mut_slice()[i] = (missing[0] - FIFTH[0] * fifth) / FOURTH;
            self.coefficients[4].as_mut_slice()[i] = fifth;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    #[test]
    fn quintic_reproduces_polynomials_of_degree_five() {
        type Scalar = SVector<f64, 1>;
        let h = 0.5;
        let value = |x: f64| {
            Scalar::new(1.0 + x - 2.0 * x * x + x * x * x - 3.0 * x.powi(4) + 2.0 * x.powi(5))
        };
        let rate = |x: f64| {
            Scalar::new((1.0 - 4.0 * x + 3.0 * x * x - 12.0 * x.powi(3) + 10.0 * x.powi(4)) / h)
        };
        let mut dense = Polynomial::<Scalar, 5>::zero();
        dense.set_cubic(h, [&value(0.0), &value(1.0)], [&rate(0.0), &rate(1.0)]);
        dense.set_inner(h, [&rate(INNER), &rate(1.0 - INNER)]);
        for step in 0..=16 {
            let x = f64::from(step) / 16.0;
            assert!((dense.at(x) - value(x)).amax() < 1e-14, "{x}");
        }
    }
}
