//! Gaps along a step that is a power series: polynomials themselves, whose signs are read from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull); no sample is taken of
//! a gap that is bounded away from zero. Roots are found on the polynomial, and corrected by one evaluation of the gap of
//! the dense output ([`GapSeries::fall`]).
//!
//! Reference: G. Farin, *Curves and Surfaces for CAGD* (2002), chapter 5.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::locate::Bracket;
use crate::integrate::{Series, Stepper};
use crate::jet::LENGTH;
use crate::state::StateVector;

/// Part of the sum of its terms that a polynomial may be wrong by and still be of use.
const USEFUL: f64 = 1.0 / (1 << 20) as f64;

/// Steps of Newton's method, which doubles the number of right digits in each.
const NEWTON: u32 = 12;

/// A step of it this small a part of the root is the last one: what is left of the error is its square.
const SETTLED: f64 = 1.0 / (1 << 26) as f64;

/// A root is certain if what rounding leaves of doubt is this small a part of the interval it was found in.
const CLOSE: f64 = 1.0 / (1 << 10) as f64;

/// Rounding of coefficients and of sums over them, in parts of the sum of terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The gaps of a step as polynomials in the part of the step.
pub(super) struct GapSeries<G> {
    coefficients: [G; LENGTH],
    order: usize,
    /// Sums of the absolute values of all terms, and of those above the fourth.
    sizes: G,
    tails: G,
    /// How wrong each polynomial may be: what it misses at the end of the step, and rounding.
    doubts: G,
    /// The slopes at the end of the step, by the part of the step.
    slopes: G,
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
        let mut slopes = G::zeros();
        for (k, gap) in gaps[..=order].iter_mut().enumerate() {
            if k == 5 {
                tails = sizes;
            }
            for i in 0..G::LEN {
                let term = gap.as_slice()[i] * power;
                gap.as_mut_slice()[i] = term;
                sums.as_mut_slice()[i] += term;
                sizes.as_mut_slice()[i] += term.abs();
                slopes.as_mut_slice()[i] += k as f64 * term;
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
            sizes,
            tails,
            doubts,
            slopes,
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

    /// The fall of the gap of a surface in an interval at whose ends the polynomial has different signs: Newton's method
    /// on the polynomial, a root at the start divided out, and one step of it on the gap itself. `None` where that does
    /// not end at once, or the gap is not what the polynomial says.
    pub(super) fn fall(
        &self,
        surface: usize,
        at_hand: bool,
        [mut before, mut after]: [f64; 2],
        gap: impl FnOnce(f64) -> f64,
    ) -> Option<Bracket> {
        let width = after - before;
        let mut part = 0.5 * (before + after);
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            let [value, slope] = self.with_slope(surface, usize::from(at_hand), part);
            if value >= 0.0 {
                before = part;
            } else {
                after = part;
            }
            let next = part - value / slope;
            // Not a comparison that NaN passes.
            let next = if next >= before && next <= after {
                next
            } else {
                0.5 * (before + after)
            };
            last = (next - part).abs();
            part = next;
            if last <= SETTLED * part {
                break;
            }
        }
        if last > SETTLED * part {
            return None;
        }
        let [_, slope] = self.with_slope(surface, 0, part);
        let (size, doubt) = (
            self.sizes.as_slice()[surface],
            self.doubts.as_slice()[surface],
        );
        let missed = gap(part);
        let root = part - missed / slope;
        // What neighbouring numbers and rounding cannot tell apart.
        let margin = 8.0 * f64::EPSILON * (root + size / slope.abs());
        let is_plain = missed.abs() <= doubt && slope < 0.0 && margin <= CLOSE * width;
        (is_plain && root > margin && root + margin < 1.0).then_some(Bracket {
            before: root - margin,
            after: root + margin,
            nearest: root,
        })
    }

    /// The polynomial of a surface without its first terms, and its slope.
    #[inline(always)]
    fn with_slope(&self, surface: usize, first: usize, part: f64) -> [f64; 2] {
        let (mut value, mut slope) = (0.0, 0.0);
        for term in self.coefficients[first..=self.order].iter().rev() {
            slope = slope * part + value;
            value = value * part + term.as_slice()[surface];
        }
        [value, slope]
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

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;

    type One = SVector<f64, 1>;

    /// The series of a polynomial that may be wrong by `doubt`.
    fn series(terms: &[f64], doubt: f64) -> GapSeries<One> {
        let mut coefficients = [One::zeros(); LENGTH];
        for (entry, term) in coefficients.iter_mut().zip(terms) {
            entry[0] = *term;
        }
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        GapSeries {
            coefficients,
            order: terms.len() - 1,
            sizes: One::new(size),
            tails: One::zeros(),
            doubts: One::new(doubt),
            slopes: One::zeros(),
        }
    }

    #[test]
    fn a_fall_is_that_of_the_gap_and_not_of_the_polynomial() {
        // The gap is a little larger than the polynomial, 0.3 - x^2.
        let more = 1e-12;
        let gap = |x: f64| 0.3 + more - x * x;
        let fall = series(&[0.3, 0.0, -1.0], 1e-11).fall(0, false, [0.4, 0.7], gap);
        let Some(Bracket {
            before,
            after,
            nearest,
        }) = fall
        else {
            panic!("{fall:?}")
        };
        let root = (0.3 + more).sqrt();
        assert!(
            (nearest - root).abs() <= 4.0 * f64::EPSILON,
            "{nearest} for {root}"
        );
        assert!(before < nearest && nearest < after && gap(before) > 0.0 && gap(after) < 0.0);
        assert!(after - before < 1e-13, "{before} to {after}");
    }

    #[test]
    fn the_root_at_the_start_is_divided_out() {
        for root in [0.9, 1e-3] {
            let gap = |x: f64| x * (root - x);
            let fall = series(&[0.0, root, -1.0], 1e-15).fall(0, true, [0.0, 1.0], gap);
            let nearest = fall.map_or(f64::NAN, |fall| fall.nearest);
            assert!(
                (nearest - root).abs() <= 4.0 * f64::EPSILON * root,
                "{fall:?}"
            );
        }
    }

    #[test]
    fn doubtful_falls_are_left_to_the_gap_itself() {
        // It is not what the polynomial says; it touches; it rises.
        let falling = series(&[0.5, -1.0], 1e-12);
        assert_eq!(falling.fall(0, false, [0.0, 1.0], |_| 1e-11), None);
        let touching = series(&[0.25, -1.0, 1.0], 1e-12);
        assert_eq!(touching.fall(0, false, [0.0, 1.0], |_| 0.0), None);
        let rising = series(&[-0.5, 1.0], 1e-12);
        assert_eq!(rising.fall(0, false, [0.0, 1.0], |_| 0.0), None);
    }
}
