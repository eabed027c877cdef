//! What a run gives.

use crate::integrate::Counters;
use crate::outcome::Outcome;

/// A finished run: why and where it ended, in what state, and what it cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run<S> {
    /// Why it ended.
    pub outcome: Outcome,
    /// The time it ended at.
    pub t: f64,
    /// The last good state, at `t`; after an impact at `t`, the state after it.
    pub state: S,
    /// What it cost.
    pub counters: Counters,
}
