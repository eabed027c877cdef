//! Dormand-Prince pair of order 8 with error estimates of orders 5 and 3, and seventh-order dense output.
//!
//! Only steps that need dense output evaluate its three extra stages. Reference: Hairer, Norsett, Wanner I, II.5, II.6.
//! The coefficients are in `dop853_tableau.rs`.

use super::controller::Control;
use super::dense::{Cubic, Polynomial};
use super::dop853_tableau::*;
use super::embedded::{Counted, Embedded, Scheme, Span};
use super::precise::Precise;
use super::tableau::{
    Term, combine, larger, make_stages, rounding, subtract_first, sum, weigh_beyond_rounding,
};
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::math;
use crate::state::StateVector;

/// Recommended integrator at tolerances below 1e-6.
pub type Dop853<S> = Embedded<S, Dop853Scheme>;

/// The coefficients of [`Dop853`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dop853Scheme;

/// Stages of the step (0 to 11), the rate at its end (12), the extra stages (13 to 15).
const STAGES: usize = 16;

impl Scheme for Dop853Scheme {
    const NAME: &'static str = "dop853";
    const ORDER: usize = 8;
    const DENSE_ORDER: usize = 7;
    const WEIGHTS: &'static [Term] = &B;
    const NODES: &'static [f64] = &NODES;
    const LAST: usize = 12;
    const ERROR_TAKES_LAST: bool = false;
    const DENSE_ERROR: f64 = 1024.0;
    const CONTROL: Control = Control {
        power: 8.0,
        beta: 0.0,
        shrink: 0.333,
        grow: 6.0,
    };

    type Stages<S: StateVector> = [S; STAGES];
    type Dense<S: StateVector> = Polynomial<S, 7>;

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
        make_stages!(field, (t, h, start), stages, inside, NODES: 1 A1 2 A2 3 A3 4 A4 5 A5 6 A6 7 A7 8 A8 9 A9 10 A10 11 A11);
        Ok(())
    }

    /// `|h| e5^2 / sqrt(e5^2 + e3^2 / 100)`, an estimate of order 8 from estimates of orders 5 and 3. `e5` and `e3` are
    /// the largest ratios of estimated to allowed errors over all components.
    #[inline(always)]
    fn error<S: StateVector>(h: f64, stages: &[S], allowed: impl Fn(usize) -> f64) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for i in 0..stages[0].count() {
            let weight = 1.0 / allowed(i);
            let e5 = sum(stages, &E5, i) * weight;
            let e3 = sum(stages, &E3, i) * weight;
            fifth = larger(fifth, e5 * e5);
            third = larger(third, e3 * e3);
        }
        if fifth == 0.0 && third == 0.0 {
            return 0.0;
        }
        h.abs() * fifth / math::sqrt(fifth + 0.01 * third)
    }

    #[inline(always)]
    fn build_dense<F: VectorField>(
        field: &mut Counted<'_, F>,
        span: Span<'_, F::State>,
        stages: &mut [F::State],
        dense: &mut Self::Dense<F::State>,
    ) -> Result<(), Fault> {
        let last = stages[Self::LAST];
        subtract_first(stages, Self::LAST);
        let built = fill_dense(field, span, stages, dense);
        stages[Self::LAST] = last;
        built
    }

    fn dense_powers<S: StateVector>(dense: &Self::Dense<S>, powers: &mut [S; LENGTH]) -> usize {
        dense.powers(powers)
    }

    #[inline(always)]
    fn dense_at<S: StateVector>(dense: &Self::Dense<S>, theta: f64) -> Precise<S> {
        dense.precisely_at(theta)
    }
}

/// Dense output from the differences of all stages, including the rate at the end.
#[inline(always)]
fn fill_dense<F: VectorField>(
    field: &mut Counted<'_, F>,
    span: Span<'_, F::State>,
    stages: &mut [F::State],
    dense: &mut Polynomial<F::State, 7>,
) -> Result<(), Fault> {
    let Span { t, h, start, .. } = span;
    let mut inside = start.value;
    make_stages!(field, (t, h, &start.value), stages, &mut inside, NODES: 13 A13 14 A14 15 A15);
    for i in 0..stages[0].count() {
        let mut gains = [0.0; STAGES];
        let mut size = (h * stages[0].as_slice()[i]).abs();
        for &(j, _) in &D3[1..] {
            gains[j] = h * stages[j].as_slice()[i];
            size = larger(size, gains[j].abs());
        }
        let cubic = Cubic {
            rate: h * stages[0].as_slice()[i],
            bend: span.bend(stages, &B, i),
            gained: gains[Dop853Scheme::LAST],
            rounding: rounding(size, &B),
        };
        dense.set_cubic(i, start, cubic);
        for &(j, _) in &D3[1..] {
            gains[j] = dense.beside_cubic(NODES[j], gains[j], i);
        }
        for (k, row) in [D3, D4, D5, D6].iter().enumerate() {
            dense.coefficients[3 + k].as_mut_slice()[i] = weigh_beyond_rounding(&gains, row, size);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tableau::check;
    use super::*;

    const ROWS: [&[Term]; STAGES] = [
        &[],
        &A1,
        &A2,
        &A3,
        &A4,
        &A5,
        &A6,
        &A7,
        &A8,
        &A9,
        &A10,
        &A11,
        &B,
        &A13,
        &A14,
        &A15,
    ];

    #[test]
    fn table_satisfies_its_order_conditions() {
        check::rows_sum_to_nodes(&ROWS, &NODES);
        check::weights_have_order(8, &B, &ROWS, &NODES);
        check::constant_forces_shift_no_step(&B, &NODES);
        check::estimate_has_order(5, &E5, &NODES);
        check::estimate_has_order(3, &E3, &NODES);
    }
}
