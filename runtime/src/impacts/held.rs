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

use super::balance::sum;
use super::instantaneous::{focused, is_rough};
use super::resting::squared_rate;
use super::sliding::Slide;
use crate::contract::Impacting;
use crate::effects::{Change, Moment};
use crate::error::Fault;
use crate::forces::Forces;
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Square of a gap rate, relative to that of a motion straight to the surface, up to which it may be an error.
const ERRORS: f64 = 1.0 / (1 << 16) as f64;
/// Square of a contact force, relative to that of a force straight to the surface with the effect of all other forces,
/// up to which it may be a rounding error: the square of `2^-40`.
const FORCELESS: f64 = 1.0 / (1_u128 << 80) as f64;
/// Relative change of positions that leaves a kink.
const STEP_ASIDE: f64 = 4.0 * f64::EPSILON;
/// Gap rate of a held surface, relative to the speeds of the motion and of the surface, that is no rounding error.
const MOVING: f64 = 1.0 / (1 << 30) as f64;

/// Square of a gap rate, relative to that gained since the time 0, that may stem from the rounding of the time: the square of 8 units in the
/// last place.
const ROUNDED: f64 = 64.0 * f64::EPSILON * f64::EPSILON;

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
        let Some((sizes, is_followed)) = self.sizes_at(system, t, state, &rate)? else {
            return Ok(None);
        };
        let pulls = || sizes.as_slice().iter().any(|&size| size < 0.0);
        if self.iter().nth(1).is_none() || is_followed && !pulls() {
            return Ok(Some(sizes));
        }
        let pushing = self.pushing(system, t, state)?;
        Ok(Some(match pushing {
            Some(pushing) if !is_followed || pushing.follows_all => pushing.sizes,
            _ => sizes,
        }))
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

    /// Same as [`Held::sizes`], for a known rate without the forces; and true if the motion can follow all surfaces.
    fn sizes_at<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &Sys::State,
    ) -> Result<Option<(G, bool)>, Fault> {
        let motion = self.traced(system, t, state, rate)?;
        let Some(accelerations) = system.gap_accelerations(t, state, &motion)? else {
            return Ok(None);
        };
        let Some(solved) = self.solve(system, t, state, &accelerations)? else {
            return Ok(None);
        };
        let is_followed = solved.is_solved(&accelerations);
        let mut sizes = solved.sizes;
        let is_one_of_several = self.iter().nth(1).is_some();
        if is_one_of_several || sizes.as_slice().iter().any(|&size| size < 0.0) {
            self.drop_rounding(system, (t, state), &motion, &mut sizes)?;
        }
        Ok(Some((sizes, is_followed)))
    }

    /// The rates of momenta or quasi-velocities, with the forces of instantaneous constraints.
    fn traced<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rate: &Sys::State,
    ) -> Result<Sys::Impulse, Fault> {
        let motion = motion_of(system, state, rate);
        Ok(match self.trace(system, t, state, &motion)? {
            Some(force) => sum(&motion, 1.0, &force),
            None => motion,
        })
    }

    /// The second rates of all gaps without the forces; `None` for a system without second rates of its gaps.
    pub(super) fn second_rates<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Option<G>, Fault> {
        let state = &self.beside_kink(system, t, state)?;
        let mut rate = system.zero_state();
        system.rate(t, state, &mut rate)?;
        let motion = self.traced(system, t, state, &rate)?;
        system.gap_accelerations(t, state, &motion)
    }

    /// Sets sizes to 0 that may be rounding errors: a surface between bodies that fall together has no force.
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
            if *size * *size * compliance <= FORCELESS * square {
                *size = 0.0;
            }
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
    ///
    /// # Errors
    /// [`Outcome::Squeezed`] if no motion follows all of the surfaces.
    pub(super) fn settle<Sys: Impacting<Gaps = G>>(
        &self,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Change, Outcome> {
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

    /// Refuses a state that moves against a held surface although its gap rates were just cancelled: there is no impulse
    /// that cancels all of them. `before` is the state before they were cancelled.
    fn check_followed<Sys: Impacting<Gaps = G>>(
        &self,
        before: &Sys::State,
        now: &Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        if self.iter().nth(1).is_none() || self.slide.is_some() {
            return Ok(());
        }
        let (system, t, state) = (now.system, now.t, &*now.state);
        let rates = system.gap_rates(t, state)?;
        for surface in self.iter() {
            let square = |rates: &G| rates.as_slice()[surface] * rates.as_slice()[surface];
            let of_motion = squared_rate(system, surface, (t, before))?
                + squared_rate(system, surface, (t, state))?;
            if square(&rates) <= MOVING * MOVING * of_motion {
                continue;
            }
            let (q, mut qdot) = (system.position(state), system.velocity(t, state)?);
            qdot.as_mut_slice().fill(0.0);
            let of_surfaces = system.gap_rates(t, &system.state_moved(state, t, &q, &qdot)?)?;
            if square(&rates) <= MOVING * MOVING * (square(&of_surfaces) + of_motion) {
                continue;
            }
            // The rounding of the time changes gap rates too.
            let gained = self.second_rates(system, t, state)?;
            let gained = gained.map_or(0.0, |second| square(&second)) * t * t;
            if square(&rates) > ROUNDED * gained {
                return Err(Outcome::Squeezed { surface });
            }
        }
        Ok(())
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
    ///
    /// # Errors
    /// [`Outcome::Squeezed`] if no motion follows all of the surfaces.
    pub(super) fn settle_rates<Sys: Impacting<Gaps = G>>(
        &self,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        let (system, t) = (now.system, now.t);
        for surface in self.iter() {
            if let Some(focused) = focused(system, surface, t, now.state)? {
                *now.state = focused;
            }
        }
        let (before, rates) = (*now.state, system.gap_rates(t, now.state)?);
        self.cancel(&rates, now)?;
        self.check_followed(&before, now)
    }

    /// True if gap rates of the held surfaces are so small that they may be errors of the motion, which took a step of this
    /// length: small beside the rate of a motion with the same energy, or beside that which the forces would have given.
    pub(super) fn are_errors<Sys: Impacting<Gaps = G>>(
        &self,
        rates: &G,
        length: f64,
        now: &Moment<'_, Sys>,
    ) -> Result<bool, Fault> {
        let (system, t) = (now.system, now.t);
        let forces = self.sizes(system, t, now.state)?;
        for surface in self.iter() {
            let rate = rates.as_slice()[surface];
            let force = forces.map_or(0.0, |forces| forces.as_slice()[surface]);
            let compliance = system
                .contact(surface, t, now.state)?
                .constrained_compliance;
            let gained = compliance * force * length;
            let whole = squared_rate(system, surface, (t, now.state))? + gained * gained;
            let is_small = rate * rate <= ERRORS * whole;
            if !is_small {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The limit of impacts on these surfaces that follow each other at one time until none is approached; `None` if no impulses that
    /// only push lead there.
    pub(super) fn limit<Sys: Impacting<Gaps = G>>(
        &self,
        now: &Moment<'_, Sys>,
    ) -> Result<Option<Sys::State>, Fault> {
        let (system, t, state) = (now.system, now.t, &*now.state);
        let rates = system.gap_rates(t, state)?;
        let Some(pushing) = self.complementary(system, (t, state), &rates)? else {
            return Ok(None);
        };
        let mut limit = *state;
        pushing
            .held
            .push(system, t, state, &pushing.sizes, &mut limit)?;
        Ok(Some(limit))
    }

    /// True if impulses on these surfaces can cancel all their gap rates.
    pub(super) fn can_follow<Sys: Impacting<Gaps = G>>(
        &self,
        now: &Moment<'_, Sys>,
    ) -> Result<bool, Fault> {
        let rates = now.system.gap_rates(now.t, now.state)?;
        let solved = self.solve(now.system, now.t, now.state, &rates)?;
        Ok(solved.is_some_and(|solved| solved.is_solved(&rates)))
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
        let Some((sizes, _)) = self.sizes_at(system, t, state, rate)? else {
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
