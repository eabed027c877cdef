//! Gap rates that are rounding errors. A surface that holds the motion, or that was just struck, has the gap rate 0; an
//! impulse on another surface changes that by rounding errors, if it is orthogonal. Such a surface is not approached.
//!
//! Such a change is below `2^-48 sqrt(c) |v|`, where `c` is the compliance of the surface and `|v|` the velocity in the
//! metric, before or after the impulse. A motion at rest on surfaces has the rounding errors of their forces: gap rates below
//! `2^-40` of those that the motion would gain without these forces in the last step.

use super::corner::{EQUAL, SAME, energy_apart};
use super::held::Held;
use super::hits::Hits;
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::error::Fault;
use crate::events::resolution::rate_resolution;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Raises the thresholds of surfaces that hold the motion and whose gap rates at `now` are rounding errors.
pub(super) fn quieten_held<Sys: Impacting>(
    hits: &mut Hits<Sys::Gaps>,
    held: &Held<Sys::Gaps>,
    rates: &Sys::Gaps,
    now: &Moment<'_, Sys>,
) -> Result<(), Outcome> {
    let is_approached = |surface: &usize| hits.is_approached(*surface, rates);
    if held.iter().find(is_approached).is_none() {
        return Ok(());
    }
    let Some(size) = energy_size(now)? else {
        return Ok(());
    };
    for surface in held.iter() {
        if hits.is_approached(surface, rates) && !hits.has_fallen(surface) {
            let rate = rates.as_slice()[surface];
            quieten(hits, surface, [rate, rate], SAME * size, now)?;
        }
    }
    Ok(())
}

/// Raises the thresholds of surfaces whose gap rates at the start of a run are rounding errors, such as those between
/// bodies of equal velocity, which is computed from their momenta.
pub(super) fn quieten_at_start<Sys: Impacting>(
    hits: &mut Hits<Sys::Gaps>,
    rates: &Sys::Gaps,
    now: &mut Moment<'_, Sys>,
) -> Result<(), Outcome> {
    for surface in 0..hits.count() {
        if !hits.is_approached(surface, rates) {
            continue;
        }
        let velocity = now.system.velocity(now.t, now.state)?;
        let rate = rates.as_slice()[surface];
        let rounding = rate_resolution(
            now.system,
            surface,
            (now.t, now.state),
            velocity.as_slice(),
            &mut now.counters.event_evaluations,
        );
        if rate.abs() <= rounding {
            hits.set_still(surface, -rate);
        }
    }
    Ok(())
}

/// Ratio of a gap rate to that gained without the contact forces, below which it is a rounding error of these.
const BALANCED: f64 = 1.0 / (1_u64 << 40) as f64;

/// Raises the thresholds of surfaces whose gap rates are rounding errors of the forces by which others hold the motion in the last
/// step, of this length.
pub(super) fn quieten_balanced<Sys: Impacting>(
    hits: &mut Hits<Sys::Gaps>,
    held: &Held<Sys::Gaps>,
    rates: &Sys::Gaps,
    length: f64,
    now: &Moment<'_, Sys>,
) -> Result<(), Outcome> {
    if held.is_empty() || held.slide().is_some() || hits.approached(rates) == 0 {
        return Ok(());
    }
    let Some(second) = held.second_rates(now.system, now.t, now.state)? else {
        return Ok(());
    };
    for surface in 0..hits.count() {
        let (rate, gained) = (
            rates.as_slice()[surface],
            second.as_slice()[surface] * length,
        );
        if rate.abs() <= BALANCED * gained.abs() && !hits.has_fallen(surface) {
            hits.set_still(surface, -rate);
        }
    }
    Ok(())
}

/// Raises the thresholds of surfaces that were not approached before an impulse on another surface, and whose gap rates it
/// has changed by rounding errors. `before` and `now` are the states before and after it; `rates` are the gap rates there.
pub(super) fn quieten_beside<Sys: Impacting>(
    hits: &mut Hits<Sys::Gaps>,
    struck: usize,
    rates: [&Sys::Gaps; 2],
    before: &Sys::State,
    now: &Moment<'_, Sys>,
) -> Result<(), Outcome> {
    let mut bound = None;
    for surface in (0..hits.count()).filter(|surface| *surface != struck) {
        let became_approached =
            !hits.is_approached(surface, rates[0]) && hits.is_approached(surface, rates[1]);
        if !became_approached {
            continue;
        }
        let bound = match bound {
            Some(bound) => bound,
            None => {
                let Some(size) = energy_size(now)? else {
                    return Ok(());
                };
                let apart = energy_apart(now, before, now.state)?;
                *bound.insert(EQUAL * size.max(apart))
            }
        };
        let [old, new] = rates.map(|rates| rates.as_slice()[surface]);
        quieten(hits, surface, [new - old, new], bound, now)?;
    }
    Ok(())
}

/// Raises the threshold of a surface to its gap rate, if its change stems from a change of the velocity with an energy of
/// at most half of `bound`.
fn quieten<Sys: Impacting>(
    hits: &mut Hits<Sys::Gaps>,
    surface: usize,
    [change, rate]: [f64; 2],
    bound: f64,
    now: &Moment<'_, Sys>,
) -> Result<(), Outcome> {
    let compliance = now
        .system
        .contact(surface, now.t, now.state)?
        .free_compliance;
    if change * change <= compliance * bound {
        hits.set_still(surface, -rate);
    }
    Ok(())
}

/// Twice the kinetic energy, as a sum of absolute values; `None` for a first-order system.
pub(super) fn energy_size<Sys: Impacting>(now: &Moment<'_, Sys>) -> Result<Option<f64>, Outcome> {
    let velocity = now.system.velocity(now.t, now.state)?;
    let momentum = match now.system.momentum(now.t, now.state) {
        Err(Fault::FirstOrder) => return Ok(None),
        momentum => momentum?,
    };
    let pairs = velocity.as_slice().iter().zip(momentum.as_slice());
    Ok(Some(pairs.map(|(v, p)| (v * p).abs()).sum()))
}
