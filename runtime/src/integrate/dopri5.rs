//! Dormand and Prince, order 5 with an error of order 4, fourth-order dense output from the stages of the step.
//!
//! J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, 1980; dense output by L. F. Shampine
//! (Hairer, Norsett, Wanner I, II.5, II.6).

use super::controller::Control;
use super::dense::Polynomial;
use super::embedded::{Counted, Embedded, Scheme, Span};
use super::tableau::{Term, combine, larger, sum, weigh};
use crate::contract::VectorField;
use crate::error::Fault;
use crate::state::StateVector;

/// The integrator of choice at loose tolerances.
pub type DormandPrince5<S> = Embedded<S, DormandPrince5Scheme>;

/// The coefficients of [`DormandPrince5`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DormandPrince5Scheme;

/// Stages of the step (0 to 5) and the rate at its end (6).
const STAGES: usize = 7;

const NODES: [f64; STAGES] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

const A1: [Term; 1] = [(0, 1.0 / 5.0)];
const A2: [Term; 2] = [(0, 3.0 / 40.0), (1, 9.0 / 40.0)];
const A3: [Term; 3] = [(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)];
const A4: [Term; 4] = [
    (0, 19372.0 / 6561.0),
    (1, -25360.0 / 2187.0),
    (2, 64448.0 / 6561.0),
    (3, -212.0 / 729.0),
];
const A5: [Term; 5] = [
    (0, 9017.0 / 3168.0),
    (1, -355.0 / 33.0),
    (2, 46732.0 / 5247.0),
    (3, 49.0 / 176.0),
    (4, -5103.0 / 18656.0),
];

/// Weights of the fifth-order solution.
const B: [Term; 5] = [
    (0, 35.0 / 384.0),
    (2, 500.0 / 1113.0),
    (3, 125.0 / 192.0),
    (4, -2187.0 / 6784.0),
    (5, 11.0 / 84.0),
];

/// Fifth-order weights minus those of the fourth-order solution, which uses the rate at the end too.
const E: [Term; 6] = [
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];

/// The fourth coefficient of dense output; the others follow from the ends.
const D: [Term; 6] = [
    (0, -12715105075.0 / 11282082432.0),
    (2, 87487479700.0 / 32700410799.0),
    (3, -10690763975.0 / 1880347072.0),
    (4, 701980252875.0 / 199316789632.0),
    (5, -1453857185.0 / 822651844.0),
    (6, 69997945.0 / 29380423.0),
];

impl Scheme for DormandPrince5Scheme {
    const NAME: &'static str = "dopri5";
    const ORDER: usize = 5;
    const DENSE_ORDER: usize = 4;
    const LAST: usize = 6;
    const ERROR_TAKES_LAST: bool = true;
    const CONTROL: Control = Control {
        power: 5.0,
        beta: 0.04,
        shrink: 0.2,
        grow: 10.0,
    };

    type Stages<S: StateVector> = [S; STAGES];
    type Dense<S: StateVector> = Polynomial<S, 4>;

    fn stages<S: StateVector>() -> Self::Stages<S> {
        [S::zeros(); STAGES]
    }

    fn dense<S: StateVector>() -> Self::Dense<S> {
        Polynomial::zero()
    }

    #[inline(always)]
    fn advance<F: VectorField>(
        field: &mut Counted<'_, F>,
        t: f64,
        h: f64,
        start: &F::State,
        stages: &mut [F::State],
        end: &mut F::State,
    ) -> Result<(), Fault> {
        macro_rules! stage {
            ($($index:literal $row:ident)*) => {$(
                combine(start, h, stages, &$row, end);
                field.rate(t + NODES[$index] * h, end, &mut stages[$index])?;
            )*};
        }
        stage! { 1 A1 2 A2 3 A3 4 A4 5 A5 }
        combine(start, h, stages, &B, end);
        Ok(())
    }

    #[inline(always)]
    fn error<S: StateVector>(h: f64, stages: &[S], allowed: impl Fn(usize) -> f64) -> f64 {
        let mut largest = 0.0;
        for i in 0..S::LEN {
            let ratio = h * sum(stages, &E, i) / allowed(i);
            largest = larger(largest, ratio.abs());
        }
        largest
    }

    #[inline(always)]
    fn build_dense<F: VectorField>(
        _: &mut Counted<'_, F>,
        span: Span<'_, F::State>,
        stages: &mut [F::State],
        dense: &mut Self::Dense<F::State>,
    ) -> Result<(), Fault> {
        let Span { h, start, end, .. } = span;
        dense.set_cubic(h, [start, end], [&stages[0], &stages[Self::LAST]]);
        for i in 0..F::State::LEN {
            let mut beside = [0.0; STAGES];
            for &(j, _) in &D {
                beside[j] = dense.beside_cubic(h, NODES[j], &stages[j], i);
            }
            dense.coefficients[3].as_mut_slice()[i] = weigh(&beside, &D);
        }
        Ok(())
    }

    #[inline(always)]
    fn interpolate<S: StateVector>(dense: &Self::Dense<S>, theta: f64) -> S {
        dense.at(theta)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tableau::check;
    use super::*;

    const ROWS: [&[Term]; STAGES] = [&[], &A1, &A2, &A3, &A4, &A5, &B];

    #[test]
    fn table_satisfies_its_order_conditions() {
        check::rows_sum_to_nodes(&ROWS, &NODES);
        check::weights_have_order(5, &B, &ROWS, &NODES);
        check::estimate_has_order(4, &E, &NODES);
    }
}
