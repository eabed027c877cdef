//! Result of a run.

use crate::integrate::Counters;
use crate::outcome::Outcome;

/// A finished run: the reason, time and state of its end, and the work done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run<S> {
    /// Reason for the end.
    pub outcome: Outcome,
    /// Time at the end.
    pub t: f64,
    /// The last good state, at `t`; after an impact at `t`, the state after it.
    pub state: S,
    /// Work done.
    pub counters: Counters,
}
