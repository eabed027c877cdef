//! Corners: several surfaces hit at one time. Impacts are carried out one after the other, and their order may matter.

use super::hits::Hits;
use super::impulse::{Impacts, STILL};
use super::policy::Corner;
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Impacts in one corner before its outcome counts as unknown. A corner of angle `pi / n` takes up to `n`.
const LONGEST: u32 = 100;

/// Two changes of velocity are the same if the energy of their difference is less than this part of the larger of their
/// own: squared `2^-40`, what rounding leaves of it in corners of small angles.
const SAME: f64 = 1.0 / (1_u128 << 80) as f64;

impl<Sys: Impacting> Impacts<Sys> {
    /// The surface to be struck next.
    pub(super) fn next(&self, hits: &Hits<Sys::Gaps>, rates: &Sys::Gaps) -> Option<usize> {
        match self.policies.corner {
            Corner::Stop | Corner::Ascending => hits.first_approached(rates),
            Corner::Descending => hits.last_approached(rates),
        }
    }

    /// The first and the last of several surfaces at hand, if it matters which of the two orders they are struck in.
    pub(super) fn ambiguous(
        &self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &Moment<'_, Sys>,
    ) -> Result<Option<[usize; 2]>, Outcome> {
        let ends = (hits.first_approached(rates), hits.last_approached(rates));
        let (Some(first), Some(last)) = ends else {
            return Ok(None);
        };
        let ascending = self.carried(*hits, rates, now, Hits::first_approached)?;
        let descending = self.carried(*hits, rates, now, Hits::last_approached)?;
        let (Some(ascending), Some(descending)) = (ascending, descending) else {
            return Ok(None);
        };
        let place = |state: &Sys::State| (now.system.mode(state), now.system.position(state));
        if place(&ascending) != place(&descending) {
            return Ok(Some([first, last]));
        }
        let energy = |a: &Sys::State, b: &Sys::State| -> Result<f64, Outcome> {
            let system = now.system;
            let (v, w) = (system.velocity(now.t, a)?, system.velocity(now.t, b)?);
            let (p, q) = (system.momentum(now.t, a)?, system.momentum(now.t, b)?);
            let velocities = v.as_slice().iter().zip(w.as_slice());
            let momenta = p.as_slice().iter().zip(q.as_slice());
            Ok(velocities
                .zip(momenta)
                .map(|((v, w), (p, q))| (v - w) * (p - q))
                .sum())
        };
        let difference = match energy(&ascending, &descending) {
            // A first-order system is where it is, and nothing besides.
            Err(Outcome::FirstOrder) => return Ok(None),
            difference => difference?,
        };
        let changes = energy(&ascending, now.state)?.max(energy(&descending, now.state)?);
        Ok((difference > SAME * changes).then_some([first, last]))
    }

    /// The state after all impacts in an order; `None` if they do not end.
    fn carried(
        &self,
        mut hits: Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        now: &Moment<'_, Sys>,
        next: impl Fn(&Hits<Sys::Gaps>, &Sys::Gaps) -> Option<usize>,
    ) -> Result<Option<Sys::State>, Outcome> {
        let (mut state, mut rates) = (*now.state, *rates);
        for _ in 0..LONGEST {
            let Some(surface) = next(&hits, &rates) else {
                return Ok(Some(state));
            };
            let rate = rates.as_slice()[surface];
            hits.set_still(surface, STILL * rate.abs());
            let struck = self.struck(now.system, surface, rate, now.t, &state)?;
            if now.system.position(&struck.after) != now.system.position(&state) {
                // A reset has left the corner.
                return Ok(Some(struck.after));
            }
            (state, rates) = (struck.after, struck.rates);
            hits.set_still(surface, -rates.as_slice()[surface]);
        }
        Ok(None)
    }
}
