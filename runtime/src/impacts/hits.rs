//! Surfaces in contact at one time, and the order of their impacts. A surface is "at hand" if its gap is 0 within
//! rounding; it is approached if its gap rate is negative beyond a threshold.
//!
//! Impacts are carried out in rounds: first on the surfaces approached on arrival, then on those approached after the
//! impacts of the first round, and so on. A wave of impacts therefore passes through touching bodies as it passes
//! through small gaps, if all gaps take equally long to close.

use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Order of the impacts in one round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Ascending index.
    Ascending,
    /// Descending index.
    Descending,
}

/// Threshold of the gap rate for a surface at hand.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Still {
    /// Approached if the gap rate is below minus this number.
    UpTo(f64),
    /// Approached at any rate: the gap has passed through 0.
    Fallen,
    /// No longer approached: its impact is settled.
    Done,
}

/// Surfaces at hand at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hits<G: StateVector> {
    /// True for surfaces at hand.
    at_hand: PerSurface<bool, G>,
    /// Thresholds of the gap rates.
    still: PerSurface<Still, G>,
    /// True for surfaces approached at the beginning of this round whose turn is still to come.
    due: PerSurface<bool, G>,
    /// True for surfaces that had an impact at this time.
    struck: PerSurface<bool, G>,
    /// True for surfaces at a place to which no smooth motion led.
    placed: PerSurface<bool, G>,
}

impl<G: StateVector> Hits<G> {
    /// No surface at hand. `like` has one component per surface.
    pub(super) fn none(like: &G) -> Self {
        let none = PerSurface::all(like, false);
        Self {
            at_hand: none,
            still: PerSurface::all(like, Still::UpTo(0.0)),
            due: none,
            struck: none,
            placed: none,
        }
    }

    /// The given surfaces at hand. `like` has one component per surface.
    pub(super) fn all_of(surfaces: impl Iterator<Item = usize>, like: &G) -> Self {
        let mut hits = Self::none(like);
        surfaces.for_each(|surface| hits.add(surface));
        hits
    }

    /// Adds a surface.
    pub(super) fn add(&mut self, surface: usize) {
        self.at_hand[surface] = true;
    }

    /// True if the surface is at hand.
    pub(super) fn is_at_hand(&self, surface: usize) -> bool {
        self.at_hand[surface]
    }

    /// Number of all surfaces, at hand or not.
    pub(super) fn count(&self) -> usize {
        self.at_hand.count()
    }

    /// True if any surface is at hand.
    pub(super) fn is_some(&self) -> bool {
        self.at_hand.iter().any(|is_at_hand| is_at_hand)
    }

    /// True if the surface is at hand and approached.
    pub(super) fn is_approached(&self, surface: usize, rates: &G) -> bool {
        self.at_hand[surface]
            && match self.still[surface] {
                Still::UpTo(still) => rates.as_slice()[surface] < -still,
                Still::Fallen => true,
                Still::Done => false,
            }
    }

    /// Number of surfaces that are at hand and approached.
    pub(super) fn approached(&self, rates: &G) -> usize {
        (0..rates.count())
            .filter(|&surface| self.is_approached(surface, rates))
            .count()
    }

    /// The first and the last index of the surfaces that are at hand and approached.
    pub(super) fn ends(&self, rates: &G) -> Option<[usize; 2]> {
        let mut approached =
            (0..rates.count()).filter(|&surface| self.is_approached(surface, rates));
        let first = approached.next()?;
        Some([first, approached.next_back().unwrap_or(first)])
    }

    /// Begins a round if the last one has ended. Returns the number of surfaces in the round, or 0 if the last one has
    /// not ended.
    pub(super) fn begin_round(&mut self, rates: &G) -> usize {
        if self.due(rates).next().is_some() {
            return 0;
        }
        for surface in 0..rates.count() {
            self.due[surface] = self.is_approached(surface, rates);
        }
        self.due(rates).count()
    }

    /// The next surface of this round, in the given order; `None` at the end of the round.
    pub(super) fn turn(&mut self, rates: &G, order: Order) -> Option<usize> {
        let surface = match order {
            Order::Ascending => self.due(rates).next(),
            Order::Descending => self.due(rates).next_back(),
        }?;
        self.due[surface] = false;
        Some(surface)
    }

    /// Surfaces of this round whose turn is still to come and that are still approached.
    fn due<'a>(&'a self, rates: &'a G) -> impl DoubleEndedIterator<Item = usize> + 'a {
        (0..rates.count())
            .filter(|&surface| self.due[surface] && self.is_approached(surface, rates))
    }

    /// Records an impact on a surface. Returns true if it had an impact at this time before.
    pub(super) fn note_struck(&mut self, surface: usize) -> bool {
        core::mem::replace(&mut self.struck[surface], true)
    }

    /// True if a surface is approached at any rate.
    pub(super) fn has_fallen(&self, surface: usize) -> bool {
        self.still[surface] == Still::Fallen
    }

    /// Marks a surface as approached at any rate, because its gap has passed through 0.
    pub(super) fn set_fallen(&mut self, surface: usize) {
        self.still[surface] = Still::Fallen;
    }

    /// Marks a surface at hand as settled.
    pub(super) fn set_done(&mut self, surface: usize) {
        self.still[surface] = Still::Done;
    }

    /// True if the surface is at hand and settled.
    pub(super) fn is_settled(&self, surface: usize) -> bool {
        self.at_hand[surface] && self.still[surface] == Still::Done
    }

    /// Lets a settled surface be approached again.
    pub(super) fn reopen(&mut self, surface: usize) {
        if self.still[surface] == Still::Done {
            self.still[surface] = Still::UpTo(0.0);
        }
    }

    /// True if the surface had an impact at this time.
    pub(super) fn was_struck(&self, surface: usize) -> bool {
        self.struck[surface]
    }

    /// True if the surface is at hand where no smooth motion led, and not settled.
    pub(super) fn is_placed(&self, surface: usize) -> bool {
        self.at_hand[surface] && self.placed[surface] && self.still[surface] != Still::Done
    }

    /// Replaces the surfaces at hand by those at a place to which no smooth motion led; settled ones stay settled.
    pub(super) fn replace(&mut self, at_hand: PerSurface<bool, G>) {
        (self.at_hand, self.placed) = (at_hand, at_hand);
        for still in self.still.iter_mut() {
            if *still == Still::Fallen {
                *still = Still::UpTo(0.0);
            }
        }
    }

    /// Raises the threshold of a surface: gap rates above `-rate` no longer count as approaching. Returns the new
    /// threshold; `None` for a settled surface.
    pub(super) fn set_still(&mut self, surface: usize, rate: f64) -> Option<f64> {
        let rate = match self.still[surface] {
            Still::UpTo(before) => before.max(rate),
            Still::Fallen => rate,
            Still::Done => return None,
        };
        self.still[surface] = Still::UpTo(rate);
        Some(rate)
    }
}
