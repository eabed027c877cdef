//! The traits between generated code and runtime: one per effect, so that a scene pays for what it declares.
//!
//! Only [`VectorField`] is known to integrators. Time is an argument everywhere; autonomous systems ignore it.

mod actuated;
mod constrained;
mod field;
mod impacting;
mod system;
mod variational;
mod volume;

pub use actuated::{Actuated, Powered};
pub use constrained::{Constrained, Level};
pub use field::{TaylorField, VectorField};
pub use impacting::Impacting;
pub use system::{Keep, Lagrangian, RankDrop, System};
pub use variational::Variational;
pub use volume::{Divergence, InvariantVolume};
