//! Power series of the motion, of one state or of several in SIMD lanes, and the polynomials made from them.

use crate::contract::TaylorField;
use crate::error::Fault;
use crate::jet::{Jets, LENGTH};
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// Initial values of the series at one moment, and the coefficients.
pub(crate) struct Expansion<F: TaylorField, L: Numbers> {
    pub(crate) coefficients: [F::Row<L>; LENGTH],
    pub(crate) gaps: [F::Gaps<L>; LENGTH],
    pub(crate) firsts: F::Firsts<L>,
    jets: F::Jets<L>,
}

impl<F: TaylorField, L: Numbers> Clone for Expansion<F, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: TaylorField, L: Numbers> Copy for Expansion<F, L> {}

impl<F: TaylorField, L: Numbers> Expansion<F, L> {
    /// Storage for the series of a system.
    pub(crate) fn of(field: &F) -> Self {
        Self::sized(
            field.state_len(),
            field.series_gap_count(),
            field.firsts_len(),
        )
    }

    /// Storage before the system is known.
    pub(crate) fn unset() -> Self {
        Self::sized(0, 0, 0)
    }

    fn sized(components: usize, gaps: usize, firsts: usize) -> Self {
        Self {
            coefficients: [F::Row::<L>::zeros(components); LENGTH],
            gaps: [F::Gaps::<L>::zeros(gaps); LENGTH],
            firsts: F::Firsts::<L>::zeros(firsts),
            jets: F::Jets::ZERO,
        }
    }

    /// Resizes the storage for a system if necessary.
    pub(crate) fn make_room(&mut self, field: &F) {
        if self.coefficients[0].as_slice().len() != field.state_len() {
            *self = Self::of(field);
        }
    }

    /// Evaluates the initial values at a state, which is the start of the next series and the end of the last.
    #[inline(always)]
    pub(crate) fn begin(
        &mut self,
        field: &F,
        parameters: &F::Parameters<L>,
        t: L,
        state: &F::Row<L>,
    ) -> Result<(), Fault> {
        field.begin(parameters, t, state, &mut self.firsts)
    }

    /// Computes the coefficients from the state passed to [`Expansion::begin`].
    #[inline(always)]
    pub(crate) fn advance(
        &mut self,
        field: &F,
        parameters: &F::Parameters<L>,
        unit: L,
        order: usize,
        start: &F::Row<L>,
    ) {
        self.coefficients[0] = *start;
        field.advance(
            parameters,
            unit,
            order,
            &self.firsts,
            &mut self.coefficients,
            &mut self.gaps,
            &mut self.jets,
        );
    }

    /// The rate at the state passed to [`Expansion::begin`].
    #[inline(always)]
    pub(crate) fn rate(&self) -> &[L] {
        &self.firsts.as_slice()[..self.coefficients[0].as_slice().len()]
    }

    /// The gaps at the state passed to [`Expansion::begin`].
    #[inline(always)]
    pub(crate) fn begun_gaps(&self) -> &[L] {
        let (components, gaps) = (&self.coefficients[0], &self.gaps[0]);
        &self.firsts.as_slice()[components.as_slice().len()..][..gaps.as_slice().len()]
    }

    /// Largest absolute values among the entries of the last coefficient, and of the one before it, each times its
    /// factor.
    #[inline(always)]
    pub(crate) fn sizes(&self, order: usize, factors: &F::Row<L>) -> [L; 2] {
        let mut sizes = [L::ZERO; 2];
        for (j, size) in sizes.iter_mut().enumerate() {
            let coefficient = self.coefficients[order - j].as_slice();
            for (entry, factor) in coefficient.iter().zip(factors.as_slice()) {
                *size = size.max(entry.abs() * *factor);
            }
        }
        sizes
    }

    /// Increment of the polynomial over `theta` units of time, and its derivative at the end.
    #[inline(always)]
    pub(crate) fn change(&self, order: usize, theta: L) -> [F::Row<L>; 2] {
        let (mut change, mut slope) =
            (self.coefficients[0].zeroed(), self.coefficients[0].zeroed());
        for coefficient in self.coefficients[1..=order].iter().rev() {
            let add = |i: usize| {
                let next = change.padded()[i].mul_add(theta, coefficient.padded()[i]);
                slope.padded_mut()[i] = slope.padded()[i].mul_add(theta, next);
                change.padded_mut()[i] = next;
            };
            // Entries that are lanes gain nothing from blocks of known length.
            match L::LANES {
                1 => coefficient.for_each_place(add),
                _ => (0..coefficient.as_slice().len()).for_each(add),
            }
        }
        for sum in change.as_mut_slice() {
            *sum = *sum * theta;
        }
        [change, slope]
    }
}

/// The end of a step from a start with rounding error `rest`, and the rounding error of the end, which is the exact
/// error of the sum (Moller, Knuth).
#[inline(always)]
pub(crate) fn sum<L: Numbers>(start: L, change: L, rest: L) -> [L; 2] {
    let change = change + rest;
    let end = start + change;
    let moved = end - start;
    [end, (start - (end - moved)) + (change - moved)]
}

/// A state as a row.
#[inline(always)]
pub(crate) fn row<F: TaylorField>(state: &F::State) -> F::Row<f64> {
    let mut row = F::Row::<f64>::zeros(state.count());
    row.as_mut_slice().copy_from_slice(state.as_slice());
    row
}

/// The state with these components.
#[inline(always)]
pub(crate) fn state<F: TaylorField>(components: &[f64]) -> F::State {
    let mut state = F::State::zeros(components.len());
    state.as_mut_slice().copy_from_slice(components);
    state
}
