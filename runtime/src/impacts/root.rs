//! The fall of one gap, from its polynomial along a step. Evaluations of the gap on the dense output correct the root.

use super::series::GapSeries;
use crate::events::crossing::Signs;
use crate::events::locate::Bracket;
use crate::math;
use crate::state::StateVector;

/// Maximum number of steps of Chebyshev's method. Each triples the number of correct digits.
const STEPS: u32 = 10;

/// Relative size of a step after which at most one more follows: the remaining error is about its cube.
const SETTLED: f64 = 1.0 / (1 << 18) as f64;

/// Number of first iterations that use the leading terms of a polynomial only, and number of these terms.
const GUESSES: u32 = 2;
const FIRST_TERMS: usize = 8;

/// The proof of a single first fall extends to this multiple of the estimated root.
const BEHIND: f64 = 1.25;

/// Maximum number of evaluations of the gap itself near a root of its polynomial.
const SECANTS: u32 = 6;

/// A root is accepted if its uncertainty from rounding is below this fraction of the bracket.
const CLOSE: f64 = 1.0 / (1 << 10) as f64;

/// The polynomial of a surface's gap, after division by a root at the start of the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polynomial<'a, G: StateVector> {
    series: &'a GapSeries<G>,
    surface: usize,
    /// True if there is a root at the start.
    at_hand: bool,
    /// Terms of the polynomial, without zeros at the end.
    terms: &'a [G],
}

impl<'a, G: StateVector> Polynomial<'a, G> {
    /// The polynomial of this surface. `at_hand` is true if the gap is 0 at the start of the step.
    pub(super) fn new(series: &'a GapSeries<G>, surface: usize, at_hand: bool) -> Self {
        let first = usize::from(at_hand);
        let known = &series.polynomials;
        let terms = &known.coefficients[first..=known.order.max(first)];
        let is_zero = |term: &G| term.as_slice()[surface] == 0.0;
        let vanishing = terms.iter().rev().take_while(|term| is_zero(term)).count();
        Self {
            series,
            surface,
            at_hand,
            terms: &terms[..terms.len() - vanishing],
        }
    }

    /// A fraction of the step up to which the polynomial provably has one fall and no other root; `None` if no such
    /// fraction is found.
    pub(super) fn first_fall(&self) -> Option<f64> {
        let end = (BEHIND * self.guess([0.0, 1.0])).min(1.0);
        let signs = self.series.signs_by_more(self.surface, self.at_hand, end);
        (signs == Signs::Falls).then_some(end)
    }

    /// The fall of the gap in a bracket in which the polynomial has a fall and no other root, by Chebyshev's method on
    /// the polynomial, with the gap itself in the last step. `None` if the method does not converge soon, if the gap
    /// differs from the polynomial, or if rounding leaves the root too uncertain. The second value is true if the gap
    /// provably has no other root in the bracket.
    pub(super) fn fall(
        &self,
        [mut before, mut after]: [f64; 2],
        gap: impl FnMut(f64) -> f64,
    ) -> Option<(Bracket, bool)> {
        let width = after - before;
        let mut near = self.near(self.terms, self.guess([before, after]));
        let mut steps = 0..STEPS;
        let mut root = loop {
            steps.next()?;
            if near.value >= 0.0 {
                before = near.part;
            } else {
                after = near.part;
            }
            let root = near.root(near.value);
            // In this form NaN fails the comparison.
            let is_inside = root >= before && root <= after;
            if is_inside && (root - near.part).abs() <= SETTLED * root {
                break root;
            }
            let middle = 0.5 * (before + after);
            near = self.near(self.terms, if is_inside { root } else { middle });
        };
        if !self.is_next(&near, root) {
            near = self.near(self.terms, root);
            root = near.root(near.value);
        }
        let size = self.series.sizes.as_slice()[self.surface];
        // Distance from the root within which rounding decides the sign of the gap.
        let margin = 8.0 * f64::EPSILON * (root + size / self.slope(&near, root).abs());
        let is_only = self.falls_through(near.slope + 2.0 * near.bend * (root - near.part));
        let root = self.corrected(&near, root, margin, gap)?;
        let is_plain = margin <= CLOSE * width && root > margin && root + margin < 1.0;
        let bracket = Bracket {
            before: root - margin,
            after: root + margin,
            nearest: root,
        };
        is_plain.then_some((bracket, is_only))
    }

    /// True if the gap certainly falls once near the root of the polynomial. `slope` is the slope of the polynomial
    /// there.
    ///
    /// The gap has roots only where the polynomial is within its error `d` of zero. Within `4 d / |slope|` of the root,
    /// the slope must change by at most half. The polynomial then exceeds `d` outside. Inside, half of the slope must
    /// exceed the error of the derivative.
    #[inline(always)]
    fn falls_through(&self, slope: f64) -> bool {
        let doubt = self.series.doubt(self.surface, self.at_hand);
        let drift = self.series.drift(self.surface);
        let sizes = self.terms.iter().enumerate();
        let bend = sizes.fold(0.0, |sum, (k, term)| {
            sum + (k * k.saturating_sub(1)) as f64 * term.as_slice()[self.surface].abs()
        });
        slope < 0.0 && 8.0 * bend * doubt <= slope * slope && -0.5 * slope > drift
    }

    /// True if the step to `root` leaves no error above rounding. The error of the step itself is about twice the
    /// step times the square of the relative change of the slope. The slope of the gap differs from that of the
    /// polynomial by at most the slope of a last term as large as the polynomial's error.
    #[inline(always)]
    fn is_next(&self, near: &Near, root: f64) -> bool {
        let step = (root - near.part).abs();
        let share = step * near.bend;
        let size = self.series.sizes.as_slice()[self.surface];
        let doubt = self.series.doubt(self.surface, self.at_hand);
        let degree = self.series.polynomials.order as f64;
        2.0 * step * share * share <= f64::EPSILON * root * near.slope * near.slope
            && degree * doubt * step <= f64::EPSILON * root * size
    }

    /// The root of the gap itself, near the root `root` of its polynomial: the same step with the value of the gap,
    /// then secant steps. One evaluation suffices if the error of the polynomial is small. `None` if that error exceeds
    /// its bound, or if the secant steps do not converge.
    fn corrected(
        &self,
        near: &Near,
        root: f64,
        margin: f64,
        mut gap: impl FnMut(f64) -> f64,
    ) -> Option<f64> {
        let mut part = near.part;
        let mut value = gap(part);
        let divisor = if self.at_hand { part } else { 1.0 };
        let missed = (value - divisor * near.value).abs();
        let is_said = missed <= self.series.doubt(self.surface, false);
        if !(is_said && self.slope(near, root) < 0.0) {
            return None;
        }
        let mut next = near.root(value / divisor);
        let degree = self.series.polynomials.order as f64;
        // `apart` measures the error of the slope: at first the distance between the roots of gap and polynomial, then
        // the distance of the last two points.
        let mut apart = (next - root).abs();
        let mut step = apart.max((next - part).abs());
        for _ in 0..SECANTS {
            if degree * apart * step <= 0.25 * margin * part {
                return Some(next);
            }
            let (last, missed) = (part, value);
            (part, value) = (next, gap(next));
            let slope = (value - missed) / (part - last);
            if !(slope < 0.0 && value.abs() < missed.abs()) {
                return None;
            }
            apart = (part - last).abs();
            next = part - value / slope;
            step = (next - part).abs();
        }
        None
    }

    /// Estimate of the fall of the polynomial in a bracket. It starts at the fall of the parabola with the same values
    /// at both ends of the step and the same slope at the start, and iterates on the leading terms.
    #[inline(always)]
    fn guess(&self, [before, after]: [f64; 2]) -> f64 {
        let middle = 0.5 * (before + after);
        let inside = |part: f64| match part > before && part < after {
            true => part,
            false => middle,
        };
        let first = usize::from(self.at_hand);
        let [a, b] = [0, 1]
            .map(|k| self.series.polynomials.coefficients[first + k].as_slice()[self.surface]);
        let end = self.series.last.as_slice()[self.surface];
        let root = math::sqrt((b * b - 4.0 * a * (end - a - b)).max(0.0));
        // This form of the quotient avoids cancellation.
        let mut part = inside(match b <= 0.0 {
            true => 2.0 * a / (root - b),
            false => -0.5 * (b + root) / (end - a - b),
        });
        if let Some(terms) = self.terms.get(..FIRST_TERMS) {
            for _ in 0..GUESSES {
                let near = self.near(terms, part);
                part = inside(near.root(near.value));
            }
        }
        part
    }

    /// Value and derivatives of these terms at a fraction of the step.
    ///
    /// Even and odd powers are summed side by side, which shortens the chain of dependent additions.
    #[inline(always)]
    fn near(&self, terms: &[G], part: f64) -> Near {
        let square = part * part;
        let (mut values, mut slopes, mut bends) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let (pairs, rest) = terms.as_chunks::<2>();
        if let Some(last) = rest.first() {
            values[0] = last.as_slice()[self.surface];
        }
        for pair in pairs.iter().rev() {
            for i in 0..2 {
                let term = pair[i].as_slice()[self.surface];
                bends[i] = math::mul_add(bends[i], square, slopes[i]);
                slopes[i] = math::mul_add(slopes[i], square, values[i]);
                values[i] = math::mul_add(values[i], square, term);
            }
        }
        // Derivatives of `E(part^2) + part O(part^2)` with respect to `part`.
        let [even, odd] = slopes;
        Near {
            part,
            value: math::mul_add(part, values[1], values[0]),
            slope: values[1] + 2.0 * part * math::mul_add(part, odd, even),
            bend: even + 3.0 * part * odd + 4.0 * square * math::mul_add(part, bends[1], bends[0]),
        }
    }

    /// The slope of the gap at a nearby root.
    #[inline(always)]
    fn slope(&self, near: &Near, root: f64) -> f64 {
        let slope = near.slope + 2.0 * near.bend * (root - near.part);
        if self.at_hand { root * slope } else { slope }
    }
}

/// A function at a fraction of a step: its value, its slope, and half of its second derivative.
#[derive(Debug, Clone, Copy)]
struct Near {
    part: f64,
    value: f64,
    slope: f64,
    bend: f64,
}

impl Near {
    /// Target of Chebyshev's step for this value.
    #[inline(always)]
    fn root(&self, value: f64) -> f64 {
        let inverse = 1.0 / self.slope;
        let newton = value * inverse;
        self.part - newton * (1.0 + newton * self.bend * inverse)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;
    use crate::events::polynomials::Polynomials;
    use crate::per_surface::PerSurface;

    type One = SVector<f64, 1>;

    /// The series of a polynomial with an error of at most `doubt`.
    fn series(terms: &[f64], doubt: f64) -> GapSeries<One> {
        let mut polynomials = Polynomials::zero(&One::zeros());
        for (entry, term) in polynomials.coefficients.iter_mut().zip(terms) {
            entry[0] = *term;
        }
        polynomials.order = terms.len() - 1;
        polynomials.doubts = [One::new(doubt); 2];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        GapSeries {
            polynomials,
            floors: One::zeros(),
            sizes: One::new(size),
            tails: One::zeros(),
            certain: PerSurface::all(&One::zeros(), Some(true)),
            last: One::new(terms.iter().sum()),
            slopes: One::zeros(),
            is_sharp: true,
            is_close: true,
        }
    }

    /// The fall of a gap between these ends, with a polynomial that has an error of at most `doubt`.
    fn fall(
        polynomial: &GapSeries<One>,
        at_hand: bool,
        ends: [f64; 2],
        gap: impl FnMut(f64) -> f64,
    ) -> Option<Bracket> {
        let found = Polynomial::new(polynomial, 0, at_hand).fall(ends, gap);
        found.map(|(bracket, is_only)| {
            assert!(is_only, "{bracket:?}");
            bracket
        })
    }

    #[test]
    fn a_fall_is_that_of_the_gap_and_not_of_the_polynomial() {
        // The gap is a little larger than the polynomial, 0.3 - x^2.
        let more = 1e-12;
        let gap = |x: f64| 0.3 + more - x * x;
        let found = fall(&series(&[0.3, 0.0, -1.0], 1e-11), false, [0.4, 0.7], gap);
        let Some(Bracket {
            before,
            after,
            nearest,
        }) = found
        else {
            panic!("{found:?}")
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
            let found = fall(&series(&[0.0, root, -1.0], 1e-15), true, [0.0, 1.0], gap);
            let nearest = found.map_or(f64::NAN, |fall| fall.nearest);
            assert!(
                (nearest - root).abs() <= 4.0 * f64::EPSILON * root,
                "{found:?}"
            );
        }
    }

    #[test]
    fn a_fall_is_told_from_the_rise_behind_it() {
        let gap = |x: f64| (x - 0.25) * (x - 0.75);
        let dip = series(&[0.1875, -1.0, 1.0], 1e-15);
        let polynomial = Polynomial::new(&dip, 0, false);
        let end = polynomial.first_fall().expect("one fall");
        assert!(end > 0.25 && end < 0.75, "{end}");
        let found = polynomial
            .fall([0.0, end], gap)
            .map(|(fall, _)| fall.nearest);
        assert!(
            found.is_some_and(|root| (root - 0.25).abs() <= 1e-15),
            "{found:?}"
        );
        let touching = series(&[0.25, -1.0, 1.0], 1e-15);
        assert_eq!(Polynomial::new(&touching, 0, false).first_fall(), None);
    }

    #[test]
    fn doubtful_falls_are_left_to_the_gap_itself() {
        // The three failures: the gap differs from the polynomial, the polynomial touches 0, the polynomial rises.
        let falling = series(&[0.5, -1.0], 1e-12);
        assert_eq!(fall(&falling, false, [0.0, 1.0], |_| 1e-11), None);
        let touching = series(&[0.25, -1.0, 1.0], 1e-12);
        assert_eq!(fall(&touching, false, [0.0, 1.0], |_| 0.0), None);
        let rising = series(&[-0.5, 1.0], 1e-12);
        assert_eq!(fall(&rising, false, [0.0, 1.0], |_| 0.0), None);
    }
}
