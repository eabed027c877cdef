//! The traits between generated code and runtime: one per effect, so that a scene contains only the code for its
//! declarations.
//!
//! Runge-Kutta methods use nothing but [`VectorField`]. Functions of the motion take the time; autonomous systems
//! ignore it.

mod constrained;
mod field;
mod impacting;
mod landing;
mod powered;
mod system;
mod tangent;
mod variational;
mod volume;

pub use constrained::Constrained;
pub use dalembert_numbers::tables::{Chart, Level};
pub use field::{TaylorField, VectorField};
pub use impacting::{Along, Impacting};
pub(crate) use landing::after_reset;
pub use powered::Powered;
pub(crate) use system::carried;
pub use system::{Keep, Lagrangian, RankDrop, System};
pub use tangent::Tangent;
pub use variational::Variational;
pub use volume::{Divergence, InvariantVolume};
