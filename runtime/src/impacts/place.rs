//! What was evaluated where a hit was placed, kept for the impact there.

use super::glance::SAME_TIME;
use crate::contract::Impacting;
use crate::error::Fault;
use crate::state::StateVector;

/// A state on the motion, and what is known of the gaps there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<Sys: Impacting> {
    t: f64,
    pub(super) state: Sys::State,
    pub(super) rates: Sys::Gaps,
    /// Gaps, unless there is one surface alone: it is at hand there.
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
        // NOTE: one after the other, so that what both are made of is computed once.
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

    /// Whether it is this moment, as far as rounded times can tell.
    pub(super) fn is(&self, t: f64, state: &Sys::State) -> bool {
        (self.t - t).abs() <= SAME_TIME * t.abs() && self.state == *state
    }
}
