//! Linear combinations of stages, written so that a table known at compile time becomes straight-line code.

use crate::state::StateVector;

/// A non-zero entry of a row of a tableau: the stage it multiplies, and its value.
pub(super) type Term = (usize, f64);

/// `sum over terms of coefficient * stage`, component `i`.
#[inline(always)]
pub(super) fn sum<S: StateVector>(stages: &[S], terms: &[Term], i: usize) -> f64 {
    let mut sum = 0.0;
    for &(stage, coefficient) in terms {
        sum += coefficient * stages[stage].as_slice()[i];
    }
    sum
}

/// `out = base + h * sum over terms of coefficient * stage`.
#[inline(always)]
pub(super) fn combine<S: StateVector>(base: &S, h: f64, stages: &[S], terms: &[Term], out: &mut S) {
    for i in 0..S::LEN {
        out.as_mut_slice()[i] = base.as_slice()[i] + h * sum(stages, terms, i);
    }
}
