//! The surfaces that push among those that the motion touches.
//!
//! A surface pushes or is left. The forces `lambda` and the second rates `w` of the gaps satisfy
//!
//! ```text
//! w = a + C lambda,   lambda >= 0,   w >= 0,   lambda_c w_c = 0
//! ```
//!
//! with the second rates `a` without forces and the matrix `C` of [`super::held`]. The motion that follows is unique if there
//! is one. The sets of surfaces are tried, the largest first, so that a surface without a force holds the motion as long as
//! the motion follows it. With surfaces that depend on each other, such as the four legs of a table, the forces are not
//! unique; a solution without pulling forces counts.

use super::balance::Solved;
use super::held::Held;
use crate::contract::Impacting;
use crate::error::Fault;
use crate::state::StateVector;

/// Largest number of touched surfaces of which all sets are tried.
const MOST: usize = 6;

/// Square of a force or of a second rate, relative to those of all surfaces, up to which it counts as 0.
const NOTHING: f64 = 1.0 / (1_u128 << 64) as f64;

/// Surfaces that push.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pushing<G: StateVector> {
    /// The surfaces.
    pub(super) held: Held<G>,
    /// The sizes of their forces. For surfaces that the motion leaves, they are negative: minus the forces with which they would have
    /// to pull to hold it, each by itself.
    pub(super) sizes: G,
    /// True if the motion also follows the other surfaces.
    pub(super) follows_all: bool,
}

impl<G: StateVector> Held<G> {
    /// The surfaces that push among the held ones. `None` if no set of them was found: because no motion follows, because
    /// they are too many and not all push, or because some have instantaneous constraints.
    pub(super) fn pushing<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        t: f64,
        state: &Sys::State,
    ) -> Result<Option<Pushing<G>>, Fault> {
        if self.slide().is_some() {
            return Ok(None);
        }
        match self.second_rates(system, t, state)? {
            Some(free) => self.complementary(system, (t, state), &free),
            None => Ok(None),
        }
    }

    /// Same as [`Held::pushing`], for given second rates, or for gap rates and impulses.
    pub(super) fn complementary<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        (t, state): (f64, &Sys::State),
        free: &G,
    ) -> Result<Option<Pushing<G>>, Fault> {
        if self.is_rough(system, t, state)? {
            return Ok(None);
        }
        let Some(whole) = self.solve(system, t, state, free)? else {
            return Ok(None);
        };
        let least = NOTHING * whole.square(free);
        let all = self.try_set(system, (t, state), free, (&whole, least), self)?;
        let count = self.iter().count();
        if all.is_some() || count > MOST {
            return Ok(all);
        }
        for size in (0..count).rev() {
            for set in (0..1_usize << count).filter(|set| set.count_ones() as usize == size) {
                let mut subset = *self;
                for (index, surface) in self.iter().enumerate() {
                    if set & (1 << index) == 0 {
                        subset.release(surface);
                    }
                }
                let found = subset.try_set(system, (t, state), free, (&whole, least), self)?;
                if found.is_some() {
                    return Ok(found);
                }
            }
        }
        Ok(None)
    }

    /// The forces of these surfaces, if they push and the motion enters none of `all`.
    fn try_set<Sys: Impacting<Gaps = G>>(
        &self,
        system: &Sys,
        (t, state): (f64, &Sys::State),
        free: &G,
        (whole, least): (&Solved<G>, f64),
        all: &Self,
    ) -> Result<Option<Pushing<G>>, Fault> {
        let Some(solved) = self.solve(system, t, state, free)? else {
            return Ok(None);
        };
        let response = all.response(system, t, state, &solved.sizes)?;
        let Some(response) = response.filter(|_| solved.is_solved(free)) else {
            return Ok(None);
        };
        let (mut sizes, mut follows_all) = (solved.sizes, true);
        for surface in all.iter() {
            let of = |values: &G| values.as_slice()[surface];
            let weight = of(&whole.weights);
            let (size, rate) = (of(&solved.sizes), of(free) + of(&response));
            let is_force = size * size > least * weight;
            let is_rate = rate * rate * weight > least;
            if size < 0.0 && is_force || rate < 0.0 && is_rate {
                return Ok(None);
            }
            if is_rate {
                follows_all = false;
                sizes.as_mut_slice()[surface] = -rate * weight;
            }
        }
        Ok(Some(Pushing {
            held: *self,
            sizes,
            follows_all,
        }))
    }
}
