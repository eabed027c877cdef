//! Runtime of dalembert: integrates generated systems, `no_std`, without allocation.

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod contract;
pub mod describe;
pub mod error;
pub mod impacts;
#[doc(hidden)]
pub mod math;
pub mod state;

pub use contract::{Constrained, Divergence, Impacting, System, VectorField};
pub use error::{Fault, ParameterError, StateError};

/// What generated code names besides the public items. Not part of the interface.
#[doc(hidden)]
pub mod __private {
    pub use crate::math;
    pub use nalgebra::SVector;
}
