//! Classical Runge-Kutta method of order 4: explicit, with fixed step, for teaching and for comparison.
//!
//! ```text
//! k1 = f(t, y),  k2 = f(t + h/2, y + h k1/2),  k3 = f(t + h/2, y + h k2/2),  k4 = f(t + h, y + h k3)
//! y1 = y + h (k1 + 2 k2 + 2 k3 + k4)/6
//! ```
//!
//! References: W. Kutta, *Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen*, 1901; Hairer,
//! Norsett, Wanner I, II.1.

use super::embedded::Counted;
use super::fixed::{Advance, Departure, FixedStep, Method, evaluate};
use super::precise::Precise;
use super::stepper::StepFailure;
use crate::contract::VectorField;
use crate::state::StateVector;

/// The classical Runge-Kutta method: order 4, dense output of order 4, four evaluations per step.
///
/// It preserves linear invariants only: the energy error grows linearly in time, and constraints hold to order 4, as
/// the solution does. Use it for comparisons, and where a well-known method is required. [`Dop853`](super::Dop853) is
/// more accurate for the same work and estimates its error.
///
/// # References
/// Hairer, Norsett, Wanner, *Solving ordinary differential equations I*, II.1, Table 1.2.
pub type Rk4<S> = FixedStep<S, ClassicalRungeKutta>;

/// The step of [`Rk4`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClassicalRungeKutta;

impl Method for ClassicalRungeKutta {
    const NAME: &'static str = "rk4";
    const ORDER: usize = 4;
    const DENSE_ORDER: usize = 4;
    const REFINEMENTS: u32 = 1;

    type Memory<S: StateVector> = ();

    fn memory<S: StateVector>(_: &S) -> Self::Memory<S> {}
}

/// Stages after the first: the fraction of the step that leads to each, and six times its weight.
const STAGES: [(f64, f64); 3] = [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];

impl<F: VectorField> Advance<F> for ClassicalRungeKutta {
    fn advance(
        field: &mut Counted<'_, F>,
        h: f64,
        departure: &Departure<'_, F::State>,
        (): &mut (),
    ) -> Result<Precise<F::State>, StepFailure> {
        let Departure { t, state, rate, .. } = *departure;
        let (mut slope, mut sum) = (*rate, *rate);
        for (part, weight) in STAGES {
            let mut inside = state.value;
            let plus = |i| inside.padded_mut()[i] = state.plus(i, part * h * slope.padded()[i]);
            rate.for_each_place(plus);
            evaluate(field, t + part * h, &inside, &mut slope)?;
            rate.for_each_place(|i| sum.padded_mut()[i] += weight * slope.padded()[i]);
        }
        Ok(state.advanced(|i| h * sum.padded()[i] / 6.0))
    }
}
