//! Numbers that generated kernels compute in, below both the generator and the runtime.
//!
//! | file | job |
//! |---|---|
//! | `numbers.rs` | the contract: one number, or one of each of several lanes |
//! | `math.rs` | elementary functions of doubles, from the configured source |
//! | `lanes.rs` | vectors of eight doubles, with the feature `lanes` |
//! | `interval.rs` | intervals that contain every value, rounded outwards |
//! | `rated.rs` | intervals of values and of rates along a stretch of motion |
//! | `extended/` | sums of a few doubles: arithmetic, elementary functions, decimal text |

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod extended;
pub mod interval;
#[cfg(feature = "lanes")]
mod lanes;
pub mod math;
pub mod numbers;
pub mod rated;

pub use extended::{Extended, MOST_PARTS, NotDecimal};
pub use interval::Interval;
pub use numbers::Numbers;
pub use rated::Rated;
