//! Kinks of gaps. Where a held surface has one, the gap rate may jump, so that the surface acts anew. On a surface that is hit, the side
//! from which the motion comes decides.

use core::cell::RefCell;

use super::hits::Hits;
use super::sides::{UNITS, about};
use super::watch::Watch;
use crate::contract::{Along, Impacting};
use crate::effects::{Moment, StepView};
use crate::events::first::onset_among;
use crate::integrate::Stepper;
use crate::math;
use crate::numbers::TaylorModel;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Number of places before a kink that are tried, each farther from it by this factor.
const ASIDE: (u32, f64) = (8, 4.0);

/// Smallest fraction of a step between two kinks that are told apart.
const LEAST_STRETCH: f64 = 1e-6;

/// Distance from a kink, in units of rounding errors, within which a motion counts as there.
const NEAR: f64 = 16.0;

/// Fractions of the motion up to a kink at which the motion may be distinguished from one at the kink.
const BEFORE_KINK: [f64; 4] = [1.0 - LEAST_STRETCH, 0.999, 0.9, 0.0];

/// Number of stretches in which a kink is sought. A step along a kink has no stretch without one.
const STRETCHES: u32 = 256;

/// Length of a path, in units of the rounding errors of the positions, below which the kinks at its ends are one.
const RETURNS: f64 = 32.0;

/// A state within rounding of another one, with its gap rates.
pub(super) struct Beside<Sys: Impacting> {
    pub(super) state: Sys::State,
    pub(super) rates: Sys::Gaps,
}

impl<Sys: Impacting> Watch<Sys> {
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

    /// The state within rounding before this one on the motion, with its gap rates, if a surface at hand has no gap rate here but has
    /// one there. A gap such as `x + abs(x^3)` has no derivative in numbers exactly on the surface.
    pub(super) fn before_kink(
        &self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &Moment<'_, Sys>,
    ) -> Result<Option<Beside<Sys>>, Outcome> {
        let lacks = |rates: &Sys::Gaps| {
            let mut surfaces = 0..rates.count();
            surfaces.any(|surface| hits.is_at_hand(surface) && rates.as_slice()[surface].is_nan())
        };
        if !lacks(rates) {
            return Ok(None);
        }
        let (t, system) = (now.t, now.system);
        let qdot = system.velocity(t, now.state)?;
        let mut way = 2.0 * f64::EPSILON;
        for _ in 0..ASIDE.0 {
            let mut q = system.position(now.state);
            let moved = q.as_mut_slice().iter_mut().zip(qdot.as_slice());
            for ((q, &v), size) in moved.zip(self.sizes.as_slice()) {
                if v != 0.0 {
                    *q -= (way * math::larger(size.abs(), q.abs())).copysign(v);
                }
            }
            let state = system.state_moved(now.state, t, &q, &qdot)?;
            let rates = system.gap_rates(t, &state)?;
            if !lacks(&rates) {
                return Ok(Some(Beside { state, rates }));
            }
            way *= ASIDE.1;
        }
        Ok(None)
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
}
