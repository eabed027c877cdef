//! Enclosures of the dense output: all values and rates of a component of the state on a part of a step.
//!
//! The dense output is a polynomial `p` in the fraction of the step. With `m` the middle and `r` half the length of a
//! part, `p(m + r x) = sum_k q_k r^k x^k` for `x` in `[-1, 1]`, where `x^k` lies in `[0, 1]` for even and in
//! `[-1, 1]` for odd `k` (centred form). The computation is in interval arithmetic.

use crate::error::Fault;
use crate::jet::LENGTH;
use crate::numbers::{Interval, Rated};
use crate::record::Segment;
use crate::state::StateVector;

/// Rounding error of a state from the dense output, relative to the sum of the absolute values of its terms. The
/// integrator evaluates the polynomial in nested form; the enclosure uses its coefficients in powers.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The dense output of a step.
#[derive(Debug, Clone)]
pub(super) struct Motion<S> {
    start: f64,
    length: f64,
    coefficients: [S; LENGTH],
    order: usize,
    /// Rounding errors of each component, and of its rate.
    doubts: [S; 2],
}

impl<S: StateVector> Motion<S> {
    /// Motion before the first step, for states with as many components as `like`.
    pub(super) fn new(like: &S) -> Self {
        Self {
            start: 0.0,
            length: 0.0,
            coefficients: [like.zeroed(); LENGTH],
            order: 0,
            doubts: [like.zeroed(); 2],
        }
    }

    /// Sets the step.
    ///
    /// # Errors
    /// The [`Fault`] of the dense output.
    pub(super) fn follow(&mut self, segment: &mut Segment<'_, S>) -> Result<(), Fault> {
        (self.start, self.length) = (segment.t_start(), segment.step_length());
        self.order = segment.powers(&mut self.coefficients)?;
        self.doubts = [self.coefficients[0].zeroed(); 2];
        for (k, coefficient) in self.coefficients[..=self.order].iter().enumerate() {
            for (i, value) in coefficient.as_slice().iter().enumerate() {
                self.doubts[0].as_mut_slice()[i] += ROUNDING * value.abs();
                self.doubts[1].as_mut_slice()[i] += 2.0 * ROUNDING * k as f64 * value.abs();
            }
        }
        Ok(())
    }

    /// Rounding error of component `i`.
    pub(super) fn doubt(&self, i: usize) -> f64 {
        self.doubts[0].as_slice()[i]
    }

    /// Time at a fraction of the step.
    pub(super) fn time_at(&self, part: f64) -> f64 {
        self.start + part * self.length
    }

    /// State at a fraction of the step.
    pub(super) fn state(&self, part: f64) -> S {
        let mut state = self.coefficients[0].zeroed();
        for coefficient in self.coefficients[..=self.order].iter().rev() {
            let pairs = state.as_mut_slice().iter_mut().zip(coefficient.as_slice());
            pairs.for_each(|(value, coefficient)| *value = *value * part + coefficient);
        }
        state
    }

    /// Enclosure of the times on a part of the step.
    pub(super) fn time(&self, [from, to]: [f64; 2]) -> Rated {
        let length = Interval::point(self.length);
        Rated {
            value: Interval::point(self.start) + length * Interval::new(from, to),
            rate: length,
        }
    }

    /// Enclosure of component `i` at a fraction of the step, including rounding.
    fn component_at(&self, i: usize, part: f64) -> Interval {
        let part = Interval::point(part);
        let terms = self.coefficients[..=self.order].iter().rev();
        let value = terms.fold(Interval::point(0.0), |sum, coefficient| {
            sum * part + Interval::point(coefficient.as_slice()[i])
        });
        value.widened(self.doubts[0].as_slice()[i])
    }

    /// Enclosure of component `i` on a part of the step, and of its derivative with respect to the fraction of the
    /// step. On a single point the derivative is 0.
    pub(super) fn component(&self, i: usize, [from, to]: [f64; 2]) -> Rated {
        if from == to {
            return Rated::steady(self.component_at(i, from));
        }
        let middle = 0.5 * (from + to);
        let radius = (to - middle).max(middle - from) * (1.0 + f64::EPSILON);
        let mut powers = [Interval::point(0.0); LENGTH];
        let count = self.order + 1;
        for (power, coefficient) in powers.iter_mut().zip(&self.coefficients[..count]) {
            *power = Interval::point(coefficient.as_slice()[i]);
        }
        let powers = &mut powers[..count];
        move_to(powers, Interval::point(middle));
        let radius = Interval::point(radius);
        let (mut value, mut rate) = (powers[0], Interval::point(0.0));
        let mut scale = Interval::point(1.0);
        for (k, &power) in powers.iter().enumerate().skip(1) {
            rate = rate + Interval::point(k as f64) * power * scale * sizes(k - 1);
            scale = scale * radius;
            value = value + power * scale * sizes(k);
        }
        Rated {
            value: value.widened(self.doubts[0].as_slice()[i]),
            rate: rate.widened(self.doubts[1].as_slice()[i]),
        }
    }
}

/// Range of `x^k` for `x` in `[-1, 1]`.
fn sizes(k: usize) -> Interval {
    match (k, k % 2) {
        (0, _) => Interval::point(1.0),
        (_, 0) => Interval::new(0.0, 1.0),
        _ => Interval::new(-1.0, 1.0),
    }
}

/// Moves the centre of a polynomial: `p(middle + y)` in powers of `y`, by Horner's scheme.
fn move_to(powers: &mut [Interval], middle: Interval) {
    for first in 0..powers.len() - 1 {
        for k in (first..powers.len() - 1).rev() {
            powers[k] = powers[k] + middle * powers[k + 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    #[test]
    fn values_and_rates_of_a_polynomial_lie_in_their_intervals() {
        type Scalar = SVector<f64, 1>;
        let coefficients = [0.25, -3.0, 2.5, 0.75, -1.5, 0.5];
        let mut motion = Motion::new(&Scalar::zeros());
        motion.order = 5;
        for (to, from) in motion.coefficients.iter_mut().zip(coefficients) {
            to[0] = from;
        }
        let rate = |x: f64| {
            let terms = coefficients.iter().enumerate().skip(1);
            terms.fold(0.0, |sum, (k, c)| sum + k as f64 * c * x.powi(k as i32 - 1))
        };
        for start in 0..16 {
            for width in [1e-9, 0.01, 1.0 / 16.0, 0.5] {
                let from = f64::from(start) / 16.0;
                let to = (from + width).min(1.0);
                let found = motion.component(0, [from, to]);
                for k in 0..=8 {
                    let x = (from + (to - from) * f64::from(k) / 8.0).min(to);
                    let value = Interval::point(motion.state(x)[0]);
                    assert!(found.value.widened(1e-15).contains(value), "{x}");
                    let rate = Interval::point(rate(x));
                    assert!(found.rate.widened(1e-14).contains(rate), "{x}");
                }
                assert!(found.value.width() <= 8.0 * width + 1e-14);
                let place = motion.component(0, [from, from]).value;
                assert!(place.contains(Interval::point(motion.state(from)[0])));
            }
        }
    }
}
