//! Integrators: one step of a [`VectorField`](crate::VectorField), with dense output.
//!
//! [`Stepper`] is the only interface that the driver uses. [`Embedded`] implements it for Runge-Kutta pairs with an
//! error estimate, whose coefficients come from a [`Scheme`]; [`FixedStep`] for methods with a fixed step size, whose
//! step comes from a [`Method`]. They contain the code that their methods share: step sizes, failures, dense output.
//! [`Taylor`] sums power series whose coefficients are generated with the vector field
//! ([`TaylorField`](crate::TaylorField)).

mod chosen;
mod collision;
pub(crate) mod controller;
mod dense;
mod dop853;
mod dop853_tableau;
mod dopri5;
mod embedded;
mod ends;
mod fixed;
mod gauss;
mod instant;
mod iteration;
mod lagrange_d_alembert;
pub(crate) mod order;
mod precise;
mod rk4;
pub(crate) mod rough;
mod stats;
mod stepper;
mod tableau;
pub(crate) mod taylor;
mod tolerance;
mod work;

pub use chosen::Chosen;
pub use controller::MaxStepError;
pub use dense::Polynomial;
pub use dop853::{Dop853, Dop853Scheme};
pub use dopri5::{DormandPrince5, DormandPrince5Scheme};
pub use embedded::{Embedded, Scheme};
pub use fixed::{AUTOMATIC_STEPS, Advance, FixedStep, Method};
pub use gauss::{Gauss, Gauss4, Gauss6};
pub use instant::Instant;
pub use lagrange_d_alembert::{ComposedPrinciple, Dla2, Dla4, MidpointPrinciple};
pub use rk4::{ClassicalRungeKutta, Rk4};
pub use stats::Counters;
pub use stepper::{EnergyAt, GapAt, Rebound, Series, StepFailure, Stepper};
#[cfg(feature = "lanes")]
pub(crate) use taylor::lanes;
pub use taylor::{TAYLOR, Taylor};
pub use tolerance::{Tolerance, ToleranceError};
pub use work::{counted_work, taylor_to_dop853};
