//! Why a run does not begin.

use dalembert::integrate::ToleranceError;
use dalembert::{MaxStepError, StartError, StateError};
use thiserror::Error;

/// Why no motion of a model is certified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Uncertified {
    /// The model has no kernels over intervals.
    #[error(
        "certified motion runs models that are loaded from a text, and this one is compiled into the program; give the file of its declaration"
    )]
    Compiled,
    /// The global form of a model that has a reduced one.
    #[error(
        "certified motion takes the reduced form of this model; leave out what asks for the global one: --form global, --off-constraint keep"
    )]
    OnlyReduced,
    /// The scene was declared without what the derivatives of a motion take.
    #[error(
        "the scene was declared without `variations`, which certified motion takes; add it to what the scene uses"
    )]
    WithoutVariations,
    /// There is no thread with the stack that is needed.
    #[error("certified motion needs 16 MiB of stack, which the system does not give")]
    NoThread,
}

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
    /// No motion of the model is certified.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
}
