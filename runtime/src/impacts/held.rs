//! Motion along surfaces: the contact forces that hold it there, and the correction of drift.
//!
//! A frictionless surface `c` pushes along `pi_D^* dh_c`. The sizes `lambda_c` of the forces keep the gap rates of all
//! held surfaces constant:
//!
//! ```text
//! sum_d dh_c(pi_D grad h_d) lambda_d = -d^2 h_c/dt^2
//! ```
//!
//! The same equations with gap rates or gaps on the right-hand side correct velocities and positions. Their matrix is
//! symmetric and positive semidefinite. In exact arithmetic, conjugate gradients solve them in at most one step per
//! surface, without storing the matrix.
//!
//! Instantaneous constraints of a surface hold as long as the surface holds the motion ([`Impacting::trace`]). Their
//! forces come first, and the surfaces push within the constraints. At most one of the held surfaces has instantaneous
//! constraints ([`super::resting`]).

use super::instantaneous::{focused, is_rough};
use super::resting::squared_rate;
use super::sliding::Slide;
use crate::contract::Impacting;
use crate::effects::{Change, Moment};
use crate::error::Fault;
use crate::forces::Forces;
use crate::per_surface::PerSurface;
use crate::state::{StateVector, scaled};

/// Square of a gap rate, relative to that of a motion straight to the surface, up to which it may be an error.
const ERRORS: f64 = 1.0 / (1 << 16) as f64;
/// Square of a contact force, relative to that of a force straight to the surface with the effect of all other forces,
/// up to which it may be a rounding error: the square of `2^-40`.
const FORCELESS: f64 = 1.0 / (1_u128 << 80) as f64;
/// Relative change of positions that leaves a kink.
const STEP_ASIDE: f64 = 4.0 * f64::EPSILON;
/// Size of a residual that counts as rounding, relative to the right-hand side.
const NEGLIGIBLE: f64 = 8.0 * f64::EPSILON;

/// Surfaces along which the motion is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held<G: StateVector> {
    surfaces: PerSurface<bool, G>,
    /// The two transitions between which the motion slides; they count as held.
    slide: Option<Slide>,
}

impl<G: StateVector> Held<G> {
    /// No surface held, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            surfaces: PerSurface::all(like, false),
            slide: None,
        }
    }

    pub(super) fn is_held(&self, surface: usize) -> bool {
        self.surfaces[surface]
    }

    pub(super) fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    pub(super) fn hold(&mut self, surface: usize) {
        self.surfaces[surface] = true;
    }

    pub(super) fn release(&mut self, surface: usize) {
        self.surfaces[surface] = false;
    }

    /// Begins sliding between two modes.
    pub(super) fn slide_along(&mut self, slide: Slide) {
        self.hold(slide.back);
        self.hold(slide.across);
        self.slide = Some(slide);
    }

    /// The transitions between which the motion slides.
    pub(super) fn slide(&self) -> Option<Slide> {
        self.slide
    }

    /// The held surfaces, in order of index.
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.surfaces.count()).filter(|&surface| self.is_held(surface))
    }

    /// The components of the held surfaces, and zeros elsewhere.
    fn only(&self, values: &G) -> G {
        let mut only = *values;
        for (value, is_held) in only.as_mut_slice().iter_mut().zip(self.surfaces.iter()) {
            if !is_held {
                *value = 0.0;
            }
        }
        only
    }

    /// The sizes of the contact forces at a state. `None` for a system without second rates of its gaps.
    pub(super) fn sizes<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Option<G>, Fault> {
        if let Some(slide) = self.slide {
            return slide.pressures(system, t, state).map(Some);
        }
        let state = &self.beside_kink(system, t, state)?;
        let mut rate = system.zero_state();
        system.rate(t, state, &mut rate)?;
        self.sizes_at(system, t, state, &rate)
    }

    /// The state, or one within rounding in the direction of the motion if the gap of a held surface has a kink there,
    /// where it has no slope.
    fn beside_kink<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::State, Fault> {
        let kinked = || self.iter().filter(|&surface| system.has_kinks(surface));
        if kinked().next().is_none() {
            return Ok(*state);
        }
        let rates = system.gap_rates(t, state)?;
        if kinked().all(|surface| rates.as_slice()[surface].is_finite()) {
            return Ok(*state);
        }
        let (mut q, qdot) = (system.position(state), system.velocity(t, state)?);
        for (q, v) in q.as_mut_slice().iter_mut().zip(qdot.as_slice()) {
            *q += (STEP_ASIDE * q.abs().max(f64::MIN_POSITIVE / f64::EPSILON)).copysign(*v);
        }
        system.state_moved(state, t, &q, &qdot)
    }

    /// Same as [`Held::sizes`], for a known rate without the forces.
    fn sizes_at<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &Sys::State,
    ) -> Result<Option<G>, Fault> {
        let mut motion = motion_of(system, state, rate);
        if let Some(force) = self.trace(system, t, state, &motion)? {
            motion = sum(&motion, 1.0, &force);
        }
        let Some(accelerations) = system.gap_accelerations(t, state, &motion)? else {
            return Ok(None);
        };
        let mut sizes = self.against(system, t, state, &accelerations)?;
        if let Some(sizes) = &mut sizes
            && sizes.as_slice().iter().any(|&size| size < 0.0)
        {
            self.drop_rounding(system, (t, state), &motion, sizes)?;
        }
        Ok(sizes)
    }

    /// Sets negative sizes to 0 that may be rounding errors: a surface between bodies that fall together has no force.
    fn drop_rounding<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        (t, state): (f64, &Sys::State),
        motion: &Sys::Impulse,
        sizes: &mut G,
    ) -> Result<(), Fault> {
        let mut kicked = *state;
        system.kick(&mut kicked, 1.0, motion);
        let (qdot, p) = (system.velocity(t, state)?, system.momentum(t, state)?);
        let (moved, pushed) = (system.velocity(t, &kicked)?, system.momentum(t, &kicked)?);
        // The sizes of the terms whose sum is the product of the motion with itself.
        let pairs = (moved.as_slice().iter().zip(qdot.as_slice()))
            .zip(pushed.as_slice().iter().zip(p.as_slice()));
        let square: f64 = pairs
            .map(|((w, v), (q, p))| ((w - v) * (q - p)).abs())
            .sum();
        for surface in self.iter() {
            let size = &mut sizes.as_mut_slice()[surface];
            let compliance = system.contact(surface, t, state)?.constrained_compliance;
            if *size < 0.0 && *size * *size * compliance <= FORCELESS * square {
                *size = 0.0;
            }
        }
        Ok(())
    }

    /// The force of the instantaneous constraints for these rates of momenta or quasi-velocities.
    fn trace<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        motion: &Sys::Impulse,
    ) -> Result<Option<Sys::Impulse>, Fault> {
        for surface in self.iter() {
            if let Some(force) = system.trace(surface, t, state, motion)? {
                return Ok(Some(force));
            }
        }
        Ok(None)
    }

    /// The reaction of the instantaneous constraints to an impulse or a force; `None` without such constraints.
    fn reaction<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        motion: &Sys::Impulse,
    ) -> Result<Option<Sys::Impulse>, Fault> {
        let Some(with) = self.trace(system, t, state, motion)? else {
            return Ok(None);
        };
        let without = self.trace(system, t, state, &system.zero_impulse())?;
        Ok(without.map(|without| sum(&with, -1.0, &without)))
    }

    /// Sizes of the impulses on the held surfaces that cancel these gap rates, or of the forces that cancel these
    /// second rates.
    fn against<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rates: &G,
    ) -> Result<Option<G>, Fault> {
        let (mut sizes, mut weights) = (rates.zeroed(), rates.zeroed());
        for surface in self.iter() {
            let contact = system.contact(surface, t, state)?;
            weights.as_mut_slice()[surface] = 1.0 / contact.constrained_compliance;
        }
        // The residual, and the search direction: for each surface the impulse that, by itself, cancels its residual.
        let mut missing = scaled(&self.only(rates), -1.0);
        let mut search = times(&weights, &missing);
        let mut squared = product(&search, &missing);
        let least = NEGLIGIBLE * NEGLIGIBLE * squared;
        for _ in 0..2 * rates.count() {
            if squared <= least {
                break;
            }
            let Some(response) = self.response(system, t, state, &search)? else {
                return Ok(None);
            };
            let step = squared / product(&search, &response);
            if !step.is_finite() {
                break;
            }
            sizes = sum(&sizes, step, &search);
            missing = sum(&missing, -step, &response);
            let wanted = times(&weights, &missing);
            let next = product(&wanted, &missing);
            search = sum(&wanted, next / squared, &search);
            squared = next;
        }
        Ok(Some(sizes))
    }

    /// Changes of the gap rates of the held surfaces by impulses of these sizes.
    fn response<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        sizes: &G,
    ) -> Result<Option<G>, Fault> {
        let mut motion = self.pushes(system, t, state, sizes)?;
        if let Some(reaction) = self.reaction(system, t, state, &motion)? {
            motion = sum(&motion, 1.0, &reaction);
        }
        let responses = system.gap_responses(t, state, &motion)?;
        Ok(responses.map(|responses| self.only(&responses)))
    }

    /// Sum of impulses of these sizes.
    fn pushes<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        sizes: &G,
    ) -> Result<Sys::Impulse, Fault> {
        let mut motion = system.zero_impulse();
        for surface in self.iter() {
            let contact = system.contact(surface, t, state)?;
            motion = sum(&motion, sizes.as_slice()[surface], &contact.direction);
        }
        Ok(motion)
    }

    /// Adds impulses of these sizes, evaluated at `state`, to a state or to a rate.
    fn push<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        sizes: &G,
        to: &mut Sys::State,
    ) -> Result<(), Fault> {
        for surface in self.iter() {
            let contact = system.contact(surface, t, state)?;
            system.kick(to, sizes.as_slice()[surface], &contact.direction);
        }
        if !self.is_rough(system, t, state)? {
            return Ok(());
        }
        let pushes = self.pushes(system, t, state, sizes)?;
        if let Some(reaction) = self.reaction(system, t, state, &pushes)? {
            system.kick(to, 1.0, &reaction);
        }
        Ok(())
    }

    /// True if a held surface has instantaneous constraints.
    pub(super) fn is_rough<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<bool, Fault> {
        for surface in self.iter() {
            if is_rough(system, surface, t, state)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Corrects the drift from the held surfaces: brings gaps and gap rates to 0, each to first order.
    pub(super) fn settle<Sys: Impacting<Gaps = G>>(
        &self,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Change, Fault> {
        if self.is_empty() {
            return Ok(Change::Kept);
        }
        if let Some(slide) = self.slide {
            slide.settle(now.system, now.t, now.state)?;
            return Ok(Change::Changed);
        }
        now.counters.event_evaluations += 1;
        let gaps = now.system.gaps(now.t, now.state);
        self.settle_positions(now, &gaps)?;
        self.settle_rates(now)?;
        Ok(Change::Changed)
    }

    /// Brings the gaps to 0: moves positions by the change of velocity that an impulse would make.
    fn settle_positions<Sys: Impacting<Gaps = G>>(
        &self,
        now: &mut Moment<'_, Sys>,
        gaps: &G,
    ) -> Result<(), Fault> {
        let (system, t) = (now.system, now.t);
        let Some(sizes) = self.against(system, t, now.state, gaps)? else {
            return Ok(());
        };
        let mut kicked = *now.state;
        self.push(system, t, now.state, &sizes, &mut kicked)?;
        let (qdot, moved) = (system.velocity(t, now.state)?, system.velocity(t, &kicked)?);
        let difference = sum(&moved, -1.0, &qdot);
        let q = sum(&system.position(now.state), 1.0, &difference);
        *now.state = system.state_moved(now.state, t, &q, &qdot)?;
        Ok(())
    }

    /// Cancels the gap rates, after enforcing the instantaneous constraints.
    pub(super) fn settle_rates<Sys: Impacting<Gaps = G>>(
        &self,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Fault> {
        let (system, t) = (now.system, now.t);
        for surface in self.iter() {
            if let Some(focused) = focused(system, surface, t, now.state)? {
                *now.state = focused;
            }
        }
        let rates = system.gap_rates(t, now.state)?;
        self.cancel(&rates, now)
    }

    /// True if gap rates of the held surfaces are so small that they may be errors of the motion.
    pub(super) fn are_errors<Sys: Impacting<Gaps = G>>(
        &self,
        rates: &G,
        now: &Moment<'_, Sys>,
    ) -> Result<bool, Fault> {
        for surface in self.iter() {
            let rate = rates.as_slice()[surface];
            let whole = squared_rate(now.system, surface, (now.t, now.state))?;
            let is_small = rate * rate <= ERRORS * whole;
            if !is_small {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Takes gap rates of held surfaces from those of the state.
    pub(super) fn cancel<Sys: Impacting<Gaps = G>>(
        &self,
        rates: &G,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Fault> {
        let (system, t, state) = (now.system, now.t, *now.state);
        match self.against(system, t, &state, rates)? {
            Some(sizes) => self.push(system, t, &state, &sizes, now.state),
            None => Ok(()),
        }
    }
}

impl<Sys: Impacting> Forces<Sys> for Held<Sys::Gaps> {
    fn add(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &mut Sys::State,
    ) -> Result<(), Fault> {
        if let Some(slide) = self.slide {
            return slide.add(system, t, state, rate);
        }
        let state = &self.beside_kink(system, t, state)?;
        let Some(sizes) = self.sizes_at(system, t, state, rate)? else {
            return Ok(());
        };
        if let Some(force) = self.trace(system, t, state, &motion_of(system, state, rate))? {
            system.kick(rate, 1.0, &force);
        }
        self.push(system, t, state, &sizes, rate)
    }
}

/// The second rates of all gaps for this rate of the state. `None` for a system that does not provide them.
pub(super) fn second_rates<Sys: Impacting>(
    system: &Sys,
    t: f64,
    state: &Sys::State,
    rate: &Sys::State,
) -> Result<Option<Sys::Gaps>, Fault> {
    system.gap_accelerations(t, state, &motion_of(system, state, rate))
}

/// The rates of momenta or quasi-velocities in the rate of a state.
fn motion_of<Sys: Impacting>(system: &Sys, state: &Sys::State, rate: &Sys::State) -> Sys::Impulse {
    let mut motion = system.zero_impulse();
    let parts = rate.as_slice().iter().skip(system.motion_start(state));
    for (part, rate) in motion.as_mut_slice().iter_mut().zip(parts) {
        *part = *rate;
    }
    motion
}

fn product<V: StateVector>(a: &V, b: &V) -> f64 {
    let pairs = a.as_slice().iter().zip(b.as_slice());
    pairs.map(|(a, b)| a * b).sum()
}

fn times<V: StateVector>(a: &V, b: &V) -> V {
    let mut times = *a;
    for (value, b) in times.as_mut_slice().iter_mut().zip(b.as_slice()) {
        *value *= b;
    }
    times
}

/// `a + factor * b`
fn sum<V: StateVector>(a: &V, factor: f64, b: &V) -> V {
    let mut sum = *a;
    for (value, b) in sum.as_mut_slice().iter_mut().zip(b.as_slice()) {
        *value += factor * b;
    }
    sum
}
