//! Gaps along a step that is a power series: polynomials themselves, whose signs are read from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull); no sample is taken of
//! a gap that is bounded away from zero. Roots are found on the polynomial, and corrected by one evaluation of the gap of
//! the dense output ([`GapSeries::fall`]).
//!
//! Reference: G. Farin, *Curves and Surfaces for CAGD* (2002), chapter 5.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::{FROM_POWERS, NODES, SAMPLES, Signs, read};
use crate::events::locate::Bracket;
use crate::integrate::{Series, Stepper};
use crate::jet::LENGTH;
use crate::math;
use crate::state::StateVector;

/// Part of the sum of its terms that a polynomial may be wrong by and still be of use.
const USEFUL: f64 = 1.0 / (1 << 7) as f64;

/// Steps of Halley's method, which triples the number of right digits in each.
const HALLEY: u32 = 10;

/// A step of it this small a part of the root is the last one: what is left of the error is its cube.
const SETTLED: f64 = 1.0 / (1 << 18) as f64;

/// Evaluations of the gap itself next to a root of its polynomial.
const SECANTS: u32 = 6;

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
    /// The gaps at the end of the step, and their slopes by the part of the step.
    last: G,
    slopes: G,
}

impl<G: StateVector> GapSeries<G> {
    /// The polynomials of a step that is a series, at whose end the gaps are `last`, if they are of use.
    #[inline(always)]
    pub(super) fn of<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        step: &StepView<'_, Sys, Step>,
        last: &G,
    ) -> Option<Self> {
        let Series { unit, order } = step.stepper.series()?;
        // NOTE: terms above the order stay zero.
        let mut gaps = [G::zeros(); LENGTH];
        for (k, gap) in gaps[..=order].iter_mut().enumerate() {
            gap.as_mut_slice()
                .copy_from_slice(step.stepper.gap_coefficient(k));
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
            last: *last,
            slopes,
        })
    }

    /// The gap of a surface at a part of the step.
    #[inline(always)]
    pub(super) fn at(&self, surface: usize, part: f64) -> f64 {
        let [gap] = self.at_each(surface, [part]);
        gap
    }

    /// Samples of the gap of a surface; that at the end of the step is the gap itself.
    pub(super) fn samples(&self, surface: usize) -> [f64; SAMPLES] {
        let mut gaps = self.at_each(surface, NODES);
        gaps[SAMPLES - 1] = self.last.as_slice()[surface];
        gaps
    }

    /// Whether the gap of a surface is positive at a part of the step, beyond doubt.
    pub(super) fn is_positive(&self, surface: usize, part: f64) -> bool {
        self.at(surface, part) > self.doubts.as_slice()[surface]
    }

    /// The gap of a surface at several parts of the step, which do not wait for each other.
    #[inline(always)]
    fn at_each<const N: usize>(&self, surface: usize, parts: [f64; N]) -> [f64; N] {
        let mut gaps = [0.0; N];
        for term in self.coefficients[..=self.order].iter().rev() {
            let term = term.as_slice()[surface];
            for (gap, part) in gaps.iter_mut().zip(parts) {
                *gap = math::mul_add(*gap, part, term);
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

    /// The signs of the polynomial of a surface over the step, a root at the start divided out.
    pub(super) fn signs(&self, surface: usize, at_hand: bool) -> Signs {
        let (coefficients, doubt) = self.bernstein(surface, at_hand);
        read(&coefficients, doubt)
    }

    /// The Bernstein coefficients of the first terms of a polynomial, a root at the start divided out, and the sum of all
    /// others.
    #[inline(always)]
    fn bernstein(&self, surface: usize, at_hand: bool) -> ([f64; SAMPLES], f64) {
        let first = usize::from(at_hand);
        let term = |k: usize| self.coefficients[first + k].as_slice()[surface];
        let mut doubt = self.doubts.as_slice()[surface];
        // NOTE: terms above the order are zero.
        for k in SAMPLES..=self.order.max(SAMPLES) - first {
            doubt += term(k).abs();
        }
        let mut coefficients = [term(0); SAMPLES];
        for (k, weights) in FROM_POWERS.iter().enumerate().skip(1) {
            let term = term(k);
            for (entry, weight) in coefficients.iter_mut().zip(weights) {
                *entry = math::mul_add(*weight, term, *entry);
            }
        }
        (coefficients, doubt)
    }

    /// The fall of the gap of a surface in an interval at whose ends the polynomial has different signs: Halley's method
    /// on the polynomial, a root at the start divided out, and a step or two on the gap itself. `None` where that
    /// does not end soon, or the gap is not what the polynomial says.
    pub(super) fn fall(
        &self,
        surface: usize,
        at_hand: bool,
        [mut before, mut after]: [f64; 2],
        gap: impl FnMut(f64) -> f64,
    ) -> Option<Bracket> {
        let width = after - before;
        let mut part = self.guess(surface, at_hand, [before, after]);
        let (mut last, mut steepness) = (f64::INFINITY, 0.0);
        for _ in 0..HALLEY {
            let [value, slope, bend] = self.derivatives(surface, usize::from(at_hand), part);
            if value >= 0.0 {
                before = part;
            } else {
                after = part;
            }
            let newton = value / slope;
            let next = part - newton / (1.0 - newton * bend / slope);
            // Not a comparison that NaN passes.
            let next = if next >= before && next <= after {
                next
            } else {
                0.5 * (before + after)
            };
            last = (next - part).abs();
            steepness = slope + 2.0 * bend * (next - part);
            part = next;
            if last <= SETTLED * part {
                break;
            }
        }
        if last > SETTLED * part {
            return None;
        }
        let slope = if at_hand { part * steepness } else { steepness };
        let (size, doubt) = (
            self.sizes.as_slice()[surface],
            self.doubts.as_slice()[surface],
        );
        // What neighbouring numbers and rounding cannot tell apart.
        let margin = 8.0 * f64::EPSILON * (part + size / slope.abs());
        let root = self.corrected([part, slope], doubt, margin, gap)?;
        let is_plain = margin <= CLOSE * width && root > margin && root + margin < 1.0;
        is_plain.then_some(Bracket {
            before: root - margin,
            after: root + margin,
            nearest: root,
        })
    }

    /// The root of the gap itself, next to a root of its polynomial with this slope: Newton's step, then secants. One
    /// evaluation is enough where the polynomial misses little; `None` where it misses more than it may.
    fn corrected(
        &self,
        [mut part, mut slope]: [f64; 2],
        doubt: f64,
        margin: f64,
        mut gap: impl FnMut(f64) -> f64,
    ) -> Option<f64> {
        let mut value = gap(part);
        if !(value.abs() <= doubt && slope < 0.0) {
            return None;
        }
        let degree = self.order as f64;
        let mut before = None;
        for _ in 0..SECANTS {
            let next = part - value / slope;
            let step = (next - part).abs();
            // The slope is off by as much as the gap bends between here and the point before; at first, by what a last
            // term that explains the miss would add to it.
            let left = degree * step * before.unwrap_or(step);
            if left <= margin * part {
                return Some(next);
            }
            let (last, missed) = (part, value);
            (part, value) = (next, gap(next));
            slope = (value - missed) / (part - last);
            if !(slope < 0.0 && value.abs() < missed.abs()) {
                return None;
            }
            before = Some(step);
        }
        None
    }

    /// About where the polynomial of a surface falls in an interval: over the whole step, where the parabola falls that
    /// has its start, its slope there and its end.
    #[inline(always)]
    fn guess(&self, surface: usize, at_hand: bool, [before, after]: [f64; 2]) -> f64 {
        let middle = 0.5 * (before + after);
        if before > 0.0 || after < 1.0 {
            return middle;
        }
        let first = usize::from(at_hand);
        let [a, b] = [0, 1].map(|k| self.coefficients[first + k].as_slice()[surface]);
        let end = self.last.as_slice()[surface];
        let root = math::sqrt((b * b - 4.0 * a * (end - a - b)).max(0.0));
        // The quotient that does not cancel.
        let part = match b <= 0.0 {
            true => 2.0 * a / (root - b),
            false => -0.5 * (b + root) / (end - a - b),
        };
        match part > 0.0 && part < 1.0 {
            true => part,
            false => middle,
        }
    }

    /// The polynomial of a surface without its first terms, its slope, and half of its second derivative.
    #[inline(always)]
    fn derivatives(&self, surface: usize, first: usize, part: f64) -> [f64; 3] {
        let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
        for term in self.coefficients[first..=self.order].iter().rev() {
            bend = math::mul_add(bend, part, slope);
            slope = math::mul_add(slope, part, value);
            value = math::mul_add(value, part, term.as_slice()[surface]);
        }
        [value, slope, bend]
    }

    /// Whether the gap of a surface keeps one sign over the step; apart from its start, where the surface is at hand
    /// there: the root is divided out. `false` means only that the coefficients do not show it.
    ///
    /// A step is a small part of the radius of convergence, so that a cubic is almost the whole gap: its Bernstein
    /// coefficients must exceed the sum of all other terms, or else those of more terms the sum of the rest.
    #[inline(always)]
    pub(super) fn is_clear(&self, surface: usize, at_hand: bool) -> bool {
        let first = usize::from(at_hand);
        let at = |k: usize| self.coefficients[first + k].as_slice()[surface];
        let [a, b, c, d] = [at(0), at(1), at(2), at(3)];
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let mut rest = self.doubts.as_slice()[surface] + self.tails.as_slice()[surface];
        if !at_hand {
            rest += at(4).abs();
        }
        if exceed(&hull, rest) {
            return true;
        }
        let (coefficients, rest) = self.bernstein(surface, at_hand);
        exceed(&coefficients, rest)
    }
}

/// Whether all values are above a bound, or all below minus it.
#[inline(always)]
fn exceed(values: &[f64], bound: f64) -> bool {
    let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values {
        least = least.min(*value);
        largest = largest.max(*value);
    }
    least > bound || largest < -bound
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
            last: One::new(terms.iter().sum()),
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
