//! Event location: falls of a gap through zero along the dense output of a step.
//!
//! Every reported crossing has a witness: two times such that the gap is not negative at the earlier and negative at
//! the later one. Taylor models of the gap along the motion ([`path`]) enclose the gap's values and rates on a stretch
//! of the step ([`piece`]). They show that no crossing was overlooked. Stretches that these models do not decide are
//! halved ([`locate`]). If a step is a power series, the gap is one too. A bound of its truncated terms ([`tails`])
//! then makes its signs certain without a Taylor model.

pub(crate) mod bends;
pub(crate) mod crossing;
pub(crate) mod first;
pub(crate) mod haven;
pub(crate) mod locate;
pub(crate) mod path;
pub(crate) mod piece;
pub(crate) mod polynomials;
pub(crate) mod resolution;
pub(crate) mod room;
pub(crate) mod sampled;
mod stretches;
pub(crate) mod tails;
