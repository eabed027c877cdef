//! Accumulation of impacts: when flights between them shrink to nothing.
//!
//! Two signs are taken. Impacts follow each other at one and the same number `t`; or the flights between impacts
//! on one surface have shrunk several times in a row and the height that the next one will reach, about
//! `gap rate * time / 4`, is below the rounding of the gap: it would be made of rounding errors.

use super::growth::Growth;
use crate::state::StateVector;

/// Impacts at one time before they count as accumulated. A corner of angle `pi / n` takes up to `n`.
const AT_ONE_TIME: u32 = 100;

/// Flights that must have shrunk in a row before their height is asked about.
const SHRUNK: f64 = 3.0;

/// One flight suffices that begins with less than this part of the rate of the one before.
const STEEP: f64 = 0.125;

/// How impacts accumulate, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ends {
    /// Hops on one surface have become too small or too short to be seen.
    Hops(f64),
    /// Impacts on several surfaces follow each other at one time.
    AtOneTime(f64),
    /// Flights have become too short to be told, while the energy grew.
    Spasmodic(f64),
}

/// What is remembered of the impacts so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accumulation<V> {
    growth: Growth<V>,
    /// Time of the last impact on any surface.
    last: f64,
    /// Impacts at that time so far, the first not counted; and how many on each surface.
    repeated: u32,
    on_each: V,
    /// Per surface: time of the last impact, length of the last flight, gap rate it began with, and how many
    /// flights in a row were shorter than the one before.
    times: V,
    flights: V,
    rates: V,
    shrunk: V,
    /// Per surface: where the flights end if they go on shrinking by the last factor of their rates, as the last impact
    /// says; the best guess so far; and how far that one is from the guess before it.
    guesses: V,
    best: V,
    spreads: V,
}

impl<V: StateVector> Accumulation<V> {
    /// No impacts yet.
    pub(super) fn none() -> Self {
        let mut times = V::zeros();
        times.as_mut_slice().fill(f64::NEG_INFINITY);
        let mut infinite = V::zeros();
        infinite.as_mut_slice().fill(f64::INFINITY);
        let mut unknown = V::zeros();
        unknown.as_mut_slice().fill(f64::NAN);
        let zeros = V::zeros();
        Self {
            growth: Growth::none(),
            last: f64::NEG_INFINITY,
            repeated: 0,
            on_each: zeros,
            times,
            flights: infinite,
            rates: zeros,
            shrunk: zeros,
            guesses: unknown,
            best: unknown,
            spreads: infinite,
        }
    }

    /// Takes in an impact after which the gap rate is `rate`, 0 for one that does not bounce. `rounding` gives the
    /// size of the gap's rounding errors, `energy` the energy after the impact. Returns how impacts accumulate, if they
    /// do.
    pub(super) fn add(
        &mut self,
        surface: usize,
        t: f64,
        rate: f64,
        rounding: impl FnOnce() -> f64,
        energy: impl FnOnce() -> f64,
    ) -> Option<Ends> {
        self.count(surface, t);
        let flight = t - self.times.as_slice()[surface];
        let flights = [self.flights.as_slice()[surface], flight];
        let before = self.rates.as_slice()[surface];
        let shrunk = &mut self.shrunk.as_mut_slice()[surface];
        *shrunk = match flight < self.flights.as_slice()[surface] {
            true if rate < STEEP * before => SHRUNK + 1.0,
            true => *shrunk + 1.0,
            false => 0.0,
        };
        let shrinking = *shrunk > SHRUNK && rate < before;
        self.times.as_mut_slice()[surface] = t;
        self.flights.as_mut_slice()[surface] = flight;
        self.rates.as_mut_slice()[surface] = rate;
        self.guess(surface, t, rate / before);
        if let Some(t) = self.growth.add(surface, t, flights, energy) {
            return Some(Ends::Spasmodic(t));
        }
        if self.repeated >= AT_ONE_TIME {
            return match self.hops_on() {
                None => Some(Ends::AtOneTime(t)),
                Some(hopping) if hopping == surface => Some(Ends::Hops(self.limit(surface, t))),
                // Another surface that happens to be hit where hops on this one end.
                Some(_) => None,
            };
        }
        let next = flight * (rate / before);
        let is_hidden = shrinking && 0.25 * rate * next <= rounding();
        is_hidden.then(|| Ends::Hops(self.limit(surface, t)))
    }

    /// Takes in an impact after which the motion goes on through the surface: no flight begins there.
    pub(super) fn pass(&mut self, surface: usize, t: f64) -> Option<Ends> {
        self.count(surface, t);
        self.times.as_mut_slice()[surface] = f64::NEG_INFINITY;
        self.flights.as_mut_slice()[surface] = f64::INFINITY;
        self.rates.as_mut_slice()[surface] = 0.0;
        self.shrunk.as_mut_slice()[surface] = 0.0;
        self.growth.forget(surface);
        (self.repeated >= AT_ONE_TIME).then_some(Ends::AtOneTime(t))
    }

    /// Counts impacts at one time.
    fn count(&mut self, surface: usize, t: f64) {
        if t == self.last {
            self.repeated += 1;
        } else {
            self.repeated = 0;
            self.on_each = V::zeros();
        }
        self.on_each.as_mut_slice()[surface] += 1.0;
        self.last = t;
    }

    /// The surface that almost all impacts at this time were on, if they do not go to and fro between several.
    fn hops_on(&self) -> Option<usize> {
        let most = 0.75 * f64::from(self.repeated);
        self.on_each.as_slice().iter().position(|&own| own > most)
    }

    /// The time of accumulation if the motion, just bounced off a surface at `t`, did not rise from it: the hop is
    /// too small to be seen. `None` if it had not bounced.
    pub(super) fn ends_at(&self, surface: usize, t: f64) -> Option<f64> {
        let bounced = self.times.as_slice()[surface] == t && self.rates.as_slice()[surface] > 0.0;
        bounced.then(|| self.limit(surface, t))
    }

    /// Takes in that flights shrink by `factor`: a geometric series. Its sum is a bad guess as long as the factor still
    /// changes, and again when the flights are made of rounding errors; in between successive guesses are closest.
    fn guess(&mut self, surface: usize, t: f64, factor: f64) {
        if self.shrunk.as_slice()[surface] == 0.0 {
            self.guesses.as_mut_slice()[surface] = f64::NAN;
            self.best.as_mut_slice()[surface] = f64::NAN;
            self.spreads.as_mut_slice()[surface] = f64::INFINITY;
            return;
        }
        let guess = t + self.flights.as_slice()[surface] * factor / (1.0 - factor);
        if !(factor > 0.0 && factor < 1.0 && guess.is_finite()) {
            return;
        }
        let apart = (guess - self.guesses.as_slice()[surface]).abs();
        let is_first = self.best.as_slice()[surface].is_nan();
        self.guesses.as_mut_slice()[surface] = guess;
        if is_first || apart < self.spreads.as_slice()[surface] {
            self.best.as_mut_slice()[surface] = guess;
            self.spreads.as_mut_slice()[surface] = if is_first { f64::INFINITY } else { apart };
        }
    }

    /// Where the flights end, not before the last impact at `t`.
    fn limit(&self, surface: usize, t: f64) -> f64 {
        self.best.as_slice()[surface].max(t)
    }
}
