//! Gaps along a step that is a power series: they are polynomials, and their signs follow from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull), and show where a
//! root may lie. An enclosure of the gap itself must show that no other root exists: the truncated terms of the
//! series may hide one.
//!
//! Reference: G. Farin, *Curves and Surfaces for CAGD* (2002), chapter 5.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::{COUNT, FROM_POWERS, Signs, read};
use crate::integrate::{Series, Stepper};
use crate::jet::LENGTH;
use crate::math;
use crate::state::StateVector;

/// Relative error of a polynomial, beside the sum of the absolute values of its terms, up to which it is useful. Its
/// first terms must also make up most of the sum: otherwise the step is longer than the reach of the series.
const USEFUL: f64 = 1.0 / (1 << 20) as f64;

/// Rounding of coefficients and of sums over them, relative to the sum of the absolute values of the terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The gaps of a step as polynomials in the fraction of the step.
#[derive(Debug)]
pub(super) struct GapSeries<G> {
    pub(super) coefficients: [G; LENGTH],
    pub(super) order: usize,
    /// Sums of the absolute values of all terms, and of those above the fourth.
    pub(super) sizes: G,
    pub(super) tails: G,
    /// Error bound of each polynomial: its deviation at the end of the step, and rounding.
    pub(super) doubts: G,
    /// The gaps at the end of the step, and their slopes by the fraction of the step.
    pub(super) last: G,
    pub(super) slopes: G,
}

impl<G: StateVector> GapSeries<G> {
    /// The polynomials of a step that is a series, with the gaps `last` at its end, if they are useful.
    #[inline(always)]
    pub(super) fn of<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        step: &StepView<'_, Sys, Step>,
        last: &G,
    ) -> Option<Self> {
        let Series { unit, order } = step.stepper.series()?;
        // NOTE: terms above the order stay zero.
        let mut gaps = [last.zeroed(); LENGTH];
        let theta = step.length() / unit;
        let mut power = 1.0;
        let (mut sums, mut sizes, mut tails) = (last.zeroed(), last.zeroed(), last.zeroed());
        let mut slopes = last.zeroed();
        for (k, gap) in gaps[..=order].iter_mut().enumerate() {
            if k == 5 {
                tails = sizes;
            }
            let coefficient = step.stepper.gap_coefficient(k);
            for i in 0..last.count() {
                let term = coefficient[i] * power;
                gap.as_mut_slice()[i] = term;
                sums.as_mut_slice()[i] += term;
                sizes.as_mut_slice()[i] += term.abs();
                slopes.as_mut_slice()[i] += k as f64 * term;
            }
            power *= theta;
        }
        let mut doubts = last.zeroed();
        for i in 0..last.count() {
            let missed = (sums.as_slice()[i] - last.as_slice()[i]).abs();
            let size = sizes.as_slice()[i];
            let first = match order < 5 {
                true => size,
                false => tails.as_slice()[i],
            };
            let is_useful = missed <= USEFUL * size && size <= 2.0 * first;
            if !is_useful {
                return None;
            }
            doubts.as_mut_slice()[i] = 4.0 * missed + ROUNDING * size;
            tails.as_mut_slice()[i] = if order < 5 {
                0.0
            } else {
                size - tails.as_slice()[i]
            };
        }
        Some(Self {
            coefficients: gaps,
            order,
            sizes,
            tails,
            doubts,
            last: *last,
            slopes,
        })
    }

    /// The gap of a surface at a fraction of the step.
    #[inline(always)]
    pub(super) fn at(&self, surface: usize, part: f64) -> f64 {
        let terms = self.coefficients[..=self.order].iter().rev();
        terms.fold(0.0, |sum, term| {
            math::mul_add(sum, part, term.as_slice()[surface])
        })
    }

    /// True if the gap of a surface is positive at a fraction of the step, beyond its error.
    pub(super) fn is_positive(&self, surface: usize, part: f64) -> bool {
        self.at(surface, part) > self.doubts.as_slice()[surface]
    }

    /// The gap rates at the end of a step of this length.
    #[inline(always)]
    pub(super) fn last_rates(&self, length: f64) -> G {
        let mut rates = self.slopes;
        rates
            .as_mut_slice()
            .iter_mut()
            .for_each(|rate| *rate /= length);
        rates
    }

    /// Signs of the polynomial of a surface over the step, after division by a root at the start.
    ///
    /// A step is a small part of the radius of convergence, so a cubic is almost the whole gap: its Bernstein
    /// coefficients must exceed the sum of all other terms, or those of more terms the sum of the rest.
    #[inline(always)]
    pub(super) fn signs(&self, surface: usize, at_hand: bool) -> Signs {
        let first = usize::from(at_hand);
        let at = |k: usize| self.coefficients[first + k].as_slice()[surface];
        let [a, b, c, d] = [at(0), at(1), at(2), at(3)];
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let mut rest = self.doubts.as_slice()[surface] + self.tails.as_slice()[surface];
        if !at_hand {
            rest += at(4).abs();
        }
        match read(&hull, rest) {
            Signs::Unclear => self.signs_by_more(surface, at_hand, 1.0),
            signs => signs,
        }
    }

    /// Signs between the start of the step and a fraction of it, from more terms: the Bernstein coefficients of the
    /// first terms must exceed the sum of all others.
    #[inline(never)]
    pub(super) fn signs_by_more(&self, surface: usize, at_hand: bool, end: f64) -> Signs {
        let first = usize::from(at_hand);
        // NOTE: terms above the order are zero.
        let terms = &self.coefficients[first..=self.order.max(COUNT)];
        let mut doubt = self.doubts.as_slice()[surface];
        let mut behind = [0.0; COUNT - 1];
        let mut power = 1.0;
        for (term, weights) in terms.iter().zip(&FROM_POWERS) {
            let term = power * term.as_slice()[surface];
            for (entry, weight) in behind.iter_mut().zip(weights) {
                *entry = math::mul_add(*weight, term, *entry);
            }
            power *= end;
        }
        for term in &terms[COUNT..] {
            doubt += (power * term.as_slice()[surface]).abs();
            power *= end;
        }
        let mut coefficients = [terms[0].as_slice()[surface]; COUNT];
        coefficients[1..].copy_from_slice(&behind);
        read(&coefficients, doubt)
    }
}
