//! The limit of impacts at one time that do not end by themselves.
//!
//! A light body between a piston and a heavy body is struck by both in turn, each time more slowly. The impulses that are left
//! push along the normals of the surfaces that are struck again and again, and cancel their gap rates: this determines their sum, and so the
//! state in the limit.

use super::held::Held;
use super::impulse::Impacts;
use crate::contract::Impacting;
use crate::effects::Moment;
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::policy::Rest;
use crate::state::StateVector;

/// Number of impacts without a limit after which there is none.
const MOST: u32 = 400;

/// Ratio of gap rates after and before an impact below which it loses speed.
const KEPT: f64 = 1.0 - 1.0 / (1 << 20) as f64;

/// Impacts at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave<G: StateVector> {
    count: u32,
    /// Number of the last impact on each surface, counted from 1.
    last: PerSurface<u32, G>,
    /// Number of impacts at the last limit.
    since: u32,
    /// Number of impacts at which a limit is sought next.
    next: u32,
    /// True if an impact has lost speed.
    is_lossy: bool,
}

impl<G: StateVector> Wave<G> {
    /// No impact, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            count: 0,
            last: PerSurface::all(like, 0),
            since: 0,
            next: 0,
            is_lossy: false,
        }
    }

    /// Counts an impact with these gap rates before and after it.
    pub(super) fn add(&mut self, surface: usize, [before, after]: [f64; 2]) {
        self.count += 1;
        self.last[surface] = self.count;
        self.is_lossy |= after.abs() < KEPT * before.abs();
    }

    /// True if impacts that return to an earlier state have lost speed: surfaces that close have added it.
    pub(super) fn is_lossy(&self) -> bool {
        self.is_lossy
    }

    /// Seeks a limit after this impact.
    pub(super) fn seek_limit(&mut self) {
        self.next = self.count;
    }

    /// The surfaces that were struck in the later half of the impacts.
    fn recurring(&self, like: &G) -> Held<G> {
        let begin = self.since.max(self.count / 2);
        let mut recurring = Held::none(like);
        for surface in (0..like.count()).filter(|&surface| self.last[surface] > begin) {
            recurring.hold(surface);
        }
        recurring
    }
}

/// Continuation of impacts at one time that do not end by themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Limit<G: StateVector> {
    /// The state is the limit; these surfaces are no longer approached.
    Reached(Held<G>),
    /// Further impacts.
    Later,
    /// Nothing: no limit is known.
    Unknown,
}

impl<Sys: Impacting> Impacts<Sys> {
    /// Sets the state to the limit of the impacts, if it is known. `surface` was struck last.
    pub(super) fn reach_limit(
        &self,
        wave: &mut Wave<Sys::Gaps>,
        surface: usize,
        now: &mut Moment<'_, Sys>,
    ) -> Result<Limit<Sys::Gaps>, Outcome> {
        if wave.count < wave.next {
            return Ok(Limit::Later);
        }
        let recurring = wave.recurring(&now.system.zero_gaps());
        if recurring.iter().nth(1).is_some()
            && let Some(limit) = recurring.limit(now)?
        {
            *now.state = limit;
            wave.since = wave.count;
            wave.next = wave.count + wave.count / 4;
            return Ok(Limit::Reached(recurring));
        }
        wave.next = 2 * wave.count;
        match self.policies.rest {
            Rest::Stop => Ok(Limit::Unknown),
            Rest::Contact if wave.count < MOST => Ok(Limit::Later),
            Rest::Contact if recurring.can_follow(now)? => Ok(Limit::Unknown),
            Rest::Contact => Err(Outcome::Squeezed { surface }),
        }
    }
}
