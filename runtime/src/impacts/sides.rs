//! Sides of surfaces: where the conditions of a surface begin to hold while the motion is behind it, and which side it is on within rounding.
//!
//! Behind a wall that does not count the motion is free. Gap and conditions are enclosed along the step: on a stretch where the gap is not
//! negative, or where the conditions do not hold, nothing begins; others are halved ([`onset`]).

use core::cell::RefCell;

use super::glance::{Glance, SAME_TIME};
use super::search::{is_active, rounding_along};
use super::watch::{Watch, rounding};
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::events::first::{Onset, narrowed, onset};
use crate::events::resolution::counts_beyond_rounding;
use crate::integrate::Stepper;
use crate::numbers::{Interval, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Relative amount by which rounding may move a component or time. Conditions have the same allowance as gaps.
const UNITS: f64 = 32.0 * f64::EPSILON;

impl<Sys: Impacting> Watch<Sys> {
    /// Proposes to cut the step where a surface first begins to count behind the motion, if that is before what is proposed already.
    pub(super) fn look_behind<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        for surface in 0..self.gaps.count() {
            let reach = self.proposed.unwrap_or(1.0);
            if self.may_be_behind(surface)
                && let Some(found) = self.begins_to_count(surface, reach, step)?
            {
                self.cut_behind(surface, found, step);
            }
        }
        Ok(())
    }

    /// A surface that counts at the end of the step, with the motion behind it, began to count in the step: proposes to cut it there.
    #[cold]
    pub(super) fn end_where_behind<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        step.prepare()?;
        let found = narrowed([0.0, 1.0], |part| {
            step.counters.event_evaluations += 1;
            gap_at(surface, step, part) < 0.0 && is_active(surface, step, part)
        });
        self.cut_behind(surface, found, step);
        Ok(())
    }

    fn cut_behind<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        found: Onset,
        step: &StepView<'_, Sys, Step>,
    ) {
        self.length = step.length();
        self.parts.fill(None);
        (self.proposed, self.behind) = (Some(found.after), Some(surface));
    }

    /// The first part of the step up to `reach` at which the gap is negative and the surface counts, both beyond rounding.
    fn begins_to_count<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<Onset>, Outcome> {
        self.path.enclose();
        if self.is_free([0.0, reach], (surface, 0.0), step) {
            return Ok(None);
        }
        self.path.refine(step)?;
        self.path.enclose();
        let mut evaluations = 0;
        let rounding = rounding_along(surface, step, 1.0, &self.sizes, &mut evaluations);
        step.counters.event_evaluations += evaluations;
        let drift = SAME_TIME * (self.rates.as_slice()[surface] * step.t_end()).abs();
        let floor = 2.0 * rounding + drift;
        let step = RefCell::new(step);
        let counts = |part: f64| {
            let step = &mut *step.borrow_mut();
            step.counters.event_evaluations += 1;
            gap_at(surface, step, part) < -floor
                && is_active(surface, step, part)
                && counts_beyond_rounding(
                    step.system,
                    surface,
                    step.time(part),
                    &step.state(part),
                    &self.sizes,
                )
        };
        let is_free = |part| self.is_free(part, (surface, floor), &mut step.borrow_mut());
        let found = onset(reach, is_free, counts);
        let step = &**step.borrow();
        Ok(found.map(|found| begin(surface, found.after, step)))
    }

    /// True if on a part of the step the gap is nowhere below `-floor` where the surface counts.
    fn is_free<Step: Stepper<Sys>>(
        &self,
        part: [f64; 2],
        (surface, floor): (usize, f64),
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        step.counters.enclosures += 1;
        let component = |i: usize| self.path.component(i, part);
        let time = self.path.time_model(part);
        let gap = step.system.gap_along(surface, time, &component);
        if gap.range().lo >= -floor {
            return true;
        }
        let about = |value: f64, size: f64| {
            TaylorModel::steady(Interval::point(value).widened(UNITS * size.abs()))
        };
        let (t, state) = (step.t_end(), step.end());
        let rounded = |i: usize| about(state.as_slice()[i], self.sizes.as_slice()[i]);
        let counts =
            (step.system).counts_along(surface, (time, &component), (about(t, t), &rounded));
        counts == Some(false)
    }

    /// Surfaces that count have a gap that is not negative beyond rounding; within rounding they are at hand. One that
    /// counts by rounding alone does not yet: so a ball that lands on a ledge is not inside the wall below.
    pub(super) fn check_negative(&mut self, now: &mut Moment<'_, Sys>) -> Result<(), Outcome> {
        for surface in 0..self.gaps.count() {
            let gap = self.gaps.as_slice()[surface];
            let is_wall = !self.is_passable(surface);
            if is_wall && gap < 0.0 && now.system.surface_active(surface, now.t, now.state) {
                let drift = SAME_TIME * (self.rates.as_slice()[surface] * now.t).abs();
                if gap >= -2.0 * rounding(now, surface, &self.sizes) - drift {
                    self.gaps.as_mut_slice()[surface] = 0.0;
                } else if counts_beyond_rounding(now.system, surface, now.t, now.state, &self.sizes)
                {
                    return Err(Outcome::StartsInside { surface, gap });
                }
            }
        }
        Ok(())
    }

    /// A passable surface that is met within rounding at the end of the step, without a fall that counted, has not been
    /// crossed: its gap gets the smallest number of the side that the motion came from.
    pub(super) fn keep_side<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        start: f64,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) {
        let gap = self.gaps.as_slice()[surface];
        let meets = gap == 0.0 && start != 0.0;
        if meets || (gap < 0.0 && start > 0.0 && !self.is_sunk(surface, step, glance)) {
            self.gaps.as_mut_slice()[surface] = f64::MIN_POSITIVE.copysign(start);
        }
    }

    /// Ends the run where a surface begins to count behind the motion, if the step was cut at this part of it for that.
    pub(super) fn check_behind(&self, part: f64, now: &Moment<'_, Sys>) -> Result<(), Outcome> {
        match self.behind {
            Some(surface) if self.proposed == Some(part) => {
                let gap = now.system.gaps(now.t, now.state).as_slice()[surface];
                Err(Outcome::BeginsBehind { surface, gap })
            }
            _ => Ok(()),
        }
    }
}

/// Time at which a surface begins to count that counts beyond rounding at a part of the step: shortly before it, by the
/// allowance for rounding.
fn begin<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    after: f64,
    step: &StepView<'_, Sys, Step>,
) -> Onset {
    let counts = |part: f64| gap_at(surface, step, part) < 0.0 && is_active(surface, step, part);
    let mut back = f64::EPSILON * after;
    while back < after && counts(after - back) {
        back *= 4.0;
    }
    narrowed([(after - back).max(0.0), after], counts)
}

/// The gap at a part of a step.
fn gap_at<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> f64 {
    let gaps = step.system.gaps(step.time(part), &step.state(part));
    gaps.as_slice()[surface]
}
