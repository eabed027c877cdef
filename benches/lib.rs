//! Items that the benchmarks share: the same mechanics written by hand, problems with known solutions, tables.
//!
//! Their use, their measurements and the limits of those: `benches/README.md`.

#![forbid(unsafe_code)]

pub mod generated;
pub mod hand;
pub mod problems;
pub mod table;
pub mod timing;

/// The state of a system: `q`, then `p`.
pub type State<S> = <S as dalembert::VectorField>::State;
