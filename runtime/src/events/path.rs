//! The motion along a step: a polynomial in the fraction of the step for each component, and its Taylor models on parts
//! of the step.

use super::polynomials::{FEW, Polynomials, ROUNDING};
use crate::contract::System;
use crate::effects::StepView;
use crate::integrate::Stepper;
use crate::numbers::{Interval, Rated, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// The motion along a step.
#[derive(Debug, Clone)]
pub(crate) struct Path<S> {
    /// Time at the start of the step.
    start: f64,
    length: f64,
    polynomials: Polynomials<S>,
    /// Models of all components on the whole step.
    whole: Whole<S>,
    /// True for the dense output, false for the cubic through the ends.
    is_dense: bool,
    /// True if the error bounds are complete, and the models of the whole step are computed.
    is_enclosed: bool,
}

/// Models of all components, side by side.
#[derive(Debug, Clone)]
struct Whole<S> {
    powers: [S; 4],
    error: S,
    slope: S,
    /// Bounds of the second derivatives of the polynomials with respect to the fraction of the step.
    bend: S,
}

impl<S: StateVector> Path<S> {
    /// Path before the first step, for states with as many components as `like`.
    pub(crate) fn new(like: &S) -> Self {
        let zeros = like.zeroed();
        Self {
            start: 0.0,
            length: 0.0,
            polynomials: Polynomials::zero(like),
            whole: Whole {
                powers: [zeros; 4],
                error: zeros,
                slope: zeros,
                bend: zeros,
            },
            is_dense: false,
            is_enclosed: false,
        }
    }

    /// Path along polynomials with these coefficients.
    #[cfg(test)]
    pub(crate) fn of(coefficients: &[S], length: f64) -> Self {
        let mut path = Self::new(&coefficients[0]);
        path.length = length;
        path.polynomials.order = coefficients.len() - 1;
        path.polynomials.coefficients[..coefficients.len()].copy_from_slice(coefficients);
        path.enclose();
        path
    }

    /// Sets the path to a step: to its dense output if that is ready, otherwise to the cubic through its ends, with an
    /// error bound from the rates inside the step. If no rates inside are known, the dense output is prepared.
    ///
    /// # Errors
    /// The [`Fault`](crate::Fault) of the dense output.
    #[inline]
    pub(crate) fn follow<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        self.take(step)?;
        self.enclose();
        Ok(())
    }

    /// Same as [`Path::follow`], but the error bounds may be missing until [`Path::enclose`] completes them.
    ///
    /// # Errors
    /// The [`Fault`](crate::Fault) of the dense output.
    #[inline]
    pub(crate) fn take<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        if step.stepper.dense_ready() {
            self.take_dense(step);
            return Ok(());
        }
        match step.stepper.sway() {
            Some(sway) => self.take_ends(step, &sway),
            None => {
                step.prepare()?;
                self.take_dense(step);
            }
        }
        Ok(())
    }

    /// Completes the error bounds and computes the models of the whole step, if this is still to be done.
    #[inline]
    pub(crate) fn enclose(&mut self) {
        if !self.is_enclosed {
            self.add_rounding();
            self.is_enclosed = true;
        }
    }

    /// Prepares the dense output of the step and replaces the cubic by it. Returns true if the path changed; it must
    /// then be enclosed again.
    ///
    /// # Errors
    /// The [`Fault`](crate::Fault) of the dense output.
    pub(crate) fn refine<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<bool, Outcome> {
        step.prepare()?;
        let is_new = !self.is_dense;
        if is_new {
            self.take_dense(step);
        }
        Ok(is_new)
    }

    /// Sets the step to its dense output, which must be ready.
    pub(crate) fn follow_dense<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
    ) {
        self.take_dense(step);
        self.enclose();
    }

    fn take_dense<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
    ) {
        (self.start, self.length) = (step.t_start(), step.length());
        let Polynomials {
            coefficients,
            order,
            doubts,
            ..
        } = &mut self.polynomials;
        *order = step.stepper.powers(coefficients);
        *doubts = [coefficients[0].zeroed(); 2];
        (self.is_dense, self.is_enclosed) = (true, false);
    }

    /// Sets the path to the cubic through the ends of a step, with an error bound of `sway` for each component.
    pub(crate) fn take_ends<Sys: System<State = S>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
        sway: &S,
    ) {
        (self.start, self.length) = (step.t_start(), step.length());
        let (start, end, [first, last]) = (step.start(), step.end(), step.rates());
        sway.for_each_place(|i| {
            let at = |state: &S| state.padded()[i];
            let (first, last) = (self.length * at(first), self.length * at(last));
            let bend = at(end) - at(start) - first;
            let twist = 2.0 * bend - (last - first);
            let coefficients = &mut self.polynomials.coefficients;
            coefficients[0].padded_mut()[i] = at(start);
            coefficients[1].padded_mut()[i] = first;
            coefficients[2].padded_mut()[i] = bend + twist;
            coefficients[3].padded_mut()[i] = -twist;
        });
        self.polynomials.order = 3;
        self.polynomials.doubts = [*sway; 2];
        // NOTE: enclosed immediately, because the order is a compile-time constant here.
        self.add_rounding();
        (self.is_dense, self.is_enclosed) = (false, true);
    }

    /// Adds the rounding errors of the coefficients to the error bounds, sums the terms that are not centred, and
    /// builds the models of the whole step.
    #[inline(always)]
    fn add_rounding(&mut self) {
        let sums = self.polynomials.sum();
        for (of, rounding) in [ROUNDING, 2.0 * ROUNDING].into_iter().enumerate() {
            let sum = sums[of].padded();
            let doubts = self.polynomials.doubts[of].padded_mut();
            sums[of].for_each_place(|i| doubts[i] += rounding * sum[i]);
        }
        match self.polynomials.order < 4 {
            true => self.fill_whole::<4>(),
            false => self.fill_whole::<FEW>(),
        }
    }

    /// Computes [`Path::component`] of the whole step for all components at once, with the first `COUNT` terms
    /// centred.
    #[inline]
    fn fill_whole<const COUNT: usize>(&mut self) {
        let zeros = self.polynomials.coefficients[0].zeroed();
        let mut powers = [zeros; COUNT];
        let Polynomials { doubts, tails, .. } = &self.polynomials;
        let coefficients = self.polynomials.terms();
        let terms = coefficients.len().min(COUNT);
        powers[..terms].copy_from_slice(&coefficients[..terms]);
        for first in 0..COUNT.saturating_sub(1) {
            for k in (first..COUNT - 1).rev() {
                let above = powers[k + 1];
                let power = powers[k].padded_mut();
                above.for_each_place(|i| power[i] += 0.5 * above.padded()[i]);
            }
        }
        let Whole {
            powers: cubic,
            error,
            slope,
            bend,
        } = &mut self.whole;
        let last = self.polynomials.order as f64 - 1.0;
        zeros.for_each_place(|i| {
            let mut scale = 1.0;
            let (mut beyond, mut steep, mut bent) = (0.0, 0.0, 0.0);
            for (k, power) in powers.iter().enumerate() {
                let term = scale * power.padded()[i];
                match k < 4 {
                    true => cubic[k].padded_mut()[i] = term,
                    false => {
                        beyond += term.abs();
                        steep += k as f64 * term.abs();
                    }
                }
                bent += (k * k.saturating_sub(1)) as f64 * term.abs();
                scale *= 0.5;
            }
            bend.padded_mut()[i] = 4.0 * bent + last * tails[1].padded()[i];
            error.padded_mut()[i] = beyond + tails[0].padded()[i] + doubts[0].padded()[i];
            slope.padded_mut()[i] = steep + 0.5 * (tails[1].padded()[i] + doubts[1].padded()[i]);
        });
    }

    /// Taylor model of component `i` on a part of the step.
    #[inline]
    pub(crate) fn component(&self, i: usize, part: [f64; 2]) -> TaylorModel {
        debug_assert!(self.is_enclosed, "the path has no error bounds yet");
        match part {
            [0.0, 1.0] => TaylorModel {
                error: self.whole.error.as_slice()[i],
                slope: self.whole.slope.as_slice()[i],
                ..TaylorModel::exact(core::array::from_fn(|k| self.whole.powers[k].as_slice()[i]))
            },
            _ => self.polynomials.on(i, part),
        }
    }

    /// Enclosures of component `i` and of its derivative with respect to the fraction of the step, on a part of the
    /// step. The part has positive length.
    pub(crate) fn rated(&self, i: usize, part: [f64; 2]) -> Rated {
        let model = self.component(i, part);
        let radius = Interval::point(0.5 * (part[1] - part[0]));
        Rated {
            value: model.range(),
            rate: model.rates() * radius.inverse(),
        }
    }

    /// Bounds of the first and second derivative of component `i` on the whole step, with respect to its fraction `s`.
    ///
    /// Path and polynomial agree at both ends of the step. If their rates differ by at most `d`, their values differ by
    /// at most `d min(s, 1 - s) <= 4 d s (1 - s)/2`. The difference therefore counts as a second derivative of `4 d`.
    #[inline]
    pub(crate) fn motion(&self, i: usize) -> [f64; 2] {
        debug_assert!(self.is_enclosed, "the path has no error bounds yet");
        let Whole {
            powers,
            slope,
            bend,
            ..
        } = &self.whole;
        let at = |values: &S| values.as_slice()[i];
        let steepness =
            at(&powers[1]).abs() + 2.0 * at(&powers[2]).abs() + 3.0 * at(&powers[3]).abs();
        [
            2.0 * (steepness + at(slope)),
            at(bend) + 4.0 * at(&self.polynomials.doubts[1]),
        ]
    }

    /// The coefficients of the polynomials, by power.
    #[inline]
    pub(crate) fn coefficients(&self) -> &[S] {
        self.polynomials.terms()
    }

    /// Component `i` at the start of the step.
    #[inline]
    pub(crate) fn value(&self, i: usize) -> Interval {
        Interval::point(self.polynomials.coefficients[0].as_slice()[i])
    }

    /// Length of the step.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Value of the polynomial of component `i` at a fraction of the step.
    pub(crate) fn at(&self, i: usize, part: f64) -> f64 {
        self.polynomials.at(i, part)
    }

    /// Enclosure of component `i` on the whole step.
    #[inline]
    pub(crate) fn range(&self, i: usize) -> Interval {
        self.component(i, [0.0, 1.0]).range()
    }

    /// Enclosures of the times on a part of the step, and of their derivative with respect to the fraction.
    #[inline]
    pub(crate) fn time(&self, [from, to]: [f64; 2]) -> Rated {
        let length = Interval::point(self.length);
        Rated {
            value: Interval::point(self.start) + length * Interval::new(from, to),
            rate: length,
        }
    }

    /// Taylor model of the time on a part of the step.
    #[inline]
    pub(crate) fn time_model(&self, [from, to]: [f64; 2]) -> TaylorModel {
        let (middle, radius) = (0.5 * (from + to), 0.5 * (to - from));
        let centre = self.start + self.length * middle;
        let change = self.length * radius;
        TaylorModel {
            error: ROUNDING * (self.start.abs() + centre.abs() + self.length),
            slope: ROUNDING * change,
            ..TaylorModel::exact([centre, change, 0.0, 0.0])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jet::LENGTH;
    use nalgebra::SVector;

    type Scalar = SVector<f64, 1>;

    fn path(coefficients: &[f64]) -> Path<Scalar> {
        let mut terms = [Scalar::zeros(); LENGTH];
        for (to, &from) in terms.iter_mut().zip(coefficients) {
            to[0] = from;
        }
        Path::of(&terms[..coefficients.len()], 2.0)
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
                    if to <= from {
                        continue;
                    }
                    let found = path.rated(0, [from, to]);
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
            let found = path.rated(0, [0.4, 0.4 + width]);
            let slope = found.rate.magnitude();
            assert!(found.value.width() <= width * slope + 4.0 * width * width);
        }
    }
}
