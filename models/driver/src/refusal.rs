//! Why a run does not begin.

use dalembert::integrate::ToleranceError;
use dalembert::{MaxStepError, StartError, StateError};
use thiserror::Error;

/// Why a run does not begin.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// There is no such state.
    #[error(transparent)]
    State(#[from] StateError),
    /// The tolerance is none.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    /// The largest step is none.
    #[error(transparent)]
    MaxStep(#[from] MaxStepError),
    /// The runtime refuses the start.
    #[error(transparent)]
    Start(#[from] StartError),
}
