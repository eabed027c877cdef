//! Hops on one surface: flights that shrink from one impact to the next, and the time of their end.

use super::accumulation::Bounce;
use super::passing::SOON;

/// Number of flights that must have shrunk in a row before their height is tested.
pub(super) const SHRUNK: u32 = 3;

/// Ratio of the gap rates at the start of successive flights below which a single shrinking flight suffices, if the impact
/// between them has reduced the gap rate as much. Gap rates at different places may differ because the gap is steep at
/// one of them.
const STEEP: f64 = 0.125;

/// Largest ratio of two reductions of the gap rate by resets that count as alike.
const ALIKE: f64 = 4.0;

/// Largest time from an impact to the end of the hops, in lengths of the flight before it. A larger estimate stems from
/// flights whose gap rates have stopped to shrink.
const FARTHEST: f64 = (1 << 20) as f64;

/// Record of successive impacts on one surface from which the motion bounced off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hops {
    last: Option<Impact>,
    /// The end, estimated from the gap rates and from the lengths of the flights.
    ends: [Option<Estimate>; 2],
}

/// An impact, with the flight before it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Impact {
    t: f64,
    /// Gap rate after the impact.
    rate: f64,
    /// Ratio of the gap rates after and before it.
    kept: f64,
    /// Length of the flight; `None` at the first impact.
    length: Option<f64>,
    /// The count [`Flight::shrunk`] of the flight before; 0 at the first impact.
    shrunk: u32,
}

/// A flight between two impacts on one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Flight {
    pub(super) length: f64,
    /// Length of the flight before; `None` for the first.
    pub(super) before: Option<f64>,
    /// Gap rates at the start of this flight and of the next.
    rates: [f64; 2],
    /// Ratio of the gap rates after and before the impact that ended it.
    kept: f64,
    /// Number of successive flights up to this one that were shorter than their predecessor; the first flight counts,
    /// too. A flight that is shorter and ends with a far smaller gap rate ([`STEEP`]) gets [`SHRUNK`]` + 1` at once.
    shrunk: u32,
}

/// The time at which hops end, estimated as the limit of a geometric series.
///
/// The estimate is inaccurate while the ratio still changes, and again when the flights consist of
/// rounding errors. Between these two phases, successive estimates agree best.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Estimate {
    /// The last estimate.
    last: f64,
    best: f64,
    /// Difference between the best estimate and its predecessor; infinite for the first.
    spread: f64,
}

/// True if a length is less than the one before it, or if there is none before it.
pub(super) fn is_shorter(length: f64, before: Option<f64>) -> bool {
    before.is_none_or(|before| length < before)
}

impl Hops {
    pub(super) const NONE: Self = Self {
        last: None,
        ends: [None; 2],
    };

    /// Records an impact. Returns the flight that it ended; `None` for the first impact, or for another one at the
    /// same moment.
    pub(super) fn land(&mut self, bounce: Bounce) -> Option<Flight> {
        let Bounce { t, rates, .. } = bounce;
        let [arrival, rate] = rates;
        if bounce.again || self.last.is_some_and(|last| last.t == t) {
            if let Some(last) = &mut self.last {
                last.rate = rate;
            }
            return None;
        }
        let flight = self.last.map(|last| last.flight(bounce));
        self.ends = match flight {
            Some(flight) if flight.shrunk > 0 => {
                let [by_rates, by_lengths] = flight.ends(t);
                [
                    Estimate::refined(self.ends[0], by_rates),
                    Estimate::refined(self.ends[1], by_lengths),
                ]
            }
            _ => [None; 2],
        };
        self.last = Some(Impact {
            t,
            rate,
            kept: rate / arrival.abs(),
            length: flight.map(|flight| flight.length),
            shrunk: flight.map_or(0, |flight| flight.shrunk),
        });
        flight
    }

    /// True if the last impact was at `t` or hardly before, and the motion rose from it.
    pub(super) fn has_bounced_at(&self, t: f64) -> bool {
        let is_at = |last: &Impact| t - last.t <= SOON * t.abs();
        self.last
            .is_some_and(|last| is_at(&last) && last.rate > 0.0)
    }

    /// The time at which the hops end; at least the time `t` of the last impact.
    pub(super) fn end(&self, t: f64) -> f64 {
        let length = self.last.and_then(|last| last.length).unwrap_or(0.0);
        let is_near = |end: &Estimate| end.best - t <= FARTHEST * length;
        let ends = self.ends.into_iter().flatten().filter(is_near);
        let closest = ends.reduce(|first, second| match second.spread < first.spread {
            true => second,
            false => first,
        });
        closest.map_or(t, |end| end.best.max(t))
    }
}

impl Impact {
    /// The flight from this impact to the next one.
    fn flight(self, next: Bounce) -> Flight {
        let [arrival, rate] = next.rates;
        let length = next.t - self.t;
        let kept = rate / arrival.abs();
        // A reset may set any rate once. If it reduces the rate again by as much, it will go on.
        let goes_on = next.by_impulse || (kept <= ALIKE * self.kept && self.kept <= ALIKE * kept);
        let is_steep = goes_on && rate < STEEP * self.rate.min(arrival.abs());
        let shrunk = match is_shorter(length, self.length) {
            true if is_steep => SHRUNK + 1,
            true => self.shrunk.saturating_add(1),
            false => 0,
        };
        Flight {
            length,
            before: self.length,
            rates: [self.rate, rate],
            kept,
            shrunk,
        }
    }
}

impl Flight {
    /// Ratio of the gap rates.
    fn factor(&self) -> f64 {
        self.rates[1] / self.rates[0]
    }

    /// True if flights shrink, and the next one would rise no higher than the rounding of the gap.
    pub(super) fn is_last(&self, rounding: impl FnOnce() -> f64) -> bool {
        let [before, rate] = self.rates;
        let is_shrinking = self.shrunk > SHRUNK && rate < before;
        // The ratio of the gap rates is far too small if the gap is steep at the impact before.
        let shrunk = self.before.map_or(self.kept, |before| self.length / before);
        let next = self.length * self.factor().max(shrunk);
        is_shrinking && 0.25 * rate * next <= rounding()
    }

    /// End of all flights after this one, which ends at `t`, if they shrink by the same factor: by that of the gap rates,
    /// and by that of the lengths. Gap rates need not shrink, where a motion is squeezed between two surfaces.
    fn ends(&self, t: f64) -> [Option<f64>; 2] {
        let by_lengths = self.before.map(|before| self.length / before);
        [Some(self.factor()), by_lengths].map(|factor| {
            let factor = factor?;
            let end = t + self.length * factor / (1.0 - factor);
            (factor > 0.0 && factor < 1.0 && end.is_finite()).then_some(end)
        })
    }
}

impl Estimate {
    /// The estimate after one more guess, if there is a guess.
    fn refined(before: Option<Self>, guess: Option<f64>) -> Option<Self> {
        let Some(guess) = guess else {
            return before;
        };
        let Some(before) = before else {
            return Some(Self {
                last: guess,
                best: guess,
                spread: f64::INFINITY,
            });
        };
        let apart = (guess - before.last).abs();
        Some(match apart < before.spread {
            true => Self {
                last: guess,
                best: guess,
                spread: apart,
            },
            false => Self {
                last: guess,
                ..before
            },
        })
    }
}
