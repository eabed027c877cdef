//! A box of times and states in which no gap vanishes: steps inside it need no event location.
//!
//! An enclosure of every gap over the box proves this, so it holds for any motion in the box. A motion that leaves the box
//! extends it, so that a bounded motion far from all surfaces is soon in one box for good. Where this fails, a new box is
//! tried around the step. It grows where motion stays far from all surfaces, and is tried ever more rarely where it does
//! not.

use core::cell::Cell;

use super::path::Path;
use super::room::{Room, place};
use crate::contract::Impacting;
use crate::numbers::TaylorModel;
use crate::state::StateVector;

/// Maximum number of steps to wait for the next trial after several failures.
const MOST_PATIENCE: u32 = 64;

/// Maximum size of a box, in multiples of the distance covered in a step.
const MOST_MARGIN: f64 = 1024.0;

/// The box, if one is known.
#[derive(Debug, Clone)]
pub(crate) struct Haven<S> {
    room: Room<S>,
    /// Number of boxes to make before one is extended again, and the number that the last failure set.
    renewals: u32,
    caution: u32,
    /// Size of the next box, as a multiple of the distance covered in a step.
    margin: f64,
    /// Number of steps to skip before the next trial, and the number that the last trial set.
    wait: u32,
    patience: u32,
}

impl<S: StateVector> Haven<S> {
    /// A search without a box yet, for systems with this number of positions and as many components as `like`.
    pub(crate) fn new(positions: usize, like: &S) -> Self {
        Self {
            room: Room::new(positions, like),
            renewals: 0,
            caution: 0,
            margin: 4.0,
            wait: 0,
            patience: 0,
        }
    }

    /// Discards the box, after a change of surfaces, parameters or mode.
    pub(crate) fn forget(&mut self) {
        self.room.forget();
    }

    /// True if a step lies in the box.
    #[inline]
    pub(crate) fn holds(&self, path: &mut Path<S>) -> bool {
        self.room.is_known() && {
            path.enclose();
            self.room.holds(path)
        }
    }

    /// Looks for a box about a step that meets no surface. In the box the gaps of walls must be positive, and those
    /// of passable surfaces different from zero.
    #[inline]
    pub(crate) fn settle<Sys: Impacting<State = S>>(
        &mut self,
        system: &Sys,
        path: &mut Path<S>,
        is_passable: impl Fn(usize) -> bool,
        evaluations: &mut u64,
    ) {
        if self.wait > 0 {
            self.wait -= 1;
            return;
        }
        path.enclose();
        if self.room.is_known() && self.renewals == 0 {
            self.room.extend(path);
            if self.is_free(system, path, &is_passable, evaluations) {
                (self.caution, self.patience, self.wait) = (0, 0, 0);
                return;
            }
            self.caution = (2 * self.caution + 1).min(MOST_PATIENCE);
            self.renewals = self.caution;
        }
        self.renewals = self.renewals.saturating_sub(1);
        self.room.surround(path, self.margin);
        match self.is_free(system, path, &is_passable, evaluations) {
            true => {
                self.margin = (2.0 * self.margin).min(MOST_MARGIN);
                self.patience = 0;
            }
            false => {
                self.room.forget();
                self.margin = (0.5 * self.margin).max(1.0);
                self.patience = (2 * self.patience + 1).min(MOST_PATIENCE);
            }
        }
        self.wait = self.patience;
    }

    /// True if no gap vanishes in the box. Restricts the box to the coordinates that the gaps depend on.
    fn is_free<Sys: Impacting<State = S>>(
        &mut self,
        system: &Sys,
        path: &Path<S>,
        is_passable: &impl Fn(usize) -> bool,
        evaluations: &mut u64,
    ) -> bool {
        let room = &self.room;
        let taken = Cell::new(0_u64);
        let component = |i: usize| match i < room.positions() {
            true => {
                taken.set(taken.get() | place(i));
                TaylorModel::steady(room.range(i))
            }
            false => TaylorModel::steady(path.range(i)),
        };
        let is_off = |surface: usize| {
            let times = TaylorModel::steady(room.times());
            let gap = system.gap_along(surface, times, &component).range();
            gap.lo > 0.0 || (is_passable(surface) && gap.hi < 0.0)
        };
        *evaluations += 1;
        let are_off = (0..system.surface_count()).all(is_off);
        self.room.keep(taken.get());
        are_off
    }
}
