//! Events: where a gap, followed along the dense output of a step, falls through zero.
//!
//! A crossing is only ever reported with a witness: two times of which the earlier finds the gap not negative and
//! the later finds it negative. That none was overlooked is shown by bounding the gap between the samples
//! ([`crossing`]); where that cannot be shown, the stretch is halved ([`locate`]).

pub(crate) mod crossing;
pub(crate) mod locate;
pub(crate) mod resolution;
