//! Dense output as a polynomial in nested form.

use super::precise::Precise;
use crate::jet::LENGTH;
use crate::state::StateVector;

/// The state inside a step: with `s = 1 - theta`,
/// `y(theta) = base + theta (c_0 + theta (c_1 + s (c_2 + s (c_3 + theta (c_4 + s (c_5 + ..))))))`.
///
/// This is the form of Hairer's codes, with the first two terms in powers of `theta`. It keeps its relative accuracy
/// for `theta` near 0, where roots just after an impact lie, even if only a small part of the step is used. A form with
/// the difference between the ends would not, because the state changes far more over the whole step than over the used
/// part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<S, const K: usize> {
    /// The state at `theta = 0`.
    pub(super) base: Precise<S>,
    /// The coefficients `c_0, .., c_{K-1}`.
    pub(super) coefficients: [S; K],
}

/// Conditions on a component at both ends of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cubic {
    /// `h` times the rate at the start.
    pub(super) rate: f64,
    /// Difference between the end of the step and an Euler step from its start.
    pub(super) bend: f64,
    /// Change of `h` times the rate over the step.
    pub(super) gained: f64,
    /// Bound of the rounding errors of `bend`. If the cubic differs from a parabola by less than these, the parabola is
    /// used: its bend is half of `gained`, and has far smaller errors than a sum with large weights.
    pub(super) rounding: f64,
}

impl<S: StateVector, const K: usize> Polynomial<S, K> {
    /// The zero polynomial, for states with as many components as `like`.
    pub(super) fn zero(like: &S) -> Self {
        Self {
            base: Precise::new(like.zeroed()),
            coefficients: [like.zeroed(); K],
        }
    }

    /// Sets the base and the first three coefficients of component `i`, which every scheme shares.
    #[inline(always)]
    pub(super) fn set_cubic(&mut self, i: usize, start: &Precise<S>, cubic: Cubic) {
        let twist = 2.0 * cubic.bend - cubic.gained;
        let is_parabola = twist.abs() <= 2.0 * cubic.rounding;
        let [bend, twist] = match is_parabola {
            true => [0.5 * cubic.gained, 0.0],
            false => [cubic.bend, twist],
        };
        self.base.value.as_mut_slice()[i] = start.value.as_slice()[i];
        self.base.rest.as_mut_slice()[i] = start.rest.as_slice()[i];
        for (k, value) in [cubic.rate, bend, twist].into_iter().enumerate() {
            self.coefficients[k].as_mut_slice()[i] = value;
        }
    }

    /// Change of `h` times the rate of component `i` between the start and the stage at `node`, minus the change of the
    /// cubic. `gained` is the former change.
    ///
    /// The weights of the higher coefficients annihilate the rates of a cubic up to the weights' rounding errors.
    /// These are the same in every step and would add up over a run, so the cubic's part is subtracted first.
    #[inline(always)]
    pub(super) fn beside_cubic(&self, node: f64, gained: f64, i: usize) -> f64 {
        let at = |k: usize| self.coefficients[k].as_slice()[i];
        gained - node * (2.0 * at(1) + (2.0 - 3.0 * node) * at(2))
    }

    /// Writes the coefficients in powers of `theta`; returns the degree.
    pub(super) fn powers(&self, powers: &mut [S; LENGTH]) -> usize {
        powers[..=K].fill(self.base.value.zeroed());
        for (k, coefficient) in self.coefficients.iter().enumerate().rev() {
            let degree = K - 1 - k;
            coefficient.for_each_place(|i| {
                powers[0].padded_mut()[i] += coefficient.padded()[i];
                for j in (0..=degree).rev() {
                    let power = powers[j].padded()[i];
                    powers[j + 1].padded_mut()[i] = match is_along(k) {
                        true => power,
                        false => powers[j + 1].padded()[i] - power,
                    };
                }
                if is_along(k) {
                    powers[0].padded_mut()[i] = 0.0;
                }
            });
        }
        let base = &self.base.value;
        base.for_each_place(|i| powers[0].padded_mut()[i] += base.padded()[i]);
        K
    }

    /// The state at `theta` in \[0, 1\].
    #[inline(always)]
    pub fn at(&self, theta: f64) -> S {
        self.precisely_at(theta).value
    }

    /// The state at `theta`, with its rounding error.
    #[inline(always)]
    pub(super) fn precisely_at(&self, theta: f64) -> Precise<S> {
        let mut value = self.base.value.zeroed();
        for (k, coefficient) in self.coefficients.iter().enumerate().rev() {
            let factor = if is_along(k) { theta } else { 1.0 - theta };
            coefficient.for_each_place(|i| {
                let sum = value.padded()[i] + coefficient.padded()[i];
                value.padded_mut()[i] = sum * factor;
            });
        }
        self.base.advanced(|i| value.padded()[i])
    }
}

/// True if coefficient `k` and those above it are multiplied by `theta`, false if by `1 - theta`.
#[inline(always)]
fn is_along(k: usize) -> bool {
    matches!(k, 0 | 1) || (k > 3 && k.is_multiple_of(2))
}

/// Fraction at which [`Polynomial::set_inner`] prescribes slopes, besides `1 - INNER`: the outer nodes of the
/// three-point Gauss rule. The Lobatto nodes, where `a (1 - a) = 1/5`, would not determine the quintic.
pub(super) const INNER: f64 = 0.112_701_665_379_258_31;

impl<S: StateVector> Polynomial<S, 5> {
    /// Raises the cubic through the ends to the quintic with slopes `h` times these rates at [`INNER`] and at
    /// `1 - INNER`.
    pub(super) fn set_inner(&mut self, h: f64, rates: [&S; 2]) {
        const A: f64 = INNER;
        const B: f64 = 1.0 - INNER;
        // Slopes of theta^2 s^2 and theta^3 s^2 at A; at B the first has the opposite sign.
        const FOURTH: f64 = 2.0 * A * B * (1.0 - 2.0 * A);
        const FIFTH: [f64; 2] = [A * A * B * (3.0 - 5.0 * A), B * B * A * (3.0 - 5.0 * B)];
        for i in 0..self.base.value.count() {
            let first = self.coefficients[0].as_slice()[i];
            let missing = [(0, A), (1, B)]
                .map(|(k, node)| self.beside_cubic(node, h * rates[k].as_slice()[i] - first, i));
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
        let mut dense = Polynomial::<Scalar, 5>::zero(&Scalar::zeros());
        let [start, end] = [rate(0.0)[0], rate(1.0)[0]].map(|rate| h * rate);
        let bend = value(1.0)[0] - value(0.0)[0] - start;
        let cubic = Cubic {
            rate: start,
            bend,
            gained: end - start,
            rounding: 0.0,
        };
        dense.set_cubic(0, &Precise::new(value(0.0)), cubic);
        dense.set_inner(h, [&rate(INNER), &rate(1.0 - INNER)]);
        let mut powers = [Scalar::zeros(); LENGTH];
        let order = dense.powers(&mut powers);
        for step in 0..=16 {
            let x = f64::from(step) / 16.0;
            assert!((dense.at(x) - value(x)).amax() < 1e-14, "{x}");
            let horner = |sum: f64, power: &Scalar| sum * x + power[0];
            let sum = powers[..=order].iter().rev().fold(0.0, horner);
            assert!((sum - value(x)[0]).abs() < 1e-13, "{x}: {sum}");
        }
    }
}
