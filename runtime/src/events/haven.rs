//! A box of times and states in which no gap vanishes: steps inside it need no look at any surface.
//!
//! It is what an enclosure of every gap over the box shows, and so holds of any motion in it. Boxes grow where motion stays far
//! from all surfaces, and are tried ever more rarely where it does not.

use super::path::Path;
use crate::contract::Impacting;
use crate::numbers::{Interval, TaylorModel};
use crate::state::StateVector;

/// Steps to wait for the next trial after several that failed, at most.
const MOST_PATIENCE: u32 = 64;

/// Sizes of a box in ways of a step, at most.
const MOST_MARGIN: f64 = 1024.0;

/// The box, once one is known.
#[derive(Debug, Clone)]
pub(crate) struct Haven<S> {
    lowest: S,
    highest: S,
    times: Interval,
    /// Components that positions are: gaps take no others.
    positions: usize,
    is_known: bool,
    /// How much larger than what a step passes the next box is to be.
    margin: f64,
    /// Steps to let pass before the next trial, and how many the last failure has cost.
    wait: u32,
    patience: u32,
}

impl<S: StateVector> Haven<S> {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self {
            lowest: S::zeros(),
            highest: S::zeros(),
            times: Interval::point(0.0),
            positions: 0,
            is_known: false,
            margin: 4.0,
            wait: 0,
            patience: 0,
        }
    }

    /// Forgets the box: surfaces, parameters or the mode are others.
    pub(crate) fn forget(&mut self) {
        self.is_known = false;
    }

    /// True if a step lies in the box.
    #[inline]
    pub(crate) fn holds(&self, path: &Path<S>) -> bool {
        self.is_known
            && self.times.contains(path.time([0.0, 1.0]).value)
            && (0..self.positions).all(|i| self.range(i).contains(path.range(i)))
    }

    #[inline]
    fn range(&self, i: usize) -> Interval {
        Interval::new(self.lowest.as_slice()[i], self.highest.as_slice()[i])
    }

    /// Looks for a box about a step that meets no surface. Gaps of walls are to be positive in it, those that motion may pass
    /// different from zero.
    #[inline]
    pub(crate) fn settle<Sys: Impacting<State = S>>(
        &mut self,
        system: &Sys,
        path: &Path<S>,
        is_passable: impl Fn(usize) -> bool,
        evaluations: &mut u64,
    ) {
        if self.wait > 0 {
            self.wait -= 1;
            return;
        }
        self.surround(path);
        self.positions = Sys::Vector::LEN.min(S::LEN);
        let component = |i: usize| match i < self.positions {
            true => TaylorModel::steady(self.range(i)),
            false => TaylorModel::steady(path.range(i)),
        };
        let is_off = |surface: usize| {
            let times = TaylorModel::steady(self.times);
            let gap = system.gap_along(surface, times, &component).range();
            gap.lo > 0.0 || (is_passable(surface) && gap.hi < 0.0)
        };
        *evaluations += 1;
        self.is_known = (0..Sys::Gaps::LEN).all(is_off);
        match self.is_known {
            true => {
                self.margin = (2.0 * self.margin).min(MOST_MARGIN);
                self.patience = 0;
            }
            false => {
                self.margin = (0.5 * self.margin).max(1.0);
                self.patience = (2 * self.patience + 1).min(MOST_PATIENCE);
            }
        }
        self.wait = self.patience;
    }

    /// The box of a step and its margin.
    fn surround(&mut self, path: &Path<S>) {
        for i in 0..S::LEN {
            let range = path.range(i);
            let room = range.widened(self.margin * range.width());
            self.lowest.as_mut_slice()[i] = room.lo;
            self.highest.as_mut_slice()[i] = room.hi;
        }
        let times = path.time([0.0, 1.0]).value;
        self.times = times.widened(self.margin * times.width());
    }
}
