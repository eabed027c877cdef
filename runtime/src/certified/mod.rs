//! Certified motion: boxes that contain the state at every end of a step, whatever rounding and truncation do.
//!
//! | file | job |
//! |---|---|
//! | `flow.rs` | steps: a tube that holds the motion, its Taylor series with remainder, the derivative by the start |
//! | `frame.rs` | a box that is turned with the motion (QR), so that boxes in boxes do not grow by themselves |
//!
//! References: R. J. Lohner, *Computation of guaranteed enclosures for the solutions of ordinary initial and boundary value problems*,
//! in Computational Ordinary Differential Equations (1992); N. S. Nedialkov, K. R. Jackson, G. F. Corliss, *Validated solutions of
//! initial value problems for ordinary differential equations*, Applied Mathematics and Computation 105 (1999).
//!
//! Smooth motion alone is certified, not impacts.

mod flow;
mod frame;
mod lost;
mod series;

pub use flow::CertifiedFlow;
pub use lost::{Lost, Reason};
