//! Symmetry groups on the states of a system. Relative periodic orbits close up to an element of the group.
//!
//! ```text
//! g = exp(a_1 xi_1 + a_2 xi_2 + ..),   P(z) = g z,   multipliers: eigenvalues of d(g^-1 P) modulo the directions xi_k
//! ```
//!
//! The derivative of `g^-1 P` maps the directions of the group to each other, and therefore acts on the state space
//! modulo these directions.

use super::chart::{Chart, add, columns, least_squares};
use super::flow::{dual_parameters, dual_state, take_slopes};
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::numbers::Row;
use crate::state::StateVector;

/// Largest number of generators of a group: one dual number carries the derivatives with respect to all coordinates of
/// an element.
pub const GENERATORS: usize = DIRECTIONS;

/// Coordinates of an element of a group: the factors of its generators, 0 beyond their number.
pub type Element = [f64; GENERATORS];

/// Maximum number of Newton steps in the search for the element that maps two points to each other.
const STEPS: usize = 30;

/// Longest step of a coordinate of an element, unless the action is linear in it.
const LONGEST: f64 = 1.0;

/// Initial guesses for a coordinate of an element. Angles have several solutions; the best one is taken.
const GUESSES: [f64; 6] = [1.0, -1.0, 2.0, -2.0, 3.0, -3.0];

/// Distances count as equal if their difference is below this fraction, or below this many units.
const SAME: f64 = 1e-3;
const TOUCHING: f64 = 1e-9;

/// A group of symmetries of a system, which acts on positions and, by its derivative, on velocities.
///
/// # Examples
///
/// ```
/// use dalembert::numbers::Numbers;
/// use dalembert::variations::group::GENERATORS;
/// use dalembert::variations::{Dual, Group};
///
/// /// Rotations of a plane about its origin, on positions (x, y).
/// struct Rotations;
///
/// impl Group for Rotations {
///     fn dimension(&self) -> usize {
///         1
///     }
///
///     fn act(&self, element: &[Dual; GENERATORS], q: &mut [Dual], qdot: &mut [Dual]) {
///         let (sine, cosine) = (element[0].sin(), element[0].cos());
///         for vector in [q, qdot] {
///             let [x, y] = [vector[0], vector[1]];
///             vector[0] = x * cosine - y * sine;
///             vector[1] = x * sine + y * cosine;
///         }
///     }
/// }
///
/// let mut element = [Dual::constant(0.0); GENERATORS];
/// element[0] = Dual::constant(std::f64::consts::FRAC_PI_2);
/// let [mut q, mut qdot] = [[1.0, 0.0], [0.0, 1.0]].map(|vector| vector.map(Dual::constant));
/// Rotations.act(&element, &mut q, &mut qdot);
/// assert!((q[1].value - 1.0).abs() < 1e-15 && (qdot[0].value + 1.0).abs() < 1e-15);
/// ```
pub trait Group {
    /// Number of generators, at most [`GENERATORS`].
    fn dimension(&self) -> usize;

    /// Moves a position and a velocity by the element with these coordinates. `q` and `qdot` have one entry per
    /// coordinate of the model. In a model with modes, entries that the present mode does not have are 0, and their
    /// results are ignored.
    fn act(&self, element: &[Dual; GENERATORS], q: &mut [Dual], qdot: &mut [Dual]);
}

/// Rates of a state along the generators of a group, followed by zeros.
pub(super) fn generators<Sys: Variational>(
    system: &Sys,
    group: &dyn Group,
    state: &Sys::State,
) -> Result<[Sys::State; GENERATORS], Undefined> {
    let parameters = dual_parameters(system, &[]);
    let row = dual_state::<Sys>(state, &[]);
    let element = varied([0.0; GENERATORS], 1.0);
    let moved = moved(system, group, &element, &parameters, &row)?;
    let mut rates = [system.zero_state(); GENERATORS];
    for (k, rate) in rates.iter_mut().enumerate() {
        take(&moved, k, rate);
    }
    Ok(rates)
}

/// Moves a state and directions at it by the inverse of an element.
pub(super) fn pull<Sys: Variational>(
    system: &Sys,
    group: &dyn Group,
    element: &Element,
    state: &mut Sys::State,
    tangents: &mut [Tangent<Sys>],
) -> Result<(), Undefined> {
    let inverse = element.map(|factor| Dual::constant(-factor));
    let from = *state;
    for some in tangents.chunks_mut(DIRECTIONS) {
        let parameters = dual_parameters(system, some);
        let row = dual_state::<Sys>(&from, some);
        let moved = moved(system, group, &inverse, &parameters, &row)?;
        take_slopes::<Sys>(&moved, some);
    }
    let parameters = dual_parameters(system, &[]);
    let row = dual_state::<Sys>(&from, &[]);
    let moved = moved(system, group, &inverse, &parameters, &row)?;
    take_values(&moved, state);
    Ok(())
}

/// The element whose inverse brings the image nearest to the point along the directions of the group. `near`: an
/// element from which to start the search.
pub(super) fn align<Sys: Variational>(
    system: &Sys,
    group: &dyn Group,
    chart: &Chart<Sys>,
    [point, image]: [&Sys::State; 2],
    near: Option<Element>,
) -> Result<Element, Undefined> {
    let pair = Pair {
        system,
        group,
        chart,
        point,
        image,
    };
    if let Some(near) = near {
        return Ok(pair.aligned(near)?.0);
    }
    let mut best = pair.aligned([0.0; GENERATORS])?;
    for k in 0..group.dimension().min(GENERATORS) {
        for guess in GUESSES {
            let mut start = [0.0; GENERATORS];
            start[k] = guess;
            let found = pair.aligned(start)?;
            if is_better(found, best) {
                best = found;
            }
        }
    }
    Ok(best.0)
}

/// True if `found` brings two points nearer together than `best`, or as near with smaller coordinates.
fn is_better(found: (Element, f64), best: (Element, f64)) -> bool {
    let margin = f64::max(SAME * best.1, TOUCHING);
    let size = |element: Element| element.iter().map(|entry| entry * entry).sum::<f64>();
    found.1 < best.1 - margin || (found.1 <= best.1 + margin && size(found.0) < size(best.0))
}

/// A point and its image.
struct Pair<'a, Sys: Variational> {
    system: &'a Sys,
    group: &'a dyn Group,
    chart: &'a Chart<Sys>,
    point: &'a Sys::State,
    image: &'a Sys::State,
}

impl<Sys: Variational> Pair<'_, Sys> {
    /// The element near a guess for which the difference has no component along the group, and the size of the
    /// difference.
    fn aligned(&self, mut element: Element) -> Result<(Element, f64), Undefined> {
        let count = GENERATORS
            .min(self.point.count())
            .min(self.group.dimension());
        for _ in 0..STEPS {
            let (miss, mut slopes, _) = self.difference(&element)?;
            let mut turned = columns(self.system);
            let (slopes, turned) = (slopes.as_mut(), turned.as_mut());
            let step = least_squares(slopes, turned, count, &miss, 0.0);
            let longest = step.as_slice()[..count]
                .iter()
                .fold(LONGEST, |longest, entry| f64::max(longest, entry.abs()));
            let factor = match self.is_linear() {
                true => 1.0,
                false => LONGEST / longest,
            };
            let before = element;
            for (entry, change) in element.iter_mut().zip(&step.as_slice()[..count]) {
                *entry -= factor * change;
            }
            if element == before {
                break;
            }
        }
        let (_, _, distance) = self.difference(&element)?;
        let is_finite = element.iter().all(|entry| entry.is_finite());
        Ok((element, if is_finite { distance } else { f64::INFINITY }))
    }

    /// True if the rates along the generators are the same at the image and after the image is moved by an element: the
    /// group then moves states along straight lines.
    fn is_linear(&self) -> bool {
        let rates = |element: Element| -> Option<[Sys::State; GENERATORS]> {
            let mut image = *self.image;
            pull(self.system, self.group, &element, &mut image, &mut []).ok()?;
            generators(self.system, self.group, &image).ok()
        };
        let (Some(here), Some(there)) = (rates([0.0; GENERATORS]), rates([1.0; GENERATORS])) else {
            return false;
        };
        here.iter().zip(&there).all(|(here, there)| {
            let mut change = *there;
            add(&mut change, -1.0, here);
            self.chart.size(&change) <= 1e-12 * self.chart.size(here)
        })
    }

    /// The components along the group of the difference between the image, moved by the inverse of an element, and the
    /// point; their derivatives with respect to the coordinates of the element; the size of the difference.
    fn difference(&self, element: &Element) -> Result<(Sys::State, Sys::Columns, f64), Undefined> {
        let parameters = dual_parameters(self.system, &[]);
        let row = dual_state::<Sys>(self.image, &[]);
        let inverse = varied(element.map(|factor| -factor), -1.0);
        let moved = moved(self.system, self.group, &inverse, &parameters, &row)?;
        let mut change = self.system.zero_state();
        take_values(&moved, &mut change);
        add(&mut change, -1.0, self.point);
        let mut slopes = columns(self.system);
        for (k, column) in slopes.as_mut().iter_mut().take(GENERATORS).enumerate() {
            let mut slope = self.system.zero_state();
            take(&moved, k, &mut slope);
            *column = self.chart.along_group(&slope);
        }
        let miss = self.chart.along_group(&change);
        Ok((miss, slopes, self.chart.size(&change)))
    }
}

/// The coordinates of an element. Coordinate `k` has the derivative `slope` along direction `k`.
fn varied(element: Element, slope: f64) -> [Dual; GENERATORS] {
    core::array::from_fn(|k| {
        let mut slopes = [0.0; DIRECTIONS];
        slopes[k] = slope;
        Dual::new(element[k], slopes)
    })
}

fn moved<Sys: Variational>(
    system: &Sys,
    group: &dyn Group,
    element: &[Dual; GENERATORS],
    parameters: &Sys::Parameters<Dual>,
    row: &Sys::Row<Dual>,
) -> Result<Sys::Row<Dual>, Undefined> {
    let moved = system.relocated(parameters, Dual::constant(0.0), row, |q, qdot| {
        group.act(element, q, qdot);
    })?;
    Ok(moved)
}

/// The derivative of a row along one direction.
fn take<S: StateVector>(row: &impl Row<Dual>, direction: usize, slope: &mut S) {
    for (entry, dual) in slope.as_mut_slice().iter_mut().zip(row.as_slice()) {
        *entry = dual.slopes()[direction];
    }
}

fn take_values<S: StateVector>(row: &impl Row<Dual>, state: &mut S) {
    for (entry, dual) in state.as_mut_slice().iter_mut().zip(row.as_slice()) {
        *entry = dual.value;
    }
}
