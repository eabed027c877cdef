//! Gaps along a step that is a power series: polynomials themselves, whose signs are read from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull); no sample is taken of
//! a gap that is bounded away from zero. Roots are found on the polynomial and confirmed on the gap of the dense
//! output ([`confirm`](crate::events::locate::confirm)).
//!
//! Reference: G. Farin, *Curves and Surfaces for CAGD* (2002), chapter 5.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::integrate::{Series, Stepper};
use crate::jet::LENGTH;
use crate::state::StateVector;

/// Part of the sum of its terms that a polynomial may be wrong by and still be of use.
const USEFUL: f64 = 1.0 / (1 << 20) as f64;

/// Rounding of coefficients and of sums over them, in parts of the sum of terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The gaps of a step as polynomials in the part of the step.
pub(super) struct GapSeries<G> {
    coefficients: [G; LENGTH],
    order: usize,
    /// Sums of the absolute values of the terms above the fourth.
    tails: G,
    /// How wrong each polynomial may be: what it misses at the end of the step, and rounding.
    doubts: G,
}

impl<G: StateVector> GapSeries<G> {
    /// The polynomials of a step at whose end the gaps are `last`, if they are of use.
    #[inline(always)]
    pub(super) fn of<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        step: &StepView<'_, Sys, Step>,
        last: &G,
    ) -> Option<Self> {
        let Series {
            unit,
            order,
            coefficients,
        } = step.stepper.series()?;
        // NOTE: terms above the order stay zero.
        let mut gaps = [G::zeros(); LENGTH];
        let t = step.t_start();
        if !step
            .system
            .gap_series(t, unit, order, coefficients, &mut gaps)
        {
            return None;
        }
        let theta = step.length() / unit;
        let mut power = 1.0;
        let (mut sums, mut sizes, mut tails) = (G::zeros(), G::zeros(), G::zeros());
        for (k, gap) in gaps[..=order].iter_mut().enumerate() {
            if k == 5 {
                tails = sizes;
            }
            for i in 0..G::LEN {
                let term = gap.as_slice()[i] * power;
                gap.as_mut_slice()[i] = term;
                sums.as_mut_slice()[i] += term;
                sizes.as_mut_slice()[i] += term.abs();
            }
            power *= theta;
        }
        let mut doubts = G::zeros();
        for i in 0..G::LEN {
            let missed = (sums.as_slice()[i] - last.as_slice()[i]).abs();
            let size = sizes.as_slice()[i];
            let is_useful = missed <= USEFUL * size;
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
            tails,
            doubts,
        })
    }

    /// The gap of a surface at a part of the step.
    #[inline(always)]
    pub(super) fn at(&self, surface: usize, part: f64) -> f64 {
        let [gap] = self.at_each(surface, [part]);
        gap
    }

    /// The gap of a surface at several parts of the step, which do not wait for each other.
    #[inline(always)]
    pub(super) fn at_each<const N: usize>(&self, surface: usize, parts: [f64; N]) -> [f64; N] {
        let mut gaps = [0.0; N];
        for term in self.coefficients[..=self.order].iter().rev() {
            let term = term.as_slice()[surface];
            for (gap, part) in gaps.iter_mut().zip(parts) {
                *gap = *gap * part + term;
            }
        }
        gaps
    }

    /// Whether the gap of a surface keeps one sign over the step; apart from its start, where the surface is at hand
    /// there: the root is divided out. `false` means only that the coefficients do not show it.
    ///
    /// A step is a small part of the radius of convergence, so that a cubic is almost the whole gap: its Bernstein
    /// coefficients must exceed the sum of all other terms.
    #[inline(always)]
    pub(super) fn is_clear(&self, surface: usize, at_hand: bool) -> bool {
        let first = usize::from(at_hand);
        let at = |k: usize| self.coefficients[first + k].as_slice()[surface];
        let [a, b, c, d] = [at(0), at(1), at(2), at(3)];
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let (mut least, mut largest) = (a, a);
        for value in hull {
            least = least.min(value);
            largest = largest.max(value);
        }
        let mut rest = self.doubts.as_slice()[surface] + self.tails.as_slice()[surface];
        if !at_hand {
            rest += at(4).abs();
        }
        least > rest || largest < -rest
    }
}
