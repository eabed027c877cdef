//! Dynamic programming on a grid: the least cost of a model with a state of two components, a held input and impacts (W.
//! Clark, thesis, sections 9.2 and 9.3).
//!
//! ```text
//! J_N(x) = g(x),   J_k(x) = min_u [ integral of l from t_k to t_{k+1} + J_{k+1}(x') ]
//! ```
//!
//! `l` is the running cost, `g` the terminal cost, and `x'` the end of the motion from `x` with the input `u` over the
//! step, including impacts. A motion must stay on the grid. The *margin* of a node is the largest distance to the edges
//! that motions from the node can keep. It is negative if all motions leave the grid. The margin is continuous at the
//! boundary of the set of nodes with a finite cost, so that it can be interpolated (level sets for problems with state
//! constraints; Altarovici, Bokanowski, Zidani 2013). Nodes with negative margin have the cost of the motion with the
//! largest margin, continued along the edge, so that costs can be interpolated near them.
//!
//! Everything except the motions is plain data, so that a caller can distribute the work over threads.
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
