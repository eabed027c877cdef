//! Accumulation of impacts (Zeno behaviour): flights between impacts shrink to zero.
//!
//! Each of three criteria detects it:
//!
//! - Many impacts follow each other at the same floating-point time `t` ([`super::coincident`]).
//! - The flights between impacts on one surface have shrunk several times in a row, and the height of the next one,
//!   about `gap rate * time / 4`, is below the rounding of the gap ([`super::hops`]).
//! - The flights have become too short to be resolved while the energy grew ([`super::growth`]).

use super::coincident::{Coincident, Gathering, REVERSED};
use super::growth::Growth;
use super::hops::{Flight, Hops};
use super::passing::Passing;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Kind and time of an accumulation of impacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ends {
    /// Hops on one surface have become too small or too short to be resolved.
    Hops(f64),
    /// Impacts on several surfaces follow each other at one time.
    AtOneTime(f64),
    /// Flights have become too short to be resolved while the energy grew, and grows on.
    Spasmodic(f64),
}

/// An impact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounce {
    pub(super) surface: usize,
    pub(super) t: f64,
    /// Gap rates before and after the impact; the latter is 0 if the motion does not bounce.
    pub(super) rates: [f64; 2],
    /// True if the surface was already struck at the same moment, without a flight in between.
    pub(super) again: bool,
    /// True for an impulse. A reset may set any gap rate, whatever it was before.
    pub(super) by_impulse: bool,
}

impl Bounce {
    /// True if the gap rate after the impact exceeds that before.
    pub(super) fn gains(&self) -> bool {
        let [before, after] = self.rates;
        after > (1.0 + REVERSED) * before.abs()
    }
}

/// Data kept of the impacts so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accumulation<G: StateVector> {
    growth: Growth<G>,
    coincident: Coincident<G>,
    hops: PerSurface<Hops, G>,
    passing: Passing<G>,
}

impl<G: StateVector> Accumulation<G> {
    /// Data before the first impact, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            growth: Growth::none(like),
            coincident: Coincident::none(like),
            hops: PerSurface::all(like, Hops::NONE),
            passing: Passing::none(like),
        }
    }

    /// Records an impact. `rounding` gives the size of the gap's rounding errors, `energy` the energy after the impact,
    /// if known. Returns the accumulation if the impacts accumulate.
    pub(super) fn add(
        &mut self,
        bounce: Bounce,
        rounding: impl FnOnce() -> f64,
        energy: impl Fn() -> Option<f64>,
    ) -> Option<Ends> {
        let Bounce { surface, t, .. } = bounce;
        self.coincident.add(bounce);
        let flight = self.hops[surface].land(bounce);
        if let Some(Flight { before, length, .. }) = flight
            && let Some(end) =
                (self.growth).add(surface, t, (before, length), bounce.rates[1], &energy)
        {
            return Some(Ends::Spasmodic(end));
        }
        let hops = &self.hops[surface];
        match self.coincident.gathering(bounce) {
            Gathering::None => {
                let is_last = flight.is_some_and(|flight| flight.is_last(rounding));
                // The gap rates shrink, but the motion gains energy without limit along the surface.
                let explodes = is_last && self.growth.has_no_limit(surface, &energy);
                match explodes {
                    true => Some(Ends::Spasmodic(hops.end(t))),
                    false => is_last.then(|| Ends::Hops(hops.end(t))),
                }
            }
            Gathering::Hops(hopping) if hopping == surface => Some(Ends::Hops(hops.end(t))),
            // The surface is hit at the time at which hops on another one end.
            Gathering::Hops(_) => None,
            // A reset that adds to the gap rate adds energy, or what takes its place.
            Gathering::Several if bounce.gains() && !bounce.by_impulse => Some(Ends::Spasmodic(t)),
            Gathering::Several => Some(Ends::AtOneTime(t)),
        }
    }

    /// Records a passage: an impact after which the motion goes on through the surface, so that no flight begins there.
    pub(super) fn pass(&mut self, surface: usize, t: f64) -> Option<Ends> {
        self.coincident.count(surface, t);
        self.hops[surface] = Hops::NONE;
        self.growth.forget(surface);
        self.passing.add(surface, t);
        let are_many = self.coincident.are_many() || self.passing.are_endless();
        are_many.then_some(Ends::AtOneTime(t))
    }

    /// Time of the last impact.
    pub(super) fn last(&self) -> Option<f64> {
        self.coincident.last()
    }

    /// True if passages through surfaces, this one among them, followed each other ever faster until the time `t`,
    /// where two of them cannot be distinguished.
    pub(super) fn has_passed_on(&self, surface: usize, t: f64) -> bool {
        self.passing.has_accumulated(surface, t)
    }

    /// True if the last passages at different times, until `t`, could hardly be distinguished.
    pub(super) fn has_quickened(&self, t: f64) -> bool {
        self.passing.has_quickened(t)
    }

    /// Records a reset on this surface; see [`Passing::leads_back`].
    pub(super) fn lead_off(&mut self, surface: usize, t: f64) {
        self.passing.lead_off(surface, t);
    }

    /// True if the ways back to this surface became ever shorter; see [`Passing::leads_back`].
    pub(super) fn leads_back(&mut self, surface: usize) -> bool {
        self.passing.leads_back(surface)
    }

    /// True if the motion passed through this surface at the time `t` or just before; see [`Passing::has_passed_at`].
    pub(super) fn has_passed_at(&self, surface: usize, t: f64) -> bool {
        self.passing.has_passed_at(surface, t)
    }

    /// The time of accumulation of a motion that bounced off a surface at `t` but did not rise from it, because the hop
    /// is too small to be resolved. `None` if it did not bounce.
    pub(super) fn ends_at(&self, surface: usize, t: f64) -> Option<f64> {
        let hops = &self.hops[surface];
        hops.has_bounced_at(t).then(|| hops.end(t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Gaps = nalgebra::SVector<f64, 2>;

    /// Accumulation of impacts with these surfaces, times and gap rates, without energy.
    fn ends(impacts: impl Iterator<Item = (usize, f64, [f64; 2])>) -> Option<Ends> {
        let mut accumulation = Accumulation::none(&Gaps::zeros());
        impacts.into_iter().find_map(|(surface, t, rates)| {
            let bounce = Bounce {
                surface,
                t,
                rates,
                again: false,
                by_impulse: true,
            };
            accumulation.add(bounce, || 1e-15, || None)
        })
    }

    #[test]
    fn hops_that_halve_end_at_the_sum_of_their_flights() {
        let impacts = (0..60).map(|n| {
            let rate = 0.5_f64.powi(n);
            (0, 2.0 - rate, [-2.0 * rate, rate])
        });
        let found = ends(impacts);
        assert!(
            matches!(found, Some(Ends::Hops(t)) if (t - 2.0).abs() < 1e-15),
            "{found:?}"
        );
    }

    #[test]
    fn impacts_at_one_time_accumulate_unless_they_keep_their_speed() {
        let at_one_time = |factor: f64| {
            let impacts = (0..1000).map(move |n| {
                let rate = factor.powi(n);
                (n as usize % 2, 1.0, [-rate, factor * rate])
            });
            ends(impacts)
        };
        assert_eq!(at_one_time(1.0), None);
        assert_eq!(at_one_time(0.8), Some(Ends::AtOneTime(1.0)));
        assert_eq!(at_one_time(1.1), Some(Ends::AtOneTime(1.0)));
    }

    #[test]
    fn a_surface_passed_faster_and_faster_has_been_passed_on() {
        let mut accumulation = Accumulation::none(&Gaps::zeros());
        for n in 0..60 {
            let t = 1.0 - 0.5_f64.powi(n);
            assert_eq!(accumulation.pass(0, t), None);
            assert_eq!(accumulation.has_passed_on(0, t), n > 50, "{n}");
            assert!(!accumulation.has_passed_on(1, t));
        }
    }
}
