//! Quantities at a hit, kept for the impact there.

use super::glance::SAME_TIME;
use crate::contract::Impacting;
use crate::error::Fault;
use crate::state::StateVector;

/// A state on the motion, with the rates and gaps there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<Sys: Impacting> {
    t: f64,
    pub(super) state: Sys::State,
    pub(super) rates: Sys::Gaps,
    /// Gaps; `None` if there is a single surface, whose gap vanishes there.
    pub(super) gaps: Option<Sys::Gaps>,
}

impl<Sys: Impacting> Place<Sys> {
    /// Evaluates rates and gaps.
    #[inline(always)]
    pub(super) fn new(
        system: &Sys,
        t: f64,
        state: Sys::State,
        evaluations: &mut u64,
    ) -> Result<Self, Fault> {
        // NOTE: rates and gaps are evaluated one after the other, so that the compiler computes common quantities once.
        let rates = system.gap_rates(t, &state)?;
        let gaps = (rates.count() > 1).then(|| {
            *evaluations += 1;
            system.gaps(t, &state)
        });
        Ok(Self {
            t,
            state,
            rates,
            gaps,
        })
    }

    /// True if the place has this state and, within the rounding of times, this time.
    pub(super) fn is(&self, t: f64, state: &Sys::State) -> bool {
        (self.t - t).abs() <= SAME_TIME * t.abs() && self.state == *state
    }
}
