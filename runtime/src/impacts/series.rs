//! Gaps along a step that is a power series. They are polynomials, and their signs follow from their coefficients.
//!
//! The Bernstein coefficients of a polynomial on the step bound it from both sides (convex hull), and show where a root
//! may lie. A bound of the truncation error makes the signs certain ([`Tails`](crate::events::tails::Tails)); without
//! one they are unclear.
//!
//! Reference: G. Farin, *Curves and Surfaces for CAGD* (2002), chapter 5.

use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::{COUNT, FROM_POWERS, Signs, read};
use crate::events::polynomials::Polynomials;
use crate::events::tails::Tail;
use crate::integrate::{Series, Stepper};
use crate::math;
use crate::numbers::TaylorModel;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Largest error of a polynomial, relative to the sum of the absolute values of its terms, with which its slope counts
/// as that of the gap. In addition, the first terms must make up most of the sum: otherwise the step exceeds the reach
/// of the series.
const USEFUL: f64 = 1.0 / (1 << 20) as f64;
/// Largest such error with which the roots of the polynomial count as estimates.
const CLOSE: f64 = 1.0 / (1 << 8) as f64;

/// Largest ratio of the error of a polynomial to its change on a part of a step with which the change counts as known.
const HIDDEN: f64 = 1.0 / 8.0;

/// Rounding error of coefficients and of sums over them, relative to the sum of the absolute values of the terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The gaps of a step as polynomials in the fraction of the step.
#[derive(Debug, Clone)]
pub(super) struct GapSeries<G: StateVector> {
    /// The polynomials. Their error bounds cover deviations at the end of the step, rounding errors, and, after
    /// [`GapSeries::certify`], truncation errors.
    pub(super) polynomials: Polynomials<G>,
    /// Error bounds of the constant terms.
    pub(super) floors: G,
    /// Sums of the absolute values of all terms, and of those above order 4.
    pub(super) sizes: G,
    pub(super) tails: G,
    /// True if the error bounds include the truncation error, false if it has no known bound; `None` before
    /// [`GapSeries::certify`].
    pub(super) certain: PerSurface<Option<bool>, G>,
    /// The gaps at the end of the step, and their slopes with respect to the fraction of the step.
    pub(super) last: G,
    pub(super) slopes: G,
    /// True if the slopes are accurate.
    pub(super) is_sharp: bool,
    /// True if the roots are good estimates.
    pub(super) is_close: bool,
}

/// The polynomials of the last step, which are computed when they are needed.
#[derive(Debug, Clone)]
pub(super) struct LastSeries<G: StateVector> {
    // NOTE: storage for all steps. A new one for each step would be copied more often than it is read.
    series: GapSeries<G>,
    is_known: bool,
}

impl<G: StateVector> LastSeries<G> {
    /// No polynomials, for as many gaps as `like`.
    pub(super) fn none(like: &G) -> Self {
        Self {
            series: GapSeries::zero(like),
            is_known: false,
        }
    }

    /// Forgets the polynomials: there is a new step.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.is_known = false;
    }

    /// The polynomials, once computed.
    #[inline(always)]
    pub(super) fn known(&self) -> Option<&GapSeries<G>> {
        self.is_known.then_some(&self.series)
    }

    /// Returns the polynomials of a step with the gaps `last` at its end. They are computed in the first call; `None` if
    /// the step is not a power series.
    #[inline(always)]
    pub(super) fn expand<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
        last: &G,
    ) -> Option<&mut GapSeries<G>> {
        if !self.is_known {
            self.is_known = self.series.fill(step, last);
        }
        self.is_known.then_some(&mut self.series)
    }
}

impl<G: StateVector> GapSeries<G> {
    fn zero(like: &G) -> Self {
        let zeros = like.zeroed();
        Self {
            polynomials: Polynomials::zero(like),
            floors: zeros,
            sizes: zeros,
            tails: zeros,
            certain: PerSurface::all(like, None),
            last: zeros,
            slopes: zeros,
            is_sharp: false,
            is_close: false,
        }
    }

    /// Computes the polynomials of a step with the gaps `last` at its end. False if the step is not a power series.
    #[inline(always)]
    fn fill<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        &mut self,
        step: &StepView<'_, Sys, Step>,
        last: &G,
    ) -> bool {
        let Some(Series { unit, order }) = step.stepper.series() else {
            return false;
        };
        let polynomials = &mut self.polynomials;
        polynomials.order = order;
        let theta = step.length() / unit;
        let mut power = 1.0;
        let (mut sums, mut slopes, mut firsts) = (last.zeroed(), last.zeroed(), last.zeroed());
        for (k, gap) in polynomials.coefficients[..=order].iter_mut().enumerate() {
            let coefficient = step.stepper.gap_coefficient(k);
            for i in 0..last.count() {
                let term = coefficient[i] * power;
                gap.as_mut_slice()[i] = term;
                sums.as_mut_slice()[i] += term;
                slopes.as_mut_slice()[i] += k as f64 * term;
                if k < 5 {
                    firsts.as_mut_slice()[i] += term.abs();
                }
            }
            power *= theta;
        }
        let [sizes, steeps] = polynomials.sum();
        (self.is_sharp, self.is_close) = (true, true);
        for i in 0..last.count() {
            let at = |values: &G| values.as_slice()[i];
            let missed = (at(&sums) - at(last)).abs();
            let (size, first) = (at(&sizes), at(&firsts));
            let is_near = size <= 2.0 * first;
            self.is_sharp &= missed <= USEFUL * size && is_near;
            self.is_close &= missed <= CLOSE * size && is_near;
            let [doubts, drifts] = &mut polynomials.doubts;
            doubts.as_mut_slice()[i] = 4.0 * missed + ROUNDING * size;
            drifts.as_mut_slice()[i] = 4.0 * order as f64 * missed + ROUNDING * at(&steeps);
            self.tails.as_mut_slice()[i] = size - first;
            self.floors.as_mut_slice()[i] = 0.0;
        }
        self.certain.fill(None);
        (self.sizes, self.last, self.slopes) = (sizes, *last, slopes);
        true
    }

    /// Adds a bound of the truncation error to the error bounds of a surface's polynomial. True if there is a bound.
    /// `tail` receives the order, and the sum of the absolute values of the terms.
    #[inline(always)]
    pub(super) fn certify(
        &mut self,
        surface: usize,
        tail: impl FnOnce((usize, f64)) -> Option<Tail>,
    ) -> bool {
        if let Some(is_certain) = self.certain[surface] {
            return is_certain;
        }
        let tail = tail((self.polynomials.order, self.sizes.as_slice()[surface]));
        self.certain[surface] = Some(tail.is_some());
        let Some(Tail {
            value,
            slope,
            floor,
        }) = tail
        else {
            return false;
        };
        let bounds = self.polynomials.doubts.iter_mut();
        for (bounds, bound) in bounds.zip([value, slope]) {
            bounds.as_mut_slice()[surface] += bound;
        }
        self.floors.as_mut_slice()[surface] = floor;
        true
    }

    /// True if the error bounds of a surface's polynomial include the truncation error.
    #[inline(always)]
    pub(super) fn is_certain(&self, surface: usize) -> bool {
        self.certain[surface] == Some(true)
    }

    /// True after the first [`GapSeries::certify`].
    #[inline(always)]
    pub(super) fn has_begun(&self) -> bool {
        self.certain.iter().any(|known| known.is_some())
    }

    /// Taylor model of the gap of a surface on a part of the step; `None` if the errors of its polynomial hide both its
    /// sign and its change.
    #[inline]
    pub(super) fn on(&self, surface: usize, part: [f64; 2]) -> Option<TaylorModel> {
        let mut model = self.polynomials.on(surface, part);
        model.error += self.floors.as_slice()[surface];
        let [middle, first, second, third] = model.powers;
        let radius = 0.5 * (part[1] - part[0]);
        let change = first.abs() + second.abs();
        let error = self.doubt(surface, false).max(radius * self.drift(surface));
        let is_off = middle.abs() > change + third.abs() + model.error;
        (is_off || error <= HIDDEN * change).then_some(model)
    }

    /// True if the gap of a surface is positive at a fraction of the step by more than its error.
    pub(super) fn is_positive(&self, surface: usize, part: f64) -> bool {
        self.polynomials.at(surface, part) > self.doubt(surface, false)
    }

    /// Error bound of the polynomial of a surface. If the surface is `at_hand`, its root at the start of the step is
    /// divided out, and the error of the constant term does not count.
    #[inline(always)]
    pub(super) fn doubt(&self, surface: usize, at_hand: bool) -> f64 {
        let doubt = self.polynomials.doubts[0].as_slice()[surface];
        match at_hand {
            true => doubt,
            false => doubt + self.floors.as_slice()[surface],
        }
    }

    /// Error bound of its derivative.
    #[inline(always)]
    pub(super) fn drift(&self, surface: usize) -> f64 {
        self.polynomials.doubts[1].as_slice()[surface]
    }

    /// The gap rates at the end of a step of this length; `None` if they are not accurate.
    #[inline(always)]
    pub(super) fn last_rates(&self, length: f64) -> Option<G> {
        let mut rates = self.slopes;
        rates
            .as_mut_slice()
            .iter_mut()
            .for_each(|rate| *rate /= length);
        self.is_sharp.then_some(rates)
    }

    /// Signs of the polynomial of a surface over the step, after division by a root at the start.
    ///
    /// A step is a small part of the radius of convergence, so a cubic is almost the whole gap. Its Bernstein
    /// coefficients must exceed the sum of all other terms. If they do not, those of more terms must exceed the rest.
    #[inline(always)]
    pub(super) fn signs(&self, surface: usize, at_hand: bool) -> Signs {
        let first = usize::from(at_hand);
        let at = |k: usize| self.polynomials.coefficients[first + k].as_slice()[surface];
        let [a, b, c, d] = [at(0), at(1), at(2), at(3)];
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let mut rest = self.doubt(surface, at_hand) + self.tails.as_slice()[surface];
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
        let Polynomials {
            coefficients,
            order,
            ..
        } = &self.polynomials;
        let terms = &coefficients[first..=(*order).max(COUNT)];
        let mut doubt = self.doubt(surface, at_hand);
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
