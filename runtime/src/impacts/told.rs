//! First tests of a step for a surface, from its gap at the ends of the step and bounds over the whole of it.

use super::glance::Glance;
use super::watch::Watch;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::Signs;
use crate::events::piece::Piece;
use crate::integrate::Stepper;
use crate::numbers::{ComplexInterval, TaylorModel};
use crate::state::StateVector;

/// Result of the first tests of a step for a surface.
pub(super) enum Told {
    /// No hit: the gaps at the ends and the bounds of their derivatives exclude it.
    Passed,
    /// No hit: the values of the gap on the whole step exclude it.
    Clear,
    /// Undecided, with the gap on the whole step if it was computed.
    Unclear(Option<TaylorModel>),
}

impl<Sys: Impacting> Watch<Sys> {
    /// Adds a bound of the truncated terms to the error of a gap's polynomial, once per step. Returns true if the gap
    /// has a polynomial and a bound.
    #[inline]
    pub(super) fn certify<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let Self {
            tails,
            path,
            series,
            ..
        } = self;
        if series
            .known()
            .is_some_and(|series| series.is_certain(surface))
        {
            return true;
        }
        if !glance.has_series() || tails.skips(surface) {
            return false;
        }
        let Some(series) = series.expand(step, &glance.gaps) else {
            return false;
        };
        if !series.is_sharp {
            tails.postpone(surface);
            return false;
        }
        if !series.has_begun() {
            tails.follow(path);
        }
        let (system, enclosures) = (step.system, &mut step.counters.enclosures);
        series.certify(surface, |terms| {
            let gap = |t: ComplexInterval, component: &dyn Fn(usize) -> ComplexInterval| {
                system.gap_complex(surface, t, component)
            };
            tails.of(surface, terms, (&gap, path), enclosures)
        })
    }

    /// Applies the first tests of the step to this surface.
    #[inline]
    pub(super) fn told<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Told {
        if self.held.is_held(surface) {
            return Told::Passed;
        }
        let at = |values: &Sys::Gaps| values.as_slice()[surface];
        let (first, last) = (at(&self.gaps), at(&glance.gaps));
        let is_at_hand = first == 0.0;
        // NOTE: if the gap of a surface at hand is negative on the whole step, the motion presses into the surface,
        // unless it passes through it. A constant sign therefore decides nothing here.
        let is_passed = self.lets_through(surface) && at(&self.rates) <= 0.0;
        if (is_at_hand && last < 0.0 && !is_passed) || glance.is_due(surface) {
            return Told::Unclear(None);
        }
        if !is_at_hand && (first > 0.0) != (last > 0.0) {
            return Told::Unclear(None);
        }
        if self.limits.tell(surface, [first, last]) {
            return Told::Passed;
        }
        let whole = [0.0, 1.0];
        let is_certain = self.certify(surface, step, glance);
        let model = match self.series.known().filter(|_| is_certain) {
            Some(series) => match series.signs(surface, is_at_hand) {
                Signs::Positive | Signs::Negative => return Told::Clear,
                _ => return Told::Unclear(None),
            },
            None => {
                step.counters.enclosures += 1;
                self.path.enclose();
                let component = |i: usize| self.path.component(i, whole);
                let time = self.path.time_model(whole);
                step.system.gap_along(surface, time, &component)
            }
        };
        let piece = Piece::of(&model, whole, whole);
        let signs = match is_at_hand {
            true => piece.signs_from_zero(),
            false => match piece.signs() {
                Signs::Unclear => piece.signs_between([first, last]),
                signs => signs,
            },
        };
        match signs {
            Signs::Positive | Signs::Negative => Told::Clear,
            _ => Told::Unclear(Some(model)),
        }
    }
}
