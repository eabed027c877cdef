//! Impacts at one time: when they are infinitely many.
//!
//! Impacts that reverse their gap rates do not accumulate at one time: billiards in a corner that leaves room to go have
//! finitely many (Burago, Ferleger and Kononenko), be it millions between bodies of very different masses. Those that lose speed do where
//! their speeds have died away, those that gain it do at once.

use super::accumulation::Bounce;
use super::repeats::Repeats;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Impacts at one time before they count as accumulated. A corner of angle `pi / n` takes up to `n`.
const MANY: u32 = 100;

/// Part of a gap rate by which one after an impact may differ from that before, of an impact that reverses it.
const REVERSED: f64 = 1.0 / (1 << 20) as f64;

/// Part of the largest gap rate at one time that counts as died away.
const DIED: f64 = 1.0 / (1 << 20) as f64;

/// Conclusion from the impacts at one time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gathering {
    /// They are few, or go on.
    None,
    /// Almost all of them are hops on this surface.
    Hops(usize),
    /// Infinitely many impacts on several surfaces.
    Several,
}

/// Impacts on one surface at one time, counted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tally {
    count: u32,
    /// Largest gap rate before them.
    fastest: f64,
}

impl Tally {
    const NONE: Self = Self {
        count: 0,
        fastest: 0.0,
    };
}

/// The impacts at the time of the last one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coincident<G: StateVector> {
    impacts: Repeats,
    /// Number of those that did not reverse the gap rate.
    unequal: u32,
    on_each: PerSurface<Tally, G>,
}

impl<G: StateVector> Coincident<G> {
    /// No impacts yet, on as many surfaces as there are components here.
    pub(super) fn none(like: &G) -> Self {
        Self {
            impacts: Repeats::none(),
            unequal: 0,
            on_each: PerSurface::all(like, Tally::NONE),
        }
    }

    /// Takes in an impact that the motion bounces off from.
    pub(super) fn add(&mut self, bounce: Bounce) {
        let Bounce {
            surface,
            t,
            rates: [before, after],
            ..
        } = bounce;
        self.count(surface, t);
        let is_reversed = (before + after).abs() <= REVERSED * before.abs();
        self.unequal += u32::from(!is_reversed);
        let fastest = &mut self.on_each[surface].fastest;
        *fastest = fastest.max(before.abs());
    }

    /// Counts an impact, whatever its rates.
    pub(super) fn count(&mut self, surface: usize, t: f64) {
        if self.impacts.add(t) == 0 {
            self.unequal = 0;
            self.on_each.fill(Tally::NONE);
        }
        self.on_each[surface].count += 1;
    }

    /// True if there are too many impacts at one time to wait for their end.
    pub(super) fn are_many(&self) -> bool {
        self.impacts.count() >= MANY
    }

    /// Concludes from the impacts so far, of which this is the last.
    pub(super) fn gathering(&self, bounce: Bounce) -> Gathering {
        if !self.are_many() {
            return Gathering::None;
        }
        match self.hops_on() {
            Some(surface) => Gathering::Hops(surface),
            None if self.are_infinite(bounce) => Gathering::Several,
            None => Gathering::None,
        }
    }

    /// The surface that almost all impacts at this time were on, if they do not go to and fro between several.
    fn hops_on(&self) -> Option<usize> {
        let most = 0.75 * f64::from(self.impacts.count());
        let mut counts = self.on_each.iter().map(|tally| tally.count);
        counts.position(|count| f64::from(count) > most)
    }

    /// True if impacts on several surfaces at one time are infinitely many.
    fn are_infinite(&self, bounce: Bounce) -> bool {
        let [before, after] = bounce.rates;
        let has_died = after <= DIED * self.on_each[bounce.surface].fastest;
        let has_gained = after > (1.0 + REVERSED) * before.abs();
        self.unequal >= MANY && (has_died || has_gained)
    }
}
