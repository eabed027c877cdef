//! Sides of surfaces: detects that a surface becomes active (its conditions begin to hold) while the motion is behind
//! it, or ceases to be active while it holds the motion, and decides the side of a motion that is on a surface within
//! rounding.
//!
//! Behind a wall that is not active, the motion is free. Gap and conditions are enclosed along the step. A stretch on
//! which the gap is not negative, or on which the conditions do not hold, is free; others are halved ([`onset`]).

use core::cell::RefCell;

use super::glance::{Glance, SAME_TIME};
use super::search::is_active;
use super::watch::{Watch, rounding};
use crate::contract::{Along, Impacting};
use crate::effects::{Moment, StepView};
use crate::events::first::{Onset, narrowed, onset, onset_among};
use crate::events::resolution::is_beyond_rounding;
use crate::integrate::Stepper;
use crate::numbers::{Interval, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Smallest fraction of a step between two kinks that are told apart.
const LEAST_STRETCH: f64 = 1e-6;
/// Bound for the relative rounding error of a component or of the time.
const UNITS: f64 = 32.0 * f64::EPSILON;

/// Distance from a kink, in units of rounding errors, within which a motion counts as there.
const NEAR: f64 = 16.0;

/// Fractions of the motion up to a kink at which the motion may be distinguished from one at the kink.
const BEFORE_KINK: [f64; 4] = [1.0 - LEAST_STRETCH, 0.999, 0.9, 0.0];

/// Number of stretches in which a kink is sought. A step along a kink has no stretch without one.
const STRETCHES: u32 = 256;

/// Length of a path, in units of the rounding errors of the positions, below which the kinks at its ends are one.
const RETURNS: f64 = 32.0;

impl<Sys: Impacting> Watch<Sys> {
    /// Proposes to cut the step where a surface first begins to count while the motion is behind it, if this precedes
    /// the present proposal.
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

    /// The first fraction of the step up to `reach` at which the gap is negative and the surface counts, both beyond
    /// rounding.
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
        let rounding = self.rounding_at(surface, 1.0, step);
        let drift = SAME_TIME * (self.rates.as_slice()[surface] * step.t_end()).abs();
        // A touched surface that counts at the start was not passed there.
        let first = match is_active(surface, step, 0.0) {
            true => gap_at(surface, step, 0.0).min(0.0),
            false => 0.0,
        };
        let floor = (2.0 * rounding + drift).max(-4.0 * first);
        let step = RefCell::new(step);
        let counts = |part: f64| {
            let step = &mut *step.borrow_mut();
            step.counters.event_evaluations += 1;
            gap_at(surface, step, part) < -floor
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
        let step = &**step.borrow();
        Ok(found.map(|found| begin(surface, found.after, step)))
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

    /// The first fraction of the step, up to `reach`, at which the gap of a surface that holds the motion has passed a
    /// kink, by more than rounding errors. The gap rate may jump there. While the motion slides, kinks are not watched.
    pub(super) fn kink_of_hold<Step: Stepper<Sys>>(
        &mut self,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let (held, mut first) = (self.held, None);
        if held.slide().is_some() {
            return Ok(None);
        }
        for surface in held
            .iter()
            .filter(|&surface| step.system.has_kinks(surface))
        {
            step.prepare()?;
            self.path.follow_dense(step);
            let until = first.unwrap_or(reach);
            let kink = self.passes_kink(surface, [0.0, until], step);
            first = kink.or(first);
        }
        Ok(first)
    }

    /// The fraction of the step up to the middle between the first two kinks that gaps of held surfaces pass; 1 for
    /// fewer kinks. At the end of a step over one kink, the force behind the kink acts, and the error of the step shows
    /// it; the force between two kinks may act at no stage.
    pub(super) fn up_to_second_kink<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<f64, Outcome> {
        let Some(first) = self.kink_of_hold(1.0, step)? else {
            return Ok(1.0);
        };
        let held = self.held;
        let mut shown = 1.0;
        for surface in held.iter() {
            if step.system.has_kinks(surface)
                && let Some(second) = self.passes_kink(surface, [first, 1.0], step)
                && second - first > LEAST_STRETCH
            {
                shown = f64::min(shown, f64::midpoint(first, second));
            }
        }
        Ok(shown)
    }

    /// The first fraction of a part of the step at which the gap of a surface has passed a kink since its start.
    fn passes_kink<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        [from, to]: [f64; 2],
        step: &mut StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let place = |part: f64| from + part * (to - from);
        let passes = |along: Along<'_>, step: &StepView<'_, Sys, Step>| {
            let start = step.state(from);
            let start = |i: usize| about(start.as_slice()[i], 0.0);
            let begin = about(step.time(from), 0.0);
            let (t, end) = (step.t_end(), step.end());
            let rounded = |i: usize| about(end.as_slice()[i], self.sizes.as_slice()[i]);
            let rounding = (about(t, t), &rounded as &dyn Fn(usize) -> TaylorModel);
            (step.system).passes_kink(surface, (begin, &start), along, rounding)
        };
        let step = RefCell::new(step);
        let is_smooth = |part: [f64; 2]| {
            let step = &mut *step.borrow_mut();
            step.counters.enclosures += 1;
            let part = part.map(place);
            let component = |i: usize| self.path.component(i, part);
            passes((self.path.time_model(part), &component), step) == Some(false)
        };
        let has_passed = |part: f64| {
            let step = &**step.borrow();
            let (time, state) = (step.time(place(part)), step.state(place(part)));
            let component = |i: usize| about(state.as_slice()[i], 0.0);
            passes((about(time, 0.0), &component), step) == Some(true)
        };
        if self.is_point([from, to], &step.borrow()) {
            return has_passed(1.0).then_some(to);
        }
        onset_among(STRETCHES, 1.0, is_smooth, has_passed).map(|found| place(found.after))
    }

    /// True if the motion stays within a few rounding errors of one place, so that no enclosure tells where it is.
    fn is_point<Step: Stepper<Sys>>(
        &self,
        [from, to]: [f64; 2],
        step: &StepView<'_, Sys, Step>,
    ) -> bool {
        let is_short = |length: f64, size: f64| length.abs() <= RETURNS * UNITS * size.abs();
        let (start, end) = (step.state(from), step.state(to));
        let places = start.as_slice().iter().zip(end.as_slice());
        let mut positions = places
            .zip(self.sizes.as_slice())
            .take(step.system.coordinate_count());
        is_short((to - from) * step.length(), step.t_end())
            || positions.all(|((start, end), size)| is_short(end - start, *size))
    }

    /// True if the gap of a surface that holds the motion has a kink within rounding of the state.
    pub(super) fn rests_at_kink(&self, now: &Moment<'_, Sys>) -> bool {
        self.has_kink(now.system, (now.t, now.state))
    }

    /// Same as [`Watch::rests_at_kink`] for the state at a fraction of a step.
    pub(super) fn is_at_kink<Step: Stepper<Sys>>(
        &self,
        part: f64,
        step: &StepView<'_, Sys, Step>,
    ) -> bool {
        self.has_kink(step.system, (step.time(part), &step.state(part)))
    }

    /// The gap rates shortly before a kink at a fraction of the step. Those of held surfaces are errors of the motion so
    /// far, since the surfaces keep them at 0. `None` if the kink is within rounding of the whole motion before it.
    pub(super) fn rates_before_kink<Step: Stepper<Sys>>(
        &self,
        kink: f64,
        step: &StepView<'_, Sys, Step>,
    ) -> Result<Option<Sys::Gaps>, Outcome> {
        let mut places = BEFORE_KINK.iter().map(|share| kink * share);
        let Some(part) = places.find(|part| !self.is_at_kink(*part, step)) else {
            return Ok(None);
        };
        let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
        Ok(Some(rates))
    }

    /// True if the gap of a surface that holds the motion has a kink within [`NEAR`] rounding errors of a state.
    fn has_kink(&self, system: &Sys, (t, place): (f64, &Sys::State)) -> bool {
        let sizes = &self.sizes;
        let state =
            |units: f64| move |i: usize| about(place.as_slice()[i], units * sizes.as_slice()[i]);
        let (exact, rounded, widened) = (state(0.0), state(1.0), state(NEAR));
        let is_near = |surface: usize| {
            let start: Along<'_> = (about(t, 0.0), &exact);
            let around: Along<'_> = (about(t, NEAR * t), &widened);
            let passes = system.passes_kink(surface, start, around, (about(t, t), &rounded));
            passes != Some(false)
        };
        let mut held = self.held.iter();
        self.held.slide().is_none()
            && held.any(|surface| system.has_kinks(surface) && is_near(surface))
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

    /// Ends the run if the step was cut at this fraction because a surface became active while the motion was behind
    /// it.
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

/// A number that is steady within the rounding errors of a component of this size.
fn about(value: f64, size: f64) -> TaylorModel {
    TaylorModel::steady(Interval::point(value).widened(UNITS * size.abs()))
}

/// The onset of a surface that counts beyond rounding at the fraction `after` of the step. It lies shortly before
/// `after`, by the allowance for rounding.
fn begin<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    after: f64,
    step: &StepView<'_, Sys, Step>,
) -> Onset {
    let counts = |part: f64| gap_at(surface, step, part) < 0.0 && is_active(surface, step, part);
    let mut back = (f64::EPSILON * after).max(f64::MIN_POSITIVE);
    while back < after && counts(after - back) {
        back *= 4.0;
    }
    narrowed([(after - back).max(0.0), after], counts)
}

/// The gap at a fraction of a step.
fn gap_at<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> f64 {
    let gaps = step.system.gaps(step.time(part), &step.state(part));
    gaps.as_slice()[surface]
}
