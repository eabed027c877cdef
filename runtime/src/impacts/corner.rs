//! Corners: several surfaces hit at one time. Impacts act one after the other, and their order may matter.

use super::hits::{Hits, Order};
use super::impulse::Impacts;
use super::quiet::{energy_size, quieten_beside};
use super::strike::STILL;
use super::watch::measured;
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::law::Law;
use crate::outcome::Outcome;
use crate::policy::Corner;
use crate::state::StateVector;

/// Number of impacts in one corner from which its outcome counts as unknown. A corner of angle `pi / n` takes up to `n`
/// impacts.
const LONGEST: u32 = 100;

/// Two changes of velocity count as equal if the energy of their difference is below this multiple of the larger of
/// their energies: the square of `2^-40`, the rounding errors in corners of small angles.
pub(super) const SAME: f64 = 1.0 / (1_u128 << 80) as f64;

/// Two velocities are equal within rounding if the energy of their difference is below this multiple of the energy: the
/// square of 16 roundings.
pub(super) const EQUAL: f64 = 1.0 / (1_u128 << 96) as f64;

/// Knowledge of the order of the impacts at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Not yet examined: tested when a round begins with several surfaces.
    Open,
    /// The order does not matter, or was chosen.
    Settled,
}

/// End of a trial in which the impacts of one moment are carried out in advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Until {
    /// The end of the round.
    Round,
    /// The first state in which no surface at hand is approached.
    End,
}

/// Detects impacts at one moment that never end: without loss of energy they return to an earlier state. After
/// [`LONGEST`] impacts, each state is compared with a kept one, which is replaced after every impact whose number is a
/// power of two (Brent's cycle detection).
///
/// In a corner with an open exit, every impact increases the momentum in a direction towards the exit, so states
/// never return.
pub(super) struct Recurrence<S> {
    kept: Option<S>,
    impacts: u64,
}

impl<S: StateVector> Recurrence<S> {
    pub(super) fn new() -> Self {
        Self {
            kept: None,
            impacts: 0,
        }
    }

    /// Records the state after an impact. Returns true if it equals an earlier state.
    pub(super) fn add<Sys: Impacting<State = S>>(
        &mut self,
        now: &Moment<'_, Sys>,
    ) -> Result<bool, Outcome> {
        self.impacts += 1;
        if self.impacts < u64::from(LONGEST) {
            return Ok(false);
        }
        let is_back = match &self.kept {
            Some(kept) => {
                let size = energy_size(now)?.ok_or(Outcome::FirstOrder)?;
                energy_apart(now, kept, now.state)? <= SAME * size
            }
            None => false,
        };
        if self.kept.is_none() || self.impacts.is_power_of_two() {
            self.kept = Some(*now.state);
        }
        Ok(is_back)
    }
}

impl<Sys: Impacting> Impacts<Sys> {
    /// The next surface to be struck.
    pub(super) fn next(
        &mut self,
        hits: &mut Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        verdict: &mut Verdict,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Option<usize>, Outcome> {
        let system = now.system;
        let mut approached = (0..rates.count()).filter(|&s| hits.is_approached(s, rates));
        if let Some(surface) = approached.find(|&s| self.law_of(system, s) == Law::Stop) {
            return Err(self.stopped_at(surface));
        }
        if hits.begin_round(rates) > 1
            && *verdict == Verdict::Open
            && let Some(surfaces) = self.ambiguous(hits, rates, verdict, now)?
        {
            return Err(Outcome::Ambiguous { surfaces });
        }
        Ok(hits.turn(rates, self.order()))
    }

    fn order(&self) -> Order {
        match self.policies.corner {
            Corner::Stop | Corner::Ascending => Order::Ascending,
            Corner::Descending => Order::Descending,
        }
    }

    /// The verdict before the first impact.
    pub(super) fn verdict(&self) -> Verdict {
        match self.policies.corner {
            Corner::Stop => Verdict::Open,
            Corner::Ascending | Corner::Descending => Verdict::Settled,
        }
    }

    /// The first and the last surface of a round, if the two orders of its impacts give different states at its end,
    /// and also when all impacts of the moment are over.
    fn ambiguous(
        &mut self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        verdict: &mut Verdict,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Option<[usize; 2]>, Outcome> {
        if self.orders_agree(hits, rates, Until::Round, now)? {
            return Ok(None);
        }
        // If the orders agree in the end, the order does not matter any more; otherwise the run ends.
        *verdict = Verdict::Settled;
        match self.orders_agree(hits, rates, Until::End, now)? {
            true => Ok(None),
            false => Ok(hits.ends(rates)),
        }
    }

    /// True if the impacts lead to the same state in both orders, or do not end in one of them.
    fn orders_agree(
        &mut self,
        hits: &Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        until: Until,
        now: &mut Moment<'_, Sys>,
    ) -> Result<bool, Outcome> {
        let ascending = self.carried(*hits, rates, (Order::Ascending, until), now)?;
        let descending = self.carried(*hits, rates, (Order::Descending, until), now)?;
        let (Some(ascending), Some(descending)) = (ascending, descending) else {
            return Ok(true);
        };
        let place = |state: &Sys::State| (now.system.mode(state), now.system.position(state));
        if place(&ascending) != place(&descending) {
            return Ok(false);
        }
        let difference = match energy_apart(now, &ascending, &descending) {
            // A first-order system is determined by its position.
            Err(Outcome::FirstOrder) => return Ok(true),
            difference => difference?,
        };
        let changes = energy_apart(now, &ascending, now.state)?.max(energy_apart(
            now,
            &descending,
            now.state,
        )?);
        let rounding = energy_size(now)?.map_or(0.0, |size| EQUAL * size);
        Ok(difference <= (SAME * changes).max(rounding))
    }

    /// The state after the impacts in a given order; `None` if they do not end.
    fn carried(
        &mut self,
        mut hits: Hits<Sys::Gaps>,
        rates: &Sys::Gaps,
        (order, until): (Order, Until),
        now: &mut Moment<'_, Sys>,
    ) -> Result<Option<Sys::State>, Outcome> {
        let (mut state, mut rates) = (*now.state, *rates);
        for _ in 0..LONGEST {
            if until == Until::End {
                hits.begin_round(&rates);
            }
            let Some(surface) = hits.turn(&rates, order) else {
                return Ok(Some(state));
            };
            if self.law_of(now.system, surface) == Law::Stop {
                return Ok(Some(state));
            }
            let rate = rates.as_slice()[surface];
            hits.set_still(surface, STILL * rate.abs());
            let struck = self.struck(now.system, surface, rate, now.t, &state)?;
            let before = (state, rates);
            (state, rates) = (struck.after, struck.rates);
            let has_moved = now.system.position(&state) != now.system.position(&before.0);
            let enters = now.system.mode(&state) != now.system.mode(&before.0);
            if has_moved && enters {
                return Ok(Some(state));
            }
            let mut there = Moment {
                system: now.system,
                t: now.t,
                state: &mut state,
                counters: now.counters,
            };
            if has_moved || enters {
                // A reset leads elsewhere, where other surfaces may still be at hand. A mode has surfaces of its own.
                let gaps = measured(&mut there)?;
                hits.replace(self.watch.at_hand(&gaps, &rates, &mut there));
                match enters {
                    true => self.watch.pass_by(&mut hits, now.system),
                    false => hits.set_done(surface),
                }
                continue;
            }
            hits.set_still(surface, -rates.as_slice()[surface]);
            quieten_beside(&mut hits, surface, [&before.1, &rates], &before.0, &there)?;
            self.watch.add_touching(&mut hits, &rates, now)?;
        }
        Ok(None)
    }
}

/// Twice the kinetic energy of the difference between the velocities of two states.
pub(super) fn energy_apart<Sys: Impacting>(
    now: &Moment<'_, Sys>,
    a: &Sys::State,
    b: &Sys::State,
) -> Result<f64, Outcome> {
    let system = now.system;
    let (v, w) = (system.velocity(now.t, a)?, system.velocity(now.t, b)?);
    let (p, q) = (system.momentum(now.t, a)?, system.momentum(now.t, b)?);
    let velocities = v.as_slice().iter().zip(w.as_slice());
    let momenta = p.as_slice().iter().zip(q.as_slice());
    Ok(velocities
        .zip(momenta)
        .map(|((v, w), (p, q))| (v - w) * (p - q))
        .sum())
}
