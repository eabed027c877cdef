//! What the benchmarks share: the same mechanics written by hand, problems with known solutions, tables.
//!
//! How to run them, what they measure and what they do not show: `benches/README.md`.

#![forbid(unsafe_code)]

pub mod generated;
pub mod hand;
pub mod problems;
pub mod table;
pub mod timing;

/// The state of a system: `q`, then `p`.
pub type State<S> = <S as dalembert::VectorField>::State;
