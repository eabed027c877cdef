//! Watching the gaps of all surfaces along a step.
//!
//! The gaps and their rates at the ends, and one probe between, settle most steps without dense output. A gap of
//! exactly 0 at the start of a step stands for a surface at hand: it was just hit, or touched within rounding.
//! Its root there is divided out, so it is neither found again nor hides a later one.
//!
//! A surface is passable where its law is a reset: its gap may be negative, and falls count from above only.

use super::glance::{Glance, SAME_TIME, finite, glance};
use super::held::{Held, second_rates};
use super::hits::Hits;
use super::series::GapSeries;
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::events::crossing::{NODES, SAMPLES, clear};
use crate::events::locate::{Line, Search, Start, confirm};
use crate::events::resolution::resolution;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Falls looked at in one step on one surface before the step is cut: those that are no impacts are passed over.
const FALLS: u32 = 1024;

/// A gap rate this small a part of those at the ends of the step may belong to a graze.
const SLOW: f64 = 1.0 / (1 << 10) as f64;

/// Only a surface that is hit within this part of a step after another is asked for its rounding.
const BESIDE: f64 = 1.0 / (1 << 20) as f64;

/// The gaps at the start of the coming step, and what was found in the last one looked at.
#[derive(Debug, Clone)]
pub(super) struct Watch<Sys: Impacting> {
    /// Gaps at the start of the step; 0 for surfaces at hand, negative only where the surface does not count or is
    /// passable.
    gaps: Sys::Gaps,
    /// 1 for passable surfaces.
    passable: Sys::Gaps,
    rates: Sys::Gaps,
    /// The earliest proposal of the last step.
    proposed: Option<f64>,
    /// Per surface, the part of the last step at which it is hit; meaningful while something is proposed.
    parts: Sys::Gaps,
    /// 1 where that hit is a graze, 2 where the surface is crossed there although the gap rate vanishes.
    grazes: Sys::Gaps,
    /// How fast the gap rate changes about that hit.
    bends: Sys::Gaps,
    /// Length of the last step.
    length: f64,
    /// Largest absolute values of the state's components since the last impact: their rounding errors stay with it.
    sizes: Sys::State,
    /// Steps since then: each has rounded the state.
    steps: u32,
    /// Surfaces that the motion is held on: their gaps are 0, and are not watched.
    held: Held<Sys::Gaps>,
}

impl<Sys: Impacting> Watch<Sys> {
    pub(super) fn new() -> Self {
        let zeros = Sys::Gaps::zeros();
        Self {
            gaps: zeros,
            passable: zeros,
            rates: zeros,
            proposed: None,
            parts: zeros,
            grazes: zeros,
            bends: zeros,
            length: 0.0,
            sizes: Sys::State::zeros(),
            steps: 0,
            held: Held::none(),
        }
    }

    /// The surfaces that the motion is held on from now on.
    pub(super) fn hold(&mut self, held: &Held<Sys::Gaps>) {
        self.held = *held;
    }

    /// Says whether a surface is passable in the coming run.
    pub(super) fn set_passable(&mut self, surface: usize, passable: bool) {
        self.passable.as_mut_slice()[surface] = f64::from(u8::from(passable));
    }

    fn is_passable(&self, surface: usize) -> bool {
        self.passable.as_slice()[surface] == 1.0
    }

    /// The surfaces at hand at the first instant of a run.
    pub(super) fn begin(&mut self, now: &mut Moment<'_, Sys>) -> Result<Hits<Sys::Gaps>, Outcome> {
        self.proposed = None;
        self.held = Held::none();
        let rates = now.system.gap_rates(now.t, now.state)?;
        let mut hits = Hits::<Sys::Gaps>::none();
        self.relocate(&mut hits, &rates, now)?;
        Ok(hits)
    }

    /// The surfaces at hand at a position that the motion did not come to by itself.
    pub(super) fn relocate(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        self.grazes = Sys::Gaps::zeros();
        self.bends = Sys::Gaps::zeros();
        (self.sizes, self.steps) = (*now.state, 0);
        let gaps = measured(now)?;
        let mut at_hand = Sys::Gaps::zeros();
        for (surface, &gap) in gaps.as_slice().iter().enumerate() {
            if now.system.surface_active(surface, now.t, now.state) {
                let drift = SAME_TIME * (rates.as_slice()[surface] * now.t).abs();
                let state = *now.state;
                if gap.abs() <= 2.0 * rounding(now, surface, &state) + drift {
                    at_hand.as_mut_slice()[surface] = 1.0;
                }
            }
        }
        hits.replace(at_hand);
        Ok(())
    }

    /// Takes in the state that motion goes on from, after impacts on the surfaces at hand.
    pub(super) fn leave(
        &mut self,
        hits: &Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
        rates: Sys::Gaps,
    ) -> Result<(), Outcome> {
        self.rates = rates;
        self.gaps = measured(now)?;
        (self.sizes, self.steps) = (*now.state, 0);
        for surface in 0..Sys::Gaps::LEN {
            if hits.at_hand.as_slice()[surface] == 1.0 || self.held.is_held(surface) {
                self.gaps.as_mut_slice()[surface] = 0.0;
            }
        }
        self.check_negative(now)
    }

    /// The surfaces hit where the step was cut: those found there, and those whose gaps are 0 there within rounding.
    pub(super) fn hits(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Hits<Sys::Gaps>, Outcome> {
        let mut hits = Hits::<Sys::Gaps>::none();
        if self.proposed.is_none() {
            return Ok(hits);
        }
        for (surface, part) in self.parts.as_slice().iter().enumerate() {
            if (part - theta) * self.length <= SAME_TIME * now.t.abs() {
                hits.add([surface].into_iter());
                if self.is_passable(surface) {
                    hits.set_fallen(surface);
                }
            }
        }
        if Sys::Gaps::LEN > 1 && hits.is_some() {
            self.add_beside(&mut hits, now)?;
        }
        Ok(hits)
    }

    /// Adds the surfaces hit so soon after others that rounding decides which is first. In the direction of a flight the
    /// rounding of its steps adds up.
    fn add_beside(
        &self,
        hits: &mut Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let gaps = measured(now)?;
        let rates = now.system.gap_rates(now.t, now.state)?;
        let roundings = 2.0 + f64::from(self.steps) / 16.0;
        for surface in 0..Sys::Gaps::LEN {
            let (gap, rate) = (gaps.as_slice()[surface], rates.as_slice()[surface]);
            let is_near = rate < 0.0 && gap.abs() <= BESIDE * rate.abs() * self.length;
            if self.is_passable(surface) && self.gaps.as_slice()[surface] <= 0.0 {
                continue;
            }
            if is_near
                && gap.abs() <= roundings * rounding(now, surface, &self.sizes)
                && now.system.surface_active(surface, now.t, now.state)
            {
                hits.add([surface].into_iter());
            }
        }
        Ok(())
    }

    /// Whether the hit on this surface is a graze.
    pub(super) fn is_graze(&self, surface: usize) -> bool {
        self.grazes.as_slice()[surface] == 1.0
    }

    /// Whether a gap rate at the last hit is so slow that the gap's rounding errors may have decided its sign.
    pub(super) fn is_slow(
        &self,
        surface: usize,
        rate: f64,
        rounding: impl FnOnce() -> f64,
    ) -> bool {
        let bend = self.bends.as_slice()[surface];
        bend > 0.0 && rate * rate < 4.0 * bend * rounding()
    }

    /// The size of a gap's rounding errors after the flight that ends now.
    pub(super) fn rounding(&self, surface: usize, now: &mut Moment<'_, Sys>) -> f64 {
        rounding(now, surface, &self.sizes)
    }

    /// Whether this surface is crossed at gap rate 0.
    pub(super) fn is_tangential_crossing(&self, surface: usize) -> bool {
        self.grazes.as_slice()[surface] == 2.0
    }

    /// Looks for the earliest hit in a step.
    #[inline]
    pub(super) fn look<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let glance = glance(step)?;
        self.proposed = None;
        self.steps = self.steps.saturating_add(1);
        for (size, value) in self
            .sizes
            .as_mut_slice()
            .iter_mut()
            .zip(step.end().as_slice())
        {
            *size = size.abs().max(value.abs());
        }
        if !(0..Sys::Gaps::LEN).all(|surface| self.is_clear(surface, &glance)) {
            self.search(step, &glance)?;
        }
        if self.proposed.is_none() {
            self.pass(step, &glance)?;
        }
        Ok(self.proposed)
    }

    /// The step passes whole: its end is the start of the next.
    #[inline]
    fn pass<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<(), Outcome> {
        let before = self.gaps;
        self.gaps = glance.gaps;
        self.rates = glance.rates;
        if self.gaps.as_slice().iter().all(|&gap| gap > 0.0) {
            return Ok(());
        }
        for surface in 0..Sys::Gaps::LEN {
            if self.is_passable(surface) {
                let start = before.as_slice()[surface];
                self.keep_side(surface, start, step, glance);
            }
        }
        for surface in 0..Sys::Gaps::LEN {
            let (gap, at_hand) = (
                self.gaps.as_slice()[surface],
                before.as_slice()[surface] == 0.0,
            );
            let is_held = self.held.is_held(surface);
            if is_held || (at_hand && gap < 0.0 && !self.is_pressed(surface, step, glance)) {
                self.gaps.as_mut_slice()[surface] = 0.0;
            }
        }
        let (t, mut state) = (step.t_end(), *step.end());
        let counters = &mut *step.counters;
        self.check_negative(&mut Moment {
            system: step.system,
            t,
            state: &mut state,
            counters,
        })
    }

    /// A passable surface that is met within rounding at the end of the step, without a fall that counted, has not been
    /// crossed: its gap gets the smallest number of the side that the motion came from.
    fn keep_side<Step: Stepper<Sys>>(
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

    /// Whether the motion goes into a surface at hand, rather than along it within rounding. Rounding adds up
    /// along a wall, so its sum over the steps says nothing.
    fn is_pressed<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let mut evaluations = 0;
        let rounding = rounding_along(surface, step, &self.sizes, &mut evaluations);
        step.counters.event_evaluations += evaluations;
        glance.rates.as_slice()[surface] * glance.length < -rounding
    }

    /// Whether the gap is negative at the end of the step, by more than rounding: a motion along a wall falls and rises
    /// through it by that much.
    fn is_sunk<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let gap = glance.gaps.as_slice()[surface];
        if gap >= 0.0 {
            return false;
        }
        let mut evaluations = 0;
        let rounding = rounding_along(surface, step, &self.sizes, &mut evaluations);
        step.counters.event_evaluations += evaluations;
        gap < -2.0 * rounding
    }

    /// Whether the step can pass this surface, told cheaply.
    #[inline(always)]
    fn is_clear(&self, surface: usize, glance: &Glance<Sys::Gaps>) -> bool {
        if self.held.is_held(surface) {
            return true;
        }
        let at = |values: &Sys::Gaps| values.as_slice()[surface];
        let slopes = [
            at(&self.rates) * glance.length,
            at(&glance.rates) * glance.length,
        ];
        // NOTE: negative throughout, a surface at hand is not clear but pressed.
        let is_sunk = at(&self.gaps) == 0.0 && at(&glance.gaps) < 0.0;
        !glance.is_due(surface)
            && !is_sunk
            && match &glance.series {
                Some(series) => series.is_clear(surface, at(&self.gaps) == 0.0),
                None => clear(
                    [at(&self.gaps), at(&glance.gaps)],
                    slopes,
                    at(&glance.probe),
                ),
            }
    }

    /// Looks for the earliest hit along the dense output.
    fn search<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<(), Outcome> {
        step.prepare()?;
        self.length = glance.length;
        let mut whole = None;
        for surface in 0..Sys::Gaps::LEN {
            self.parts.as_mut_slice()[surface] = f64::INFINITY;
            if self.is_clear(surface, glance) {
                continue;
            }
            let samples = match &glance.series {
                Some(series) => {
                    let mut gaps = series.at_each(surface, NODES);
                    gaps[SAMPLES - 1] = glance.gaps.as_slice()[surface];
                    gaps
                }
                None => whole
                    .get_or_insert_with(|| samples(step, &self.gaps, &glance.gaps))
                    .map(|gaps| gaps.as_slice()[surface]),
            };
            let (part, is_hit) = match self.first_hit(surface, step, &samples, glance)? {
                Found::Hit(part) => (part, true),
                Found::Unfinished(part) => (part, false),
                Found::Nothing if glance.is_due(surface) && is_active(surface, step, 1.0) => {
                    (1.0, true)
                }
                Found::Nothing => continue,
            };
            if is_hit {
                self.parts.as_mut_slice()[surface] = part;
                self.note_graze(surface, part, step, glance)?;
            }
            self.proposed = Some(self.proposed.map_or(part, |earliest| earliest.min(part)));
        }
        Ok(())
    }

    /// The first fall of this gap that is an impact: the surface counts there, and is approached.
    fn first_hit<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        samples: &[f64; SAMPLES],
        glance: &Glance<Sys::Gaps>,
    ) -> Result<Found, Outcome> {
        let gap = self.gaps.as_slice()[surface];
        let slope = (gap == 0.0).then_some(self.rates.as_slice()[surface] * self.length);
        let until = self.proposed.unwrap_or(1.0);
        // A passable surface at hand has counted: it is left upwards, or crossed.
        let crosses = self.is_passable(surface) && slope.is_some_and(|slope| slope <= 0.0);
        let mut start = Start {
            from: 0.0,
            above: gap >= 0.0 && !crosses,
            slope,
            until,
        };
        let mut tangential = None;
        for _ in 0..FALLS {
            let found = first_fall(surface, step, &self.sizes, samples, start, &glance.series);
            let (part, after) = match found {
                Search::Clear => {
                    let sunk = self.is_sunk(surface, step, glance);
                    return Ok(tangential
                        .filter(|_| sunk)
                        .map_or(Found::Nothing, Found::Hit));
                }
                Search::Unfinished(part) => return Ok(Found::Unfinished(part)),
                Search::Pole(after) => {
                    self.check_behind_pole(surface, after, step)?;
                    start = Start {
                        from: after,
                        above: false,
                        slope: None,
                        until,
                    };
                    continue;
                }
                Search::Sinks(part) => (part, part),
                Search::Falls(bracket) => (bracket.before, bracket.after),
            };
            step.counters.crossings += 1;
            if is_active(surface, step, part) {
                if part == 0.0 && start.slope.is_some() {
                    let pressed = self.is_pressed(surface, step, glance);
                    return match pressed {
                        true if !is_accelerated(surface, step)?
                            && crosses_at_rest(surface, step, 0.0)? =>
                        {
                            Err(Outcome::TangentialCrossing { surface })
                        }
                        true => Err(Outcome::Contact { surface }),
                        false => Ok(Found::Nothing),
                    };
                }
                if is_approached(surface, step, part)? || is_approached(surface, step, after)? {
                    return Ok(Found::Hit(if part > 0.0 { part } else { after }));
                }
                tangential = tangential.or(Some(after));
            }
            start = Start {
                from: after,
                above: false,
                slope: None,
                until,
            };
            if after >= 1.0 {
                return Ok(Found::Nothing);
            }
        }
        Ok(Found::Unfinished(start.from))
    }

    /// Behind a pole the surface must not count: the motion is on the side that is not allowed, and met no wall.
    fn check_behind_pole<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        let gaps = step.system.gaps(step.time(part), &step.state(part));
        let gap = gaps.as_slice()[surface];
        let mut evaluations = 1;
        let rounding = rounding_along(surface, step, &self.sizes, &mut evaluations);
        step.counters.event_evaluations += evaluations;
        let counts = !self.is_passable(surface) && is_active(surface, step, part);
        if gap < -2.0 * rounding && counts {
            return Err(Outcome::StartsInside { surface, gap });
        }
        Ok(())
    }

    /// Marks a hit so slow that the gap's lowest value would be within its rounding.
    fn note_graze<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<(), Outcome> {
        let ends = [
            self.rates.as_slice()[surface],
            glance.rates.as_slice()[surface],
        ];
        let state = step.state(part);
        let rate = step.system.gap_rates(step.time(part), &state)?.as_slice()[surface];
        let (other, apart) = if part > 0.5 {
            (ends[0], part)
        } else {
            (ends[1], 1.0 - part)
        };
        self.bends.as_mut_slice()[surface] = (other - rate).abs() / (apart * self.length);
        let mut graze = 0.0;
        if rate.abs() <= SLOW * ends[0].abs().max(ends[1].abs()) {
            let mut evaluations = 0;
            let rounding = || rounding_along(surface, step, &self.sizes, &mut evaluations);
            if self.is_slow(surface, rate, rounding) {
                graze = 1.0;
            }
            step.counters.event_evaluations += evaluations;
        }
        if graze == 1.0 && crosses_at_rest(surface, step, part)? {
            graze = 2.0;
        }
        self.grazes.as_mut_slice()[surface] = graze;
        Ok(())
    }

    /// Surfaces that count have a gap that is not negative beyond rounding; within rounding they are at hand.
    fn check_negative(&mut self, now: &mut Moment<'_, Sys>) -> Result<(), Outcome> {
        for surface in 0..Sys::Gaps::LEN {
            let gap = self.gaps.as_slice()[surface];
            let is_wall = !self.is_passable(surface);
            if is_wall && gap < 0.0 && now.system.surface_active(surface, now.t, now.state) {
                let drift = SAME_TIME * (self.rates.as_slice()[surface] * now.t).abs();
                if gap < -2.0 * rounding(now, surface, &self.sizes) - drift {
                    return Err(Outcome::StartsInside { surface, gap });
                }
                self.gaps.as_mut_slice()[surface] = 0.0;
            }
        }
        Ok(())
    }
}

/// The first hit of one surface in a step.
enum Found {
    Nothing,
    Hit(f64),
    Unfinished(f64),
}

/// Gaps at a moment, all finite.
fn measured<Sys: Impacting>(now: &mut Moment<'_, Sys>) -> Result<Sys::Gaps, Outcome> {
    now.counters.event_evaluations += 1;
    finite::<Sys>(now.system.gaps(now.t, now.state))
}

/// The size of a gap's rounding errors at a moment, from components that have had these sizes.
fn rounding<Sys: Impacting>(now: &mut Moment<'_, Sys>, surface: usize, sizes: &Sys::State) -> f64 {
    resolution(
        now.system,
        surface,
        now.t,
        now.state,
        sizes,
        &mut now.counters.event_evaluations,
    )
}

/// The size of a gap's rounding errors along a step, from components that have had these sizes.
fn rounding_along<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    sizes: &Sys::State,
    evaluations: &mut u64,
) -> f64 {
    resolution(
        step.system,
        surface,
        step.t_end(),
        step.end(),
        sizes,
        evaluations,
    )
}

fn is_active<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> bool {
    step.system
        .surface_active(surface, step.time(part), &step.state(part))
}

fn is_approached<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<bool, Outcome> {
    let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
    Ok(rates.as_slice()[surface] < 0.0)
}

/// Parts of a step down to which the second rate of a gap is looked for in how its rate falls: half the digits, so that
/// rounding of the second rate is not taken for one.
const LEAST_PART: f64 = 1.0 / (1 << 26) as f64;

/// Whether the second rate of a gap, which is 0 at the start of a step at rate 0, tells at least half of how its rate
/// falls in some small part of the step.
fn is_accelerated<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
) -> Result<bool, Outcome> {
    let (t, start, [rate, _]) = (step.t_start(), step.start(), step.rates());
    let Some(accelerations) = second_rates(step.system, t, start, rate)? else {
        return Ok(false);
    };
    let acceleration = accelerations.as_slice()[surface];
    let first = step.system.gap_rates(t, start)?.as_slice()[surface];
    let mut part = 0.125;
    while acceleration < 0.0 && part > LEAST_PART {
        let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
        let fall = rates.as_slice()[surface] - first;
        if fall < 0.0 && fall > 2.0 * acceleration * part * step.length() {
            return Ok(true);
        }
        part *= 0.125;
    }
    Ok(false)
}

/// Whether a gap that is 0 at this part of a step, at rate 0, goes on like the cube of time: told from the square, which
/// is a graze or a contact, by what the rate changes in an eighth and in a quarter of the rest.
fn crosses_at_rest<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<bool, Outcome> {
    let rate = |share: f64| {
        let part = part + share * (1.0 - part);
        let rates = step.system.gap_rates(step.time(part), &step.state(part));
        rates.map(|rates| rates.as_slice()[surface])
    };
    let (first, eighth, quarter) = (rate(0.0)?, rate(0.125)?, rate(0.25)?);
    // A quarter of the change for the cube, half of it for the square.
    Ok(quarter < first && eighth - first > 0.375 * (quarter - first))
}

/// The first fall of a gap, with its time to the last bits. On a series it is looked for on the polynomial; what is
/// not a plain fall there is left to the gap itself.
fn first_fall<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &mut StepView<'_, Sys, Step>,
    sizes: &Sys::State,
    whole: &[f64; SAMPLES],
    start: Start,
    series: &Option<GapSeries<Sys::Gaps>>,
) -> Search {
    let (mut evaluations, mut more) = (0, 0);
    let mut gap = |part: f64| {
        evaluations += 1;
        step.system
            .gaps(step.time(part), &step.state(part))
            .as_slice()[surface]
    };
    let mut rounding = || rounding_along(surface, step, sizes, &mut more);
    let on_series = series.as_ref().and_then(|series| {
        let line = Line {
            // At the end the gap itself: it may be negative by rounding where the polynomial is not.
            gap: |part: f64| match part >= 1.0 {
                true => whole[SAMPLES - 1],
                false => series.at(surface, part),
            },
            rounding: &mut rounding,
            whole,
            start,
        };
        match line.first_fall() {
            Search::Clear => Some(Search::Clear),
            Search::Falls(near) => confirm(near, start.slope, &mut gap).map(Search::Falls),
            _ => None,
        }
    });
    let found = on_series.unwrap_or_else(|| {
        let line = Line {
            gap,
            rounding,
            whole,
            start,
        };
        line.first_fall()
    });
    step.counters.event_evaluations += evaluations + more;
    found
}

/// Gaps at the samples over a whole step; those at the ends are known.
fn samples<Sys: Impacting, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
    first: &Sys::Gaps,
    last: &Sys::Gaps,
) -> [Sys::Gaps; SAMPLES] {
    let mut samples = [*first; SAMPLES];
    samples[SAMPLES - 1] = *last;
    for j in 1..SAMPLES - 1 {
        samples[j] = step.system.gaps(step.time(NODES[j]), &step.state(NODES[j]));
    }
    step.counters.event_evaluations += SAMPLES as u64 - 2;
    samples
}
