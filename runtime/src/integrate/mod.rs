//! Integrators: one step of a [`VectorField`](crate::VectorField), with error control and dense output.
//!
//! [`Stepper`] is all that the driver knows of them. [`Dop853`] and [`DormandPrince5`] are [`Embedded`] Runge-Kutta
//! pairs: a [`Scheme`] brings the coefficients, [`Embedded`] the step, its control and its failures. [`Taylor`] sums
//! power series whose coefficients are generated with the vector field
//! ([`TaylorField`](crate::TaylorField)).

mod controller;
mod dense;
mod dop853;
mod dop853_tableau;
mod dopri5;
mod embedded;
mod stats;
mod stepper;
mod tableau;
mod taylor;
mod tolerance;

pub use dense::Polynomial;
pub use dop853::{Dop853, Dop853Scheme};
pub use dopri5::{DormandPrince5, DormandPrince5Scheme};
pub use embedded::{Embedded, Scheme};
pub use stats::Counters;
pub use stepper::{Series, StepFailure, Stepper};
pub use taylor::{TAYLOR, Taylor};
pub use tolerance::{Tolerance, ToleranceError};
