//! Surfaces at hand at one moment: approached surfaces, and the order in which they are struck. A surface is at hand
//! where its gap is 0 within rounding.
//!
//! Surfaces are struck in rounds: first those approached on arrival, then those that the impacts of a round leave
//! approached, and so on. A wave of impacts therefore passes through bodies that touch in the same way as through
//! small gaps, if all of them take equally long.

use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// The order in which the surfaces of one round are struck.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Ascending index.
    Ascending,
    /// Descending index.
    Descending,
}

/// Threshold of the gap rate from which a surface at hand counts as approached.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Still {
    /// Approached if the gap falls faster than this.
    UpTo(f64),
    /// Approached at any rate: the gap was seen to fall through 0.
    Fallen,
    /// Not approached any more: its impact is settled.
    Done,
}

/// Surfaces at hand at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hits<G: StateVector> {
    /// True for surfaces at hand.
    at_hand: PerSurface<bool, G>,
    /// Thresholds of the gap rates.
    still: PerSurface<Still, G>,
    /// True for surfaces that were approached when this round began and have not had their turn.
    due: PerSurface<bool, G>,
    /// True for surfaces that were struck at this moment.
    struck: PerSurface<bool, G>,
}

impl<G: StateVector> Hits<G> {
    /// No surface at hand, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        let none = PerSurface::all(like, false);
        Self {
            at_hand: none,
            still: PerSurface::all(like, Still::UpTo(0.0)),
            due: none,
            struck: none,
        }
    }

    /// These surfaces at hand, for as many surfaces as `like` has components.
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

    /// Number of surfaces at hand that are approached.
    pub(super) fn approached(&self, rates: &G) -> usize {
        (0..rates.count())
            .filter(|&surface| self.is_approached(surface, rates))
            .count()
    }

    /// The first and the last surface at hand that is approached.
    pub(super) fn ends(&self, rates: &G) -> Option<[usize; 2]> {
        let mut approached =
            (0..rates.count()).filter(|&surface| self.is_approached(surface, rates));
        let first = approached.next()?;
        Some([first, approached.next_back().unwrap_or(first)])
    }

    /// Begins a round if the last one is over. Returns its number of surfaces; 0 within a round.
    pub(super) fn begin_round(&mut self, rates: &G) -> usize {
        if self.due(rates).next().is_some() {
            return 0;
        }
        for surface in 0..rates.count() {
            self.due[surface] = self.is_approached(surface, rates);
        }
        self.due(rates).count()
    }

    /// The next surface of this round; `None` at its end.
    pub(super) fn turn(&mut self, rates: &G, order: Order) -> Option<usize> {
        let surface = match order {
            Order::Ascending => self.due(rates).next(),
            Order::Descending => self.due(rates).next_back(),
        }?;
        self.due[surface] = false;
        Some(surface)
    }

    /// Surfaces of this round that have not had their turn and are still approached.
    fn due<'a>(&'a self, rates: &'a G) -> impl DoubleEndedIterator<Item = usize> + 'a {
        (0..rates.count())
            .filter(|&surface| self.due[surface] && self.is_approached(surface, rates))
    }

    /// Records an impact on a surface. Returns true if it was struck at this moment before.
    pub(super) fn note_struck(&mut self, surface: usize) -> bool {
        core::mem::replace(&mut self.struck[surface], true)
    }

    /// Marks a surface whose gap was seen to fall through 0 as approached, whatever its rate.
    pub(super) fn set_fallen(&mut self, surface: usize) {
        self.still[surface] = Still::Fallen;
    }

    /// Marks a surface at hand as settled.
    pub(super) fn set_done(&mut self, surface: usize) {
        self.still[surface] = Still::Done;
    }

    /// Replaces the surfaces at hand; settled ones stay settled.
    pub(super) fn replace(&mut self, at_hand: PerSurface<bool, G>) {
        self.at_hand = at_hand;
        for still in self.still.iter_mut() {
            if *still == Still::Fallen {
                *still = Still::UpTo(0.0);
            }
        }
    }

    /// Raises the threshold: gap rates above `-rate` count as not approaching. Returns the largest such `rate` so
    /// far; `None` for a settled surface.
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
