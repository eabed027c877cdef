//! Roles of passable surfaces on which the motion is at rest: they act once it is pressed into them, or have acted already.

use super::hits::Hits;
use super::watch::Watch;
use crate::contract::Impacting;
use crate::state::StateVector;

/// Role of a surface if the motion on it is pressed into it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// That of its law; none, if it is passable.
    Usual,
    /// It acts: the motion began on this passable surface, or was put there by a reset.
    Waits,
    /// None: it is passable and has acted at this moment, and no reset has led off it since.
    Acted,
}

impl<Sys: Impacting> Watch<Sys> {
    /// True for a passable surface that acts if the motion is pressed into it.
    pub(super) fn is_waiting(&self, surface: usize) -> bool {
        self.standing[surface] == Standing::Waits
    }

    /// True for a passable surface that does not act if the motion is pressed into it.
    pub(super) fn lets_through(&self, surface: usize) -> bool {
        self.is_passable(surface) && !self.is_waiting(surface)
    }

    /// Records which passable surfaces have acted at a moment, and which wait.
    pub(super) fn note_standing(&mut self, hits: &Hits<Sys::Gaps>) {
        for surface in 0..self.gaps.count() {
            if !self.is_passable(surface) {
                continue;
            }
            let is_struck = hits.is_at_hand(surface) && hits.was_struck(surface);
            self.standing[surface] = match self.standing[surface] {
                Standing::Acted => Standing::Acted,
                _ if is_struck => Standing::Acted,
                _ if hits.is_placed(surface) => Standing::Waits,
                before => before,
            };
        }
    }

    /// Forgets the surfaces that a reset has led off, and those that waited at another place. Surfaces at hand that have acted
    /// are settled.
    pub(super) fn forget_led_off(&mut self, hits: &mut Hits<Sys::Gaps>) {
        for surface in 0..self.gaps.count() {
            match self.standing[surface] {
                Standing::Acted if hits.is_at_hand(surface) => hits.set_done(surface),
                _ => self.standing[surface] = Standing::Usual,
            }
        }
    }

    /// Forgets the surfaces that are no longer touched.
    pub(super) fn forget_left(&mut self) {
        for surface in 0..self.gaps.count() {
            if self.gaps.as_slice()[surface] != 0.0 {
                self.standing[surface] = Standing::Usual;
            }
        }
    }

    /// Forgets the surfaces that acted at an earlier moment.
    pub(super) fn forget_acted(&mut self) {
        let acted = self.standing.iter_mut();
        for standing in acted.filter(|standing| **standing == Standing::Acted) {
            *standing = Standing::Usual;
        }
    }
}
