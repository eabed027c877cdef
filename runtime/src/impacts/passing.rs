//! Impacts after which the motion passes through the surface: detection of their accumulation.

use super::hops::{SHRUNK, is_shorter};
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Relative difference below which times cannot be distinguished.
const INSTANT: f64 = 4.0 * f64::EPSILON;

/// Time, in units of [`INSTANT`], within which a passage through the same surface is not repeated at the start of a step.
const AT_ONCE: f64 = 16.0;

/// The impacts at which the motion passed through a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing<G: StateVector> {
    /// Time of the last impact on any surface; `None` before the first.
    last: Option<f64>,
    /// Time between the last two impacts.
    stretch: Option<f64>,
    /// Number of successive times that `stretch` became shorter. The first stretch counts as one of them.
    shortened: u32,
    /// Time of the last impact on each surface.
    on_each: PerSurface<Option<f64>, G>,
}

impl<G: StateVector> Passing<G> {
    /// Data before the first impact, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            last: None,
            stretch: None,
            shortened: 0,
            on_each: PerSurface::all(like, None),
        }
    }

    /// Records an impact.
    pub(super) fn add(&mut self, surface: usize, t: f64) {
        let stretch = self.last.replace(t).map(|last| t - last);
        self.on_each[surface] = Some(t);
        let is_apart = |stretch: f64| stretch > INSTANT * t.abs();
        if stretch.is_none_or(is_apart) {
            self.shortened = match stretch {
                Some(stretch) if is_shorter(stretch, self.stretch) => {
                    self.shortened.saturating_add(1)
                }
                // Both are equal up to the rounding of times.
                Some(stretch) if is_shorter(stretch - INSTANT * t.abs(), self.stretch) => {
                    self.shortened
                }
                _ => 0,
            };
        }
        self.stretch = stretch;
    }

    /// True if the motion passed through this surface at the time `t`, or so shortly before that a motion which moves on by
    /// rounding errors of the time would return to it again and again.
    pub(super) fn has_passed_at(&self, surface: usize, t: f64) -> bool {
        self.on_each[surface].is_some_and(|last| t - last <= AT_ONCE * INSTANT * t.abs())
    }

    /// True if impacts followed each other faster and faster until one on this surface at the time `t`.
    pub(super) fn is_ever_faster(&self, surface: usize, t: f64) -> bool {
        self.shortened > SHRUNK && self.on_each[surface] == Some(t)
    }

    /// True if impacts followed each other faster and faster until `t`, where two of them cannot be distinguished, and
    /// one of the last was on this surface.
    pub(super) fn has_accumulated(&self, surface: usize, t: f64) -> bool {
        let instant = INSTANT * t.abs();
        let is_instant = |stretch: f64| stretch <= instant;
        let is_recent = |last: f64| t - last <= 2.0 * instant;
        self.shortened > SHRUNK
            && self.stretch.is_some_and(is_instant)
            && self.on_each[surface].is_some_and(is_recent)
    }
}
