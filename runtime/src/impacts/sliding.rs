//! Sliding mode along a surface at which two first-order modes meet and both lead into it.
//!
//! The motion is Filippov's: the convex combination of both fields that stays on the surface,
//!
//! ```text
//! f = f_b + s (f_a - f_b),   s = r_b/(r_a + r_b),
//! ```
//!
//! with the gap rates `r_b` and `r_a` of the transitions `back` and `across` ([`Slide`]), each in the mode that the
//! transition leaves. Both are negative. The sliding mode ends where one of them is 0, or where one of the transitions
//! no longer counts; the motion continues in the mode that this transition leaves.
//!
//! The motion is the limit of switches between both modes, ever faster. Surfaces of either mode therefore act on it. Those
//! of the mode of the state are watched as always; for those of the other mode, see `Watch::met_across`.
//!
//! Reference: A. F. Filippov, *Differential Equations with Discontinuous Righthand Sides* (1988), section 4.

use core::cell::RefCell;

use super::hits::Hits;
use super::impulse::Impacts;
use super::sides::{about, shortly_before};
use super::watch::Watch;
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::error::Fault;
use crate::events::first::{narrowed, onset};
use crate::integrate::Stepper;
use crate::numbers::{Interval, TaylorModel};
use crate::outcome::Outcome;
use crate::record::Observer;
use crate::state::StateVector;

/// Rounding error of the rate of the sliding motion, as a fraction of its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Two transitions that lead into each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slide {
    /// The transition out of the mode of the state.
    pub(super) back: usize,
    /// The transition out of the other mode.
    pub(super) across: usize,
}

/// Both fields at a state, and the gap rates with which they lead into the surface.
struct Sides<Sys: Impacting> {
    here: Sys::State,
    other: Sys::State,
    /// `[r_b, r_a]`
    rates: [f64; 2],
}

impl Slide {
    /// True if a surface at hand is another one that modes on both sides lead to. Where two such surfaces cross, the order
    /// of the transitions decides.
    pub(super) fn meets_another<Sys: Impacting>(
        self,
        system: &Sys,
        hits: &Hits<Sys::Gaps>,
    ) -> bool {
        (0..hits.count()).any(|surface| {
            surface != self.back
                && surface != self.across
                && hits.is_at_hand(surface)
                && system.opposite(surface).is_some()
        })
    }

    /// The state in the other mode.
    pub(super) fn across<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::State, Outcome> {
        Ok(system.landing(self.back, t, state)?.state)
    }

    /// The first fraction of the step, up to `reach`, at which the transition out of the other mode does not count,
    /// if it does not count at `reach`.
    pub(super) fn end_across<Sys: Impacting, Step: Stepper<Sys>>(
        self,
        reach: f64,
        step: &StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let (system, across) = (step.system, self.across);
        let ceases = |part: f64| {
            let t = step.time(part);
            let other = self.across(system, t, &step.state(part));
            other.is_ok_and(|other| !system.surface_active(across, t, &other))
        };
        match (ceases(0.0), ceases(reach)) {
            (true, _) => Some(0.0),
            (false, true) => Some(narrowed([0.0, reach], ceases).after),
            (false, false) => None,
        }
    }

    fn sides<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sides<Sys>, Fault> {
        let other = self
            .across(system, t, state)
            .map_err(|_| Fault::SingularSurface { surface: self.back })?;
        let mut rates = [system.zero_state(); 2];
        system.rate(t, state, &mut rates[0])?;
        system.rate(t, &other, &mut rates[1])?;
        let back = system.gap_rates(t, state)?.as_slice()[self.back];
        let across = system.gap_rates(t, &other)?.as_slice()[self.across];
        Ok(Sides {
            here: rates[0],
            other: rates[1],
            rates: [back, across],
        })
    }

    /// Speeds with which both modes lead into the surface, at the indices of their transitions; 0 elsewhere.
    pub(super) fn pressures<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::Gaps, Fault> {
        let [back, across] = self.sides(system, t, state)?.rates;
        let mut pressures = system.zero_gaps();
        pressures.as_mut_slice()[self.back] = -back;
        pressures.as_mut_slice()[self.across] = -across;
        Ok(pressures)
    }

    /// Replaces the rate of the present mode by that of the sliding motion.
    pub(super) fn add<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &mut Sys::State,
    ) -> Result<(), Fault> {
        let Sides { here, other, rates } = self.sides(system, t, state)?;
        let share = rates[0] / (rates[0] + rates[1]);
        let pairs = here.as_slice().iter().zip(other.as_slice());
        for (rate, (here, other)) in rate.as_mut_slice().iter_mut().zip(pairs) {
            let (alone, push) = (*rate, share * (other - here));
            *rate += push;
            // Across the surface the rates cancel. What is left by rounding would limit the steps.
            if rate.abs() <= ROUNDING * alone.abs() {
                *rate = 0.0;
            }
        }
        Ok(())
    }

    /// Brings the state back to the surface, along the difference of both fields.
    pub(super) fn settle<Sys: Impacting>(
        self,
        system: &Sys,
        t: f64,
        state: &mut Sys::State,
    ) -> Result<(), Fault> {
        let gap = system.gap(self.back, t, state);
        let Sides { here, other, rates } = self.sides(system, t, state)?;
        let step = gap / (rates[0] + rates[1]);
        if !step.is_finite() {
            return Ok(());
        }
        let pairs = here.as_slice().iter().zip(other.as_slice());
        for (value, (here, other)) in state.as_mut_slice().iter_mut().zip(pairs) {
            *value += step * (other - here);
        }
        Ok(())
    }
}

impl<Sys: Impacting> Watch<Sys> {
    /// The first fraction of the step, up to `reach`, at which a sliding motion meets a surface of the other mode by more
    /// than rounding errors, and the surface. A surface of both modes is watched in the mode of the state.
    pub(super) fn met_across<Step: Stepper<Sys>>(
        &mut self,
        reach: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<(f64, usize)>, Outcome> {
        let Some(slide) = self.held.slide() else {
            return Ok(None);
        };
        step.prepare()?;
        self.path.follow_dense(step);
        let system = step.system;
        let sides = |part: f64| -> Result<_, Outcome> {
            let (t, here) = (step.time(part), step.state(part));
            let other = slide.across(system, t, &here)?;
            let gaps = [&here, &other].map(|state| system.gaps(t, state));
            Ok(([here, other], gaps))
        };
        let ((_, start), (states, end)) = (sides(0.0)?, sides(reach)?);
        let mut first = None;
        for surface in 0..self.gaps.count() {
            // The same gap at both ends is that of a surface of both modes.
            let is_common = [&start, &end]
                .iter()
                .all(|[here, other]| here.as_slice()[surface] == other.as_slice()[surface]);
            if surface == slide.across || is_common {
                continue;
            }
            let until = first.map_or(reach, |(part, _)| part);
            let part = self.first_across((slide, surface), until, &states, step);
            first = part.map(|part| (part, surface)).or(first);
        }
        Ok(first)
    }

    /// The first fraction of the step, up to `reach`, at which one surface of the other mode is met. The states are those
    /// in this mode and in the other at one time.
    fn first_across<Step: Stepper<Sys>>(
        &self,
        (slide, surface): (Slide, usize),
        reach: f64,
        [here, other]: &[Sys::State; 2],
        step: &mut StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let system = step.system;
        // They have the same components except for the number of the mode.
        let changed = |i: usize| {
            let (one, other) = (here.as_slice()[i], other.as_slice()[i]);
            (one != other).then(|| TaylorModel::steady(Interval::point(other)))
        };
        let along = |part: [f64; 2]| {
            let component = |i: usize| changed(i).unwrap_or_else(|| self.path.component(i, part));
            system.gap_along(surface, self.path.time_model(part), &component)
        };
        let floor = {
            let sizes = self.sizes.as_slice();
            let rounded =
                |i: usize| changed(i).unwrap_or_else(|| about(here.as_slice()[i], sizes[i]));
            let time = about(step.t_end(), step.t_end());
            system.gap_along(surface, time, &rounded).range().width()
        };
        let is_behind = |part: f64, floor: f64, step: &StepView<'_, Sys, Step>| {
            let (t, state) = (step.time(part), step.state(part));
            slide.across(system, t, &state).is_ok_and(|other| {
                system.gap(surface, t, &other) < -floor && system.surface_active(surface, t, &other)
            })
        };
        if is_behind(0.0, floor, step) {
            return None;
        }
        let step = RefCell::new(step);
        let is_clear = |part| {
            step.borrow_mut().counters.enclosures += 1;
            along(part).range().lo >= -floor
        };
        let found = onset(reach, is_clear, |part| {
            is_behind(part, floor, &step.borrow())
        })?;
        Some(shortly_before(found.after, |part| is_behind(part, 0.0, &step.borrow())).after)
    }
}

impl<Sys: Impacting> Impacts<Sys> {
    /// The impact of a sliding motion on a surface of the other mode. Afterwards the motion slides on if both modes still
    /// lead into each other.
    pub(super) fn strike_across<O: Observer<Sys>>(
        &mut self,
        surface: usize,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let Some(slide) = self.resting.held().slide() else {
            return Ok(());
        };
        self.resting.end_slide(slide, slide.across, now, observer)?;
        self.watch.hold(self.resting.held());
        let rates = now.system.gap_rates(now.t, now.state)?;
        if rates.as_slice()[surface] >= 0.0 {
            // Only the other mode leads there, in which the surface does not act.
            return Err(Outcome::Ambiguous {
                surfaces: [surface, slide.across],
            });
        }
        let arrived = *now.state;
        let hits = |surface: usize| Hits::all_of(core::iter::once(surface), &rates);
        self.strike(hits(surface), now, observer)?;
        let positions = [&arrived, now.state].map(|state| now.system.position(state));
        match positions[0] == positions[1]
            && now.system.mode(&arrived) == now.system.mode(now.state)
        {
            true => self.strike(hits(slide.across), now, observer),
            false => Ok(()),
        }
    }
}
