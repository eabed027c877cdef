//! Impulses on the surfaces that hold the motion, and the equations for their sizes; see [`super::held`].

use super::held::Held;
use crate::contract::Impacting;
use crate::error::Fault;
use crate::state::{StateVector, scaled};

/// Ratio below which the effect of several impulses together on the gap rates, compared with the effects of each alone,
/// counts as 0: the surfaces push against each other.
const COUNTERACTING: f64 = 1.0 / (1_u64 << 40) as f64;
/// Square of gap rates that are not cancelled, relative to all, up to which they count as cancelled.
const SOLVED: f64 = 1.0 / (1_u128 << 64) as f64;
/// Size of a residual that counts as rounding, relative to the right-hand side.
const NEGLIGIBLE: f64 = 8.0 * f64::EPSILON;

/// Impulses on held surfaces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solved<G> {
    /// Their sizes.
    pub(super) sizes: G,
    /// The gap rates that they do not cancel.
    missing: G,
    /// For each surface the impulse that, by itself, changes its gap rate by 1.
    pub(super) weights: G,
}

impl<G: StateVector> Solved<G> {
    /// A measure of gap rates of the held surfaces.
    pub(super) fn square(&self, rates: &G) -> f64 {
        product(rates, &times(&self.weights, rates))
    }

    /// True if the impulses cancel these gap rates.
    pub(super) fn is_solved(&self, rates: &G) -> bool {
        self.square(&self.missing) <= SOLVED * self.square(rates)
    }
}

impl<G: StateVector> Held<G> {
    /// The components of the held surfaces, and zeros elsewhere.
    pub(super) fn only(&self, values: &G) -> G {
        let mut only = *values;
        for (surface, value) in only.as_mut_slice().iter_mut().enumerate() {
            if !self.is_held(surface) {
                *value = 0.0;
            }
        }
        only
    }

    /// The force of the instantaneous constraints for these rates of momenta or quasi-velocities.
    pub(super) fn trace<Sys: Impacting<Gaps = G>>(
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
    pub(super) fn reaction<Sys: Impacting<Gaps = G>>(
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
    pub(super) fn against<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rates: &G,
    ) -> Result<Option<G>, Fault> {
        let solved = self.solve(system, t, state, rates)?;
        Ok(solved.map(|solved| solved.sizes))
    }

    /// Same as [`Held::against`], with what is not cancelled.
    pub(super) fn solve<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        rates: &G,
    ) -> Result<Option<Solved<G>>, Fault> {
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
            let effect = product(&search, &response);
            let alone: f64 = (search.as_slice().iter().zip(weights.as_slice()))
                .filter(|(_, weight)| **weight != 0.0)
                .map(|(size, weight)| size * size / weight)
                .sum();
            let step = squared / effect;
            if effect <= COUNTERACTING * alone || !step.is_finite() {
                break;
            }
            sizes = sum(&sizes, step, &search);
            missing = sum(&missing, -step, &response);
            let wanted = times(&weights, &missing);
            let next = product(&wanted, &missing);
            search = sum(&wanted, next / squared, &search);
            squared = next;
        }
        Ok(Some(Solved {
            sizes,
            missing,
            weights,
        }))
    }

    /// Changes of the gap rates of the held surfaces by impulses of these sizes.
    pub(super) fn response<Sys: Impacting<Gaps = G>>(
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
    pub(super) fn pushes<Sys: Impacting<Gaps = G>>(
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
    ///
    /// NOTE: what is left by rounding where they cancel would move bodies at rest, and collide with those they touch.
    pub(super) fn push<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
        sizes: &G,
        to: &mut Sys::State,
    ) -> Result<(), Fault> {
        let mut terms = *to;
        let mut kick = |size: f64, direction: &Sys::Impulse| {
            system.kick(to, size, direction);
            let moved = &mut terms.as_mut_slice()[system.motion_start(state)..];
            for (term, part) in moved.iter_mut().zip(direction.as_slice()) {
                *term = term.abs() + (size * part).abs();
            }
        };
        for surface in self.iter() {
            let contact = system.contact(surface, t, state)?;
            kick(sizes.as_slice()[surface], &contact.direction);
        }
        if self.is_rough(system, t, state)? {
            let pushes = self.pushes(system, t, state, sizes)?;
            if let Some(reaction) = self.reaction(system, t, state, &pushes)? {
                kick(1.0, &reaction);
            }
        }
        let pairs = to.as_mut_slice().iter_mut().zip(terms.as_slice());
        for (value, term) in pairs {
            if value.abs() <= ROUNDING * term.abs() {
                *value = 0.0;
            }
        }
        Ok(())
    }
}

/// Rounding error of a sum of impulses, as a fraction of their sizes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

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
pub(super) fn sum<V: StateVector>(a: &V, factor: f64, b: &V) -> V {
    let mut sum = *a;
    for (value, b) in sum.as_mut_slice().iter_mut().zip(b.as_slice()) {
        *value += factor * b;
    }
    sum
}
