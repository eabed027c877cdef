//! A few models as one would write them by hand: functions of the state `(q, p)` of the generated ones.
//!
//! `rate`, `energy` and `impact` use the formulas of the generated code, written out for one model: the metric
//! factorised, the multipliers solved for. Where somebody who knows the model would do better, that is written too:
//! `rate_in_frame`, `rate_by_links`, .. use facts that the declaration does not say.

pub mod chain;
pub mod chaplygin_sleigh;
pub mod double_pendulum;
pub mod point_billiard;
pub mod rolling_disk;

#[cfg(test)]
mod agreement;
