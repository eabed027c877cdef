//! The effect that finds impacts in a step and applies their laws.

use core::ops::ControlFlow;

use super::accumulation::{Accumulation, Bounce, Ends};
use super::bottom::Brief;
use super::corner::Recurrence;
use super::held::Held;
use super::hits::Hits;
use super::instantaneous::focused;
use super::resting::{Resting, is_at_rest};
use super::sliding::Slide;
use super::watch::Watch;
use crate::audit::{Audit, Auditor};
use crate::contract::Impacting;
use crate::effects::{Change, Effect, Moment, SceneEffects, StepView};
use crate::error::Fault;
use crate::integrate::Stepper;
use crate::law::{Blow, Law};
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::policy::{Penetration, Policies, Rest, Split};
use crate::record::{Event, Observer};
use crate::state::StateVector;

/// Default limit of the number of impacts of a run.
pub const IMPACT_BUDGET: u64 = 10_000_000;

/// Ratio of the gap rates after and before an impact below which the rate after it counts as 0: `2^-36`, the rounding
/// of a plastic impact in a metric of condition `1e4`.
pub(super) const STILL: f64 = 1.0 / (1_u64 << 36) as f64;

/// Impacts of a system on its surfaces. Each surface has its declared law unless another was chosen.
///
/// Simultaneous impacts (within rounding) act in rounds, each in order of index, until no surface at hand is
/// approached. Touching surfaces that are approached after an impact join the next round, so that a wave of impacts
/// passes through touching bodies at one time. The [`Policies`] decide the continuation where the order of a round
/// matters, where a law leaves the state approaching, and where the motion presses into a surface. By default the run
/// ends there; after an impact, it ends with the state after the impact.
///
/// At a surface with instantaneous constraints, the state is first projected onto them ([`Impacting::focus`]). If the
/// state still approaches the surface, the law acts within the constraints. Instantaneous constraints also hold while
/// the motion goes on along the surface.
///
/// A surface with the law [`Law::Reset`] has no forbidden side. It acts whenever its gap falls through 0 from above;
/// if the reset leaves the gap falling, the motion crosses the surface. At the first instant of a run, and after a
/// reset of positions, a surface at hand acts if it is approached. Such a surface does not hold the motion.
///
/// A surface with the law [`Law::Stop`] ends the run as [`Outcome::StoppedAt`] when it is approached, before other
/// surfaces at hand act.
///
/// # Examples
///
/// ```
/// use dalembert::{Dop853, Impacts, Law, Simulation, System, Tolerance};
///
/// # dalembert::model! {
/// #     pub Ball {
/// #         coordinates { x; }
/// #         lagrangian = dot(x)^2/2 - x;
/// #         impacts { floor: x >= 0; }
/// #         initial { x = 1; }
/// #     }
/// # }
///
/// let ball = Ball::default();
/// let state = ball.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let effects = Impacts::declared(&ball).with_law(0, Law::Restitution(0.8));
/// let run = Simulation::new(&ball, Dop853::new(Tolerance::new(1e-12)?), effects).run(0.0, state, 1.5, &mut ())?;
///
/// // The first impact leaves the energy 0.8^2 of 1/2.
/// assert!((ball.energy(run.t, &run.state)? - 0.32).abs() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Impacts<Sys: Impacting> {
    overrides: PerSurface<Option<Law>, Sys::Gaps>,
    budget: u64,
    pub(super) policies: Policies,
    pub(super) watch: Watch<Sys>,
    pub(super) accumulation: Accumulation<Sys::Gaps>,
    pub(super) resting: Resting<Sys::Gaps>,
}

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
    /// Contact: infinitely many impacts have reached their limit, and surfaces still approached hold the motion.
    Rest,
}

/// Number of transitions at one moment. Finite sequences are short, because each transition loses energy (Cortes and
/// Vinogradov, Remark 5.8).
struct Passages(u32);

impl Passages {
    /// Number of transitions at one moment beyond which the motion counts as trapped between modes.
    const MOST: u32 = 64;

    fn count(&mut self, surface: usize) -> Result<(), Outcome> {
        self.0 += 1;
        match self.0 > Self::MOST {
            true => Err(Outcome::Trapped { surface }),
            false => Ok(()),
        }
    }
}

impl<Sys: Impacting> Impacts<Sys> {
    /// Impacts with the declared laws.
    pub fn declared(system: &Sys) -> Self {
        let gaps = system.zero_gaps();
        Self {
            overrides: PerSurface::all(&gaps, None),
            budget: IMPACT_BUDGET,
            policies: Policies::default(),
            watch: Watch::new(system),
            accumulation: Accumulation::none(&gaps),
            resting: Resting::none(&gaps),
        }
    }

    /// Replaces the law of a surface. The coefficient of the law is used as given: a coefficient above 1 adds energy at
    /// every impact. An index past the last surface has no effect.
    #[must_use]
    pub fn with_law(mut self, surface: usize, law: Law) -> Self {
        self.overrides.set(surface, Some(law));
        self
    }

    /// Ends runs after this many impacts instead of [`IMPACT_BUDGET`].
    #[must_use]
    pub fn with_budget(mut self, budget: u64) -> Self {
        self.budget = budget;
        self
    }

    /// Replaces the policies.
    #[must_use]
    pub fn with_policies(mut self, policies: Policies) -> Self {
        self.policies = policies;
        self
    }

    /// The contact forces `lambda_c`, one per surface, 0 for surfaces that do not hold the motion now: a surface
    /// pushes by `lambda_c pi_D^* dh_c`. `None` for a system without second rates of its gaps.
    ///
    /// # Errors
    /// A [`Fault`] where the rates or the forces do not exist.
    pub fn contact_forces(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Option<Sys::Gaps>, Fault> {
        self.resting.held().sizes(system, t, state)
    }

    /// Handles a motion that presses into a surface at the start of a step.
    fn press<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let t = step.t_start();
        let law = self.law_of(step.system, surface);
        if law == Law::Stop {
            return Err(self.stopped_at(surface));
        }
        let is_map = law.is_map();
        if is_map && self.accumulation.has_passed_on(surface, t) {
            return Err(Outcome::Zeno { t, surface });
        }
        let is_held = self.resting.held().is_held(surface);
        if law == Law::Transition && !is_held && !self.accumulation.has_passed_at(surface, t) {
            // It begins to count where the motion is on it.
            self.resting.count(surface, t)?;
            self.watch.cut_at(surface, 0.0, step.length());
            return Ok(Some(0.0));
        }
        // After a bounce: the hops have become too small to rise from the surface.
        let accumulation = self.accumulation.ends_at(surface, t);
        match (self.may_rest(surface), accumulation) {
            (false, None) => return Err(Outcome::Contact { surface }),
            (false, Some(t)) => return Err(Outcome::Zeno { t, surface }),
            (true, Some(t)) => self.resting.note_accumulation(surface, t),
            (true, None) => {}
        }
        self.resting.press(surface, t)
    }

    /// The end of a run at a surface with the law [`Law::Stop`].
    pub(super) fn stopped_at(&self, surface: usize) -> Outcome {
        Outcome::StoppedAt {
            surface,
            graze: self.watch.is_graze(surface),
        }
    }

    /// True if the motion may go on along a surface. A surface with a reset does not hold the motion.
    fn may_rest(&self, surface: usize) -> bool {
        self.policies.rest == Rest::Contact && !self.watch.is_passable(surface)
    }

    /// The law in force on a surface.
    pub fn law_of(&self, system: &Sys, surface: usize) -> Law {
        let law = self.overrides.get(surface).flatten();
        law.unwrap_or_else(|| system.law(surface))
    }

    /// True if the motion may be on both sides of a surface.
    fn passes(&self, system: &Sys, surface: usize) -> bool {
        self.law_of(system, surface).is_map() && system.is_passable(surface)
    }

    /// Applies impacts until none of the surfaces at hand is approached.
    pub(super) fn strike<O: Observer<Sys>>(
        &mut self,
        mut hits: Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let mut rates = self.watch.rates_here(now)?;
        if let Some(slide) = self.resting.held().slide()
            && !slide.meets_another(now.system, &hits)
        {
            // It is part of the motion.
            hits.set_done(slide.back);
        }
        let mut several = hits.approached(&rates) > 1;
        let mut verdict = self.verdict();
        let mut passages = Passages(0);
        let mut recurrence = Recurrence::new();
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
            let arrived = *now.state;
            let next;
            (rates, next) = self.impact(strike, now, observer)?;
            if is_map {
                let changes = now.system.mode(now.state) != now.system.mode(&arrived);
                match changes {
                    true => passages.count(surface)?,
                    false => hits.set_done(surface),
                }
                if changes || now.system.position(now.state) != now.system.position(&arrived) {
                    self.watch.resize(&arrived, now.state);
                    self.watch.relocate(&mut hits, &rates, now)?;
                    self.resting.keep(&hits, now, observer)?;
                    self.watch.hold(self.resting.held());
                }
                if changes {
                    self.watch.pass_by(&mut hits);
                    self.slide(surface, &mut hits, &rates, now, observer)?;
                }
            } else {
                // A gap rate that is still negative here is a rounding error.
                hits.set_still(surface, -rates.as_slice()[surface]);
                self.watch.touch(&mut hits, &rates, now)?;
                if recurrence.add(now)? {
                    return Err(Outcome::Zeno { t: now.t, surface });
                }
            }
            if next == Next::Rest {
                break;
            }
            several = several || hits.approached(&rates) > 0;
        }
        self.watch.leave(&hits, now, rates)
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
            // The motion goes on through the surface, or in another mode.
            false if penetrates || leads_on => match self.accumulation.pass(surface, t) {
                Some(_) => Err(Outcome::Zeno { t, surface }),
                None => Ok((struck.rates, Next::Impacts)),
            },
            _ => self.accumulate(strike, struck, now),
        }
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

impl<Sys: Impacting> Effect<Sys> for Impacts<Sys> {
    type Forces = Held<Sys::Gaps>;

    #[inline(always)]
    fn forces(&self) -> Option<Held<Sys::Gaps>> {
        self.resting.forces()
    }

    fn begin<O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let gaps = now.system.zero_gaps();
        self.accumulation = Accumulation::none(&gaps);
        self.resting = Resting::none(&gaps);
        for surface in 0..gaps.count() {
            let (law, declared) = (self.law_of(now.system, surface), now.system.law(surface));
            if law.is_map() && law != declared {
                return Err(Outcome::NoReset { surface });
            }
            let passes = self.passes(now.system, surface);
            self.watch.set_passable(surface, passes);
            let is_guarded = !passes && now.system.has_conditions(surface);
            self.watch.set_guarded(surface, is_guarded);
        }
        let hits = self.watch.begin(now)?;
        self.strike(hits, now, observer)
    }

    fn shown<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<f64, Outcome> {
        self.watch.up_to_second_kink(step)
    }

    #[inline]
    fn propose<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        match self.watch.look(step) {
            Ok(Some(theta)) if self.resting.is_none() => Ok(Some(self.watch.meet(theta, step))),
            Ok(hit) if self.resting.is_none() => Ok(hit),
            Ok(hit) => {
                let end = self.watch.end_of_hold(hit.unwrap_or(1.0), step)?;
                let first = self.resting.look(hit, end, step)?;
                if let Some(met) = self.watch.met_across(first.unwrap_or(1.0), step)?
                    && first.is_none_or(|first| met.0 < first)
                {
                    return Ok(Some(self.resting.meet_across(met)));
                }
                let kink = self.watch.kink_of_hold(1.0, step)?;
                // At a kink the force jumps, perhaps through 0: the kink comes first.
                let is_first = |kink: &f64| match (first, end) {
                    (None, _) => true,
                    // Behind the kink the surface does not count.
                    (Some(first), Some((part, _))) if part == first => {
                        *kink < first && !self.watch.is_at_kink(first, step)
                    }
                    (Some(first), _) => *kink < first || self.watch.is_at_kink(first, step),
                };
                match kink.filter(is_first) {
                    Some(kink) => {
                        let rates = self.watch.rates_before_kink(kink, step)?;
                        Ok(Some(self.resting.pass_kink(kink, rates)))
                    }
                    None => Ok(first),
                }
            }
            Err(Outcome::Contact { surface }) => self.press(surface, step),
            // At rest on the surface: a force that grows from 0 presses.
            Err(Outcome::TangentialCrossing { surface }) if self.may_rest(surface) => {
                self.press(surface, step)
            }
            Err(outcome) => Err(outcome),
        }
    }

    fn settle(&mut self, now: &mut Moment<'_, Sys>, _: bool) -> Result<Change, Outcome> {
        match self.resting.forces() {
            // A gap rate that is not 0 may be that of the other side of a kink.
            Some(_) if self.resting.is_behind_kink() || self.watch.rests_at_kink(now) => {
                self.resting.stay_at_kink(now.t)?;
                Ok(Change::Kept)
            }
            Some(held) => {
                self.resting.leave_kinks();
                Ok(held.settle(now)?)
            }
            None => Ok(Change::Kept),
        }
    }

    fn act<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        if let Err(outcome) = self.watch.check_behind(theta, now) {
            let none = Hits::none(&now.system.zero_gaps());
            return match self.ends_at_bottom(&none, Brief::UNORDERED, now, observer)? {
                true => Ok(()),
                false => Err(outcome),
            };
        }
        if let Some(surface) = self.resting.take_across() {
            return self.strike_across(surface, now, observer);
        }
        let held = *self.resting.held();
        self.resting.arrive_at_kink(now)?;
        if self.resting.turn(now, observer)? {
            let rates = now.system.gap_rates(now.t, now.state)?;
            self.watch.hold(self.resting.held());
            let mut at_hand = Hits::all_of(held.iter().chain(self.resting.held().iter()), &rates);
            if theta == 0.0 {
                // Holding a surface moves the positions, by errors of the motion so far.
                self.watch.add_reached(&mut at_hand, now)?;
            }
            return self.watch.leave(&at_hand, now, rates);
        }
        let mut hits = self.watch.hits(theta, now)?;
        held.iter().for_each(|surface| hits.add(surface));
        if self.ends_at_bottom(&hits, Brief::UNRESOLVED, now, observer)? {
            return Ok(());
        }
        match self.strike(hits, now, observer) {
            Err(Outcome::Ambiguous { .. } | Outcome::StartsInside { .. })
                if self.ends_at_bottom(&hits, Brief::UNORDERED, now, observer)? =>
            {
                return Ok(());
            }
            struck => struck?,
        }
        self.resting.bounce(now, observer)?;
        self.watch.hold(self.resting.held());
        Ok(())
    }
}

impl<Sys: Impacting> SceneEffects<Sys> for Impacts<Sys> {
    fn set_law(&mut self, surface: usize, law: Law) {
        self.overrides.set(surface, Some(law));
    }

    fn law(&self, system: &Sys, surface: usize) -> Option<Law> {
        (surface < system.surface_count()).then(|| self.law_of(system, surface))
    }

    fn set_impact_budget(&mut self, budget: Option<u64>) {
        self.budget = budget.unwrap_or(IMPACT_BUDGET);
    }

    fn set_policies(&mut self, policies: Policies) {
        self.policies = policies;
    }

    fn audit(&self, system: &Sys, work: &mut dyn FnMut(&mut dyn Auditor<Sys>)) -> bool {
        work(&mut Audit::passing(system, |surface| {
            self.passes(system, surface)
        }));
        true
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
