//! Event detection: tests the gaps of all surfaces along a step.
//!
//! A step in a box in which no gap vanishes needs no test ([`Haven`]). Elsewhere the values and rates of each gap
//! along the step are enclosed ([`Path`]); a gap that is enclosed away from zero, or rises from a surface just left,
//! settles its surface. The other surfaces are searched ([`super::search`]). A gap of exactly 0 at the start of a
//! step marks a surface at hand, which was just hit, or touched within rounding. Its root there is divided out, so it
//! is neither found again nor hides a later one.
//!
//! A surface is passable if its law is a reset, or a transition that counts from both sides. Its gap may be negative,
//! and only falls from above count.

use super::glance::{Glance, SAME_TIME, finite, glance};
use super::held::Held;
use super::hits::Hits;
use super::place::Place;
use super::quiet::quieten_at_start;
use super::series::LastSeries;
use super::sides::Behind;
use super::standing::Standing;
use super::told::Told;
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::events::bends::Bends;
use crate::events::haven::Haven;
use crate::events::path::Path;
use crate::events::resolution::resolution;
use crate::events::tails::Tails;
use crate::integrate::Stepper;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Time after a hit, as a fraction of the step, within which other surfaces may be hit at the same time up to the
/// rounding of their gaps.
pub(super) const BESIDE: f64 = 1.0 / (1 << 20) as f64;

/// Depth, in units of the rounding of the gap, up to which a wall may be touched after many steps along it.
const DRIFT: f64 = 1024.0;

/// Largest correction of the time of a cut, as a fraction of the step.
const LARGEST_AIM: f64 = 1.0 / 64.0;

/// Maximum number of surfaces for which the polynomials of the gaps are tested first, if the step is a power series.
const FEW: usize = 8;

/// The gaps at the start of the next step, and the results for the last one.
#[derive(Debug, Clone)]
pub(super) struct Watch<Sys: Impacting> {
    /// Gaps at the start of the step; 0 for surfaces at hand. A gap is negative only if its surface does not count or
    /// is passable.
    pub(super) gaps: Sys::Gaps,
    /// True for passable surfaces.
    passable: PerSurface<bool, Sys::Gaps>,
    /// Roles of the surfaces if the motion is pressed into them.
    pub(super) standing: PerSurface<Standing, Sys::Gaps>,
    /// Rates at the start of the step, if known; always known for surfaces at hand.
    pub(super) rates: Sys::Gaps,
    has_rates: bool,
    /// The earliest fraction of the last step at which a cut is proposed.
    pub(super) proposed: Option<f64>,
    /// Fraction of the last step at which a surface is hit; valid while there is a proposal.
    pub(super) parts: PerSurface<Option<f64>, Sys::Gaps>,
    /// True if only the values of the gap show that hit: its rate there is 0 or has no value.
    pub(super) is_shown_by_values: PerSurface<bool, Sys::Gaps>,
    /// Grazing test of that hit.
    pub(super) grazes: PerSurface<Graze, Sys::Gaps>,
    /// Absolute change of the gap rate per unit of time near that hit.
    pub(super) bends: Sys::Gaps,
    /// Length of the last step.
    pub(super) length: f64,
    /// Quantities at the hit that was located last, which may be the earliest.
    pub(super) place: Option<Place<Sys>>,
    /// Gaps at the position of the impacts, once known.
    pub(super) here: Option<Sys::Gaps>,
    /// Largest absolute values of the state's components since the last impact; they determine the rounding errors.
    pub(super) sizes: Sys::State,
    /// The sizes at the start of the last step. A cut uses them, because the motion behind it does not contribute.
    pub(super) sizes_at_start: Sys::State,
    /// The least sizes after impacts: 0, or those of the motion of which the start of the run is the end.
    pub(super) least_sizes: Sys::State,
    /// Number of steps since the last impact. Each has rounded the state.
    pub(super) steps: u32,
    /// Sum of the local errors of these steps, in units of the tolerance.
    pub(super) errors: f64,
    /// Surfaces that hold the motion. Their gaps are 0 and are not tested.
    pub(super) held: Held<Sys::Gaps>,
    /// The surface behind which the motion is where the last step is to be cut.
    pub(super) behind: Option<(usize, Behind)>,
    /// True if a surface is a wall with conditions, behind which the motion may be.
    guarded: PerSurface<bool, Sys::Gaps>,
    has_guarded: bool,
    /// True if the gap of a surface is known to have one sign on the last step.
    pub(super) is_told: PerSurface<bool, Sys::Gaps>,
    /// The motion along the last step.
    pub(super) path: Path<Sys::State>,
    /// The gaps along the last step, if it is a power series.
    pub(super) series: LastSeries<Sys::Gaps>,
    /// A box in which no gap vanishes.
    haven: Haven<Sys::State>,
    /// A box with bounds of the gaps' derivatives.
    pub(super) limits: Bends<Sys::State, Sys::Gaps>,
    /// Bounds of the truncated terms of the gaps' power series.
    pub(super) tails: Tails<Sys::State, Sys::Gaps>,
    /// True if the stored gaps belong to an earlier time than the start of the next step, because the last steps were
    /// not tested.
    is_stale: bool,
}

/// Grazing test of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Graze {
    /// Not a grazing impact.
    None,
    /// A grazing impact within the rounding of the gap.
    WithinRounding,
    /// A crossing of the surface at gap rate zero.
    Crossing,
    /// A grazing impact within the error of the integrator.
    WithinError,
}

impl<Sys: Impacting> Watch<Sys> {
    pub(super) fn new(system: &Sys) -> Self {
        let (state, zeros) = (system.zero_state(), system.zero_gaps());
        let positions = system.coordinate_count();
        Self {
            gaps: zeros,
            passable: PerSurface::all(&zeros, false),
            standing: PerSurface::all(&zeros, Standing::Usual),
            guarded: PerSurface::all(&zeros, false),
            has_guarded: false,
            is_told: PerSurface::all(&zeros, false),
            rates: zeros,
            has_rates: false,
            proposed: None,
            parts: PerSurface::all(&zeros, None),
            is_shown_by_values: PerSurface::all(&zeros, false),
            grazes: PerSurface::all(&zeros, Graze::None),
            bends: zeros,
            length: 0.0,
            place: None,
            here: None,
            sizes: state,
            sizes_at_start: state,
            least_sizes: state,
            steps: 0,
            errors: 0.0,
            held: Held::none(&zeros),
            behind: None,
            path: Path::new(&state),
            series: LastSeries::none(&zeros),
            haven: Haven::new(positions, &state),
            limits: Bends::new(positions, &state, &zeros),
            tails: Tails::new(positions, &state, &zeros),
            is_stale: false,
        }
    }

    /// Sets the surfaces that hold the motion from now on.
    pub(super) fn hold(&mut self, held: &Held<Sys::Gaps>) {
        self.haven.forget();
        // Sliding may end in another mode.
        if (0..self.gaps.count()).any(|surface| held.is_held(surface) != self.held.is_held(surface))
        {
            self.limits.forget();
            self.tails.forget();
        }
        self.held = *held;
    }

    /// Makes a surface passable, or not, in the next run.
    pub(super) fn set_passable(&mut self, surface: usize, passable: bool) {
        self.passable[surface] = passable;
    }

    /// Marks a surface as a wall with conditions, or not, in the next run.
    pub(super) fn set_guarded(&mut self, surface: usize, is_guarded: bool) {
        self.guarded[surface] = is_guarded;
        self.has_guarded = self.guarded.iter().any(|is_guarded| is_guarded);
    }

    /// True if the surface has conditions, does not hold the motion, and may have had the motion behind it in the last
    /// step.
    pub(super) fn may_be_behind(&self, surface: usize) -> bool {
        let is_in_front = self.is_told[surface] && self.gaps.as_slice()[surface] >= 0.0;
        self.guarded[surface] && !is_in_front && !self.held.is_held(surface)
    }

    /// True if the motion touched a wall at the start of the step and has not risen from it up to where it has this gap.
    /// The gap is the sum of the errors of the steps along the wall. Behind a wall with conditions the motion may be free.
    pub(super) fn stays_touched(
        &self,
        surface: usize,
        gap: f64,
        now: &mut Moment<'_, Sys>,
    ) -> bool {
        let is_wall = !self.is_passable(surface) && !self.guarded[surface];
        is_wall
            && self.gaps.as_slice()[surface] == 0.0
            && gap <= 0.0
            && (gap == 0.0 || gap >= -DRIFT * self.rounding_at_cut(surface, now))
    }

    /// True if the motion touched a surface at the start of the step and hits it at `theta`.
    pub(super) fn comes_back(&self, surface: usize, theta: f64) -> bool {
        self.gaps.as_slice()[surface] == 0.0 && self.parts[surface] == Some(theta)
    }

    /// Adds the walls in front of which the motion was at the start of the step, and which it no longer is after a small
    /// correction of the positions.
    pub(super) fn add_reached(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let gaps = measured(now)?;
        for (surface, gap) in self.gaps.as_slice().iter().enumerate() {
            let was_before = *gap == 0.0 || (*gap > 0.0 && !self.is_passable(surface));
            if was_before && (*gap == 0.0 || gaps.as_slice()[surface] < 0.0) {
                hits.add(surface);
            }
        }
        self.here = Some(gaps);
        Ok(())
    }

    pub(super) fn is_passable(&self, surface: usize) -> bool {
        self.passable[surface]
    }

    /// The surfaces at hand at the first instant of a run.
    pub(super) fn begin(&mut self, now: &mut Moment<'_, Sys>) -> Result<Hits<Sys::Gaps>, Outcome> {
        (self.proposed, self.place) = (None, None);
        self.held = Held::none(&self.gaps);
        let positions = now.system.coordinate_count();
        self.haven = Haven::new(positions, now.state);
        self.limits = Bends::new(positions, now.state, &self.gaps);
        self.tails = Tails::new(positions, now.state, &self.gaps);
        self.is_stale = false;
        self.standing.fill(Standing::Usual);
        let rates = now.system.gap_rates(now.t, now.state)?;
        let mut hits = Hits::none(&rates);
        self.least_sizes = self.sizes_of_start(now)?;
        self.sizes = self.sized(now.state);
        self.sizes_at_start = self.sizes;
        self.relocate(&mut hits, &rates, now)?;
        quieten_at_start(&mut hits, &rates, now)?;
        Ok(hits)
    }

    /// The surfaces at hand at a position that smooth motion did not reach: at the start of a run or after a reset.
    pub(super) fn relocate(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let gaps = measured(now)?;
        self.grazes.fill(Graze::None);
        self.bends = gaps.zeroed();
        (self.gaps, self.here) = (gaps, Some(gaps));
        hits.replace(self.at_hand(&gaps, rates, now));
        self.forget_led_off(hits);
        Ok(())
    }

    /// Keeps surfaces at hand whose gaps a reset of the state `arrived` has not changed, whatever their size.
    pub(super) fn keep_at_hand(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        before: &Hits<Sys::Gaps>,
        arrived: &Sys::State,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        now.counters.event_evaluations += 1;
        let gaps = finite(now.system.gaps(now.t, arrived))?;
        for (surface, gap) in gaps.as_slice().iter().enumerate() {
            let is_same = *gap == self.gaps.as_slice()[surface];
            let is_active = || now.system.surface_active(surface, now.t, now.state);
            if is_same && before.is_at_hand(surface) && is_active() {
                hits.add(surface);
            }
        }
        Ok(())
    }

    /// True for the surfaces at hand, at a position with these gaps.
    pub(super) fn at_hand(
        &self,
        gaps: &Sys::Gaps,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) -> PerSurface<bool, Sys::Gaps> {
        let mut at_hand = PerSurface::all(gaps, false);
        for (surface, &gap) in gaps.as_slice().iter().enumerate() {
            if now.system.surface_active(surface, now.t, now.state) {
                // At a kink the gap has no rate, which `f64::max` drops.
                let rate = rates.as_slice()[surface].abs().max(0.0);
                let drift = SAME_TIME * rate * now.t.abs();
                if gap.abs() <= 2.0 * rounding(now, surface, &self.sizes) + drift {
                    at_hand[surface] = true;
                }
            }
        }
        at_hand
    }

    /// Lets passable surfaces act again that a reset has led off, if the way back takes no time that can be resolved.
    pub(super) fn reopen(
        &self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) {
        for surface in 0..self.gaps.count() {
            let gap = self.gaps.as_slice()[surface];
            let comes_back = hits.is_at_hand(surface) && rates.as_slice()[surface] < 0.0;
            if comes_back && self.is_passable(surface) && gap > 2.0 * self.rounding(surface, now) {
                hits.reopen(surface);
            }
        }
    }

    /// In a mode that was just entered, the surface of a transition in either direction counts as settled if it is at hand: the
    /// motion entered there.
    pub(super) fn pass_by(&self, hits: &mut Hits<Sys::Gaps>, system: &Sys) {
        for surface in 0..self.gaps.count() {
            let is_passable = self.is_passable(surface) && system.law(surface) == Law::Transition;
            if is_passable && hits.is_at_hand(surface) {
                hits.set_done(surface);
            }
        }
    }

    /// Records the state from which the motion goes on, after impacts on the surfaces at hand.
    pub(super) fn leave(
        &mut self,
        hits: &Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
        rates: Sys::Gaps,
    ) -> Result<(), Outcome> {
        (self.rates, self.has_rates) = (rates, true);
        self.haven.forget();
        self.note_standing(hits);
        let leads_on =
            |surface: usize| matches!(now.system.law(surface), Law::Reset | Law::Transition);
        if (0..self.gaps.count()).any(|s| hits.is_at_hand(s) && leads_on(s)) {
            self.limits.forget();
            self.tails.forget();
        }
        self.is_stale = false;
        (self.steps, self.errors) = (0, 0.0);
        let (held, here) = (self.held, self.here.take());
        let is_at_hand = |surface: usize| hits.is_at_hand(surface) || held.is_held(surface);
        if (0..self.gaps.count()).all(is_at_hand) {
            self.gaps = rates.zeroed();
            self.sizes = self.sized(now.state);
            return Ok(());
        }
        let mut gaps = match here {
            Some(gaps) => gaps,
            None => measured(now)?,
        };
        for surface in 0..gaps.count() {
            let gap = gaps.as_slice()[surface];
            if is_at_hand(surface) || self.stays_touched(surface, gap, now) {
                gaps.as_mut_slice()[surface] = 0.0;
            }
        }
        self.gaps = gaps;
        self.forget_left();
        // The gaps now have the rounding errors of the last flight; later gaps have those of the next one.
        let checked = self.check_negative(now);
        self.sizes = self.sized(now.state);
        checked
    }

    /// The time until the settled motion meets the surface that was proposed, by a step of Newton's method; `None` if it
    /// does so here, within the rounding of the gap, or if the gap does not show it.
    pub(super) fn aim(
        &self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Option<f64>, Outcome> {
        let is_met = |part: Option<f64>| self.proposed.is_some() && part == Some(theta);
        let Some(surface) = self.parts.iter().position(is_met) else {
            return Ok(None);
        };
        if self.grazes[surface] != Graze::None || self.is_shown_by_values[surface] {
            return Ok(None);
        }
        let gap = measured(now)?.as_slice()[surface];
        if gap.abs() <= rounding(now, surface, &self.sizes) {
            return Ok(None);
        }
        let rate = now.system.gap_rates(now.t, now.state)?.as_slice()[surface];
        let late = -gap / rate;
        let is_near = rate < 0.0 && late.abs() <= LARGEST_AIM * self.length;
        Ok(is_near.then_some(late))
    }

    /// The surfaces hit at the cut of the step: those found there, and those whose gaps are 0 there within rounding.
    pub(super) fn hits(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Hits<Sys::Gaps>, Outcome> {
        let mut hits = Hits::none(&self.gaps);
        self.here = None;
        if theta > 0.0 {
            self.forget_acted();
        }
        if self.proposed.is_none() {
            return Ok(hits);
        }
        for (surface, part) in self.parts.iter().enumerate() {
            if part.is_some_and(|part| (part - theta) * self.length <= SAME_TIME * now.t.abs()) {
                hits.add(surface);
                if self.is_passable(surface) || self.is_shown_by_values[surface] {
                    hits.set_fallen(surface);
                }
            }
        }
        if self.parts.count() > 1 && hits.is_some() {
            self.add_beside(&mut hits, now)?;
        }
        Ok(hits)
    }

    /// Adds the surfaces that are hit so soon after others that rounding decides the order. Along a flight the
    /// rounding of its steps accumulates.
    fn add_beside(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let rates = self.rates_here(now)?;
        let known = self.known_here(now).and_then(|place| place.gaps);
        let gaps = match known {
            Some(gaps) => finite(gaps)?,
            None => measured(now)?,
        };
        self.here = Some(gaps);
        let roundings = 2.0 + f64::from(self.steps) / 16.0;
        for surface in 0..self.gaps.count() {
            if hits.is_at_hand(surface) {
                continue;
            }
            let (gap, rate) = (gaps.as_slice()[surface], rates.as_slice()[surface]);
            let is_near = rate < 0.0 && gap.abs() <= BESIDE * rate.abs() * self.length;
            // A surface that was passed, or has acted, lies behind.
            let is_ahead = !self.is_passable(surface) || self.gaps.as_slice()[surface] > 0.0;
            if is_near
                && is_ahead
                && gap.abs() <= roundings * rounding(now, surface, &self.sizes)
                && now.system.surface_active(surface, now.t, now.state)
            {
                hits.add(surface);
            }
        }
        Ok(())
    }

    /// The quantities at this moment, if they were evaluated when the hit was found.
    fn known_here(&self, now: &Moment<'_, Sys>) -> Option<&Place<Sys>> {
        let place = self.place.as_ref();
        place.filter(|place| place.is(now.t, now.state))
    }

    /// The gap rates at the cut of the step.
    pub(super) fn rates_here(&self, now: &Moment<'_, Sys>) -> Result<Sys::Gaps, Outcome> {
        match self.known_here(now) {
            Some(place) => Ok(place.rates),
            None => Ok(now.system.gap_rates(now.t, now.state)?),
        }
    }

    /// True if the hit on this surface is a grazing impact.
    pub(super) fn is_graze(&self, surface: usize) -> bool {
        matches!(
            self.grazes[surface],
            Graze::WithinRounding | Graze::WithinError
        )
    }

    /// True if the gap rate at the last hit is so small that the gap may have reached 0 only by an error of this size,
    /// for example its rounding error.
    pub(super) fn is_slow(
        &self,
        surface: usize,
        rate: f64,
        rounding: impl FnOnce() -> f64,
    ) -> bool {
        let bend = self.bends.as_slice()[surface];
        bend > 0.0 && rate * rate < 4.0 * bend * rounding()
    }

    /// Size of a gap's rounding errors after the flight that ends now.
    pub(super) fn rounding(&self, surface: usize, now: &mut Moment<'_, Sys>) -> f64 {
        rounding(now, surface, &self.sizes)
    }

    /// Size of a gap's rounding errors at the cut of the last step. The motion behind the cut does not contribute.
    pub(super) fn rounding_at_cut(&self, surface: usize, now: &mut Moment<'_, Sys>) -> f64 {
        let mut sizes = self.sizes_at_start;
        for (size, value) in sizes.as_mut_slice().iter_mut().zip(now.state.as_slice()) {
            *size = size.abs().max(value.abs());
        }
        rounding(now, surface, &sizes)
    }

    /// True if this surface is crossed at gap rate 0.
    pub(super) fn is_tangential_crossing(&self, surface: usize) -> bool {
        self.grazes[surface] == Graze::Crossing
    }

    /// Finds the earliest hit in a step.
    #[inline]
    pub(super) fn look<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        (self.proposed, self.behind) = (None, None);
        self.tails.count();
        self.steps = self.steps.saturating_add(1);
        self.errors += step.stepper.error();
        self.sizes_at_start = self.sizes;
        for (i, size) in self.sizes.as_mut_slice().iter_mut().enumerate() {
            *size = size.abs().max(step.end().as_slice()[i].abs());
        }
        self.path.take(step)?;
        if self.haven.holds(&mut self.path) {
            self.is_stale = true;
            return Ok(None);
        }
        if self.is_stale {
            self.catch_up(step)?;
        }
        let mut glance = match glance(step) {
            Ok(glance) => glance,
            Err(outcome) => {
                // The driver repeats the step with another end.
                self.sizes = self.sizes_at_start;
                return Err(outcome);
            }
        };
        self.series.forget();
        if self.may_be_due(&glance) {
            glance.look_closer(&mut self.series, step)?;
        }
        let mut surfaces = 0..self.gaps.count();
        // Polynomials of a few gaps cost less than boxes.
        let has_series = glance.has_series() && self.gaps.count() <= FEW;
        let has_limits = !(has_series && self.tails.is_useful());
        let Self { limits, path, .. } = self;
        match has_limits {
            true => {
                path.enclose();
                limits.follow(step.system, path, &mut step.counters.enclosures);
            }
            false => limits.skip(),
        }
        let mut has_told = true;
        self.is_told.fill(false);
        let unclear = surfaces.find_map(|surface| match self.told(surface, step, &glance) {
            Told::Unclear(model) => Some((surface, model)),
            told => {
                has_told &= matches!(told, Told::Passed);
                self.is_told[surface] = true;
                None
            }
        });
        if has_limits {
            self.limits.learn(has_told);
        }
        if let Some(first) = unclear {
            let last_rates = glance.look_closer(&mut self.series, step)?;
            if !self.has_rates {
                self.rates = step.system.gap_rates(step.t_start(), step.start())?;
                self.has_rates = true;
            }
            self.search(step, &glance, &last_rates, first)?;
        }
        if self.has_guarded {
            self.look_behind(step)?;
        }
        if self.proposed.is_none() {
            self.pass(step, &mut glance)?;
        }
        Ok(self.proposed)
    }

    /// True if some gap is so small at the end of the step that it may vanish there within the rounding of times.
    #[inline]
    fn may_be_due(&self, glance: &Glance<Sys::Gaps>) -> bool {
        (0..self.gaps.count()).any(|surface| {
            let at = |values: &Sys::Gaps| values.as_slice()[surface];
            let rise = match self.has_rates {
                true => at(&self.rates) * glance.length,
                false => 0.0,
            };
            at(&glance.gaps).abs() <= BESIDE * (at(&self.gaps).abs() + rise.abs())
        })
    }

    /// Computes gaps and rates at the start of a step that follows untested ones.
    fn catch_up<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        step.counters.event_evaluations += 1;
        self.gaps = finite(step.system.gaps(step.t_start(), step.start()))?;
        self.has_rates = self.gaps.as_slice().iter().any(|&gap| gap <= 0.0);
        if self.has_rates {
            self.rates = step.system.gap_rates(step.t_start(), step.start())?;
        }
        self.is_stale = false;
        Ok(())
    }

    /// Accepts the whole step: its end is the start of the next.
    #[inline]
    fn pass<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
        glance: &mut Glance<Sys::Gaps>,
    ) -> Result<(), Outcome> {
        let before = self.gaps;
        self.gaps = glance.gaps;
        let is_off = self.gaps.as_slice().iter().all(|&gap| gap > 0.0);
        if !is_off {
            glance.look_closer(&mut self.series, step)?;
        }
        self.has_rates = match glance.rates() {
            Some(rates) => {
                self.rates = *rates;
                true
            }
            None => false,
        };
        if is_off {
            if before.as_slice().contains(&0.0) {
                self.standing.fill(Standing::Usual);
                return Ok(());
            }
            let Self { haven, path, .. } = self;
            let passable = self.passable;
            let is_passable = |surface: usize| passable[surface];
            haven.settle(
                step.system,
                path,
                is_passable,
                &mut step.counters.enclosures,
            );
            return Ok(());
        }
        for surface in 0..self.gaps.count() {
            if self.is_passable(surface) {
                let start = before.as_slice()[surface];
                self.keep_side(surface, start, step, glance);
            }
        }
        for surface in 0..self.gaps.count() {
            let (gap, at_hand) = (
                self.gaps.as_slice()[surface],
                before.as_slice()[surface] == 0.0,
            );
            let is_held = self.held.is_held(surface);
            // Behind a passable surface, the motion may turn back within the step.
            let mut goes_behind = || match self.is_passable(surface) {
                true => self.is_sunk(surface, step, glance),
                false => self.is_pressed(surface, step, glance),
            };
            if is_held || (at_hand && gap < 0.0 && !goes_behind()) {
                self.gaps.as_mut_slice()[surface] = 0.0;
            }
        }
        self.forget_left();
        let (t, mut state) = (step.t_end(), *step.end());
        let counters = &mut *step.counters;
        let checked = self.check_negative(&mut Moment {
            system: step.system,
            t,
            state: &mut state,
            counters,
        });
        match checked {
            // The surface began to count within rounding of the end of the step, or its conditions are not enclosed.
            Err(Outcome::StartsInside { surface, .. }) => self.end_where_behind(surface, step),
            checked => checked,
        }
    }
}

/// Gaps at a moment; fails if one is not finite.
pub(super) fn measured<Sys: Impacting>(now: &mut Moment<'_, Sys>) -> Result<Sys::Gaps, Outcome> {
    now.counters.event_evaluations += 1;
    finite(now.system.gaps(now.t, now.state))
}

/// The size of a gap's rounding errors at a moment, for components that reached these sizes.
pub(super) fn rounding<Sys: Impacting>(
    now: &mut Moment<'_, Sys>,
    surface: usize,
    sizes: &Sys::State,
) -> f64 {
    resolution(
        now.system,
        surface,
        now.t,
        now.state,
        sizes,
        &mut now.counters.event_evaluations,
    )
}
