//! Reasons why a run does not start.

use dalembert::erased::Excess;
use dalembert::integrate::ToleranceError;
use dalembert::{MaxStepError, StartError, StateError};
use thiserror::Error;

/// Reasons why no motion of a model can be certified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Uncertified {
    /// The model has no kernels over intervals.
    #[error(
        "certified motion needs a model that is loaded from a text, and this one is compiled into the program; give the file of its declaration"
    )]
    Compiled,
    /// The global form is requested for a model that can be certified in its reduced form only.
    #[error(
        "certified motion of this model needs the reduced form; leave out --form global and --off-constraint keep"
    )]
    OnlyReduced,
    /// The scene was declared without `variations`, which the derivatives of a motion need.
    #[error("certified motion needs `variations`; add it to the declaration of the scene")]
    WithoutVariations,
    /// The start of a model with constraints depends on a parameter with a range, so that one start does not belong to all
    /// values of the parameter.
    #[error(
        "the start depends on `{parameter}`: it satisfies the constraints, or follows from them, for one value of `{parameter}` only; certify single values with --set, or give ranges of all quasi-velocities"
    )]
    MovingStart {
        /// The name of the parameter.
        parameter: &'static str,
    },
    /// A parameter with a range and momenta in the reduced form.
    #[error(
        "quasi-velocities follow from momenta for single values of parameters only; give velocities (--qdot) with ranges of parameters"
    )]
    MomentaOfRanges,
    /// The operating system does not provide a thread with the required stack.
    #[error("certified motion needs 16 MiB of stack, which the system does not provide")]
    NoThread,
}

/// Reasons why a run does not start.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The state is refused.
    #[error(transparent)]
    State(#[from] StateError),
    /// The tolerance is invalid.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    /// The largest step is invalid.
    #[error(transparent)]
    MaxStep(#[from] MaxStepError),
    /// The runtime refuses the start.
    #[error(transparent)]
    Start(#[from] StartError),
    /// The model is too large for the computation, which is compiled for shorter vectors.
    #[error("the model has {0} in this computation")]
    Large(#[from] Excess),
    /// No motion of the model can be certified.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
}
