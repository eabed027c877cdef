//! Accumulation of impacts: when flights between them shrink to nothing.
//!
//! Two signs are taken. Impacts follow each other at one and the same number `t`; or the flights between impacts
//! on one surface have shrunk several times in a row and the height that the next one will reach, about
//! `gap rate * time / 4`, is below the rounding of the gap: it would be made of rounding errors.
//!
//! Impacts that reverse their gap rates do not accumulate at one time: billiards in a corner that leaves room to go have
//! finitely many (Burago, Ferleger and Kononenko), be it millions between bodies of very different masses. Those that lose speed do where
//! their speeds have died away, those that gain it do at once.

use super::growth::Growth;
use crate::state::StateVector;

/// Impacts at one time before they count as accumulated. A corner of angle `pi / n` takes up to `n`.
const AT_ONE_TIME: u32 = 100;

/// Part of a gap rate by which one after an impact may differ from that before, of an impact that reverses it.
const REVERSED: f64 = 1.0 / (1 << 20) as f64;

/// Part of the largest gap rate at one time that counts as died away.
const DIED: f64 = 1.0 / (1 << 20) as f64;

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

/// Times closer than this part of themselves cannot be told apart.
const INSTANT: f64 = 4.0 * f64::EPSILON;

/// An impact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounce {
    pub(super) surface: usize,
    pub(super) t: f64,
    /// Gap rates before and after it, the latter 0 for one that does not bounce.
    pub(super) rates: [f64; 2],
    /// Whether the surface was struck at the same moment before: no flight lies in between.
    pub(super) again: bool,
}

/// What the impacts at one time mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Gathering {
    /// They are not many, or go on.
    None,
    /// Hops on one surface end, and this is another that happens to be hit there.
    Elsewhere,
    Ends(Ends),
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
    /// How many of them did not reverse the gap rate; and per surface the largest gap rate before them.
    unequal: u32,
    fastest: V,
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
    /// Impacts after which the motion goes on through the surface: per surface the time of the last; time of the last of all,
    /// time since the one before, and how many times in a row that was shorter.
    passes: V,
    passed: f64,
    stretch: f64,
    shortened: f64,
}

impl<V: StateVector> Accumulation<V> {
    /// No impacts yet, on as many surfaces as there are components here.
    pub(super) fn none(like: &V) -> Self {
        let zeros = like.zeroed();
        let [mut times, mut infinite, mut unknown] = [zeros; 3];
        times.as_mut_slice().fill(f64::NEG_INFINITY);
        infinite.as_mut_slice().fill(f64::INFINITY);
        unknown.as_mut_slice().fill(f64::NAN);
        Self {
            growth: Growth::none(like),
            last: f64::NEG_INFINITY,
            repeated: 0,
            on_each: zeros,
            unequal: 0,
            fastest: zeros,
            times,
            flights: infinite,
            rates: zeros,
            shrunk: zeros,
            guesses: unknown,
            best: unknown,
            spreads: infinite,
            passes: times,
            passed: f64::NEG_INFINITY,
            stretch: f64::INFINITY,
            shortened: 0.0,
        }
    }

    /// Takes in an impact. `rounding` gives the size of the gap's rounding errors, `energy` the energy after the impact.
    /// Returns how impacts accumulate, if they do.
    pub(super) fn add(
        &mut self,
        bounce: Bounce,
        rounding: impl FnOnce() -> f64,
        energy: impl FnOnce() -> f64,
    ) -> Option<Ends> {
        let Bounce {
            surface,
            t,
            rates: [_, rate],
            again,
        } = bounce;
        self.count(surface, t);
        self.compare(bounce);
        if again {
            self.rates.as_mut_slice()[surface] = rate;
            return match self.at_one_time(bounce) {
                Gathering::Ends(ends) => Some(ends),
                Gathering::None | Gathering::Elsewhere => None,
            };
        }
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
        match self.at_one_time(bounce) {
            Gathering::None => {}
            Gathering::Elsewhere => return None,
            Gathering::Ends(ends) => return Some(ends),
        }
        let next = flight * (rate / before);
        let is_hidden = shrinking && 0.25 * rate * next <= rounding();
        is_hidden.then(|| Ends::Hops(self.limit(surface, t)))
    }

    /// What the impacts at one time mean.
    fn at_one_time(&self, bounce: Bounce) -> Gathering {
        let Bounce { surface, t, .. } = bounce;
        if self.repeated < AT_ONE_TIME {
            return Gathering::None;
        }
        match self.hops_on() {
            None if self.has_gathered(bounce) => Gathering::Ends(Ends::AtOneTime(t)),
            None => Gathering::None,
            Some(hopping) if hopping == surface => {
                Gathering::Ends(Ends::Hops(self.limit(surface, t)))
            }
            Some(_) => Gathering::Elsewhere,
        }
    }

    /// Whether impacts on several surfaces at one time are infinitely many.
    fn has_gathered(&self, bounce: Bounce) -> bool {
        let Bounce {
            surface,
            rates: [before, after],
            ..
        } = bounce;
        let has_died = after <= DIED * self.fastest.as_slice()[surface];
        let has_gained = after > (1.0 + REVERSED) * before.abs();
        self.unequal >= AT_ONE_TIME && (has_died || has_gained)
    }

    /// Takes in an impact after which the motion goes on through the surface: no flight begins there.
    pub(super) fn pass(&mut self, surface: usize, t: f64) -> Option<Ends> {
        self.count(surface, t);
        self.times.as_mut_slice()[surface] = f64::NEG_INFINITY;
        self.flights.as_mut_slice()[surface] = f64::INFINITY;
        self.rates.as_mut_slice()[surface] = 0.0;
        self.shrunk.as_mut_slice()[surface] = 0.0;
        self.growth.forget(surface);
        let stretch = t - core::mem::replace(&mut self.passed, t);
        self.passes.as_mut_slice()[surface] = t;
        if stretch > INSTANT * t.abs() {
            self.shortened = match stretch < self.stretch {
                true => self.shortened + 1.0,
                false => 0.0,
            };
        }
        self.stretch = stretch;
        (self.repeated >= AT_ONE_TIME).then_some(Ends::AtOneTime(t))
    }

    /// Compares the gap rates before and after an impact.
    fn compare(&mut self, bounce: Bounce) {
        let Bounce {
            surface,
            rates: [before, after],
            ..
        } = bounce;
        let is_reversed = (before + after).abs() <= REVERSED * before.abs();
        self.unequal += u32::from(!is_reversed);
        let fastest = &mut self.fastest.as_mut_slice()[surface];
        *fastest = fastest.max(before.abs());
    }

    /// Whether impacts that the motion went on from through their surfaces, this one among them, followed each other faster
    /// and faster until this time, at which two of them cannot be told apart.
    pub(super) fn has_passed_on(&self, surface: usize, t: f64) -> bool {
        let instant = INSTANT * t.abs();
        let since = t - self.passes.as_slice()[surface];
        self.shortened > SHRUNK && self.stretch <= instant && since <= 2.0 * instant
    }

    /// Counts impacts at one time.
    fn count(&mut self, surface: usize, t: f64) {
        if t == self.last {
            self.repeated += 1;
        } else {
            self.repeated = 0;
            (self.on_each, self.unequal) = (self.on_each.zeroed(), 0);
            self.fastest = self.on_each.zeroed();
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
