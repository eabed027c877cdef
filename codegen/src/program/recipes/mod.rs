//! Composition of each emitted function. There is one recipe per function. Quantities that functions share come from
//! the kernel.

pub mod blow;
pub mod constrained;
pub mod declared;
pub mod geometry;
pub mod gradient;
pub mod impact;
mod instantaneous;
pub mod motion;
pub mod powers;
pub mod reduced;
pub mod volume;

pub use geometry::{Geometry, Group};
