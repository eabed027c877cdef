//! Certified motion: boxes that contain the state at every end of a step and after every impact, whatever rounding and truncation do.
//!
//! | file | job |
//! |---|---|
//! | `flow.rs` | steps: a tube that holds the motion, its Taylor series with remainder, the derivative by the start |
//! | `frame.rs` | a box that is turned with the motion (QR), so that boxes in boxes do not grow by themselves |
//! | `series.rs` | tubes, and series with remainder, of motions and of their derivatives |
//! | `course.rs` | gaps along a step: which surfaces are certainly not met |
//! | `crossing.rs` | the impact of all motions of a box: when, where, and the states at one time after it |
//! | `departure.rs` | the motions after it, and changes of states along them |
//! | `run.rs` | smooth motion and impacts by turns |
//! | `orbit.rs` | periodic orbits that exist and attract by proof |
//! | `lost.rs` | where certified motion ends, and why |
//!
//! What is certified is the motion by the equations, the surfaces and the laws of the model, with the doubles of its parameters or with
//! ranges about them. Intervals of coordinates (charts) are not looked at, and nothing is held at a surface.
//!
//! References: R. J. Lohner, *Computation of guaranteed enclosures for the solutions of ordinary initial and boundary value problems*,
//! in Computational Ordinary Differential Equations (1992); N. S. Nedialkov, K. R. Jackson, G. F. Corliss, *Validated solutions of
//! initial value problems for ordinary differential equations*, Applied Mathematics and Computation 105 (1999).

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
