//! A set of states `centre + C r_0 + Q r`. The axes `C` of the box `r_0` are propagated with the motion. The frame `Q`
//! of the box `r` is orthonormal up to rounding.
//!
//! The first box is the image of an earlier set and contains no errors of steps. The second box collects these errors;
//! its frame is rotated by QR against the wrapping effect. When the second box becomes as large as the first, both are
//! joined into one.

use crate::contract::{Variational, VectorField};
use crate::math;
use crate::numbers::{Interval, Numbers};
use crate::state::{StateVector, scaled};

/// A box, given by its lower and upper bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds<S> {
    pub(super) lo: S,
    pub(super) hi: S,
}

impl<S: StateVector> Bounds<S> {
    /// A box that contains one point.
    pub(super) fn point(point: &S) -> Self {
        Self {
            lo: *point,
            hi: *point,
        }
    }

    /// The box of `n` components whose component `i` is `of(i)`.
    pub(super) fn of(n: usize, of: impl Fn(usize) -> Interval) -> Self {
        let mut bounds = Self::point(&S::zeros(n));
        for i in 0..bounds.count() {
            bounds.set(i, of(i));
        }
        bounds
    }

    /// The number of components.
    pub(super) fn count(&self) -> usize {
        self.lo.count()
    }

    pub(super) fn at(&self, i: usize) -> Interval {
        Interval::new(self.lo.as_slice()[i], self.hi.as_slice()[i])
    }

    pub(super) fn set(&mut self, i: usize, range: Interval) {
        self.lo.as_mut_slice()[i] = range.lo;
        self.hi.as_mut_slice()[i] = range.hi;
    }

    /// The midpoint of the box.
    pub(super) fn middle(&self) -> S {
        let mut middle = self.lo.zeroed();
        for (i, entry) in middle.as_mut_slice().iter_mut().enumerate() {
            *entry = self.at(i).middle();
        }
        middle
    }

    /// The width of the widest component.
    pub(super) fn width(&self) -> f64 {
        (0..self.count()).fold(0.0, |most, i| most.max(self.at(i).width()))
    }

    /// Intersection of both boxes; `other` if they are disjoint.
    pub(super) fn within(&self, other: &Self) -> Self {
        Self::of(self.count(), |i| {
            self.at(i).intersection(other.at(i)).unwrap_or(other.at(i))
        })
    }

    pub(super) fn is_finite(&self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }
}

/// The columns of a zero matrix with `n` rows, in storage of full capacity.
pub(super) fn columns<Sys: Variational>(n: usize) -> Sys::Columns {
    let mut columns = Sys::columns();
    columns.as_mut().fill(Sys::State::zeros(n));
    columns
}

/// The columns of the identity.
pub(super) fn identity<Sys: Variational>(n: usize) -> Sys::Columns {
    let mut identity = columns::<Sys>(n);
    for (j, column) in identity.as_mut().iter_mut().enumerate().take(n) {
        column.as_mut_slice()[j] = 1.0;
    }
    identity
}

/// A matrix of intervals, stored by columns.
pub(super) struct Matrix<Sys: Variational> {
    lo: Sys::Columns,
    hi: Sys::Columns,
}

impl<Sys: Variational> Clone for Matrix<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Matrix<Sys> {}

impl<Sys: Variational> Matrix<Sys> {
    /// A zero matrix.
    pub(super) fn zero(n: usize) -> Self {
        Self::of(&columns::<Sys>(n))
    }

    /// Number of rows, which is also the number of columns.
    pub(super) fn count(&self) -> usize {
        self.lo.as_ref().first().map_or(0, StateVector::count)
    }

    pub(super) fn at(&self, i: usize, j: usize) -> Interval {
        let [lo, hi] = [&self.lo, &self.hi].map(|vector| vector.as_ref()[j].as_slice()[i]);
        Interval::new(lo, hi)
    }

    pub(super) fn set(&mut self, i: usize, j: usize, range: Interval) {
        self.lo.as_mut()[j].as_mut_slice()[i] = range.lo;
        self.hi.as_mut()[j].as_mut_slice()[i] = range.hi;
    }

    /// A matrix of point intervals.
    pub(super) fn of(columns: &Sys::Columns) -> Self {
        Self {
            lo: *columns,
            hi: *columns,
        }
    }

    /// Midpoints of the entries.
    pub(super) fn middle(&self) -> Sys::Columns {
        let n = self.count();
        let mut middle = columns::<Sys>(n);
        for (j, column) in middle.as_mut().iter_mut().enumerate().take(n) {
            for (i, entry) in column.as_mut_slice().iter_mut().enumerate() {
                *entry = self.at(i, j).middle();
            }
        }
        middle
    }

    /// Column `j`.
    pub(super) fn column(&self, j: usize) -> Bounds<Sys::State> {
        Bounds::of(self.count(), |i| self.at(i, j))
    }

    /// Replaces column `j`.
    pub(super) fn set_column(&mut self, j: usize, column: &Bounds<Sys::State>) {
        self.lo.as_mut()[j] = column.lo;
        self.hi.as_mut()[j] = column.hi;
    }

    /// The product with a box.
    pub(super) fn times_bounds(&self, bounds: &Bounds<Sys::State>) -> Bounds<Sys::State> {
        let n = self.count();
        Bounds::of(n, |i| {
            (0..n).fold(Interval::ZERO, |sum, k| sum + self.at(i, k) * bounds.at(k))
        })
    }
}

/// A box along given axes, the columns of `axes`.
struct Block<Sys: Variational> {
    axes: Sys::Columns,
    rest: Bounds<Sys::State>,
}

impl<Sys: Variational> Clone for Block<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Block<Sys> {}

impl<Sys: Variational> Block<Sys> {
    /// A box of size 0, in the axes of the state.
    fn none(n: usize) -> Self {
        Self {
            axes: identity::<Sys>(n),
            rest: Bounds::point(&Sys::State::zeros(n)),
        }
    }

    /// The axes, with their indices.
    fn axes(&self) -> impl Iterator<Item = (usize, &Sys::State)> {
        self.axes.as_ref()[..self.rest.count()].iter().enumerate()
    }

    /// Square of half the diagonal, if the edges are orthogonal.
    fn size(&self) -> f64 {
        self.axes().fold(0.0, |sum, (k, axis)| {
            let reach = self.rest.at(k).magnitude();
            sum + inner(axis, axis) * reach * reach
        })
    }
}

/// Number of blocks of a frame.
pub(super) const BLOCKS: usize = 2;

/// Derivatives along all axes of a frame, one matrix per block. Derivatives along axes of extent 0 may be unset.
pub(super) type Turned<Sys> = [Matrix<Sys>; BLOCKS];

/// One interval for each axis of a frame, for example the derivatives of a scalar function.
pub(super) type Slopes<Sys> = [Bounds<<Sys as VectorField>::State>; BLOCKS];

/// The set `centre + C r_0 + Q r`; see the module.
pub(super) struct Frame<Sys: Variational> {
    pub(super) centre: Sys::State,
    blocks: [Block<Sys>; BLOCKS],
}

impl<Sys: Variational> Clone for Frame<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Frame<Sys> {}

impl<Sys: Variational> Frame<Sys> {
    /// A box along the axes of the state.
    pub(super) fn of(bounds: &Bounds<Sys::State>) -> Self {
        let centre = bounds.middle();
        let n = bounds.count();
        let mut first = Block::none(n);
        first.rest = Bounds::of(n, |i| bounds.at(i) - Interval::point(centre.as_slice()[i]));
        Self {
            centre,
            blocks: [first, Block::none(n)],
        }
    }

    /// A box that contains the set.
    pub(super) fn hull(&self) -> Bounds<Sys::State> {
        Bounds::of(self.centre.count(), |i| {
            let along = |block: usize, k: usize| {
                let axis = &self.blocks[block].axes.as_ref()[k];
                Interval::point(axis.as_slice()[i])
            };
            Interval::point(self.centre.as_slice()[i]) + self.along(along)
        })
    }

    /// Block, index and direction of every axis along which the set has an extent.
    pub(super) fn axes(&self) -> impl Iterator<Item = (usize, usize, Bounds<Sys::State>)> + '_ {
        let blocks = self.blocks.iter().enumerate();
        blocks.flat_map(|(b, block)| {
            let used = block
                .axes()
                .filter(|(k, _)| block.rest.at(*k) != Interval::ZERO);
            used.map(move |(k, axis)| (b, k, Bounds::point(axis)))
        })
    }

    /// Enclosure of `f(x) - f(centre)` for all `x` in the set. `slopes(block, k)` encloses the derivative of `f` along
    /// axis `k` of a block.
    pub(super) fn along(&self, slopes: impl Fn(usize, usize) -> Interval) -> Interval {
        self.axes().fold(Interval::ZERO, |sum, (block, k, _)| {
            sum + slopes(block, k) * self.blocks[block].rest.at(k)
        })
    }

    /// Image of the set under a map that takes the centre into `moved` and whose derivatives over the hull lie in
    /// `turned`.
    pub(super) fn moved(&self, moved: &Bounds<Sys::State>, turned: &Turned<Sys>) -> Self {
        let (centre, n) = (moved.middle(), moved.count());
        let [first, second] = &self.blocks;
        let axes = turned[0].middle();
        let carried = Block::<Sys> {
            axes,
            rest: first.rest,
        };
        let shift = Bounds::of(n, |i| {
            let rounded = |k: usize| {
                let middle = Interval::point(axes.as_ref()[k].as_slice()[i]);
                (turned[0].at(i, k) - middle) * first.rest.at(k)
            };
            let from_centre = moved.at(i) - Interval::point(centre.as_slice()[i]);
            (0..n).fold(from_centre, |sum, k| sum + rounded(k))
        });
        let added = Block::<Sys> {
            axes: turned[1].middle(),
            rest: second.rest,
        };
        let axes = orthonormal(n, &[&added]);
        let added = Block::<Sys> {
            axes,
            rest: components::<Sys>(&axes, &[(&turned[1], &second.rest)], &shift),
        };
        let blocks = match added.size() < carried.size() {
            true => [carried, added],
            false => [joined(&carried, &added), Block::none(n)],
        };
        Self { centre, blocks }
    }
}

/// Joins both blocks into one.
fn joined<Sys: Variational>(first: &Block<Sys>, second: &Block<Sys>) -> Block<Sys> {
    let axes = orthonormal(first.rest.count(), &[first, second]);
    let [one, other] = [first, second].map(|block| Matrix::<Sys>::of(&block.axes));
    let parts = [(&one, &first.rest), (&other, &second.rest)];
    let none = Bounds::point(&Sys::State::zeros(first.rest.count()));
    Block {
        axes,
        rest: components::<Sys>(&axes, &parts, &none),
    }
}

pub(super) fn product<Sys: Variational>(a: &Matrix<Sys>, b: &Matrix<Sys>) -> Matrix<Sys> {
    let n = a.count();
    let mut product = Matrix::zero(n);
    for i in 0..n {
        for j in 0..n {
            let terms = (0..n).map(|k| a.at(i, k) * b.at(k, j));
            product.set(i, j, terms.fold(Interval::ZERO, |sum, term| sum + term));
        }
    }
    product
}

/// Orthonormal axes along the edges of boxes. Each axis follows the edge with the largest component orthogonal to the
/// axes before it (modified Gram-Schmidt, applied twice).
fn orthonormal<Sys: Variational>(n: usize, blocks: &[&Block<Sys>]) -> Sys::Columns {
    let mut axes = columns::<Sys>(n);
    for j in 0..n {
        let mut longest = (0.0, Sys::State::zeros(n));
        for block in blocks {
            for (k, edge) in block.axes() {
                let mut edge = scaled(edge, block.rest.at(k).magnitude());
                let whole = length(&edge);
                for _ in 0..2 {
                    let before = &axes.as_ref()[..j];
                    before.iter().for_each(|axis| remove(axis, &mut edge));
                }
                let left = length(&edge);
                // After projection the remainder of an edge may consist of rounding errors, in an arbitrary direction.
                if left > longest.0 && left > 1e-12 * whole {
                    longest = (left, edge);
                }
            }
        }
        let (size, edge) = longest;
        axes.as_mut()[j] = match size > 0.0 && size.is_finite() {
            true => scaled(&edge, 1.0 / size),
            false => another::<Sys>(n, &axes, j),
        };
    }
    axes
}

/// A unit vector orthogonal to the first `count` axes, from the axis of the state with the largest remainder.
fn another<Sys: Variational>(n: usize, axes: &Sys::Columns, count: usize) -> Sys::State {
    let mut best = (0.0, Sys::State::zeros(n));
    for i in 0..n {
        let mut axis = Sys::State::zeros(n);
        axis.as_mut_slice()[i] = 1.0;
        for _ in 0..2 {
            let before = &axes.as_ref()[..count];
            before.iter().for_each(|other| remove(other, &mut axis));
        }
        let left = length(&axis);
        if left > best.0 {
            best = (left, scaled(&axis, 1.0 / left));
        }
    }
    best.1
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

/// A box that contains `Q^-1 (A_1 r_1 + .. + s)` for axes `Q` that are orthonormal up to rounding. The box is unbounded
/// if they are not.
///
/// With `E = I - Q^T Q`, `w = Q^-1 v` is the fixed point of `w -> Q^T v + E w`. If the norm of `E` is less than 1, `w`
/// lies in every box that this map takes into itself.
fn components<Sys: Variational>(
    axes: &Sys::Columns,
    parts: &[(&Matrix<Sys>, &Bounds<Sys::State>)],
    shift: &Bounds<Sys::State>,
) -> Bounds<Sys::State> {
    let n = shift.count();
    let mut transpose = Matrix::<Sys>::zero(n);
    for i in 0..n {
        for j in 0..n {
            transpose.set(i, j, Interval::point(axes.as_ref()[i].as_slice()[j]));
        }
    }
    let mut defect = product(&transpose, &Matrix::of(axes));
    let mut norm = 0.0_f64;
    for i in 0..n {
        let mut row = Interval::ZERO;
        for j in 0..n {
            let unit = Interval::point(if i == j { 1.0 } else { 0.0 });
            defect.set(i, j, unit - defect.at(i, j));
            row = row + defect.at(i, j).abs();
        }
        norm = norm.max(row.hi);
    }
    let mut image = transpose.times_bounds(shift);
    for (matrix, rest) in parts {
        let linear = product(&transpose, matrix).times_bounds(rest);
        image = Bounds::of(n, |i| image.at(i) + linear.at(i));
    }
    let added = |bounds: &Bounds<Sys::State>| defect.times_bounds(bounds);
    let first = added(&image);
    let wide = Bounds::of(n, |i| {
        let reach = 4.0 * first.at(i).magnitude() + f64::MIN_POSITIVE;
        image.at(i).widened(reach)
    });
    let more = added(&wide);
    let found = Bounds::of(n, |i| image.at(i) + more.at(i));
    let holds = (0..n).all(|i| wide.at(i).contains(found.at(i)));
    match norm < 0.5 && holds {
        true => found,
        false => Bounds::of(n, |_| Interval::WHOLE),
    }
}
