//! Which surfaces are at hand at one moment, which of them are approached, and in which order they are struck.
//!
//! Surfaces are struck in rounds: first those that are approached on arrival, then those that the impacts of a round leave
//! approached, and so on. So a wave of impacts passes through bodies that touch as it does through small gaps, if every
//! gap takes equally long.

use crate::state::StateVector;

/// The order in which the surfaces of one round are struck.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// First the surface declared first.
    Ascending,
    /// First the surface declared last.
    Descending,
}

/// Surfaces at hand at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hits<G> {
    /// 1 for surfaces at hand.
    pub(super) at_hand: G,
    /// Gap rates above minus this count as not approaching.
    still: G,
    /// 1 for surfaces that were approached when this round began and have not had their turn.
    due: G,
    /// 1 for surfaces that were struck at this moment.
    struck: G,
}

impl<G: StateVector> Hits<G> {
    /// No surface, of as many as there are components here.
    pub(super) fn none(like: &G) -> Self {
        let none = like.zeroed();
        Self {
            at_hand: none,
            still: none,
            due: none,
            struck: none,
        }
    }

    /// These surfaces, of as many as there are components here.
    pub(super) fn all_of(surfaces: impl Iterator<Item = usize>, like: &G) -> Self {
        let mut hits = Self::none(like);
        hits.add(surfaces);
        hits
    }

    /// These surfaces are at hand as well.
    pub(super) fn add(&mut self, surfaces: impl Iterator<Item = usize>) {
        for surface in surfaces {
            self.at_hand.as_mut_slice()[surface] = 1.0;
        }
    }

    /// Whether any is at hand.
    pub(super) fn is_some(&self) -> bool {
        self.at_hand.as_slice().contains(&1.0)
    }

    /// Whether a surface is at hand and approached.
    pub(super) fn is_approached(&self, surface: usize, rates: &G) -> bool {
        self.at_hand.as_slice()[surface] == 1.0
            && rates.as_slice()[surface] < -self.still.as_slice()[surface]
    }

    /// Number of surfaces at hand that are approached.
    pub(super) fn approached(&self, rates: &G) -> usize {
        (0..rates.count())
            .filter(|&surface| self.is_approached(surface, rates))
            .count()
    }

    /// The first and the last of them.
    pub(super) fn ends(&self, rates: &G) -> Option<[usize; 2]> {
        let mut approached =
            (0..rates.count()).filter(|&surface| self.is_approached(surface, rates));
        let first = approached.next()?;
        Some([first, approached.next_back().unwrap_or(first)])
    }

    /// Begins a round if the last one is over. Returns the number of surfaces in it; 0 within a round.
    pub(super) fn begin_round(&mut self, rates: &G) -> usize {
        if self.due(rates).next().is_some() {
            return 0;
        }
        for surface in 0..rates.count() {
            let is_due = f64::from(u8::from(self.is_approached(surface, rates)));
            self.due.as_mut_slice()[surface] = is_due;
        }
        self.due(rates).count()
    }

    /// The surface whose turn it is in this round; `None` where it is over.
    pub(super) fn turn(&mut self, rates: &G, order: Order) -> Option<usize> {
        let surface = match order {
            Order::Ascending => self.due(rates).next(),
            Order::Descending => self.due(rates).next_back(),
        }?;
        self.due.as_mut_slice()[surface] = 0.0;
        Some(surface)
    }

    /// Surfaces of this round that have not had their turn and are still approached.
    fn due<'a>(&'a self, rates: &'a G) -> impl DoubleEndedIterator<Item = usize> + 'a {
        let is_due = |surface: usize| self.due.as_slice()[surface] == 1.0;
        (0..rates.count())
            .filter(move |&surface| is_due(surface) && self.is_approached(surface, rates))
    }

    /// Notes an impact on a surface. Returns whether it was struck at this moment before.
    pub(super) fn note_struck(&mut self, surface: usize) -> bool {
        core::mem::replace(&mut self.struck.as_mut_slice()[surface], 1.0) == 1.0
    }

    /// The gap was seen to fall through 0: it counts as approached, whatever its rate.
    pub(super) fn set_fallen(&mut self, surface: usize) {
        self.still.as_mut_slice()[surface] = f64::NEG_INFINITY;
    }

    /// The surface is at hand and was dealt with.
    pub(super) fn set_done(&mut self, surface: usize) {
        self.still.as_mut_slice()[surface] = f64::INFINITY;
    }

    /// The surfaces at hand are others now; those dealt with stay so.
    pub(super) fn replace(&mut self, at_hand: G) {
        self.at_hand = at_hand;
        for still in self.still.as_mut_slice() {
            *still = still.max(0.0);
        }
    }

    /// Gap rates above minus this count as not approaching.
    pub(super) fn still(&self, surface: usize) -> f64 {
        self.still.as_slice()[surface]
    }

    /// From now on, gap rates above `-rate` count as not approaching.
    pub(super) fn set_still(&mut self, surface: usize, rate: f64) {
        let still = &mut self.still.as_mut_slice()[surface];
        *still = still.max(rate);
    }
}
