//! Shipped models as a programmer would write them by hand: functions of the components of the generated states.
//!
//! `rate`, `energy` and `impact` use the formulas of the generated code, written out for one model: they factorise the
//! metric and solve for the multipliers. Some models also have faster functions (`rate_in_frame`, `rate_by_links`, ..)
//! that use facts which the declaration does not state. Functions are generic over their [`Number`](number::Number), so
//! that their operations can be counted.

pub mod bead;
pub mod bouncing_ball;
pub mod chain;
pub mod chaplygin_sleigh;
pub mod double_pendulum;
pub mod harmonic_oscillator;
pub mod number;
pub mod point_billiard;
pub mod rolling_ball;
pub mod rolling_disk;
pub mod two_wheels;

#[cfg(test)]
mod agreement;
#[cfg(test)]
mod counted;
#[cfg(test)]
mod operations;
