//! Numbers of more than double precision: sums of a few doubles.
mod decimal;
mod functions;
mod number;
mod sums;

pub use decimal::NotDecimal;
pub use number::{Extended, MOST_PARTS};
