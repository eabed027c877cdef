//! Numbers of more than double precision.

mod decimal;
mod functions;
mod number;
mod sums;

pub use decimal::NotDecimal;
pub use number::{Extended, MOST_PARTS};
