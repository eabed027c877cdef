//! Numbers of more than double precision, and runs in them: a reference for digits that doubles have lost.
//!
//! An [`Extended`] number is the sum of a few doubles. Whatever generated code computes over
//! [`Numbers`](crate::numbers::Numbers), power series, gaps and transitions, it computes in them too, with every
//! constant of the declaration to so many digits. [`ExtendedSimulation`] runs a system with
//! [`variations`](crate::Variational) so:
//!
//! - Smooth motion is summed from power series whose last terms are below the rounding of the numbers; times add up in
//!   extended numbers too.
//! - The steps, rounded to doubles, are watched by the same effects as those of any run: they find the surface that is met,
//!   and about when. The root of the gap is then refined, and the law in force acts, in extended numbers.
//! - What cannot be told within the rounding of doubles is not decided: grazes, several surfaces at one time,
//!   motion that is held on a surface and what a policy adds to a law end the run with an [`Undefined`](crate::Undefined).
//!   So do accumulations with their [`Outcome`](crate::Outcome), where doubles see them.
//!
//! Parameters and laws chosen for a run are doubles; so is a start, unless it is given in more digits. A projection to
//! constraints acts on the rounded states alone: the motion keeps to them by all its digits. At a kink of `|x|`
//! that the motion passes, series end: the run ends as [`Outcome::StepUnderflow`](crate::Outcome::StepUnderflow). Of a surface
//! whose gap has a kink somewhere, grazes within the rounding of doubles are decided by these, and not refused.
//!
//! ```
//! use core::ops::ControlFlow;
//!
//! use dalembert::extended::{At, Extended, ExtendedSimulation};
//! use dalembert::{Scene, System, model};
//!
//! model! {
//!     /// A ball over a floor that takes a tenth of its speed.
//!     pub Ball {
//!         coordinates { x; }
//!         lagrangian = dot(x)^2/2 - x;
//!         impacts { floor: x >= 0 => newton(9/10); }
//!     }
//! }
//!
//! let ball = Ball {};
//! let start = At::<_, 3>::of(0.0, &ball.state(0.0, &[0.0].into(), &[1.0].into())?);
//! let mut last = start.t;
//! let run = ExtendedSimulation::new(&ball, ball.effects()).run(start, 4.0, |impact| {
//!     last = impact.t;
//!     ControlFlow::Continue(())
//! })?;
//! assert!(run.outcome.is_ok_and(|outcome| outcome.is_done()));
//! // Flights of 2 and 9/5.
//! let exact: Extended<3> = "3.8".parse()?;
//! assert!((last - exact).nearest().abs() < 1e-46);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod flight;
mod simulation;
mod stepper;

pub use dalembert_numbers::{Extended, MOST_PARTS, NotDecimal};
pub use simulation::{At, ExtendedRun, ExtendedSimulation, Impact};
