//! Dynamic programming on a grid: the least cost of a model with a state of two components, held inputs and impacts
//! (thesis, sections 9.2 and 9.3).
//!
//! ```text
//! J_N(x) = g(x),   J_k(x) = min_u [ integral of l from t_k to t_{k+1} + J_{k+1}(x') ]
//! ```
//!
//! `x'` is where the motion from `x` with the input `u` is after the step, with the impacts in it. A motion must stay on the
//! grid. The *margin* of a node tells whether one does: it is the largest distance to the edges that motions from there can keep,
//! negative if all of them leave. It is continuous, where the least cost of motions that stay has an end; so it is what is
//! interpolated (level sets for problems with state constraints; Altarovici, Bokanowski, Zidani 2013). Nodes of negative margin
//! keep the cost of the motion that stays longest, along the edge from there on, so that costs can be interpolated beside them.
//!
//! All of it is plain data except the motions, so that a caller may share the work among threads.
//!
//! | file | job |
//! |---|---|
//! | `lattice.rs` | axes, and values between their nodes |
//! | `legs.rs` | motions over a step |
//! | `choice.rs` | the best input of a state |

mod choice;
mod lattice;
mod legs;

pub use choice::{Choice, Layer, Move, choose};
pub use lattice::{Axis, Lattice};
pub(crate) use legs::Walker;
pub use legs::{Hit, Landing, Leg, Unlanded};
