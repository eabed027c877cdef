//! Surfaces in contact at an impact: their gaps are 0, and their gap rates were not negative before the impact.

use super::glance::finite;
use super::hits::Hits;
use super::watch::{BESIDE, Graze, Watch};
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::outcome::Outcome;
use crate::state::StateVector;

impl<Sys: Impacting> Watch<Sys> {
    /// Adds the surfaces in contact that an impulse leaves with negative gap rates, and resets their grazing data.
    pub(super) fn touch(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        if rates.count() == 1 {
            return Ok(());
        }
        let before = *hits;
        self.add_touching(hits, rates, now)?;
        for surface in 0..rates.count() {
            if hits.is_at_hand(surface) != before.is_at_hand(surface) {
                // These data belong to the last hit on the surface, at another state.
                self.grazes[surface] = Graze::None;
                self.bends.as_mut_slice()[surface] = 0.0;
            }
        }
        Ok(())
    }

    /// Same as [`Watch::touch`], but leaves the grazing data of the surfaces unchanged.
    pub(super) fn add_touching(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        for surface in 0..rates.count() {
            let is_candidate = !hits.is_at_hand(surface)
                && rates.as_slice()[surface] < 0.0
                && !self.is_passable(surface);
            if is_candidate && self.touches(surface, rates.as_slice()[surface], now)? {
                hits.add(surface);
            }
        }
        Ok(())
    }

    /// True if the surface is active and its gap is 0 within rounding. False if the gap needs more than the fraction
    /// [`BESIDE`] of the last step to close at this rate.
    fn touches(
        &mut self,
        surface: usize,
        rate: f64,
        now: &mut Moment<'_, Sys>,
    ) -> Result<bool, Outcome> {
        let gaps = match self.here {
            Some(gaps) => gaps,
            None => {
                now.counters.event_evaluations += 1;
                finite(now.system.gaps(now.t, now.state))?
            }
        };
        self.here = Some(gaps);
        let gap = gaps.as_slice()[surface];
        if gap > BESIDE * rate.abs() * self.length {
            return Ok(false);
        }
        let roundings = 2.0 + f64::from(self.steps) / 16.0;
        let is_near = gap == 0.0
            || self.stays_touched(surface, gap, now)
            || gap.abs() <= roundings * self.rounding_at_cut(surface, now);
        Ok(is_near && now.system.surface_active(surface, now.t, now.state))
    }
}
