//! Compensated sums: states with the low parts of their components, as in double-double arithmetic.

use crate::state::StateVector;

/// A state and its accumulated rounding error (Kahan; the exact error of a sum by Knuth's two-sum).
///
/// A step adds a small increment to a large state. Without the compensation, rounding errors add up over many steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precise<S> {
    pub(super) value: S,
    pub(super) rest: S,
}

impl<S: StateVector> Precise<S> {
    /// A state without rounding error.
    pub(super) fn new(value: S) -> Self {
        Self {
            value,
            rest: value.zeroed(),
        }
    }

    /// `state`. A component that equals that of `self` keeps its rounding error; the others have none.
    #[inline]
    pub(super) fn kept(&self, state: &S) -> Self {
        let mut kept = Self::new(*state);
        for i in 0..state.count() {
            if state.as_slice()[i] == self.value.as_slice()[i] {
                kept.rest.as_mut_slice()[i] = self.rest.as_slice()[i];
            }
        }
        kept
    }

    /// Component `i`, with its rounding error, plus a number.
    #[inline(always)]
    pub(super) fn plus(&self, i: usize, increment: f64) -> f64 {
        self.value.padded()[i] + (self.rest.padded()[i] + increment)
    }

    /// Component `i` minus that of another state, with the rounding errors of both.
    #[inline(always)]
    pub(super) fn minus(&self, other: &Self, i: usize) -> f64 {
        let rests = self.rest.padded()[i] - other.rest.padded()[i];
        (self.value.padded()[i] - other.value.padded()[i]) + rests
    }

    /// The state plus `increment(i)` in each component and in the padding ([`StateVector::padded`]), with the rounding
    /// error of the sum.
    #[inline]
    pub(super) fn advanced(&self, increment: impl Fn(usize) -> f64) -> Self {
        let mut sum = *self;
        self.value.for_each_place(|i| {
            let before = self.value.padded()[i];
            let change = self.rest.padded()[i] + increment(i);
            let after = before + change;
            let gained = after - before;
            sum.value.padded_mut()[i] = after;
            sum.rest.padded_mut()[i] = (before - (after - gained)) + (change - gained);
        });
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    #[test]
    #[cfg_attr(miri, ignore = "a million steps take an hour under miri")]
    fn nothing_is_lost_over_a_million_steps() {
        let mut sum = Precise::new(SVector::<f64, 1>::new(1.0));
        let mut naive = 1.0_f64;
        for _ in 0..1_000_000 {
            sum = sum.advanced(|_| 1e-7);
            naive += 1e-7;
        }
        assert_eq!(sum.value[0], 1.1);
        assert!((naive - 1.1).abs() > 1e-12);
    }
}
