//! Declarations that tests transform, as texts.
//!
//! | file | subject |
//! |---|---|
//! | `bodies.rs` | rigid bodies and trains |
//! | `visible.rs` | systems with known verdicts on their densities |
//! | `expansion.rs` | test: the cost of expanding declarations |

#![forbid(unsafe_code)]

pub mod bodies;
pub mod visible;
