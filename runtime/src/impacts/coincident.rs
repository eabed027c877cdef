//! Impacts at one time: a test for infinitely many impacts.
//!
//! Impacts that reverse their gap rates do not accumulate at one time. A billiard in a corner with an open exit has
//! finitely many impacts (Burago, Ferleger and Kononenko), although there may be millions between bodies of widely
//! different masses. Impacts that lose speed count as accumulated once their speeds have decayed. Impacts that gain
//! speed count as accumulated at once.

use super::accumulation::Bounce;
use super::repeats::Repeats;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Number of repeated impacts at one time from which they count as accumulated. A corner of angle `pi / n` takes up to `n`.
pub(super) const MANY: u32 = 100;

/// Relative difference of the gap rates before and after an impact up to which it counts as reversing.
pub(super) const REVERSED: f64 = 1.0 / (1 << 20) as f64;

/// Fraction of the largest gap rate at one time below which a rate counts as decayed.
const DIED: f64 = 1.0 / (1 << 20) as f64;

/// Conclusion from the impacts at one time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gathering {
    /// They are few, or may be finitely many.
    None,
    /// Almost all of them are hops on this surface.
    Hops(usize),
    /// Infinitely many impacts on several surfaces.
    Several,
}

/// Counts of the impacts on one surface at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tally {
    count: u32,
    /// Largest gap rate before one of them.
    fastest: f64,
}

impl Tally {
    const NONE: Self = Self {
        count: 0,
        fastest: 0.0,
    };
}

/// Number of impacts on one surface at one time from which on they count as infinitely many if they do not reverse their gap
/// rates.
const ENDLESS: u32 = 1 << 14;

/// The impacts at the time of the last one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coincident<G: StateVector> {
    impacts: Repeats,
    /// Number of impacts on surfaces that had been hit before at this time.
    repeated: u32,
    /// Number of impacts that did not reverse the gap rate.
    unequal: u32,
    on_each: PerSurface<Tally, G>,
}

impl<G: StateVector> Coincident<G> {
    /// Data before the first impact, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            impacts: Repeats::none(),
            repeated: 0,
            unequal: 0,
            on_each: PerSurface::all(like, Tally::NONE),
        }
    }

    /// Records an impact after which the motion bounces off.
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

    /// Counts an impact, regardless of its rates.
    pub(super) fn count(&mut self, surface: usize, t: f64) {
        if self.impacts.add(t) == 0 {
            (self.repeated, self.unequal) = (0, 0);
            self.on_each.fill(Tally::NONE);
        }
        let count = &mut self.on_each[surface].count;
        self.repeated += u32::from(*count > 0);
        *count += 1;
    }

    /// Time of the last impact.
    pub(super) fn last(&self) -> Option<f64> {
        self.impacts.last()
    }

    /// True if there are too many impacts at one time to wait for their end.
    pub(super) fn are_many(&self) -> bool {
        self.repeated >= MANY
    }

    /// Conclusion from the impacts so far; `bounce` is the last.
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

    /// The surface of almost all impacts at this time, unless they alternate between several.
    fn hops_on(&self) -> Option<usize> {
        let most = 0.75 * f64::from(self.impacts.count());
        let mut counts = self.on_each.iter().map(|tally| tally.count);
        counts.position(|count| f64::from(count) > most)
    }

    /// True if infinitely many impacts on several surfaces happen at one time.
    fn are_infinite(&self, bounce: Bounce) -> bool {
        let [_, after] = bounce.rates;
        let has_died = after <= DIED * self.on_each[bounce.surface].fastest;
        let is_endless = self.on_each[bounce.surface].count >= ENDLESS;
        self.unequal >= MANY && (has_died || bounce.gains() || is_endless)
    }
}
