//! Slices across the directions of a symmetry group, on which a return map acts modulo the group.

use super::chart::{DEPENDENT, add, adjoin, dot, least_squares, products};
use super::group::GENERATORS;
use crate::math;
use crate::state::StateVector;

/// A slice across the directions of a group: linear functions that are 0 on the slice, and directions along which the
/// group moves points to it.
#[derive(Clone, Copy)]
pub(super) struct Slice<S> {
    functions: [S; GENERATORS],
    /// For each function, a combination of the group's directions on which this function is 1 and the others are 0.
    back: [S; GENERATORS],
    count: usize,
}

impl<S: StateVector> Slice<S> {
    pub(super) fn none(zero: S) -> Self {
        Self {
            functions: [zero; GENERATORS],
            back: [zero; GENERATORS],
            count: 0,
        }
    }

    pub(super) fn functions(&self) -> &[S] {
        &self.functions[..self.count]
    }

    fn add(&mut self, function: S) {
        self.functions[self.count] = function;
        self.count += 1;
    }

    /// Adds a function for each independent direction of the group. The first `kept` rows of the frame are an
    /// orthonormal basis of the gradients of the section's equations. Returns the number of rows that are excluded from
    /// the directions of the section: `kept`, and the directions of the group that are appended.
    ///
    /// A direction along which an equation of the section changes leads to other levels of a constraint. Its function
    /// is the change of the level, and the section keeps all its directions. Any other direction of the group lies
    /// along the section and is excluded from it.
    pub(super) fn cut(&mut self, frame: &mut [S], kept: usize, rates: [S; GENERATORS]) -> usize {
        let (mut left_out, mut leaving) = (kept, self.back);
        for rate in rates {
            // The remainder of the rate does not change the levels that earlier directions change.
            let (mut left, size) = (rate, math::sqrt(dot(&rate, &rate)));
            for _ in 0..2 {
                for (function, direction) in self.functions().iter().zip(&leaving) {
                    let along = dot(function, &left);
                    add(&mut left, -along, direction);
                }
            }
            let mut change = rate.zeroed();
            for equation in &frame[..kept] {
                add(&mut change, dot(equation, &left), equation);
            }
            let length = math::sqrt(dot(&change, &change));
            if length > DEPENDENT * size {
                for (vector, factor) in [(&mut change, length), (&mut left, length)] {
                    vector
                        .as_mut_slice()
                        .iter_mut()
                        .for_each(|entry| *entry /= factor);
                }
                leaving[self.count] = left;
                self.add(change);
            } else if adjoin(frame, left_out, left).is_some() {
                leaving[self.count] = rate.zeroed();
                self.add(frame[left_out]);
                left_out += 1;
            }
        }
        left_out
    }

    /// Computes the directions back to the slice.
    pub(super) fn solve(&mut self, rates: &[S; GENERATORS], columns: &mut [S], turned: &mut [S]) {
        // No more generators than components are independent.
        let size = GENERATORS
            .min(columns.len())
            .min(turned.len())
            .min(rates[0].as_slice().len());
        for j in 0..self.count {
            for (column, rate) in columns.iter_mut().zip(rates) {
                *column = products(rate, self.functions());
            }
            let mut unit = rates[0].zeroed();
            unit.as_mut_slice()[j] = 1.0;
            let factors = least_squares(columns, turned, size, &unit, 0.0);
            let mut back = rates[0].zeroed();
            for (factor, rate) in factors.as_slice()[..size].iter().zip(rates) {
                add(&mut back, *factor, rate);
            }
            self.back[j] = back;
        }
    }

    /// Moves a vector along the directions of the group to the slice.
    pub(super) fn project(&self, vector: &mut S) {
        let values = products(vector, self.functions());
        for (value, back) in values.as_slice().iter().zip(&self.back[..self.count]) {
            add(vector, -value, back);
        }
    }
}
