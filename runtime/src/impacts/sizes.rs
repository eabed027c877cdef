//! Sizes of the components that gaps are computed from, which determine the rounding errors of the gaps.

use super::watch::{Watch, measured, rounding};
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::outcome::Outcome;
use crate::state::StateVector;

impl<Sys: Impacting> Watch<Sys> {
    /// Updates the sizes after an impact: components that it changed take their present size, the others keep the
    /// rounding errors of the flight.
    pub(super) fn resize(&mut self, before: &Sys::State, after: &Sys::State) {
        let sized = self.sized(after);
        let states = before.as_slice().iter().zip(after.as_slice());
        let changed = states.zip(sized.as_slice());
        for (size, ((before, after), new)) in self.sizes.as_mut_slice().iter_mut().zip(changed) {
            if before != after {
                *size = *new;
            }
        }
    }

    /// Sizes of the components after an impact that leads to this state.
    pub(super) fn sized(&self, state: &Sys::State) -> Sys::State {
        let mut sizes = *state;
        let entries = sizes.as_mut_slice().iter_mut();
        for (size, least) in entries.zip(self.least_sizes.as_slice()) {
            *size = size.abs().max(*least);
        }
        sizes
    }

    /// The sizes of the motion of which the start of a run is the end, if it lies behind a wall by no more than their rounding
    /// errors, but by more than its own; 0 otherwise.
    pub(super) fn sizes_of_start(&self, now: &mut Moment<'_, Sys>) -> Result<Sys::State, Outcome> {
        let gaps = measured(now)?;
        let state = *now.state;
        let mut larger = now.system.scale(now.t, &state);
        for (size, value) in larger.as_mut_slice().iter_mut().zip(state.as_slice()) {
            *size = size.max(value.abs());
        }
        for (surface, &gap) in gaps.as_slice().iter().enumerate() {
            let is_behind = gap < 0.0 && !self.is_passable(surface);
            if is_behind
                && now.system.surface_active(surface, now.t, now.state)
                && -gap <= 2.0 * rounding(now, surface, &larger)
                && -gap > 2.0 * rounding(now, surface, &state)
            {
                return Ok(larger);
            }
        }
        Ok(state.zeroed())
    }
}
