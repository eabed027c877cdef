//! A set of states `centre + Q r`: a box `r` in a frame `Q` that is orthonormal up to rounding.

use crate::contract::Variational;
use crate::math;
use crate::numbers::{Interval, Numbers};
use crate::state::StateVector;

/// A box by its ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds<S> {
    pub(super) lo: S,
    pub(super) hi: S,
}

impl<S: StateVector> Bounds<S> {
    /// One point.
    pub(super) fn point(point: &S) -> Self {
        Self {
            lo: *point,
            hi: *point,
        }
    }

    /// The box whose component `i` is `of(i)`.
    pub(super) fn of(of: impl Fn(usize) -> Interval) -> Self {
        let mut bounds = Self::point(&S::zeros());
        for i in 0..S::LEN {
            bounds.set(i, of(i));
        }
        bounds
    }

    pub(super) fn at(&self, i: usize) -> Interval {
        Interval::new(self.lo.as_slice()[i], self.hi.as_slice()[i])
    }

    pub(super) fn set(&mut self, i: usize, range: Interval) {
        self.lo.as_mut_slice()[i] = range.lo;
        self.hi.as_mut_slice()[i] = range.hi;
    }

    /// The point in the middle.
    pub(super) fn middle(&self) -> S {
        let mut middle = S::zeros();
        for (i, entry) in middle.as_mut_slice().iter_mut().enumerate() {
            *entry = self.at(i).middle();
        }
        middle
    }

    /// The width of the widest component.
    pub(super) fn width(&self) -> f64 {
        (0..S::LEN).fold(0.0, |most, i| most.max(self.at(i).width()))
    }

    /// What both boxes contain; the other one where they do not meet.
    pub(super) fn within(&self, other: &Self) -> Self {
        Self::of(|i| self.at(i).intersection(other.at(i)).unwrap_or(other.at(i)))
    }

    pub(super) fn is_finite(&self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }
}

/// A matrix of intervals by its columns.
pub(super) struct Matrix<Sys: Variational> {
    lo: Sys::Columns,
    hi: Sys::Columns,
}

impl<Sys: Variational> Matrix<Sys> {
    pub(super) fn zero() -> Self {
        Self {
            lo: Sys::columns(),
            hi: Sys::columns(),
        }
    }

    pub(super) fn at(&self, i: usize, j: usize) -> Interval {
        let [lo, hi] = [&self.lo, &self.hi].map(|own| own.as_ref()[j].as_slice()[i]);
        Interval::new(lo, hi)
    }

    pub(super) fn set(&mut self, i: usize, j: usize, range: Interval) {
        self.lo.as_mut()[j].as_mut_slice()[i] = range.lo;
        self.hi.as_mut()[j].as_mut_slice()[i] = range.hi;
    }

    /// Column `j`.
    pub(super) fn column(&self, j: usize) -> Bounds<Sys::State> {
        Bounds {
            lo: self.lo.as_ref()[j],
            hi: self.hi.as_ref()[j],
        }
    }

    /// Replaces column `j`.
    pub(super) fn set_column(&mut self, j: usize, column: &Bounds<Sys::State>) {
        self.lo.as_mut()[j] = column.lo;
        self.hi.as_mut()[j] = column.hi;
    }

    /// The product with a box.
    pub(super) fn times_bounds(&self, bounds: &Bounds<Sys::State>) -> Bounds<Sys::State> {
        Bounds::of(|i| {
            (0..Sys::State::LEN).fold(Interval::ZERO, |sum, k| sum + self.at(i, k) * bounds.at(k))
        })
    }
}

/// `centre + Q r`
pub(super) struct Frame<Sys: Variational> {
    pub(super) centre: Sys::State,
    axes: Sys::Columns,
    rest: Bounds<Sys::State>,
}

impl<Sys: Variational> Clone for Frame<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Frame<Sys> {}

impl<Sys: Variational> Frame<Sys> {
    /// A box, in the axes of the state.
    pub(super) fn of(bounds: &Bounds<Sys::State>) -> Self {
        let centre = bounds.middle();
        let mut axes = Sys::columns();
        for (j, axis) in axes.as_mut().iter_mut().enumerate() {
            axis.as_mut_slice()[j] = 1.0;
        }
        Self {
            centre,
            axes,
            rest: Bounds::of(|i| bounds.at(i) - Interval::point(centre.as_slice()[i])),
        }
    }

    /// The smallest box found that contains the set.
    pub(super) fn hull(&self) -> Bounds<Sys::State> {
        Bounds::of(|i| {
            let axes = self.axes.as_ref().iter().enumerate();
            axes.fold(
                Interval::point(self.centre.as_slice()[i]),
                |sum, (k, axis)| sum + Interval::point(axis.as_slice()[i]) * self.rest.at(k),
            )
        })
    }

    /// Column `k` of `Q`.
    pub(super) fn axis(&self, k: usize) -> Bounds<Sys::State> {
        Bounds::point(&self.axes.as_ref()[k])
    }

    /// `slopes . r`: all that a function with these derivatives along the axes differs by from its value at the centre.
    pub(super) fn along(&self, slopes: impl Fn(usize) -> Interval) -> Interval {
        (0..Sys::State::LEN).fold(Interval::ZERO, |sum, k| sum + slopes(k) * self.rest.at(k))
    }

    /// The set that the map `centre -> moved` makes of this one; column `k` of `turned` has its derivatives along axis `k`, all over
    /// the hull.
    pub(super) fn moved(&self, moved: &Bounds<Sys::State>, turned: &Matrix<Sys>) -> Self {
        let centre = moved.middle();
        let axes = orthonormal::<Sys>(turned, &self.rest);
        let inverse = inverse::<Sys>(&axes);
        let along = product::<Sys>(&inverse, turned);
        let shift = Bounds::of(|i| moved.at(i) - Interval::point(centre.as_slice()[i]));
        let (linear, shift) = (along.times_bounds(&self.rest), inverse.times_bounds(&shift));
        Self {
            centre,
            axes,
            rest: Bounds::of(|i| linear.at(i) + shift.at(i)),
        }
    }
}

fn product<Sys: Variational>(a: &Matrix<Sys>, b: &Matrix<Sys>) -> Matrix<Sys> {
    let mut product = Matrix::zero();
    for i in 0..Sys::State::LEN {
        for j in 0..Sys::State::LEN {
            let terms = (0..Sys::State::LEN).map(|k| a.at(i, k) * b.at(k, j));
            product.set(i, j, terms.fold(Interval::ZERO, |sum, term| sum + term));
        }
    }
    product
}

/// Orthonormal axes along the columns of a matrix, the longest edges of the box that they span first (modified Gram-Schmidt, twice).
fn orthonormal<Sys: Variational>(matrix: &Matrix<Sys>, rest: &Bounds<Sys::State>) -> Sys::Columns {
    let n = Sys::State::LEN;
    let mut axes = Sys::columns();
    let mut lengths = Sys::State::zeros();
    for (j, axis) in axes.as_mut().iter_mut().enumerate() {
        for (i, entry) in axis.as_mut_slice().iter_mut().enumerate() {
            *entry = matrix.at(i, j).middle();
        }
        lengths.as_mut_slice()[j] = length(axis) * rest.at(j).magnitude();
    }
    for first in 0..n {
        let longest = (first..n).fold(first, |best, j| {
            match lengths.as_slice()[j] > lengths.as_slice()[best] {
                true => j,
                false => best,
            }
        });
        axes.as_mut().swap(first, longest);
        lengths.as_mut_slice().swap(first, longest);
    }
    for j in 0..n {
        for trial in 0..=n {
            for _ in 0..2 {
                let (before, rest) = axes.as_mut().split_at_mut(j);
                before.iter().for_each(|other| remove(other, &mut rest[0]));
            }
            let axis = &mut axes.as_mut()[j];
            let size = length(axis);
            if size > 0.0 && size.is_finite() {
                axis.as_mut_slice()
                    .iter_mut()
                    .for_each(|entry| *entry /= size);
                // What is left of a column along the others may be rounding, which points anywhere.
                if is_normal(&axes, j) {
                    break;
                }
            }
            let axis = &mut axes.as_mut()[j];
            *axis = Sys::State::zeros();
            axis.as_mut_slice()[(j + trial) % n] = 1.0;
        }
    }
    axes
}

/// True if an axis is normal to those before it, far beyond what a frame needs.
fn is_normal<S: StateVector>(axes: &impl AsRef<[S]>, j: usize) -> bool {
    let axes = axes.as_ref();
    axes[..j]
        .iter()
        .all(|other| inner(other, &axes[j]).abs() < 1e-8)
}

fn inner<S: StateVector>(a: &S, b: &S) -> f64 {
    a.as_slice()
        .iter()
        .zip(b.as_slice())
        .map(|(a, b)| a * b)
        .sum()
}

fn length<S: StateVector>(vector: &S) -> f64 {
    math::sqrt(inner(vector, vector))
}

fn remove<S: StateVector>(axis: &S, from: &mut S) {
    let along = inner(axis, from);
    for (entry, axis) in from.as_mut_slice().iter_mut().zip(axis.as_slice()) {
        *entry -= along * axis;
    }
}

/// All inverses of a frame: its transpose, and what `I - Q^T Q` leaves.
///
/// With `e` the norm of `I - Q^T Q` (largest sum of a row), `Q^-1 - Q^T = (I - Q^T Q) Q^-1` has a norm of at most
/// `e |Q^T|/(1 - e)`, and no entry is larger.
fn inverse<Sys: Variational>(axes: &Sys::Columns) -> Matrix<Sys> {
    let n = Sys::State::LEN;
    let axes = axes.as_ref();
    let (mut defect, mut norm) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        let (mut row, mut size) = (Interval::ZERO, Interval::ZERO);
        for j in 0..n {
            let pairs = axes[i].as_slice().iter().zip(axes[j].as_slice());
            let product = pairs.fold(Interval::ZERO, |sum, (a, b)| {
                sum + Interval::point(*a) * Interval::point(*b)
            });
            let unit = Interval::point(if i == j { 1.0 } else { 0.0 });
            row = row + (product - unit).abs();
            size = size + Interval::point(axes[i].as_slice()[j]).abs();
        }
        defect = defect.max(row.hi);
        norm = norm.max(size.hi);
    }
    let bound = match defect < 0.5 {
        true => (Interval::point(2.0) * Interval::point(defect) * Interval::point(norm)).hi,
        false => f64::INFINITY,
    };
    let mut inverse = Matrix::zero();
    for i in 0..n {
        for j in 0..n {
            let entry = Interval::point(axes[i].as_slice()[j]);
            inverse.set(i, j, entry.widened(bound));
        }
    }
    inverse
}
