//! The impacts of one moment: rounds over the surfaces at hand, and the result of each law.

use core::ops::{ControlFlow, RangeInclusive};

use super::accumulation::{Bounce, Ends};
use super::corner::Recurrence;
use super::held::Held;
use super::hits::Hits;
use super::impulse::Impacts;
use super::instantaneous::focused;
use super::quiet::{quieten_balanced, quieten_beside, quieten_held};
use super::resting::is_at_rest;
use super::sliding::Slide;
use super::wave::{Limit, Wave};
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::error::Fault;
use crate::law::{Blow, Law};
use crate::outcome::Outcome;
use crate::policy::{Penetration, Split};
use crate::record::{Event, Observer};
use crate::state::StateVector;

/// Ratio of the gap rates after and before an impact below which the rate after it counts as 0: `2^-36`, the rounding
/// of a plastic impact in a metric of condition `1e4`.
pub(super) const STILL: f64 = 1.0 / (1_u64 << 36) as f64;

/// Ratios of the gap rates after and before a reset at which the rate after it counts as 0. A sum of numbers of one size that
/// cancel is a rounding error, or 0; a smaller rate was set.
const CANCELLED: RangeInclusive<f64> = f64::EPSILON / 16.0..=8.0 * f64::EPSILON;

/// Result of an impact on a state.
pub(super) struct Struck<Sys: Impacting> {
    pub(super) after: Sys::State,
    /// Gap rates after the impact.
    pub(super) rates: Sys::Gaps,
    /// True if the impact was an impulse, false for a reset or a transition.
    by_impulse: bool,
    /// True if rounding may have decided between two possible continuations.
    is_graze: bool,
}

/// An impact to apply.
#[derive(Debug, Clone, Copy)]
struct Strike {
    surface: usize,
    /// Gap rate at which the surface is approached.
    rate: f64,
    /// True if other surfaces are hit at the same moment.
    simultaneous: bool,
    /// Threshold: a gap rate above `-still` counts as not approaching.
    still: f64,
    /// True if the surface was struck at this moment before.
    again: bool,
}

/// Next action at the same moment after an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Next {
    /// Impacts on the surfaces that are still approached.
    Impacts,
    /// Infinitely many impacts at one time.
    Rest,
}

/// Number of transitions at one moment. Finite sequences are short, because each transition loses energy (Cortes and
/// Vinogradov, Remark 5.8).
struct Passages(u32);

impl Passages {
    /// Number of transitions at one moment beyond which the motion counts as trapped between modes.
    const MOST: u32 = 64;

    fn are_endless(&self) -> bool {
        self.0 >= Self::MOST
    }
}

impl<Sys: Impacting> Impacts<Sys> {
    /// Applies impacts until none of the surfaces at hand is approached.
    pub(super) fn strike<O: Observer<Sys>>(
        &mut self,
        mut hits: Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let mut rates = self.arrive(&mut hits, now)?;
        let mut several = hits.approached(&rates) > 1;
        let mut verdict = self.verdict();
        let mut passages = Passages(0);
        let mut recurrence = Recurrence::new();
        let mut wave = Wave::none(&rates);
        while let Some(surface) = self.next(&mut hits, &rates, &mut verdict, now)? {
            if now.counters.impacts >= self.budget {
                return Err(Outcome::ImpactBudget);
            }
            let rate = rates.as_slice()[surface];
            let is_map = self.law_of(now.system, surface).is_map();
            let mut still = STILL * rate.abs();
            if !is_map {
                if self.watch.is_tangential_crossing(surface) {
                    return Err(Outcome::TangentialCrossing { surface });
                }
                still = hits.set_still(surface, still).unwrap_or(still);
            }
            let strike = Strike {
                surface,
                rate,
                simultaneous: several,
                still,
                again: hits.note_struck(surface),
            };
            let (arrived, rates_before) = (*now.state, rates);
            let mut next;
            (rates, next) = self.impact(strike, now, observer)?;
            if is_map {
                let after = &mut rates.as_mut_slice()[surface];
                if CANCELLED.contains(&(*after / rate).abs()) {
                    *after = 0.0;
                }
                wave = Wave::none(&rates);
                let course = (&mut hits, &mut passages);
                self.follow_map(surface, (&arrived, &rates), course, now, observer)?;
            } else {
                let both = [&rates_before, &rates];
                self.follow_impulse(surface, (&arrived, both), &mut hits, now)?;
                wave.add(surface, both.map(|rates| rates.as_slice()[surface]));
                if recurrence.add(now)? {
                    if !(wave.is_lossy() && self.may_rest(surface)) {
                        return Err(Outcome::Zeno { t: now.t, surface });
                    }
                    recurrence = Recurrence::new();
                    wave.seek_limit();
                    next = Next::Rest;
                }
            }
            if next == Next::Rest {
                match self.reach_limit(&mut wave, surface, now)? {
                    Limit::Reached(still) => {
                        rates = self.quieten_limit(&mut hits, &still, now)?;
                    }
                    Limit::Later => {}
                    Limit::Unknown => break,
                }
            }
            several = several || hits.approached(&rates) > 0;
        }
        self.watch.leave(&hits, now, rates)
    }

    /// The gap rates on arrival, on the near side of a kink. Gap rates that are rounding errors do not count as approaching.
    fn arrive(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Sys::Gaps, Outcome> {
        let mut rates = self.watch.rates_here(now)?;
        if let Some(before) = self.watch.before_kink(hits, &rates, now)? {
            (*now.state, rates) = (before.state, before.rates);
        }
        if let Some(slide) = self.resting.held().slide()
            && !slide.meets_another(now.system, hits)
        {
            // It is part of the motion.
            hits.set_done(slide.back);
        }
        quieten_held(hits, self.resting.held(), &rates, now)?;
        let length = self.watch.length;
        quieten_balanced(hits, self.resting.held(), &rates, length, now)?;
        self.pass_by_touched(hits, now);
        Ok(rates)
    }

    /// The surfaces at hand after a reset or a transition of the state `arrived`. The motion may be in another mode, or elsewhere.
    fn follow_map<O: Observer<Sys>>(
        &mut self,
        surface: usize,
        (arrived, rates): (&Sys::State, &Sys::Gaps),
        (hits, passages): (&mut Hits<Sys::Gaps>, &mut Passages),
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        if now.system.mode(now.state) != now.system.mode(arrived) {
            if passages.are_endless() {
                return Err(self.trapped(surface, now.t));
            }
            passages.0 += 1;
            self.land(arrived, (&mut *hits, rates), now, observer)?;
            self.watch.pass_by(hits, now.system);
            self.watch.reopen(hits, rates, now);
            return self.slide(surface, hits, rates, now, observer);
        }
        hits.set_done(surface);
        if now.system.position(now.state) != now.system.position(arrived) {
            let before = *hits;
            self.land(arrived, (&mut *hits, rates), now, observer)?;
            self.watch.keep_at_hand(hits, &before, arrived, now)?;
            self.watch.reopen(hits, rates, now);
            self.check_ways_back(surface, (hits, rates), now.t)?;
        }
        Ok(())
    }

    /// The surfaces at hand after an impulse on the state `arrived`, with the gap rates before and after it.
    fn follow_impulse(
        &mut self,
        surface: usize,
        (arrived, both): (&Sys::State, [&Sys::Gaps; 2]),
        hits: &mut Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let [_, rates] = both;
        // A gap rate that is still negative here is a rounding error.
        hits.set_still(surface, -rates.as_slice()[surface]);
        quieten_beside(hits, surface, both, arrived, now)?;
        self.watch.touch(hits, rates, now)
    }

    /// Marks surfaces that are met at gap rate 0 as settled, if they may hold the motion: if it presses into them from now on, they do.
    fn pass_by_touched(&self, hits: &mut Hits<Sys::Gaps>, now: &Moment<'_, Sys>) {
        for surface in 0..hits.count() {
            if self.watch.is_tangential_crossing(surface)
                && self.may_rest(surface)
                && !self.law_of(now.system, surface).is_map()
            {
                hits.set_done(surface);
            }
        }
    }

    /// Finds the surfaces at hand where a reset or a transition has led.
    fn land<O: Observer<Sys>>(
        &mut self,
        arrived: &Sys::State,
        (hits, rates): (&mut Hits<Sys::Gaps>, &Sys::Gaps),
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.watch.resize(arrived, now.state);
        self.watch.relocate(hits, rates, now)?;
        self.resting.keep(hits, now, observer)?;
        self.watch.hold(self.resting.held());
        Ok(())
    }

    /// Ends the run if a reset has led onto a surface that acted at this moment before, and the ways back to this surface became
    /// ever shorter: the last one takes no time that can be resolved.
    fn check_ways_back(
        &mut self,
        surface: usize,
        (hits, rates): (&Hits<Sys::Gaps>, &Sys::Gaps),
        t: f64,
    ) -> Result<(), Outcome> {
        self.accumulation.lead_off(surface, t);
        for surface in 0..hits.count() {
            let returns = hits.is_settled(surface) && rates.as_slice()[surface] < 0.0;
            if returns && self.watch.is_passable(surface) && self.accumulation.leads_back(surface) {
                return Err(Outcome::Zeno { t, surface });
            }
        }
        Ok(())
    }

    /// The end of a motion between modes that lead to each other at the time `t`: an accumulation if they did so at short
    /// intervals before.
    pub(super) fn trapped(&self, surface: usize, t: f64) -> Outcome {
        match self.accumulation.has_quickened(t) {
            true => Outcome::Zeno { t, surface },
            false => Outcome::Trapped { surface },
        }
    }

    /// The gap rates in the limit of impacts on these surfaces, which are rounding errors for them.
    fn quieten_limit(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        still: &Held<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Sys::Gaps, Outcome> {
        let rates = now.system.gap_rates(now.t, now.state)?;
        for surface in still.iter() {
            hits.set_still(surface, -rates.as_slice()[surface]);
        }
        self.watch.touch(hits, &rates, now)?;
        Ok(rates)
    }

    /// Begins to slide, if the mode just entered through a surface leads back at once and only the mode changed.
    fn slide<O: Observer<Sys>>(
        &mut self,
        across: usize,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        match now.system.opposite(across) {
            Some(back) if hits.is_approached(back, rates) => {
                hits.set_done(back);
                self.resting
                    .begin_slide(Slide { back, across }, now, observer)?;
                self.watch.hold(self.resting.held());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The impulse of the law in force, before any correction of its rounding error.
    fn blow(
        &self,
        system: &Sys,
        surface: usize,
        t: f64,
        state: &Sys::State,
    ) -> Result<Blow<Sys::Impulse>, Fault> {
        match self.overrides.get(surface).flatten() {
            Some(law) => Ok(system.contact(surface, t, state)?.blow(law)),
            None => system.blow(surface, t, state),
        }
    }

    /// Result of the law in force for a state that approaches a surface at gap rate `rate`, after the instantaneous
    /// constraints of the surface.
    pub(super) fn struck(
        &self,
        system: &Sys,
        surface: usize,
        rate: f64,
        t: f64,
        before: &Sys::State,
    ) -> Result<Struck<Sys>, Outcome> {
        let law = self.law_of(system, surface);
        if law.is_map() {
            let landing = system.landing(surface, t, before)?;
            if landing.is_one_of_several && self.policies.split == Split::Stop {
                return Err(Outcome::Ambiguous {
                    surfaces: [surface; 2],
                });
            }
            let rates = system.gap_rates(t, &landing.state)?;
            return Ok(Struck {
                after: landing.state,
                rates,
                by_impulse: false,
                is_graze: landing.is_graze,
            });
        }
        let (before, rate) = match focused(system, surface, t, before)? {
            None => (*before, rate),
            Some(focused) => {
                let rates = system.gap_rates(t, &focused)?;
                let rate = rates.as_slice()[surface];
                if rate >= 0.0 {
                    // The instantaneous constraints alone have reversed the motion.
                    return Ok(Struck {
                        after: focused,
                        rates,
                        by_impulse: true,
                        is_graze: false,
                    });
                }
                (focused, rate)
            }
        };
        let blow = self.blow(system, surface, t, &before)?;
        let mut after = before;
        system.kick(&mut after, blow.size, &blow.direction);
        // NOTE: `dh(pi_D grad h)` is rounded, for a constant metric always in the same direction. Without this
        // correction, the energy would drift like the number of impacts instead of its square root. The error is
        // measured half way: for an elastic law the gap rate there is small and has a small rounding error.
        let taken = blow.share * rate;
        let half = rate - 0.5 * taken;
        let middle = system.gap_rates(t, &between(&before, &after))?.as_slice()[surface];
        let missed = 2.0 * (half - middle);
        let correction = -missed / taken * blow.size;
        if correction.is_finite() {
            system.kick(&mut after, correction, &blow.direction);
        }
        let rates = system.gap_rates(t, &after)?;
        match after.as_slice().iter().position(|value| !value.is_finite()) {
            Some(component) => Err(Outcome::NonFinite { component }),
            None => Ok(Struck {
                after,
                rates,
                by_impulse: true,
                is_graze: false,
            }),
        }
    }

    /// Applies one impact. Returns the gap rates after it, and the next action.
    fn impact<O: Observer<Sys>>(
        &mut self,
        strike: Strike,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(Sys::Gaps, Next), Outcome> {
        let Strike {
            surface,
            rate,
            simultaneous,
            ..
        } = strike;
        let (t, before) = (now.t, *now.state);
        let mut struck = self.struck(now.system, surface, rate, t, &before)?;
        let penetrates = self.penetrates(strike, struck.rates.as_slice()[surface], now);
        let repeats = struck.by_impulse && self.policies.penetration == Penetration::Repeat;
        if penetrates && repeats {
            struck.take_rate(now.system, surface, t)?;
        }
        *now.state = struck.after;
        now.counters.impacts += 1;
        let event = Event {
            t,
            surface,
            law: self.law_of(now.system, surface),
            before,
            after: struck.after,
            simultaneous,
            graze: self.watch.is_graze(surface) || struck.is_graze,
        };
        if let ControlFlow::Break(()) = observer.event(&event) {
            return Err(Outcome::Stopped);
        }
        if struck.by_impulse && penetrates && self.policies.penetration == Penetration::Stop {
            let rho = now.system.contact(surface, t, &before)?.rho();
            return Err(Outcome::StillPenetrating { surface, rho });
        }
        if now.counters.impacts >= self.budget {
            return Err(Outcome::ImpactBudget);
        }
        let leads_on = now.system.mode(&before) != now.system.mode(&struck.after);
        match struck.by_impulse {
            // The motion goes on through the surface, in another mode, or elsewhere.
            false if penetrates || leads_on || self.is_displaced(surface, &before, now) => {
                match self.accumulation.pass(surface, t) {
                    Some(_) => Err(Outcome::Zeno { t, surface }),
                    None => Ok((struck.rates, Next::Impacts)),
                }
            }
            _ => self.accumulate(strike, struck, now),
        }
    }

    /// True if a reset of the state `before` has led off its surface. A state before the reset may be as far off, within the
    /// rounding of times.
    fn is_displaced(&self, surface: usize, before: &Sys::State, now: &mut Moment<'_, Sys>) -> bool {
        let [from, to] = [before, &*now.state].map(|state| now.system.gap(surface, now.t, state));
        to.abs().min((to - from).abs()) > 2.0 * self.watch.rounding(surface, now)
    }

    /// True if the state still approaches a surface after an impact.
    fn penetrates(&self, strike: Strike, rate_after: f64, now: &mut Moment<'_, Sys>) -> bool {
        // After a slow impact, rounding errors that the impact has amplified may decide the sign of the rate.
        let watch = &self.watch;
        let surface = strike.surface;
        rate_after < -strike.still
            && !watch.is_slow(surface, 0.25 * rate_after, || watch.rounding(surface, now))
            && !is_at_rest(now.system, surface, rate_after, (now.t, now.state)).unwrap_or(false)
    }

    /// Records an impact in the accumulation. Returns the gap rates and the next action.
    fn accumulate(
        &mut self,
        strike: Strike,
        mut struck: Struck<Sys>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(Sys::Gaps, Next), Outcome> {
        let Strike { surface, rate, .. } = strike;
        let (system, t) = (now.system, now.t);
        let rate_after = struck.rates.as_slice()[surface];
        // A reset sets the rate exactly. An impulse leaves rounding errors, relative to the rate that it removes.
        let still = match struck.by_impulse {
            true => strike.still,
            false => 0.0,
        };
        let bounce = Bounce {
            surface,
            t,
            rates: [rate, if rate_after > still { rate_after } else { 0.0 }],
            again: strike.again,
            by_impulse: struck.by_impulse,
        };
        let may_rest = self.may_rest(surface);
        // A first-order system has no energy; the rate at which its motion leaves the surface replaces it.
        let energy = || match system.energy(t, &struck.after) {
            Ok(energy) => Some(energy),
            Err(Fault::FirstOrder) => Some(rate_after * rate_after),
            Err(_) => None,
        };
        let watch = &self.watch;
        let rounding = || watch.rounding(surface, now);
        match self.accumulation.add(bounce, rounding, energy) {
            None => Ok((struck.rates, Next::Impacts)),
            Some(Ends::Spasmodic(t)) => Err(Outcome::Spasmodic { t, surface }),
            Some(Ends::Hops(t)) if may_rest => {
                // The hops are too small to be resolved: the remaining rate of the last one is removed.
                struck.take_rate(system, surface, now.t)?;
                *now.state = struck.after;
                self.resting.note_accumulation(surface, t);
                Ok((struck.rates, Next::Impacts))
            }
            // The motion does not bounce off the surface and presses into it.
            Some(Ends::AtOneTime(_)) if bounce.rates[1] == 0.0 => Ok((struck.rates, Next::Rest)),
            Some(Ends::AtOneTime(t)) if may_rest && bounce.rates[1] < rate.abs() => {
                self.resting.note_accumulation(surface, t);
                Ok((struck.rates, Next::Rest))
            }
            Some(Ends::Hops(t) | Ends::AtOneTime(t)) => Err(Outcome::Zeno { t, surface }),
        }
    }
}

impl<Sys: Impacting> Struck<Sys> {
    /// Removes the whole gap rate of this surface.
    fn take_rate(&mut self, system: &Sys, surface: usize, t: f64) -> Result<(), Outcome> {
        let contact = system.contact(surface, t, &self.after)?;
        let impulse = contact.impulse(Law::ImpactPlastic);
        system.kick(&mut self.after, impulse, &contact.direction);
        self.rates = system.gap_rates(t, &self.after)?;
        Ok(())
    }
}

/// The state half way between two.
///
/// NOTE: unchanged components stay bitwise the same, so that quantities that depend on them are computed once.
#[inline(always)]
fn between<S: StateVector>(one: &S, other: &S) -> S {
    let mut middle = *one;
    for (middle, other) in middle.as_mut_slice().iter_mut().zip(other.as_slice()) {
        if middle.to_bits() != other.to_bits() {
            *middle = 0.5 * *middle + 0.5 * other;
        }
    }
    middle
}
