//! Stage 3b, prove or refute: what a model's author claims about it.
//!
//! | file | job |
//! |---|---|
//! | `problem.rs` | what an invariant density depends on |
//! | `linear.rs`, `frame.rs`, `closure.rs` | the frame of D as series, and its hull under brackets |
//! | `exactness.rs` | does a local density exist? |
//! | `potential.rs`, `global.rs` | the density in closed form; is it single-valued? |
//! | `dynamics.rs` | the motion on D at a point |
//! | `obstruction.rs`, `sample.rs` | why there is none, at a point that a person can follow |

mod closure;
pub mod dynamics;
pub mod exactness;
mod frame;
mod global;
mod linear;
mod obstruction;
mod potential;
pub mod problem;
mod sample;

pub use dynamics::{Dynamics, Motion};
pub use exactness::{Exactness, Local, Undecided, decide, decide_local};
pub use global::Global;
pub use obstruction::{Obstruction, find_obstruction};
pub use potential::{Certified, Potential, Term};
pub use problem::Problem;
pub use sample::Sample;
