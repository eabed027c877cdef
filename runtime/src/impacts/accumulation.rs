//! Accumulation of impacts: when flights between them shrink to nothing.
//!
//! Two signs are taken. Impacts follow each other at one and the same number `t`; or the flights between impacts
//! on one surface have shrunk several times in a row and the height they reach, about `gap rate * time / 4`, is
//! below the rounding of the gap: what came after would be made of rounding errors.

use crate::state::StateVector;

/// Impacts at one time before they count as accumulated. A corner of angle `pi / n` takes up to `n`.
const AT_ONE_TIME: u32 = 100;

/// Flights that must have shrunk in a row before their height is asked about.
const SHRUNK: f64 = 3.0;

/// One flight suffices that begins with less than this part of the rate of the one before.
const STEEP: f64 = 0.125;

/// Weight of the newest factor in the average.
const MEMORY: f64 = 0.125;

/// What is remembered of the impacts so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accumulation<V> {
    /// Time of the last impact on any surface.
    last: f64,
    /// Impacts at that time so far, the first not counted.
    repeated: u32,
    /// Per surface: time of the last impact, length of the last flight, gap rate it began with, and how many
    /// flights in a row were shorter than the one before.
    times: V,
    flights: V,
    rates: V,
    shrunk: V,
    /// Per surface: the factor between the rates of successive flights, averaged over the last few because their
    /// rounding errors grow as the flights shrink.
    factors: V,
}

impl<V: StateVector> Accumulation<V> {
    /// No impacts yet.
    pub(super) fn none() -> Self {
        let mut times = V::zeros();
        times.as_mut_slice().fill(f64::NEG_INFINITY);
        let mut flights = V::zeros();
        flights.as_mut_slice().fill(f64::INFINITY);
        let zeros = V::zeros();
        Self {
            last: f64::NEG_INFINITY,
            repeated: 0,
            times,
            flights,
            rates: zeros,
            shrunk: zeros,
            factors: zeros,
        }
    }

    /// Takes in an impact after which the gap rate is `rate`, 0 for one that does not bounce. `rounding` gives the
    /// size of the gap's rounding errors. Returns the time of accumulation, if impacts accumulate.
    pub(super) fn add(
        &mut self,
        surface: usize,
        t: f64,
        rate: f64,
        rounding: impl FnOnce() -> f64,
    ) -> Option<f64> {
        self.repeated = if t == self.last { self.repeated + 1 } else { 0 };
        self.last = t;
        let flight = t - self.times.as_slice()[surface];
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
        let factor = &mut self.factors.as_mut_slice()[surface];
        let weight = if *factor > 0.0 { MEMORY } else { 1.0 };
        *factor += if before > 0.0 {
            weight * (rate / before - *factor)
        } else {
            0.0
        };
        if self.repeated >= AT_ONE_TIME {
            return Some(t);
        }
        (shrinking && 0.25 * rate * flight <= rounding()).then(|| self.limit(surface, t))
    }

    /// The time of accumulation if the motion, just bounced off a surface at `t`, did not rise from it: the hop is
    /// too small to be seen. `None` if it had not bounced.
    pub(super) fn ends_at(&self, surface: usize, t: f64) -> Option<f64> {
        let bounced = self.times.as_slice()[surface] == t && self.rates.as_slice()[surface] > 0.0;
        bounced.then(|| self.limit(surface, t))
    }

    /// Where flights end that go on shrinking by the factor their rates do: a geometric series.
    fn limit(&self, surface: usize, t: f64) -> f64 {
        let (flight, factor) = (
            self.flights.as_slice()[surface],
            self.factors.as_slice()[surface],
        );
        let rest = flight * factor / (1.0 - factor);
        if rest.is_finite() && rest > 0.0 {
            t + rest
        } else {
            t
        }
    }
}
