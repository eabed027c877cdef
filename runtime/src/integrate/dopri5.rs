//! Dormand-Prince pair of order 5 with an error estimate of order 4, and fourth-order dense output from the stages of
//! the step.
//!
//! J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, 1980; dense output by L. F. Shampine
//! (Hairer, Norsett, Wanner I, II.5, II.6).

use super::controller::Control;
use super::dense::{Cubic, Polynomial};
use super::embedded::{Counted, Embedded, Scheme, Span};
use super::precise::Precise;
use super::tableau::{
    Term, combine, larger, make_stages, rounding, subtract_first, sum, weigh_beyond_rounding,
};
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
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

/// Weights of the fifth-order solution. The weights 500/1113, 125/192, -2187/6784 and 11/84 are changed by a few units
/// in their last places, so that `sum b_i c_i` differs from 1/2 by 1/400 of a rounding error. Under constant forces, a
/// deviation of this sum would shift every step by the same amount.
const B: [Term; 5] = [
    (0, 35.0 / 384.0),
    (2, 0.449_236_298_292_902_57),
    (3, 0.651_041_666_666_665_9),
    (4, -0.322_376_179_245_282_45),
    (5, 0.130_952_380_952_380_9),
];

/// Error estimate: fifth-order weights minus those of the fourth-order solution, which also uses the rate at the end.
const E: [Term; 6] = [
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339200.0),
    (5, 22.0 / 525.0),
    (6, E_LAST),
];

/// Entry of [`E`] for the rate at the end.
const E_LAST: f64 = -1.0 / 40.0;

/// The fourth coefficient of dense output. The other coefficients follow from the ends.
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
    const WEIGHTS: &'static [Term] = &B;
    const NODES: &'static [f64] = &NODES;
    const LAST: usize = 6;
    const ERROR_TAKES_LAST: bool = true;
    const DENSE_ERROR: f64 = 1.0;
    const CONTROL: Control = Control {
        power: 5.0,
        beta: 0.04,
        shrink: 0.2,
        grow: 10.0,
    };

    type Stages<S: StateVector> = [S; STAGES];
    type Dense<S: StateVector> = Polynomial<S, 4>;

    fn stages<S: StateVector>(like: &S) -> Self::Stages<S> {
        [like.zeroed(); STAGES]
    }

    fn dense<S: StateVector>(like: &S) -> Self::Dense<S> {
        Polynomial::zero(like)
    }

    #[inline(always)]
    fn advance<F: VectorField>(
        field: &mut Counted<'_, F>,
        t: f64,
        h: f64,
        start: &F::State,
        stages: &mut [F::State],
        inside: &mut F::State,
    ) -> Result<(), Fault> {
        make_stages!(field, (t, h, start), stages, inside, NODES: 1 A1 2 A2 3 A3 4 A4 5 A5);
        Ok(())
    }

    #[inline(always)]
    fn error<S: StateVector>(h: f64, stages: &[S], allowed: impl Fn(usize) -> f64) -> f64 {
        let mut largest = 0.0;
        for i in 0..stages[0].count() {
            // The last stage is a rate, not a difference. The entries of `E` add up to 0.
            let ending = stages[Self::LAST].as_slice()[i] - stages[0].as_slice()[i];
            let error = sum(stages, &E[..5], i) + E_LAST * ending;
            let ratio = h * error / allowed(i);
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
        let h = span.h;
        for i in 0..stages[0].count() {
            let first = stages[0].as_slice()[i];
            let mut gains = [0.0; STAGES];
            let mut size = (h * first).abs();
            for &(j, _) in &D[1..] {
                let rate = stages[j].as_slice()[i];
                gains[j] = h * if j == Self::LAST { rate - first } else { rate };
                size = larger(size, gains[j].abs());
            }
            let cubic = Cubic {
                rate: h * first,
                bend: span.bend(stages, &B, i),
                gained: gains[Self::LAST],
                rounding: rounding(size, &B),
            };
            dense.set_cubic(i, span.start, cubic);
            for &(j, _) in &D[1..] {
                gains[j] = dense.beside_cubic(NODES[j], gains[j], i);
            }
            dense.coefficients[3].as_mut_slice()[i] = weigh_beyond_rounding(&gains, &D, size);
        }
        Ok(())
    }

    fn dense_powers<S: StateVector>(dense: &Self::Dense<S>, powers: &mut [S; LENGTH]) -> usize {
        dense.powers(powers)
    }

    #[inline(always)]
    fn dense_at<S: StateVector>(dense: &Self::Dense<S>, theta: f64) -> Precise<S> {
        dense.precisely_at(theta)
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
        check::constant_forces_shift_no_step(&B, &NODES);
        check::estimate_has_order(4, &E, &NODES);
    }
}
