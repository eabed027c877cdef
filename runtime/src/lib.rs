//! Runtime of dalembert: integrates generated systems, `no_std`, without allocation.

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod contract;
pub mod describe;
pub mod effects;
pub mod error;
mod events;
mod generated;
pub mod impacts;
pub mod initial;
pub mod integrate;
mod linalg;
#[doc(hidden)]
pub mod math;
pub mod outcome;
pub mod projection;
pub mod record;
pub mod simulation;
pub mod state;

pub use contract::{Constrained, Divergence, Impacting, System, VectorField};
pub use describe::Described;
pub use effects::{Effect, Scene, SceneEffects};
pub use error::{Fault, ParameterError, StateError};
pub use impacts::Impacts;
pub use impacts::law::{Contact, Law};
pub use initial::complete_velocities;
pub use integrate::{Counters, Dop853, DormandPrince5, Stepper, Tolerance, ToleranceError};
pub use outcome::{Outcome, Run, StartError};
pub use projection::Projection;
pub use record::{Event, EventLog, Observer, Segment};
pub use simulation::Simulation;
pub use state::StateVector;

#[cfg(feature = "macros")]
pub use dalembert_macros::model;

/// What generated code names besides the public items. Not part of the interface.
#[doc(hidden)]
pub mod __private {
    pub use crate::generated::*;
    pub use crate::initial::complete_velocities;
    pub use crate::math;
    pub use nalgebra::SVector;
}
