//! Rest on several surfaces at once: the bottom of a groove.
//!
//! There, hops on one surface end in sliding, sliding ends in an impact on another, and the motion hops again, ever
//! faster, so that the accumulations themselves accumulate. It rests once its flights are shorter than the rounding of
//! the time: the contact force of each surface would then bring the motion back to it at once.

use super::held::{Held, second_rates};
use super::hits::Hits;
use super::impulse::Impacts;
use super::instantaneous::is_rough;
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::error::Fault;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::policy::Rest;
use crate::record::Observer;
use crate::state::StateVector;

/// Bounds below which a flight from a surface counts as over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Brief {
    /// Duration, relative to the time of the run.
    moment: f64,
    /// Height, in units of the rounding error of the gap.
    height: f64,
}

impl Brief {
    /// A flight that cannot be resolved.
    pub(super) const UNRESOLVED: Self = Self {
        moment: 512.0 * f64::EPSILON,
        height: 64.0,
    };

    /// A flight during which rounding decides the order of impacts.
    pub(super) const UNORDERED: Self = Self {
        moment: 1.0 / (1 << 30) as f64,
        height: (1 << 14) as f64,
    };

    /// True for a flight at `t` that begins with this gap rate, while `back` is the second rate by which the gap falls. `rounding`
    /// is that of the gap.
    fn covers(self, rate: f64, back: f64, t: f64, rounding: f64) -> bool {
        2.0 * rate <= back * self.moment * t.abs()
            || rate * rate <= 2.0 * back * self.height * rounding
    }
}

/// Time between two impacts, in such flights, up to which the motion may be at the bottom.
const SINCE: f64 = 4.0;

/// The same, relative to the time of the run.
const RECENT: f64 = 1.0 / (1 << 10) as f64;

impl<Sys: Impacting> Impacts<Sys> {
    /// Ends an accumulation of impacts on several surfaces, if the flights that follow are brief. True if it does: the
    /// motion rests on these surfaces.
    pub(super) fn ends_at_bottom<O: Observer<Sys>>(
        &mut self,
        hits: &Hits<Sys::Gaps>,
        brief: Brief,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<bool, Outcome> {
        let Some(bottom) = self.bottom(hits, brief, now)? else {
            return Ok(false);
        };
        self.resting.rest_on(bottom, now, observer)?;
        self.watch.hold(self.resting.held());
        let rates = now.system.gap_rates(now.t, now.state)?;
        self.watch.leave(hits, now, rates)?;
        Ok(true)
    }

    /// True if held surfaces, behind kinks of their gaps, would let the motion go only for flights that cannot be resolved.
    pub(super) fn holds_beyond_kink(&self, now: &mut Moment<'_, Sys>) -> Result<bool, Outcome> {
        let (system, t, held) = (now.system, now.t, *self.resting.held());
        if held.slide().is_some() {
            return Ok(false);
        }
        let Some(forces) = held.sizes(system, t, now.state)? else {
            return Ok(false);
        };
        let rates = system.gap_rates(t, now.state)?;
        for surface in held.iter() {
            if !self.brings_back(surface, [&forces, &rates], Brief::UNRESOLVED, now)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// True if the contact force of a surface ends a flight that begins with its gap rate, and the flight is brief. Given are
    /// the forces and the gap rates of all surfaces.
    fn brings_back(
        &self,
        surface: usize,
        [forces, rates]: [&Sys::Gaps; 2],
        brief: Brief,
        now: &mut Moment<'_, Sys>,
    ) -> Result<bool, Fault> {
        let contact = now.system.contact(surface, now.t, now.state)?;
        let back = contact.constrained_compliance * forces.as_slice()[surface];
        let rate = rates.as_slice()[surface].abs();
        let rounding = self.watch.rounding_at_cut(surface, now);
        Ok(back > 0.0 && brief.covers(rate, back, now.t, rounding))
    }

    /// The surfaces on which the motion comes to rest. `None` if they are fewer than two, or if it rises from one
    /// of them for a time that can be resolved.
    fn bottom(
        &self,
        hits: &Hits<Sys::Gaps>,
        brief: Brief,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Option<Held<Sys::Gaps>>, Outcome> {
        let (system, t) = (now.system, now.t);
        let is_candidate = self.policies.rest == Rest::Contact
            && hits.count() > 1
            && self.resting.held().slide().is_none();
        if !is_candidate {
            return Ok(None);
        }
        let rates = system.gap_rates(t, now.state)?;
        if !self.follows_brief_flight(hits, &rates, brief, now) {
            return Ok(None);
        }
        let mut bottom = self.within_reach(hits, &rates, brief, now)?;
        // The division of a common impulse between two surfaces with instantaneous constraints is undetermined.
        let mut rough = 0;
        for surface in bottom.iter() {
            rough += u32::from(is_rough(system, surface, t, now.state)?);
        }
        if rough > 1 {
            return Ok(None);
        }
        while bottom.iter().nth(1).is_some() {
            let Some(forces) = bottom.sizes(system, t, now.state)? else {
                return Ok(None);
            };
            let mut rising = None;
            for surface in bottom.iter() {
                if !self.brings_back(surface, [&forces, &rates], brief, now)? {
                    rising = Some(surface);
                }
            }
            match rising {
                Some(surface) => bottom.release(surface),
                None => {
                    let must_act =
                        |surface| hits.is_approached(surface, &rates) && !bottom.is_held(surface);
                    return Ok((!(0..hits.count()).any(must_act)).then_some(bottom));
                }
            }
        }
        Ok(None)
    }

    /// True if the flight since the last impact was brief, judged by the surfaces that it ends on.
    fn follows_brief_flight(
        &self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        brief: Brief,
        now: &mut Moment<'_, Sys>,
    ) -> bool {
        let t = now.t;
        let Some(length) = self.accumulation.last().map(|last| t - last) else {
            return false;
        };
        if length <= SINCE * brief.moment * t.abs() {
            return true;
        }
        length <= RECENT * t.abs()
            && (0..hits.count()).any(|surface| {
                let height = 0.25 * length * rates.as_slice()[surface].abs();
                hits.is_approached(surface, rates)
                    && height <= brief.height * self.watch.rounding_at_cut(surface, now)
            })
    }

    /// The surfaces that may hold the motion, and which it touches or reaches within a moment.
    fn within_reach(
        &self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        brief: Brief,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Held<Sys::Gaps>, Outcome> {
        let (system, t) = (now.system, now.t);
        let mut within = *self.resting.held();
        let mut rate = system.zero_state();
        system.rate(t, now.state, &mut rate)?;
        let second = second_rates(system, t, now.state, &rate)?;
        now.counters.event_evaluations += 1;
        let gaps = system.gaps(t, now.state);
        for surface in 0..rates.count() {
            let of = |values: &Sys::Gaps| values.as_slice()[surface].abs();
            let moment = brief.moment * t.abs();
            let reach = moment * (of(rates) + moment * second.as_ref().map_or(0.0, of));
            let rounding = brief.height * self.watch.rounding_at_cut(surface, now);
            let is_wall =
                !self.watch.is_passable(surface) && self.law_of(system, surface) != Law::Stop;
            if is_wall
                && (hits.is_at_hand(surface) || of(&gaps) <= reach.max(rounding))
                && system.surface_active(surface, t, now.state)
            {
                within.hold(surface);
            }
        }
        Ok(within)
    }
}
