//! Which surfaces are at hand at one moment, and which of them are approached.

use crate::state::StateVector;

/// Surfaces at hand at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hits<G> {
    /// 1 for surfaces at hand.
    pub(super) at_hand: G,
    /// Gap rates above minus this count as not approaching.
    still: G,
}

impl<G: StateVector> Hits<G> {
    /// No surface.
    pub(super) fn none() -> Self {
        Self {
            at_hand: G::zeros(),
            still: G::zeros(),
        }
    }

    /// These surfaces.
    pub(super) fn all_of(surfaces: impl Iterator<Item = usize>) -> Self {
        let mut hits = Self::none();
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
        (0..G::LEN)
            .filter(|&surface| self.is_approached(surface, rates))
            .count()
    }

    /// The first of them.
    pub(super) fn first_approached(&self, rates: &G) -> Option<usize> {
        (0..G::LEN).find(|&surface| self.is_approached(surface, rates))
    }

    /// The last of them.
    pub(super) fn last_approached(&self, rates: &G) -> Option<usize> {
        (0..G::LEN)
            .rev()
            .find(|&surface| self.is_approached(surface, rates))
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

    /// From now on, gap rates above `-rate` count as not approaching.
    pub(super) fn set_still(&mut self, surface: usize, rate: f64) {
        let still = &mut self.still.as_mut_slice()[surface];
        *still = still.max(rate);
    }
}
