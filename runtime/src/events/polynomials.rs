//! Polynomials in the fraction of a step, with error bounds, and Taylor models of them on parts of the step.
//!
//! On `[a, b]`, with middle `m` and half length `r`, `p(m + r s) = sum_k q_k s^k` for `s` in `[-1, 1]`. The model
//! contains the first four terms; the other terms are bounded by its remainder.

use crate::jet::LENGTH;
use crate::numbers::TaylorModel;
use crate::state::StateVector;

/// Number of terms that are expanded about the middle of a part at first. The other terms are bounded by the sum of
/// their absolute values.
pub(crate) const FEW: usize = 8;

/// Largest sum of these other terms relative to the linear term of the model. Above it, all terms are expanded about
/// the middle.
const SMALL: f64 = 1.0 / (1 << 10) as f64;

/// Bound for the rounding error of a coefficient and of moving the centre of expansion, relative to the sum of the
/// absolute values of all terms.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// One polynomial per component.
#[derive(Debug, Clone)]
pub(crate) struct Polynomials<S> {
    /// Coefficients by power. Entries above the order are unset.
    pub(crate) coefficients: [S; LENGTH],
    pub(crate) order: usize,
    /// Error bounds of each polynomial and of its derivative.
    pub(crate) doubts: [S; 2],
    /// Sums of the absolute values of the terms from degree [`FEW`] on, and of their derivatives.
    pub(crate) tails: [S; 2],
}

impl<S: StateVector> Polynomials<S> {
    /// Zero polynomials, for as many components as `like`.
    pub(crate) fn zero(like: &S) -> Self {
        let zeros = like.zeroed();
        Self {
            coefficients: [zeros; LENGTH],
            order: 0,
            doubts: [zeros; 2],
            tails: [zeros; 2],
        }
    }

    /// The coefficients by power.
    #[inline]
    pub(crate) fn terms(&self) -> &[S] {
        &self.coefficients[..=self.order]
    }

    /// Computes the sums of the terms from degree [`FEW`] on. Returns the sums of the absolute values of all terms, and
    /// of their derivatives.
    #[inline(always)]
    pub(crate) fn sum(&mut self) -> [S; 2] {
        let zeros = self.coefficients[0].zeroed();
        let [mut sizes, mut slopes] = [zeros; 2];
        let mut first = [zeros; 2];
        for (k, coefficient) in self.coefficients[..=self.order].iter().enumerate() {
            if k == FEW {
                first = [sizes, slopes];
            }
            zeros.for_each_place(|i| {
                let size = coefficient.padded()[i].abs();
                sizes.padded_mut()[i] += size;
                slopes.padded_mut()[i] += k as f64 * size;
            });
        }
        self.tails = [zeros; 2];
        if self.order >= FEW {
            for (tail, (all, first)) in self
                .tails
                .iter_mut()
                .zip([sizes, slopes].iter().zip(&first))
            {
                zeros.for_each_place(|i| {
                    let all = all.padded()[i];
                    tail.padded_mut()[i] = all - first.padded()[i] + ROUNDING * all;
                });
            }
        }
        [sizes, slopes]
    }

    /// Value of component `i` at a fraction of the step.
    #[inline]
    pub(crate) fn at(&self, i: usize, part: f64) -> f64 {
        let terms = self.terms().iter().rev();
        terms.fold(0.0, |sum, term| sum * part + term.as_slice()[i])
    }

    /// Taylor model of component `i` on a part of the step.
    #[inline]
    pub(crate) fn on(&self, i: usize, part: [f64; 2]) -> TaylorModel {
        let (model, tail) = self.centred::<FEW>(i, part);
        match tail <= SMALL * model.powers[1].abs() {
            true => model,
            false => self.centred::<LENGTH>(i, part).0,
        }
    }

    /// The model with the first `COUNT` terms expanded about the middle, and the share of the other terms in its error.
    #[inline]
    fn centred<const COUNT: usize>(&self, i: usize, part: [f64; 2]) -> (TaylorModel, f64) {
        let [middle, radius] = [0.5 * (part[0] + part[1]), 0.5 * (part[1] - part[0])];
        let terms = (self.order + 1).min(COUNT);
        let mut powers = [0.0; COUNT];
        for (power, coefficient) in powers.iter_mut().zip(&self.coefficients[..terms]) {
            *power = coefficient.as_slice()[i];
        }
        move_to(&mut powers[..terms], middle);
        let mut cubic = [0.0; 4];
        let (mut error, mut slope) = (
            self.doubts[0].as_slice()[i],
            radius * self.doubts[1].as_slice()[i],
        );
        let mut scale = 1.0;
        for (k, &power) in powers[..terms].iter().enumerate() {
            let term = scale * power;
            match cubic.get_mut(k) {
                Some(entry) => *entry = term,
                None => {
                    error += term.abs();
                    slope += k as f64 * term.abs();
                }
            }
            scale *= radius;
        }
        let mut tail = 0.0;
        if terms <= self.order {
            // The bound of the terms from degree `k` on is `b^k` times as large on `[0, b]` as on the whole step.
            let [b, square] = [part[1], part[1] * part[1]];
            let power = square * square * square * b;
            tail = power * b * self.tails[0].as_slice()[i];
            error += tail;
            slope += radius * power * self.tails[1].as_slice()[i];
        }
        let model = TaylorModel {
            error,
            slope,
            ..TaylorModel::exact(cubic)
        };
        (model, tail)
    }
}

/// Moves the centre of expansion: replaces `p` by the coefficients of `p(middle + y)` in powers of `y` (Horner's
/// scheme).
#[inline(always)]
fn move_to(powers: &mut [f64], middle: f64) {
    let count = powers.len();
    for first in 0..count.saturating_sub(1) {
        for k in (first..count - 1).rev() {
            powers[k] += middle * powers[k + 1];
        }
    }
}
