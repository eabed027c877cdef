//! The shipped models as one would write them by hand: functions of the components of the generated states.
//!
//! `rate`, `energy` and `impact` use the formulas of the generated code, written out for one model: the metric
//! factorised, the multipliers solved for. Where somebody who knows the model would do better, that is written too:
//! `rate_in_frame`, `rate_by_links`, .. use facts that the declaration does not say. Functions are generic over their
//! [`Number`](number::Number), so that their operations can be counted.

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
