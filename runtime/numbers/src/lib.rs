//! Numbers that generated kernels compute in, below both the generator and the runtime.
//!
//! | file | job |
//! |---|---|
//! | `numbers.rs` | the contract: one number, or one of each of several lanes |
//! | `math.rs` | elementary functions of doubles, from the configured source |
//! | `lanes.rs` | vectors of eight doubles, with the feature `lanes` |
//! | `extended/` | sums of a few doubles: arithmetic, elementary functions, decimal text |

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod extended;
#[cfg(feature = "lanes")]
mod lanes;
pub mod math;
pub mod numbers;

pub use extended::{Extended, MOST_PARTS, NotDecimal};
pub use numbers::Numbers;
