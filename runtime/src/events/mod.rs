//! Events: where a gap, followed along the dense output of a step, falls through zero.
//!
//! A crossing is only ever reported with a witness: two times of which the earlier finds the gap not negative and
//! the later finds it negative. That none was overlooked is shown by Taylor models of the gap along the motion ([`path`]): all its
//! values and rates on a stretch of the step ([`piece`]); where these do not tell, the stretch is halved ([`locate`]).

pub(crate) mod bends;
pub(crate) mod crossing;
pub(crate) mod haven;
pub(crate) mod locate;
pub(crate) mod path;
pub(crate) mod piece;
pub(crate) mod resolution;
pub(crate) mod room;
pub(crate) mod sampled;
mod stretches;
