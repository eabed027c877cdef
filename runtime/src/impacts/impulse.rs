//! The effect that finds impacts in a step and applies their laws.

use super::accumulation::Accumulation;
use super::bottom::Brief;
use super::held::Held;
use super::hits::Hits;
use super::resting::Resting;
use super::search::{FLAT, gap_at, is_active};
use super::tangency::second_rate_at;
use super::watch::Watch;
use crate::audit::{Audit, Auditor};
use crate::contract::Impacting;
use crate::effects::{Change, Effect, Moment, SceneEffects, StepView};
use crate::error::Fault;
use crate::integrate::Stepper;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::policy::{Policies, Rest};
use crate::record::Observer;
use crate::state::StateVector;

/// Default limit of the number of impacts of a run.
pub const IMPACT_BUDGET: u64 = 10_000_000;

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
/// reset of positions, a surface at hand acts if it is approached, or once the motion at rest on it is pressed into it. Such
/// a surface does not hold the motion.
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
    pub(super) overrides: PerSurface<Option<Law>, Sys::Gaps>,
    pub(super) budget: u64,
    pub(super) policies: Policies,
    pub(super) watch: Watch<Sys>,
    pub(super) accumulation: Accumulation<Sys::Gaps>,
    pub(super) resting: Resting<Sys::Gaps>,
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
        let is_waiting = self.watch.is_waiting(surface);
        let enters = law == Law::Transition && !is_held;
        let is_entered = enters && !self.accumulation.has_passed_at(surface, t);
        if is_entered || is_waiting {
            // It begins to count where the motion is on it, perhaps without a gap rate.
            match is_waiting {
                true if self.resting.are_endless(t) => return Err(Outcome::Zeno { t, surface }),
                true => {}
                false => self.resting.count(surface, t)?,
            }
            self.watch.cut_at(surface, 0.0, step.length());
            self.watch.is_shown_by_values[surface] = self.watch.rates.as_slice()[surface] <= 0.0;
            return Ok(Some(0.0));
        }
        // After a bounce: the hops have become too small to rise from the surface.
        let accumulation = self.accumulation.ends_at(surface, t);
        if law == Law::Reset && accumulation.is_some() && self.throws_up(surface, step)? {
            // The hop takes no time that can be resolved. The next one may be larger: impacts at one time are counted.
            self.watch.cut_at(surface, 0.0, step.length());
            self.watch.is_shown_by_values[surface] = true;
            return Ok(Some(0.0));
        }
        match (self.may_rest(surface), accumulation) {
            (false, None) => return Err(Outcome::Contact { surface }),
            (false, Some(t)) => return Err(Outcome::Zeno { t, surface }),
            (true, Some(t)) => self.resting.note_accumulation(surface, t),
            (true, None) if enters => return Err(self.trapped(surface, t)),
            (true, None) => {}
        }
        self.resting.press(surface, t)
    }

    /// True if the reset of a surface throws the motion up again that it has just thrown up. One that depends on the velocity would
    /// have to know that at the end of the hop.
    fn throws_up<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &StepView<'_, Sys, Step>,
    ) -> Result<bool, Outcome> {
        let (system, t) = (step.system, step.t_start());
        let landing = system.landing(surface, t, step.start())?;
        let rates = system.gap_rates(t, &landing.state)?;
        Ok(rates.as_slice()[surface] > 0.0)
    }

    /// The surface hit at `theta` on which the motion is in balance at the start of the step and into which it is pressed at
    /// the end, if it may rest there, and the part of the step where the pressure begins. In balance gap, gap rate and second
    /// rate are 0.
    ///
    /// NOTE: dense output of a step across a kink of the force dips before the kink. The dip is no impact, and the law of the
    /// surface would make hops of it. A motion that has left the surface by then comes back to it by an impact.
    fn pressed_from<Step: Stepper<Sys>>(
        &self,
        theta: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<(usize, f64)>, Outcome> {
        let holds = |surface: usize| {
            let law = self.law_of(step.system, surface);
            self.may_rest(surface) && !law.is_map() && law != Law::Stop
        };
        let mut candidates = (0..step.system.surface_count())
            .filter(|surface| holds(*surface) && self.watch.comes_back(*surface, theta));
        let Some(surface) = candidates.next() else {
            return Ok(None);
        };
        let first = step.system.gap_rates(step.t_start(), step.start())?;
        if first.as_slice()[surface] != 0.0 {
            return Ok(None);
        }
        // NaN where there is none.
        let mut second = |part: f64| {
            step.counters.event_evaluations += 1;
            second_rate_at(surface, step, part).unwrap_or(f64::NAN)
        };
        let (balance, last) = (second(0.0), second(1.0));
        if balance != 0.0 || last.is_nan() || last >= 0.0 {
            return Ok(None);
        }
        let [mut before, mut after] = [0.0, 1.0];
        for _ in 0..ONSET {
            let middle = 0.5 * (before + after);
            match second(middle) < FAINT * last {
                true => after = middle,
                false => before = middle,
            }
        }
        if self.moves_off(surface, after, step) {
            return Ok(None);
        }
        // Other surfaces were searched up to the hit only. One that presses before holds the motion together with this one.
        let mut others = (0..step.system.surface_count()).filter(|other| *other != surface);
        let is_met = others.any(|other| holds(other) && self.is_behind(other, after, step));
        Ok(Some((surface, if is_met { 0.0 } else { after })))
    }

    /// True if the gap of a surface that is touched at the start of the step rises up to this part as its second rates have it, or
    /// has risen and fallen again. In balance they are 0.
    fn moves_off<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        let (mut rise, mut expected) = (0.0, 0.0);
        for k in 0..RISES {
            let place = (f64::from(k) + 0.5) / f64::from(RISES);
            let second = second_rate_at(surface, step, part * place).unwrap_or(0.0);
            rise += 0.5 * second.max(0.0);
            expected += (1.0 - place) * second;
        }
        let elapsed = part * step.length();
        let scale = elapsed * elapsed / f64::from(RISES);
        let (rise, expected) = (scale * rise, scale * expected);
        let gap = gap_at(surface, step, part);
        step.counters.event_evaluations += 1 + u64::from(RISES);
        let rounding = self.watch.rounding_at(surface, part, step);
        let rises = gap > LEAST_SHARE * rise && gap < 4.0 * rise;
        let is_expected = (gap - expected).abs() < 0.5 * expected.abs();
        let has_fallen = gap < 0.0 && rise > FLAT * rounding && is_expected;
        gap.abs() > FLAT * rounding && (rises || has_fallen)
    }

    /// True if the motion is behind a surface that counts at this part of the step, by more than rounding.
    fn is_behind<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        let rounding = self.watch.rounding_at(surface, part, step);
        step.counters.event_evaluations += 1;
        gap_at(surface, step, part) < -2.0 * rounding && is_active(surface, step, part)
    }

    /// The end of a run at a surface with the law [`Law::Stop`].
    pub(super) fn stopped_at(&self, surface: usize) -> Outcome {
        Outcome::StoppedAt {
            surface,
            graze: self.watch.is_graze(surface),
        }
    }

    /// True if the motion may go on along a surface. A surface with a reset does not hold the motion.
    pub(super) fn may_rest(&self, surface: usize) -> bool {
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
}

/// Number of halvings of a step that find where a force begins to press.
const ONSET: u32 = 40;

/// Number of places at which the second rate of a gap is evaluated, and the least share of the rise that it gives which a
/// gap has: `2/n` for a gap like the power `n` of time.
const RISES: u32 = 8;
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Second rate of a gap, relative to that at the end of the step, from which on a force presses.
const FAINT: f64 = 1.0 / (1 << 20) as f64;

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
            Ok(Some(theta)) if self.resting.is_none() => match self.pressed_from(theta, step)? {
                Some((surface, part)) => Ok(self.press(surface, step)?.map(|_| part)),
                None => Ok(Some(self.watch.meet(theta, step))),
            },
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
            Err(Outcome::TangentialCrossing { surface })
                if self.may_rest(surface)
                    || self.law_of(step.system, surface) == Law::Transition
                    || self.watch.is_waiting(surface) =>
            {
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

    fn aim(&mut self, theta: f64, now: &mut Moment<'_, Sys>) -> Result<Option<f64>, Outcome> {
        self.watch.aim(theta, now)
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
        let (held, is_kink) = (*self.resting.held(), self.resting.is_behind_kink());
        self.resting.arrive_at_kink(self.watch.length, now)?;
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
        if is_kink && self.holds_beyond_kink(now)? {
            held.settle_rates(now)?;
            let rates = now.system.gap_rates(now.t, now.state)?;
            return self
                .watch
                .leave(&Hits::all_of(held.iter(), &rates), now, rates);
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
