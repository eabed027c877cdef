//! The motion along a step: a polynomial in the part of the step for each component, with all values and rates that it has on a
//! part of the step.
//!
//! On `[a, b]`, with `m` in the middle and `r` half as long, `p(m + r x) = sum_k q_k x^k` for `x` in `[-1, 1]` has values within
//! `q_0 + [-1, 1] |q_k|` for odd and `q_0 + [0, 1] q_k` for even `k`; the same holds of its rate. This is the centred form of a
//! polynomial: it is wider than the range by no more than the square of `b - a`.

use crate::contract::System;
use crate::effects::StepView;
use crate::integrate::Stepper;
use crate::jet::LENGTH;
use crate::numbers::{Interval, Rated};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Terms that are centred on a part of the step that is not short; the sizes of all others are added.
const CENTRED: usize = 6;

/// A part of the step that is shorter has all its terms centred.
const SHORT: f64 = 1.0 / 8.0;

/// Rounding of a coefficient, and of the sums that move it, in parts of the sum of all terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The motion along a step.
#[derive(Debug, Clone)]
pub(crate) struct Path<S> {
    /// Time at the start, and length.
    start: f64,
    length: f64,
    coefficients: [S; LENGTH],
    order: usize,
    /// How far each component may be from its polynomial, and its rate from that of the polynomial.
    doubts: [S; 2],
    /// Sizes of the terms that are not centred on long parts: of the component, and of its rate.
    tails: [S; 2],
    /// True once the dense output is taken in, false of the cubic through the ends.
    is_dense: bool,
}

impl<S: StateVector> Path<S> {
    /// Of no step.
    pub(crate) fn new() -> Self {
        let zeros = S::zeros();
        Self {
            start: 0.0,
            length: 0.0,
            coefficients: [zeros; LENGTH],
            order: 0,
            doubts: [zeros; 2],
            tails: [zeros; 2],
            is_dense: false,
        }
    }

    /// Takes in a step: its dense output where that is ready, else the cubic through its ends with what the rates inside differ
    /// by. Where no rates inside are known dense output is prepared.
    ///
    /// # Errors
    /// Those of the dense output.
    #[inline]
    pub(crate) fn follow<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        if step.stepper.dense_ready() {
            self.follow_dense(step);
            return Ok(());
        }
        match step.stepper.sway() {
            Some(sway) => self.follow_ends(step, &sway),
            None => {
                step.prepare()?;
                self.follow_dense(step);
            }
        }
        Ok(())
    }

    /// Takes in the dense output of the step, which it prepares.
    ///
    /// # Errors
    /// Those of the dense output.
    pub(crate) fn refine<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        step.prepare()?;
        if !self.is_dense {
            self.follow_dense(step);
        }
        Ok(())
    }

    fn follow_dense<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
    ) {
        (self.start, self.length) = (step.t_start(), step.length());
        self.order = step.stepper.powers(&mut self.coefficients);
        self.is_dense = true;
        self.doubts = [S::zeros(); 2];
        self.add_rounding();
    }

    fn follow_ends<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
        sway: &S,
    ) {
        (self.start, self.length) = (step.t_start(), step.length());
        let (start, end, [first, last]) = (step.start(), step.end(), step.rates());
        for i in 0..S::LEN {
            let at = |state: &S| state.as_slice()[i];
            let rates = [first, last].map(|rate| self.length * at(rate));
            let bend = at(end) - at(start) - rates[0];
            let twist = 2.0 * bend - (rates[1] - rates[0]);
            let powers = [at(start), rates[0], bend + twist, -twist];
            for (coefficient, power) in self.coefficients.iter_mut().zip(powers) {
                coefficient.as_mut_slice()[i] = power;
            }
        }
        self.order = 3;
        self.is_dense = false;
        self.doubts = [*sway; 2];
        self.add_rounding();
    }

    /// Adds the rounding errors of the coefficients to the doubts, and sums up the terms that are not centred.
    #[inline]
    fn add_rounding(&mut self) {
        self.tails = [S::zeros(); 2];
        let (mut sizes, mut slopes) = (S::zeros(), S::zeros());
        for (k, coefficient) in self.coefficients[..=self.order].iter().enumerate() {
            for i in 0..S::LEN {
                let size = coefficient.as_slice()[i].abs();
                sizes.as_mut_slice()[i] += size;
                slopes.as_mut_slice()[i] += k as f64 * size;
                if k >= CENTRED {
                    self.tails[0].as_mut_slice()[i] += size;
                    self.tails[1].as_mut_slice()[i] += k as f64 * size;
                }
            }
        }
        for i in 0..S::LEN {
            self.doubts[0].as_mut_slice()[i] += ROUNDING * sizes.as_slice()[i];
            self.doubts[1].as_mut_slice()[i] += 2.0 * ROUNDING * slopes.as_slice()[i];
        }
    }

    /// All values of component `i` on a part of the step, and its rates by the part.
    #[inline]
    pub(crate) fn component(&self, i: usize, part: [f64; 2]) -> Rated {
        let [middle, radius] = [0.5 * (part[0] + part[1]), 0.5 * (part[1] - part[0])];
        let terms = match radius < 0.5 * SHORT {
            true => self.order + 1,
            false => (self.order + 1).min(CENTRED),
        };
        let mut powers = [0.0; LENGTH];
        for (power, coefficient) in powers.iter_mut().zip(&self.coefficients[..terms]) {
            *power = coefficient.as_slice()[i];
        }
        let powers = &mut powers[..terms];
        move_to(powers, middle);
        let (mut value, mut rate) = (Interval::point(0.0), Interval::point(0.0));
        let mut scale = 1.0;
        for (k, &power) in powers.iter().enumerate() {
            let slope = k as f64 * power * scale;
            if k > 0 {
                rate = with_term(rate, slope, k - 1);
                scale *= radius;
            }
            value = with_term(value, power * scale, k);
        }
        let (mut doubt, mut rate_doubt) =
            (self.doubts[0].as_slice()[i], self.doubts[1].as_slice()[i]);
        if terms <= self.order {
            doubt += self.tails[0].as_slice()[i];
            rate_doubt += self.tails[1].as_slice()[i];
        }
        Rated {
            value: value.widened(doubt),
            rate: rate.widened(rate_doubt),
        }
    }

    /// All values of component `i` on the whole step.
    #[inline]
    pub(crate) fn range(&self, i: usize) -> Interval {
        self.component(i, [0.0, 1.0]).value
    }

    /// All times on a part of the step.
    #[inline]
    pub(crate) fn time(&self, [from, to]: [f64; 2]) -> Rated {
        let length = Interval::point(self.length);
        Rated {
            value: Interval::point(self.start) + length * Interval::new(from, to),
            rate: length,
        }
    }
}

/// The interval with `term x^k` added, for `x` in `[-1, 1]`; sums round by less than the doubts hold.
#[inline(always)]
fn with_term(range: Interval, term: f64, k: usize) -> Interval {
    let size = term.abs();
    match (k, k % 2) {
        (0, _) => Interval::new(range.lo + term, range.hi + term),
        (_, 0) => Interval::new(range.lo + term.min(0.0), range.hi + term.max(0.0)),
        _ => Interval::new(range.lo - size, range.hi + size),
    }
}

/// Moves the centre of a polynomial: `p(middle + y)` in powers of `y`, by Horner's scheme.
#[inline(always)]
fn move_to(powers: &mut [f64], middle: f64) {
    let count = powers.len();
    for first in 0..count.saturating_sub(1) {
        for k in (first..count - 1).rev() {
            powers[k] += middle * powers[k + 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    type Scalar = SVector<f64, 1>;

    fn path(coefficients: &[f64]) -> Path<Scalar> {
        let mut path = Path::<Scalar>::new();
        path.length = 2.0;
        path.order = coefficients.len() - 1;
        for (to, from) in path.coefficients.iter_mut().zip(coefficients) {
            to[0] = *from;
        }
        path.add_rounding();
        path
    }

    #[test]
    fn values_and_rates_lie_in_their_intervals() {
        let long: [f64; 24] =
            core::array::from_fn(|k| (k % 5) as f64 * 0.4_f64.powi(k as i32) - 0.1);
        for coefficients in [&[1.0, -3.0, 2.5][..], &[0.0, 1.0], &[4.0], &long] {
            let path = path(coefficients);
            let at = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
            for start in 0..=16 {
                for width in [0.0, 1e-7, 0.05, 0.3, 1.0] {
                    let from = f64::from(start) / 16.0;
                    let to = (from + width).min(1.0);
                    let found = path.component(0, [from, to]);
                    for k in 0..=16 {
                        let x = (from + (to - from) * f64::from(k) / 16.0).min(to);
                        assert!(
                            found.value.contains(Interval::point(at(x))),
                            "{x}: {found:?}"
                        );
                        let chord = (at(x + 1e-5 * (1.0 - x)) - at(x)) / (1e-5 * (1.0 - x));
                        let is_inside = x < to - 1e-4;
                        assert!(
                            !is_inside || found.rate.widened(1e-9).contains(Interval::point(chord))
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn intervals_of_short_parts_are_as_narrow_as_their_squares() {
        let path = path(&[0.3, -1.0, 2.0, 0.5, -0.25, 0.1, 0.05, -0.02]);
        for width in [0.1, 1e-2, 1e-3] {
            let found = path.component(0, [0.4, 0.4 + width]);
            let slope = found.rate.magnitude();
            assert!(found.value.width() <= width * slope + 4.0 * width * width);
        }
    }
}
