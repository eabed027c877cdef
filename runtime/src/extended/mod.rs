//! Double-double and longer arithmetic, and runs in it: a reference for digits that doubles have lost.
//!
//! An [`Extended`] number is the sum of a few doubles (double-double arithmetic for two). Generated code over
//! [`Numbers`](crate::numbers::Numbers), for power series, gaps and transitions, runs over these numbers too, with
//! every constant of the declaration in full precision. [`ExtendedSimulation`] uses it to run a system with
//! [`variations`](crate::Variational):
//!
//! - Smooth motion is summed from power series whose last terms are below the rounding of the numbers; times are
//!   summed in extended numbers too.
//! - The steps, rounded to doubles, are examined by the same effects as in any run: they find the surface that is met
//!   and an approximate time. The root of the gap is then refined, and the law in force acts, in extended numbers.
//! - Events that doubles cannot decide end the run with an [`Undefined`](crate::Undefined): a grazing impact, several
//!   surfaces hit at one time, motion that a surface holds, and a policy that adds to a law. An accumulation of
//!   impacts ends the run with its [`Outcome`](crate::Outcome) where the run in doubles detects it.
//!
//! Parameters and laws chosen for a run are doubles; so is a start, unless it is given in more digits. A projection
//! onto constraints acts on the rounded states only, since the extended motion satisfies the constraints to all its
//! digits. A motion that passes a kink of `|x|` has no series there: the run ends as
//! [`Outcome::StepUnderflow`](crate::Outcome::StepUnderflow). For a surface whose gap has a kink somewhere, grazing
//! impacts within the rounding of doubles are decided in doubles and not refused.
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
//! // The flights take the times 2 and 9/5.
//! let exact: Extended<3> = "3.8".parse()?;
//! assert!((last - exact).nearest().abs() < 1e-46);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod flight;
mod simulation;
mod stepper;

pub use dalembert_numbers::{Extended, MOST_PARTS, NotDecimal};
pub use simulation::{At, ExtendedRun, ExtendedSimulation, Impact};
