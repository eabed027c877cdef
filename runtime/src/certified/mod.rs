//! Certified motion: boxes that provably contain the state at the end of every step and after every impact, including
//! rounding and truncation errors.
//!
//! | file | job |
//! |---|---|
//! | `flow.rs` | steps: a tube around the motion, its Taylor series with remainder, derivatives with respect to the start |
//! | `frame.rs` | a box that is rotated with the motion (QR), against the wrapping effect |
//! | `series.rs` | tubes, and series with remainder, of motions and of their derivatives |
//! | `course.rs` | gaps along a step: surfaces that are certainly not met |
//! | `crossing.rs` | the impact of all motions of a box: times, places, and the states at one time after it |
//! | `departure.rs` | the motions after an impact, and derivatives of states along them |
//! | `run.rs` | smooth motion and impacts in turn |
//! | `orbit.rs` | proofs that periodic orbits exist and attract |
//! | `lost.rs` | end of certified motion, and its reason |
//!
//! The certificate holds for the equations, surfaces and laws of the model, with parameters that are doubles or ranges.
//! Intervals of coordinates (charts) are not checked. Contact is not certified: a motion that a surface may hold is
//! [`Lost`].
//!
//! References: R. J. Lohner, *Computation of guaranteed enclosures for the solutions of ordinary initial and boundary
//! value problems*, in Computational Ordinary Differential Equations (1992); N. S. Nedialkov, K. R. Jackson, G. F.
//! Corliss, *Validated solutions of initial value problems for ordinary differential equations*, Applied Mathematics
//! and Computation 105 (1999).

mod course;
mod crossing;
mod departure;
mod flow;
mod frame;
mod lost;
mod orbit;
mod run;
mod series;

pub use flow::CertifiedFlow;
pub use lost::{Lost, Reason};
pub use orbit::{CertifiedOrbit, CertifiedSection, NotProved};
pub use run::{CertifiedImpact, CertifiedRun};
