//! Sides of surfaces: detects that a surface becomes active (its conditions begin to hold) while the motion is behind
//! it, or ceases to be active while it holds the motion, and decides the side of a motion that is on a surface within
//! rounding.
//!
//! Behind a wall that is not active, the motion is free. Gap and conditions are enclosed along the step. A stretch on
//! which the gap is not negative, or on which the conditions do not hold, is free; others are halved ([`onset`]).

use core::cell::RefCell;

use super::glance::{Glance, SAME_TIME};
use super::search::{gap_at, is_active};
use super::watch::{Watch, rounding};
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::events::first::{Onset, narrowed, onset};
use crate::events::resolution::{is_beyond_rounding, least_on};
use crate::integrate::Stepper;
use crate::numbers::{Interval, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Causes of a motion behind a surface without an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Behind {
    /// The surface began to count.
    Begins,
    /// The gap changed its sign at a pole, or jumped.
    Pole,
}

/// Number of halvings of the distance to a pole behind which the sign of a gap is looked for.
const CLOSEST: u32 = 40;

/// Bound for the relative rounding error of a component or of the time.
pub(super) const UNITS: f64 = 32.0 * f64::EPSILON;

impl<Sys: Impacting> Watch<Sys> {
    /// Proposes to cut the step where a surface first begins to count while the motion is behind it, if this precedes
    /// the present proposal. A motion that is on the surface at that time, within rounding, hits it.
    pub(super) fn look_behind<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        for surface in 0..self.gaps.count() {
            let reach = self.proposed.unwrap_or(1.0);
            if self.may_be_behind(surface)
                && let Some((found, rounding)) = self.begins_to_count(surface, reach, step)?
            {
                match gap_at(surface, step, found.after) >= -rounding {
                    true => self.cut_at(surface, found.after, step.length()),
                    false => self.cut_behind((surface, Behind::Begins), found.after, step),
                }
            }
        }
        Ok(())
    }

    /// For a surface that counts at the end of the step with the motion behind it: proposes to cut the step where the
    /// surface began to count.
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
        self.cut_behind((surface, Behind::Begins), found.after, step);
        Ok(())
    }

    /// Proposes an impact on a surface at this fraction of a step of this length.
    pub(super) fn cut_at(&mut self, surface: usize, part: f64, length: f64) {
        self.length = length;
        self.parts.fill(None);
        self.is_shown_by_values[surface] = false;
        self.parts[surface] = Some(part);
        (self.proposed, self.behind) = (Some(part), None);
    }

    /// Proposes to end the run at this fraction of the step, where the motion is behind a surface.
    pub(super) fn cut_behind<Step: Stepper<Sys>>(
        &mut self,
        (surface, behind): (usize, Behind),
        part: f64,
        step: &StepView<'_, Sys, Step>,
    ) {
        self.length = step.length();
        self.parts.fill(None);
        (self.proposed, self.behind) = (Some(part), Some((surface, behind)));
    }

    /// The first fraction of the step up to `reach` at which the gap is negative and the surface counts, both beyond
    /// rounding, and the rounding error of the gap.
    fn begins_to_count<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<(Onset, f64)>, Outcome> {
        self.path.enclose();
        if self.is_free([0.0, reach], (surface, 0.0), step) {
            return Ok(None);
        }
        self.path.refine(step)?;
        self.path.enclose();
        let drift = SAME_TIME * (self.rates.as_slice()[surface] * step.t_end()).abs();
        // A touched surface that counts at the start was not passed there.
        let first = match is_active(surface, step, 0.0) {
            true => gap_at(surface, step, 0.0).min(0.0),
            false => 0.0,
        };
        // NOTE: a gap that is steep at one place has larger rounding errors there than elsewhere.
        let rounding =
            |part: f64, step: &mut _| 2.0 * self.rounding_at(surface, part, step) + drift;
        let least = least_on([0.0, reach], |part| rounding(part, step));
        let floor = least.max(-4.0 * first);
        let step = RefCell::new(step);
        let counts = |part: f64| {
            let step = &mut *step.borrow_mut();
            step.counters.event_evaluations += 1;
            let gap = gap_at(surface, step, part);
            gap < -floor
                && gap < -rounding(part, step)
                && is_active(surface, step, part)
                && is_beyond_rounding(
                    step.system,
                    (surface, true),
                    step.time(part),
                    &step.state(part),
                    &self.sizes,
                )
        };
        let is_free = |part| self.is_free(part, (surface, floor), &mut step.borrow_mut());
        let found = onset(reach, is_free, counts);
        let step = step.into_inner();
        Ok(found.map(|found| {
            let rounding = rounding(found.after, step);
            (begin(surface, found.after, step), rounding)
        }))
    }

    /// True if the gap is certainly nowhere below `-floor` on a part of the step, or if the surface counts nowhere on
    /// it.
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
        gap.range().lo >= -floor || self.counts_on(part, surface, step) == Some(false)
    }

    /// True if a surface counts all along a part of the step, false if it counts nowhere on it; `None` if neither is
    /// certain.
    fn counts_on<Step: Stepper<Sys>>(
        &self,
        part: [f64; 2],
        surface: usize,
        step: &StepView<'_, Sys, Step>,
    ) -> Option<bool> {
        let component = |i: usize| self.path.component(i, part);
        let time = self.path.time_model(part);
        let (t, state) = (step.t_end(), step.end());
        let rounded = |i: usize| about(state.as_slice()[i], self.sizes.as_slice()[i]);
        (step.system).counts_along(surface, (time, &component), (about(t, t), &rounded))
    }

    /// The first fraction of the step, up to `reach`, at which a surface that holds the motion no longer counts, and the
    /// surface.
    pub(super) fn end_of_hold<Step: Stepper<Sys>>(
        &mut self,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<(f64, usize)>, Outcome> {
        let mut first: Option<(f64, usize)> = None;
        let held = self.held;
        let across = held.slide().map(|slide| slide.across);
        for surface in held.iter() {
            // The condition of the other transition holds or fails in the other mode.
            if step.system.has_conditions(surface) && Some(surface) != across {
                step.prepare()?;
                self.path.follow_dense(step);
                let until = first.map_or(reach, |(part, _)| part);
                let part = self.ceases_to_count(surface, until, step);
                let part = part.filter(|part| *part < until || first.is_none());
                first = part.map(|part| (part, surface)).or(first);
            }
        }
        if let Some(slide) = held.slide()
            && step.system.has_conditions(slide.across)
        {
            step.prepare()?;
            let until = first.map_or(reach, |(part, _)| part);
            let part = slide.end_across(until, step);
            let part = part.filter(|part| *part < until || first.is_none());
            first = part.map(|part| (part, slide.across)).or(first);
        }
        Ok(first)
    }

    /// The first fraction of the step, up to `reach`, at which a surface does not count, by more than rounding errors.
    fn ceases_to_count<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let is_off = |part: f64, step: &StepView<'_, Sys, Step>| {
            let (t, state) = (step.time(part), step.state(part));
            is_beyond_rounding(step.system, (surface, false), t, &state, &self.sizes)
        };
        if is_off(0.0, step) {
            return Some(0.0);
        }
        let step = RefCell::new(step);
        let counts = |part| {
            let step = &mut *step.borrow_mut();
            step.counters.enclosures += 1;
            self.counts_on(part, surface, step) == Some(true)
        };
        onset(reach, counts, |part| is_off(part, &step.borrow())).map(|found| found.after)
    }

    /// Refuses a gap that is negative beyond rounding if the surface is active. Sets a gap that is negative within
    /// rounding to 0, so that the motion is on the surface. A surface whose conditions hold only within rounding is not
    /// active yet: a ball that lands on a ledge is not inside the wall below.
    pub(super) fn check_negative(&mut self, now: &mut Moment<'_, Sys>) -> Result<(), Outcome> {
        for surface in 0..self.gaps.count() {
            let gap = self.gaps.as_slice()[surface];
            let is_wall = !self.is_passable(surface);
            if is_wall && gap < 0.0 && now.system.surface_active(surface, now.t, now.state) {
                let drift = SAME_TIME * (self.rates.as_slice()[surface] * now.t).abs();
                let rounding = rounding(now, surface, &self.sizes);
                if gap >= -2.0 * rounding - drift {
                    self.gaps.as_mut_slice()[surface] = 0.0;
                } else if is_beyond_rounding(
                    now.system,
                    (surface, true),
                    now.t,
                    now.state,
                    &self.sizes,
                ) {
                    return Err(Outcome::StartsInside { surface, gap });
                }
            }
        }
        Ok(())
    }

    /// Keeps the side of a passable surface that the motion meets within rounding at the end of the step, unless it has
    /// sunk below the surface beyond rounding. The gap becomes the smallest normal number with the sign of `start`, the
    /// gap at the start of the step.
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

    /// True if a wall counts behind a pole of its gap while the gap is negative there: the motion comes to the forbidden
    /// side without an impact. The gap is evaluated ever closer to the pole, where it is large, as are its rounding errors.
    pub(super) fn leads_behind<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        [pole, after]: [f64; 2],
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        if self.is_passable(surface) {
            return false;
        }
        let mut way = after - pole;
        for _ in 0..CLOSEST {
            let part = pole + way;
            let gap = gap_at(surface, step, part);
            step.counters.event_evaluations += 1;
            if gap < 0.0
                && gap < -2.0 * self.rounding_at(surface, part, step)
                && is_active(surface, step, part)
            {
                return true;
            }
            way *= 0.5;
        }
        false
    }

    /// Ends the run if the step was cut at this fraction because the motion is behind a surface there.
    pub(super) fn check_behind(&self, part: f64, now: &Moment<'_, Sys>) -> Result<(), Outcome> {
        match self.behind {
            Some((surface, behind)) if self.proposed == Some(part) => {
                let gap = now.system.gap(surface, now.t, now.state);
                Err(match behind {
                    Behind::Begins => Outcome::BeginsBehind { surface, gap },
                    Behind::Pole => Outcome::StartsInside { surface, gap },
                })
            }
            _ => Ok(()),
        }
    }
}

/// A number that is steady within the rounding errors of a component of this size.
pub(super) fn about(value: f64, size: f64) -> TaylorModel {
    TaylorModel::steady(Interval::point(value).widened(UNITS * size.abs()))
}

/// The onset of a surface that counts beyond rounding at the fraction `after` of the step. It lies shortly before
/// `after`, by the allowance for rounding.
fn begin<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    after: f64,
    step: &StepView<'_, Sys, Step>,
) -> Onset {
    shortly_before(after, |part| {
        gap_at(surface, step, part) < 0.0 && is_active(surface, step, part)
    })
}

/// The onset of a predicate that holds at the fraction `after` of the step, and not far before.
pub(super) fn shortly_before(after: f64, holds: impl Fn(f64) -> bool) -> Onset {
    let mut back = (f64::EPSILON * after).max(f64::MIN_POSITIVE);
    while back < after && holds(after - back) {
        back *= 4.0;
    }
    narrowed([(after - back).max(0.0), after], holds)
}
