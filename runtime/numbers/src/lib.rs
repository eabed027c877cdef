//! Definitions shared by generator and runtime: the numbers of generated kernels, the names of kernels, and the tables
//! of a model.
//!
//! | file | job |
//! |---|---|
//! | `numbers.rs` | the contract: one number, or one number in each of several lanes |
//! | `math.rs` | elementary functions of doubles, from the configured source |
//! | `lanes.rs` | vectors of eight doubles, with the feature `lanes` |
//! | `interval.rs` | intervals that contain every value, rounded outwards |
//! | `smooth.rs` | functions with their derivatives, for numbers that carry derivatives |
//! | `rated.rs` | intervals of values and of rates along a part of the motion |
//! | `everywhere.rs` | intervals of values at all states, with a flag for sharp variation |
//! | `bent.rs` | intervals of values, first and second derivatives along lines through a box |
//! | `complex_interval.rs` | rectangles of complex numbers about the real axis, which bound power series |
//! | `taylor_model.rs` | cubics along a part of the motion, with bounds of the error of values and rates |
//! | `tables.rs` | data of a form of a model besides its functions |
//! | `description.rs` | self-description of a model |
//! | `law.rs`, `assumption.rs` | laws of impacts, conditions on parameters |
//! | `held.rs` | constants, or owned values |
//! | `kernel.rs` | the names of a model's functions, shared by generator and runtime |
//! | `extended/` | sums of a few doubles: arithmetic, elementary functions, decimal text |

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

mod assumption;
pub mod bent;
pub mod complex_interval;
pub mod description;
pub mod everywhere;
pub mod extended;
pub mod held;
pub mod interval;
pub mod kernel;
#[cfg(feature = "lanes")]
mod lanes;
pub mod law;
pub mod math;
pub mod numbers;
pub mod rated;
pub mod smooth;
pub mod tables;
pub mod taylor_model;

pub use bent::Bent;
pub use complex_interval::ComplexInterval;
pub use everywhere::Everywhere;
pub use extended::{Extended, MOST_PARTS, NotDecimal};
pub use held::{Held, Shared};
pub use interval::Interval;
pub use kernel::Kernel;
pub use numbers::Numbers;
pub use rated::Rated;
pub use taylor_model::TaylorModel;
