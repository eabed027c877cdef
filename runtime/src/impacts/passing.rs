//! Impacts after which the motion passes through the surface: detection of their accumulation.

use super::coincident::MANY;
use super::hops::{SHRUNK, is_shorter};
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Relative difference below which times cannot be distinguished.
const INSTANT: f64 = 4.0 * f64::EPSILON;

/// Relative difference below which two times can hardly be distinguished.
pub(super) const SOON: f64 = 1.0 / (1_u64 << 32) as f64;

/// Time, in units of [`INSTANT`], within which a passage through the same surface is not repeated at the start of a step.
const AT_ONCE: f64 = 16.0;

/// The impacts at which the motion passed through a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing<G: StateVector> {
    /// Time of the last impact on any surface; `None` before the first.
    last: Option<f64>,
    /// Time between the last two impacts.
    stretch: Option<f64>,
    /// The last such time that can be resolved.
    resolved: f64,
    /// Time of the first of the last impacts between which hardly any time can be resolved, and the number of them on surfaces that
    /// had been passed since.
    burst: (f64, u32),
    /// Number of successive times that `stretch` became shorter. The first stretch counts as one of them.
    shortened: u32,
    /// Time of the last impact on each surface.
    on_each: PerSurface<Option<f64>, G>,
    /// The ways back to each surface after resets on it.
    ways: PerSurface<Ways, G>,
}

/// Ways back to a surface from where resets on it have led.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ways {
    /// Time of the last reset, if it led off the surface.
    last: Option<f64>,
    /// Time that the last way took.
    time: Option<f64>,
    /// Number of successive ways that were shorter than their predecessor. The first way counts as one of them.
    shortened: u32,
}

impl Ways {
    const NONE: Self = Self {
        last: None,
        time: None,
        shortened: 0,
    };

    /// Records a reset at `t` and the end of the way from the reset before.
    fn arrive(&mut self, t: f64) {
        let Some(time) = self.last.replace(t).map(|last| t - last) else {
            return;
        };
        // Times are rounded.
        let instant = INSTANT * t.abs();
        self.shortened = match time <= instant {
            true => self.shortened,
            false if is_shorter(time, self.time) => self.shortened.saturating_add(1),
            // Both are equal up to the rounding of times.
            false if is_shorter(time - instant, self.time) => self.shortened,
            false => 0,
        };
        self.time = Some(time);
    }
}

impl<G: StateVector> Passing<G> {
    /// Data before the first impact, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            last: None,
            stretch: None,
            resolved: f64::INFINITY,
            burst: (f64::NEG_INFINITY, 0),
            shortened: 0,
            on_each: PerSurface::all(like, None),
            ways: PerSurface::all(like, Ways::NONE),
        }
    }

    /// Records an impact.
    pub(super) fn add(&mut self, surface: usize, t: f64) {
        let stretch = self.last.replace(t).map(|last| t - last);
        let before = self.on_each[surface].replace(t);
        let is_apart = |stretch: f64| stretch > INSTANT * t.abs();
        let is_moment = |stretch: f64| stretch <= AT_ONCE * INSTANT * t.abs();
        self.burst = match stretch.is_some_and(is_moment) {
            true => {
                let (first, repeated) = self.burst;
                let is_repeated = before.is_some_and(|before| before >= first);
                (first, repeated + u32::from(is_repeated))
            }
            false => (t, 0),
        };
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
        self.resolved = stretch
            .filter(|stretch| is_apart(*stretch))
            .unwrap_or(self.resolved);
        self.stretch = stretch;
    }

    /// True if impacts without a time between them that can be resolved repeat without end.
    pub(super) fn are_endless(&self) -> bool {
        self.burst.1 >= MANY
    }

    /// True if the last impacts at different times, until `t`, could hardly be distinguished.
    pub(super) fn has_quickened(&self, t: f64) -> bool {
        self.resolved <= SOON * t.abs()
    }

    /// True if the motion passed through this surface at the time `t`, or so shortly before that a motion which moves on by
    /// rounding errors of the time would return to it again and again.
    pub(super) fn has_passed_at(&self, surface: usize, t: f64) -> bool {
        self.on_each[surface].is_some_and(|last| t - last <= AT_ONCE * INSTANT * t.abs())
    }

    /// Records a reset on this surface at `t`.
    pub(super) fn lead_off(&mut self, surface: usize, t: f64) {
        self.ways[surface].arrive(t);
    }

    /// Records that a reset has led onto this surface, so that the way back takes no time that can be resolved. True if it
    /// follows ways that became shorter and shorter.
    pub(super) fn leads_back(&mut self, surface: usize) -> bool {
        let ways = core::mem::replace(&mut self.ways[surface], Ways::NONE);
        ways.shortened > SHRUNK
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
