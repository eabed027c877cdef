//! Items shared by the benchmarks: equations of shipped models written by hand, problems with known
//! solutions, tables.
//!
//! `benches/README.md` describes their use, the measurements, and the limits of the measurements.

#![forbid(unsafe_code)]

pub mod generated;
pub mod hand;
pub mod problems;
pub mod table;
pub mod timing;

/// The state of a system: `(q, p)`, or `(q, u)` for a model that runs on D.
pub type State<S> = <S as dalembert::VectorField>::State;
