//! Declarations through the stages of the generator: accepted, refused at the right token, compiled.
//!
//! | file | subject |
//! |---|---|
//! | `parser/` | the syntax tree; errors of syntax |
//! | `models.rs` | checked models, and the remarks on them |
//! | `check/` | errors of the check |
//! | `budget.rs` | algebra that is given up |
//! | `rank.rs`, `factors.rs` | derived facts: ranks of constraints, the factorised metric |
//! | `defaults.rs` | claims at the defaults of the parameters |
//! | `marks.rs` | marked places in sources |

// A test fails by panicking.
#![allow(clippy::unwrap_used)]

mod budget;
mod check;
mod defaults;
mod factors;
mod marks;
mod models;
mod parser;
mod rank;
