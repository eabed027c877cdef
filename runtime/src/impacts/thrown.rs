//! Motions that a reset has thrown up from its surface, by a hop that rounding may hide.

use super::glance::Glance;
use super::search::{counted_rounding, is_active};
use super::watch::Watch;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::locate::Start;
use crate::integrate::Stepper;
use crate::state::StateVector;

/// Ratio of the gap at the start of a hop to its height below which the hop is measured from the surface.
const LOW: f64 = 1.0 / 64.0;

impl<Sys: Impacting> Watch<Sys> {
    /// The gap at the start of a step on a surface from which a reset has thrown the motion up, if it is a rounding error, and
    /// not far smaller than the height of the hop; else 0. `slope` is that of the gap at the start, `last` the gap at the end.
    #[inline(never)]
    pub(super) fn offset<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        (slope, last): (f64, f64),
        step: &mut StepView<'_, Sys, Step>,
    ) -> f64 {
        let (t, state) = (step.t_start(), *step.start());
        step.counters.event_evaluations += 1;
        let gap = step.system.gap(surface, t, &state);
        // The height of the parabola with this slope through the gap at the end.
        let fall = slope - (last - gap);
        let is_small = fall > 0.0 && 4.0 * fall * gap.abs() < LOW * slope * slope;
        if gap == 0.0 || is_small {
            return 0.0;
        }
        let mut sizes = step.system.scale(t, &state);
        for (size, value) in sizes.as_mut_slice().iter_mut().zip(state.as_slice()) {
            *size = size.max(value.abs());
        }
        match gap.abs() <= 2.0 * counted_rounding(surface, 0.0, step, &sizes) {
            true => gap,
            false => 0.0,
        }
    }

    /// True if a reset has thrown the motion up from this surface at the start of the step, and it is below the surface at the end
    /// although no fall was found.
    pub(super) fn has_fallen_unseen<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let is_thrown_up = self.gaps.as_slice()[surface] == 0.0
            && self.is_thrown_up(surface, self.rates.as_slice()[surface]);
        if !is_thrown_up || self.proposed.is_some() {
            return false;
        }
        let counts = |part: f64| is_active(surface, step, part);
        if ![0.0, 0.25, 0.5, 0.75, 1.0].into_iter().all(counts) {
            return false;
        }
        let falls = glance.rate(surface).is_some_and(|rate| rate < 0.0);
        let gap = glance.gaps.as_slice()[surface];
        gap < 0.0 && (falls || gap < -2.0 * self.rounding_at(surface, 1.0, step))
    }

    /// True if a reset has thrown the motion up from this surface; `slope` is that of the gap at the start of the step.
    pub(super) fn is_thrown_up(&self, surface: usize, slope: f64) -> bool {
        self.is_passable(surface) && slope > 0.0
    }

    /// True if a reset has thrown the motion up from this surface by less than rounding, and it falls at the end of the step.
    pub(super) fn hops_below_rounding(
        &self,
        surface: usize,
        start: Start,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let is_thrown_up = start
            .slope
            .is_some_and(|slope| self.is_thrown_up(surface, slope));
        is_thrown_up && start.above && glance.rate(surface).is_some_and(|rate| rate < 0.0)
    }
}
