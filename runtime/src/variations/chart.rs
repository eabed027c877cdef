//! Directions along a section, and linear equations in them. Matrices are arrays of columns.

use super::group::{Group, generators};
use super::slice::Slice;
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::math;
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;
use crate::variations::flow::{dual_parameters, dual_state};

/// Singular values below this multiple of the largest one count as 0; of 1 if the largest one is below 1.
const RANK: f64 = 1e-7;

/// A direction is dependent on others if its orthogonal part is at most this fraction of its length.
pub(super) const DEPENDENT: f64 = 1e-10;

/// Maximum number of sweeps of Jacobi rotations over all pairs of columns.
const SWEEPS: usize = 60;

/// Maximum number of Newton steps onto the section.
const STEPS: usize = 12;

/// Tangent directions of a section at a point. Along them, neither the gap nor the constraints change. The directions
/// of a group are excluded.
pub(super) struct Chart<Sys: Variational> {
    /// Orthonormal basis, in units of the components: first the excluded directions, then those of the section.
    frame: Sys::Columns,
    /// Number of excluded directions.
    left_out: usize,
    slice: Slice<Sys::State>,
    scale: Sys::State,
}

impl<Sys: Variational> Clone for Chart<Sys> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Sys: Variational> Copy for Chart<Sys> {}

/// Equations of a section: the gap of a surface is 0, and the deviations from the constraints keep their values. A
/// deviation that depends on time does not hold the points of a section, which have no time: for `dot(phi) = w` the
/// motion keeps `phi - w*t`, and an orbit may have any `phi`.
pub(super) struct Fixed<Sys: Variational> {
    surface: usize,
    /// The deviations. Direction 0 is time.
    kept: Sys::Deviations<Dual>,
}

impl<Sys: Variational> Fixed<Sys> {
    /// The equations of the section through a point.
    pub(super) fn of(
        system: &Sys,
        surface: usize,
        t: f64,
        point: &Sys::State,
    ) -> Result<Self, Undefined> {
        let parameters = dual_parameters(system, &[]);
        let row = dual_state::<Sys>(point, &[]);
        let mut by_time = [0.0; DIRECTIONS];
        by_time[0] = 1.0;
        let kept = system.deviations(&parameters, Dual::new(t, by_time), &row)?;
        Ok(Self { surface, kept })
    }

    /// Calls `take` with the index of each equation and its residual at a point, with derivatives along some
    /// directions.
    fn excess(
        &self,
        system: &Sys,
        t: f64,
        point: &Sys::State,
        along: &[Tangent<Sys>],
        mut take: impl FnMut(usize, Dual),
    ) -> Result<(), Undefined> {
        let parameters = dual_parameters(system, along);
        let row = dual_state(point, along);
        let gaps = system.clearances(&parameters, Dual::of(t), &row)?;
        take(0, gaps.as_slice()[self.surface]);
        let deviations = system.deviations(&parameters, Dual::of(t), &row)?;
        let both = deviations.as_slice().iter().zip(self.kept.as_slice());
        let timeless = both.filter(|(_, kept)| kept.slopes()[0] == 0.0);
        for (k, (entry, kept)) in timeless.enumerate() {
            take(k + 1, *entry - Dual::of(kept.value));
        }
        Ok(())
    }
}

impl<Sys: Variational> Chart<Sys> {
    /// The directions at a point, and a step to first order. Without a parameter, the step moves the point onto the
    /// section. With a parameter, it is the change per unit of the parameter that keeps the point on the section.
    fn at(
        system: &Sys,
        (fixed, group): (&Fixed<Sys>, Option<&dyn Group>),
        t: f64,
        point: &Sys::State,
        parameter: Option<usize>,
    ) -> Result<(Self, Sys::State), Undefined> {
        let scale = system.scale(t, point);
        let mut frame = columns(system);
        let mut values = system.zero_state();
        let mut equations = 0;
        for first in (0..system.state_len()).step_by(DIRECTIONS) {
            let along: [Tangent<Sys>; DIRECTIONS] = core::array::from_fn(|k| {
                let mut tangent = Tangent::<Sys>::of_component(first + k);
                for (entry, scale) in tangent
                    .state
                    .as_mut_slice()
                    .iter_mut()
                    .zip(scale.as_slice())
                {
                    *entry *= scale;
                }
                tangent
            });
            fixed.excess(system, t, point, &along, |equation, excess| {
                equations = equations.max(equation + 1);
                values.as_mut_slice()[equation] = excess.value;
                let row = frame.as_mut()[equation].as_mut_slice();
                for (entry, slope) in row.iter_mut().skip(first).zip(excess.slopes()) {
                    *entry = slope;
                }
            })?;
        }
        if let Some(parameter) = parameter {
            let along = [Tangent::<Sys>::of_parameter(parameter)];
            fixed.excess(system, t, point, &along, |equation, excess| {
                values.as_mut_slice()[equation] = excess.slopes()[0];
            })?;
        }
        let mut correction = system.zero_state();
        let mut left_out = orthonormalise(frame.as_mut(), equations, &values, &mut correction);
        let mut slice = Slice::none(system.zero_state());
        if let Some(group) = group {
            let mut rates = generators(system, group, point)?;
            for rate in &mut rates {
                for (entry, scale) in rate.as_mut_slice().iter_mut().zip(scale.as_slice()) {
                    *entry /= scale;
                }
            }
            left_out = slice.cut(frame.as_mut(), left_out, rates);
            slice.solve(&rates, columns(system).as_mut(), columns(system).as_mut());
        }
        complete(frame.as_mut(), left_out);
        for (entry, scale) in correction.as_mut_slice().iter_mut().zip(scale.as_slice()) {
            *entry *= scale;
        }
        let chart = Self {
            frame,
            left_out,
            slice,
            scale,
        };
        Ok((chart, correction))
    }

    /// The point of the section near a given point, and the directions there.
    pub(super) fn onto(
        system: &Sys,
        on: (&Fixed<Sys>, Option<&dyn Group>),
        t: f64,
        mut point: Sys::State,
    ) -> Result<(Self, Sys::State), Undefined> {
        for _ in 0..STEPS {
            let (_, correction) = Self::at(system, on, t, &point, None)?;
            let before = point;
            add(&mut point, 1.0, &correction);
            if point == before || !point.is_finite() {
                break;
            }
        }
        match point.is_finite() {
            true => Ok((Self::at(system, on, t, &point, None)?.0, point)),
            false => Err(Undefined::NotFinite { t }),
        }
    }

    /// The least change of a point of the section, per unit of a parameter, that keeps it on the section.
    pub(super) fn shift(
        system: &Sys,
        fixed: &Fixed<Sys>,
        t: f64,
        point: &Sys::State,
        parameter: usize,
    ) -> Result<Sys::State, Undefined> {
        Ok(Self::at(system, (fixed, None), t, point, Some(parameter))?.1)
    }

    /// The units of the components.
    pub(super) fn scale(&self) -> &Sys::State {
        &self.scale
    }

    /// Number of directions.
    pub(super) fn dimension(&self) -> usize {
        self.scale.count() - self.left_out
    }

    /// A direction, in units of the state.
    pub(super) fn direction(&self, index: usize) -> Sys::State {
        let mut direction = self.frame.as_ref()[self.left_out + index];
        for (entry, scale) in direction
            .as_mut_slice()
            .iter_mut()
            .zip(self.scale.as_slice())
        {
            *entry *= scale;
        }
        direction
    }

    /// The components of a change of the state along the directions of the section.
    pub(super) fn components(&self, change: &Sys::State) -> Sys::State {
        let mut scaled = self.scaled(change);
        self.slice.project(&mut scaled);
        products(&scaled, &self.frame.as_ref()[self.left_out..])
    }

    /// The values of the functions that define the slice across the group, for a change of the state.
    pub(super) fn along_group(&self, change: &Sys::State) -> Sys::State {
        products(&self.scaled(change), self.slice.functions())
    }

    /// A change of the state in units of its components.
    fn scaled(&self, change: &Sys::State) -> Sys::State {
        let mut scaled = *change;
        for (entry, scale) in scaled.as_mut_slice().iter_mut().zip(self.scale.as_slice()) {
            *entry /= scale;
        }
        scaled
    }

    /// The size of a change of the state, in units of its components.
    pub(super) fn size(&self, change: &Sys::State) -> f64 {
        let parts = change.as_slice().iter().zip(self.scale.as_slice());
        parts.fold(0.0, |size, (component, scale)| {
            f64::max(size, (component / scale).abs())
        })
    }
}

/// The products of a vector with directions.
pub(super) fn products<S: StateVector>(vector: &S, directions: &[S]) -> S {
    let mut components = vector.zeroed();
    for (component, direction) in components.as_mut_slice().iter_mut().zip(directions) {
        *component = dot(vector, direction);
    }
    components
}

/// A square matrix of zeros, for as many components as a state has.
pub(super) fn columns<Sys: Variational>(system: &Sys) -> Sys::Columns {
    let mut columns = Sys::columns();
    columns.as_mut().fill(system.zero_state());
    columns
}

/// Orthonormalises the first `count` rows, drops dependent ones, and returns the number of rows that remain. Also
/// computes the `correction` of least norm whose products with the original rows are `-values`.
fn orthonormalise<S: StateVector>(
    rows: &mut [S],
    count: usize,
    values: &S,
    correction: &mut S,
) -> usize {
    let mut kept = 0;
    for index in 0..count {
        let row = rows[index];
        let missing = -values.as_slice()[index] - dot(&row, correction);
        rows[index] = row.zeroed();
        if let Some(left) = adjoin(rows, kept, row) {
            add(correction, missing / left, &rows[kept]);
            kept += 1;
        }
    }
    kept
}

/// Orthonormalises a row against the first `kept`, which are orthonormal, and appends it unless it depends on them.
/// Returns the length of its orthogonal part.
pub(super) fn adjoin<S: StateVector>(rows: &mut [S], kept: usize, mut row: S) -> Option<f64> {
    let before = math::sqrt(dot(&row, &row));
    for _ in 0..2 {
        for earlier in &rows[..kept] {
            let along = dot(&row, earlier);
            add(&mut row, -along, earlier);
        }
    }
    let left = math::sqrt(dot(&row, &row));
    if kept >= row.count() || left.is_nan() || left <= DEPENDENT * before {
        return None;
    }
    for entry in row.as_mut_slice() {
        *entry /= left;
    }
    rows[kept] = row;
    Some(left)
}

/// Completes `count` orthonormal rows to a basis, with the unit vectors that have the largest orthogonal parts.
fn complete<S: StateVector>(rows: &mut [S], count: usize) {
    let dimension = rows.first().map_or(0, StateVector::count);
    for kept in count..dimension {
        let mut best = (0.0, rows[kept].zeroed());
        for component in 0..dimension {
            let mut row = rows[kept].zeroed();
            row.as_mut_slice()[component] = 1.0;
            for _ in 0..2 {
                for earlier in &rows[..kept] {
                    let along = dot(&row, earlier);
                    add(&mut row, -along, earlier);
                }
            }
            let left = dot(&row, &row);
            // The factor selects the first of several remainders that are equal up to rounding.
            if left > 1.000_001 * best.0 {
                best = (left, row);
            }
        }
        let (left, mut row) = best;
        let norm = math::sqrt(left);
        for entry in row.as_mut_slice() {
            *entry /= norm;
        }
        rows[kept] = row;
    }
}

/// The `x` that minimises `|A x - b|^2 + damping |x|^2`, with component 0 along singular vectors whose singular values
/// count as 0. `A` consists of the first `size` of the `columns`. `columns` and `turned` are overwritten.
///
/// One-sided Jacobi method (Hestenes): pairs of columns are rotated until all are orthogonal.
pub(super) fn least_squares<S: StateVector>(
    columns: &mut [S],
    turned: &mut [S],
    size: usize,
    b: &S,
    damping: f64,
) -> S {
    for (i, column) in turned.iter_mut().enumerate().take(b.count()) {
        *column = b.zeroed();
        column.as_mut_slice()[i] = 1.0;
    }
    for _ in 0..SWEEPS {
        let mut is_done = true;
        for i in 0..size {
            for j in i + 1..size {
                let [one, other] = [&columns[i], &columns[j]];
                let (a, b, c) = (dot(one, one), dot(other, other), dot(one, other));
                if c.abs() <= f64::EPSILON * math::sqrt(a * b) {
                    continue;
                }
                is_done = false;
                let zeta = (b - a) / (2.0 * c);
                let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + math::sqrt(1.0 + zeta * zeta));
                let cosine = 1.0 / math::sqrt(1.0 + tangent * tangent);
                turn(columns, [i, j], [cosine, cosine * tangent]);
                turn(turned, [i, j], [cosine, cosine * tangent]);
            }
        }
        if is_done {
            break;
        }
    }
    let squares = columns[..size].iter().map(|column| dot(column, column));
    let largest = squares.fold(1.0, f64::max);
    let mut solution = b.zeroed();
    for (column, direction) in columns[..size].iter().zip(turned.iter()) {
        let square = dot(column, column);
        if square > RANK * RANK * largest {
            add(
                &mut solution,
                dot(column, b) / (square + damping),
                direction,
            );
        }
    }
    solution
}

/// Rotates two columns by the angle with this cosine and sine.
fn turn<S: StateVector>(columns: &mut [S], [i, j]: [usize; 2], [cosine, sine]: [f64; 2]) {
    let (one, other) = (columns[i], columns[j]);
    for k in 0..one.count() {
        let (x, y) = (one.as_slice()[k], other.as_slice()[k]);
        columns[i].as_mut_slice()[k] = cosine * x - sine * y;
        columns[j].as_mut_slice()[k] = sine * x + cosine * y;
    }
}

pub(super) fn dot<S: StateVector>(a: &S, b: &S) -> f64 {
    let pairs = a.as_slice().iter().zip(b.as_slice());
    pairs.map(|(x, y)| x * y).sum()
}

/// Adds `factor * direction`.
pub(super) fn add<S: StateVector>(sum: &mut S, factor: f64, direction: &S) {
    for (component, entry) in sum.as_mut_slice().iter_mut().zip(direction.as_slice()) {
        *component += factor * entry;
    }
}
