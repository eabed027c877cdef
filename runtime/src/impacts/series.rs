//! Gaps along a step that is a power series: polynomials themselves, whose signs are read from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull); no sample is taken of
//! a gap that they bound away from zero. Roots are found on the polynomial and confirmed on the gap of the dense
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
        let (mut sums, mut sizes) = (G::zeros(), G::zeros());
        for gap in &mut gaps[..=order] {
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
        }
        Some(Self {
            coefficients: gaps,
            order,
            doubts,
        })
    }

    /// The gap of a surface at a part of the step.
    #[inline(always)]
    pub(super) fn at(&self, surface: usize, part: f64) -> f64 {
        let terms = self.coefficients[..=self.order].iter().rev();
        terms.fold(0.0, |sum, term| sum * part + term.as_slice()[surface])
    }

    /// Whether the gap of a surface keeps one sign over the step; apart from its start, where the surface is at hand
    /// there. `false` means only that the coefficients do not show it.
    #[inline]
    pub(super) fn is_clear(&self, surface: usize, at_hand: bool) -> bool {
        let mut row = [0.0; LENGTH];
        let first = usize::from(at_hand);
        let degree = self.order - first;
        // b_j = sum_(k <= j) binomial(j, k) / binomial(n, k) a_k: divide, then add up along the rows of Pascal.
        let mut inverse = 1.0;
        let terms = &self.coefficients[first..=self.order];
        for (k, (entry, term)) in row.iter_mut().zip(terms).enumerate() {
            *entry = term.as_slice()[surface] * inverse;
            inverse *= (k + 1) as f64 / (degree - k).max(1) as f64;
        }
        let row = &mut row[..=degree];
        for from in 1..=degree {
            for j in (from..=degree).rev() {
                row[j] += row[j - 1];
            }
        }
        let (mut least, mut largest) = (row[0], row[0]);
        for &value in &*row {
            least = least.min(value);
            largest = largest.max(value);
        }
        let doubt = self.doubts.as_slice()[surface];
        least > doubt || largest < -doubt
    }
}
