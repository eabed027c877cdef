//! Proofs of periodic orbits, by fixed points of the Poincare map of a surface.
//!
//! `F` maps the state after an impact on a surface to the state after a later impact on it. `Z` is a box about a point
//! `z`, and `Y` approximates `(DF(z) - I)^-1`. With
//!
//! ```text
//! K = z - Y (F(z) - z) + (I - Y (DF(Z) - I)) (Z - z)
//! ```
//!
//! there is exactly one fixed point in `Z` if `K` lies inside `Z`, and it lies in `K` (Krawczyk). `DF` is the
//! derivative in all directions of the state. It vanishes in the direction of the motion, as all states of one motion
//! have the same image. The method fails if `DF` has the eigenvalue 1: for example if a quantity is conserved, or if
//! the system does not depend on a coordinate.
//!
//! References: R. Krawczyk, *Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken*, Computing 4
//! (1969); R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis* (2009), chapter 8.

use core::fmt;

use super::frame::{Bounds, Matrix, identity, product};
use super::lost::Lost;
use super::run::{CertifiedImpact, CertifiedRun};
use super::series::Field;
use crate::contract::{Impacting, Variational};
use crate::numbers::{Interval, Numbers, Rated, Row};
use crate::state::StateVector;
use crate::variations::transition::Strike;

/// Number of squarings of the derivative for the bound of its spectral radius.
const SQUARINGS: u32 = 8;

/// Maximum number of trial boxes, each about the image of the one before.
const TRIALS: u32 = 4;

/// Maximum number of refinements of a proved orbit.
const REFINEMENTS: u32 = 8;

/// A surface whose impacts are the Poincare section of an orbit.
///
/// ```
/// use dalembert::certified::CertifiedSection;
/// use dalembert::model;
/// use dalembert::numbers::Interval;
///
/// model! {
///     /// `x` falls from 1 to 0 in one unit of time, while `y` goes to 0.
///     pub Conveyor {
///         coordinates { x; y; }
///         field { dot(x) = -1; dot(y) = -y; }
///         impacts { end: x >= 0 => reset { x = 1; y = y; }; }
///     }
/// }
///
/// let section = CertifiedSection::new(&Conveyor {}, 0, 2.0);
/// let orbit = section.periodic(&[1.0, 0.001].into(), 0.01)?;
/// assert!(orbit.point(1).contains(Interval::point(0.0)));
/// // `1/e`
/// assert!(orbit.largest_multiplier < 0.37);
/// # Ok::<(), dalembert::certified::NotProved>(())
/// ```
pub struct CertifiedSection<'a, Sys: Variational + Impacting> {
    field: Field<'a, Sys>,
    surface: usize,
    returns: u32,
    horizon: f64,
}

/// A periodic orbit that provably exists.
pub struct CertifiedOrbit<Sys: Variational> {
    point: Bounds<Sys::State>,
    derivative: Matrix<Sys>,
    /// Enclosure of the period.
    pub period: Interval,
    /// Upper bound of the absolute values of all Floquet multipliers. If it is less than 1, the orbit attracts all
    /// motions that start near it.
    pub largest_multiplier: f64,
}

/// Reason for the failure of a proof.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NotProved {
    /// The motion from the box could not be enclosed up to the section.
    Lost(Lost),
    /// The section is not met again within the horizon.
    NotMet,
    /// The motion, the surfaces or the laws may depend on time. Then a fixed point is not a periodic orbit.
    DependsOnTime,
    /// The map of the section may have an eigenvalue 1.
    Singular,
    /// No trial box is mapped into itself: the boxes are too wide, or they contain no orbit.
    NotContained,
}

impl fmt::Display for NotProved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lost(lost) => lost.fmt(f),
            Self::NotMet => write!(f, "the section is not met within the time allowed"),
            Self::DependsOnTime => write!(f, "the system may depend on time"),
            Self::Singular => write!(f, "the map of the section may have an eigenvalue 1"),
            Self::NotContained => write!(f, "the box is not mapped into itself"),
        }
    }
}

impl core::error::Error for NotProved {}

impl From<Lost> for NotProved {
    fn from(lost: Lost) -> Self {
        Self::Lost(lost)
    }
}

impl<Sys: Variational> CertifiedOrbit<Sys> {
    /// Enclosure of component `i` of the state just after the impact on the section.
    pub fn point(&self, i: usize) -> Interval {
        self.point.at(i)
    }

    /// Enclosure of entry `(i, j)` of the derivative of the map: component `i` of the image with respect to component
    /// `j` of the state.
    pub fn derivative(&self, i: usize, j: usize) -> Interval {
        self.derivative.at(i, j)
    }
}

impl<'a, Sys: Variational + Impacting> CertifiedSection<'a, Sys> {
    /// The section at the surface with this index. One application of the map, all its returns together, may take at
    /// most the time `horizon`.
    pub fn new(system: &'a Sys, surface: usize, horizon: f64) -> Self {
        Self {
            field: Field::new(system),
            surface,
            returns: 1,
            horizon,
        }
    }

    /// Counts this many returns as one application of the map; 0 means 1.
    #[must_use]
    pub fn with_returns(mut self, returns: u32) -> Self {
        self.returns = returns.max(1);
        self
    }

    /// Sets a parameter to a range, as [`CertifiedFlow::with_parameter`](super::CertifiedFlow::with_parameter) does.
    /// The proof then holds for every value in the range.
    #[must_use]
    pub fn with_parameter(mut self, index: usize, range: Interval) -> Self {
        self.field.set_parameter(index, range);
        self
    }

    /// Proves that there is a periodic orbit whose state just after the impact on the section differs from `near` by at
    /// most `radius` in each component. `near` may be the point of an [`Orbit`](crate::variations::Orbit), for example.
    ///
    /// # Errors
    /// [`NotProved`] with the condition that could not be proved.
    pub fn periodic(
        &self,
        near: &Sys::State,
        radius: f64,
    ) -> Result<CertifiedOrbit<Sys>, NotProved> {
        let n = near.count();
        let whole = Bounds::of(n, |i| Interval::point(near.as_slice()[i]).widened(radius));
        let mut region = whole;
        for _ in 0..TRIALS {
            let (image, orbit) = self.contraction(&region)?;
            if !image.is_finite() {
                return Err(NotProved::Singular);
            }
            let is_inside = |i: usize| {
                let (image, region) = (image.at(i), region.at(i));
                image.lo > region.lo && image.hi < region.hi
            };
            if (0..n).all(is_inside) {
                return Ok(self.refined(orbit));
            }
            // The next trial box is a widened copy of the image.
            let wider = |i: usize| {
                let range = image.at(i);
                let range = range.widened(0.25 * range.width() + f64::MIN_POSITIVE);
                range.intersection(whole.at(i))
            };
            if (0..n).any(|i| wider(i).is_none()) {
                return Err(NotProved::NotContained);
            }
            region = Bounds::of(n, |i| wider(i).unwrap_or(whole.at(i)));
        }
        Err(NotProved::NotContained)
    }

    /// The same orbit with narrower enclosures. The fixed point lies in the image of every box that contains it.
    fn refined(&self, mut orbit: CertifiedOrbit<Sys>) -> CertifiedOrbit<Sys> {
        for _ in 0..REFINEMENTS {
            match self.contraction(&orbit.point) {
                Ok((image, narrower)) if image.width() < 0.5 * orbit.point.width() => {
                    let point = image.within(&orbit.point);
                    orbit = CertifiedOrbit { point, ..narrower };
                }
                _ => break,
            }
        }
        orbit
    }

    /// The image of a box by Krawczyk's operator, and the orbit, which exists if the box contains this image.
    fn contraction(
        &self,
        region: &Bounds<Sys::State>,
    ) -> Result<(Bounds<Sys::State>, CertifiedOrbit<Sys>), NotProved> {
        let n = region.count();
        let whole = self.returned(region)?;
        let derivative = whole.derivative.ok_or(NotProved::Singular)?;
        let centre = region.middle();
        let point = Bounds::point(&centre);
        let end = self.returned(&point)?.after;
        let unit = |i: usize, j: usize| Interval::point(if i == j { 1.0 } else { 0.0 });
        let mut excess = Matrix::<Sys>::zero(n);
        for i in 0..n {
            for j in 0..n {
                excess.set(i, j, derivative.at(i, j) - unit(i, j));
            }
        }
        let inverse = inverted::<Sys>(n, excess.middle()).ok_or(NotProved::Singular)?;
        let inverse = Matrix::<Sys>::of(&inverse);
        let mut rest = product(&inverse, &excess);
        for i in 0..n {
            for j in 0..n {
                rest.set(i, j, unit(i, j) - rest.at(i, j));
            }
        }
        let missing = Bounds::of(n, |i| end.at(i) - point.at(i));
        let around = Bounds::of(n, |i| region.at(i) - point.at(i));
        let (newton, linear) = (inverse.times_bounds(&missing), rest.times_bounds(&around));
        let image = Bounds::of(n, |i| point.at(i) - newton.at(i) + linear.at(i));
        let orbit = CertifiedOrbit {
            point: image,
            derivative,
            period: whole.time,
            largest_multiplier: spectral_bound(&derivative),
        };
        Ok((image, orbit))
    }

    /// The impact at the last return to the section, for all motions from a box.
    fn returned(&self, from: &Bounds<Sys::State>) -> Result<CertifiedImpact<Sys>, NotProved> {
        let mut run = CertifiedRun::new(self.field.system, 0.0, |i| from.at(i)).with_derivative();
        run.set_field(&self.field);
        let mut left = self.returns;
        loop {
            let impact = run.next_impact(self.horizon)?.ok_or(NotProved::NotMet)?;
            if self.depends_on_time(&impact) {
                return Err(NotProved::DependsOnTime);
            }
            if impact.surface == self.surface {
                left -= 1;
                if left == 0 {
                    return Ok(impact);
                }
            }
        }
    }

    /// True if rates, gaps or the law of this impact may depend on time. They are evaluated over all times, with the
    /// time as the only variable; a rate whose enclosure is not exactly 0 counts as dependence. Conditions of surfaces
    /// are not examined.
    fn depends_on_time(&self, impact: &CertifiedImpact<Sys>) -> bool {
        let surface = impact.surface;
        let times = Rated {
            value: Interval::WHOLE,
            rate: Interval::WHOLE,
        };
        let mut states = Sys::Row::<Rated>::zeros(impact.before.count());
        for (i, entry) in states.as_mut_slice().iter_mut().enumerate() {
            *entry = Rated::steady(impact.before(i));
        }
        let parameters = self.field.steady_parameters();
        let mut firsts = Sys::Firsts::<Rated>::zeros(self.field.system.firsts_len());
        let begun = self
            .field
            .system
            .begin(&parameters, times, &states, &mut firsts);
        let gaps = self.field.system.clearances(&parameters, times, &states);
        let strike = Strike {
            surface,
            chosen: None,
            motion_start: self.field.system.motion_start(&impact.before.middle()),
        };
        let after = strike.applied(self.field.system, &parameters, times, &states);
        let (Ok(()), Ok(gaps), Ok(Some(after))) = (begun, gaps, after) else {
            return true;
        };
        let rates = &firsts.as_slice()[..impact.before.count()];
        let parts = [rates, gaps.as_slice(), after.as_slice()];
        let mut all = parts.into_iter().flatten();
        all.any(|entry| entry.rate != Interval::ZERO || entry.value.is_whole())
    }
}

/// Bound of the spectral radius of every matrix in the enclosure: the smallest `|M^k|^(1/k)` among powers of two `k`.
fn spectral_bound<Sys: Variational>(matrix: &Matrix<Sys>) -> f64 {
    let mut power = *matrix;
    let mut bound = norm(&power);
    let mut exponent = 1.0;
    for _ in 0..SQUARINGS {
        power = product(&power, &power);
        exponent *= 2.0;
        let norm = Interval::point(norm(&power));
        let root = Numbers::powf(norm, 1.0 / exponent).hi;
        // This form of the comparison is false for NaN.
        if root < bound {
            bound = root;
        }
    }
    bound
}

/// The largest sum of absolute values in a row.
fn norm<Sys: Variational>(matrix: &Matrix<Sys>) -> f64 {
    let n = matrix.count();
    (0..n).fold(0.0, |most, i| {
        let row = (0..n).map(|j| Interval::point(matrix.at(i, j).magnitude()));
        f64::max(most, row.fold(Interval::ZERO, |sum, entry| sum + entry).hi)
    })
}

/// Approximate inverse of a matrix stored by columns, by Gauss-Jordan elimination with column pivoting.
fn inverted<Sys: Variational>(n: usize, mut columns: Sys::Columns) -> Option<Sys::Columns> {
    let mut inverse = identity::<Sys>(n);
    // Columns are combined until the matrix is the identity; the same operations turn the identity into the inverse.
    for row in 0..n {
        let size = |j: usize, columns: &Sys::Columns| columns.as_ref()[j].as_slice()[row].abs();
        let pivot = (row..n).fold(row, |best, j| {
            match size(j, &columns) > size(best, &columns) {
                true => j,
                false => best,
            }
        });
        columns.as_mut().swap(row, pivot);
        inverse.as_mut().swap(row, pivot);
        let value = columns.as_ref()[row].as_slice()[row];
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        for both in [&mut columns, &mut inverse] {
            for entry in both.as_mut()[row].as_mut_slice() {
                *entry /= value;
            }
        }
        let (column, own_inverse) = (columns.as_ref()[row], inverse.as_ref()[row]);
        for j in (0..n).filter(|&j| j != row) {
            let factor = columns.as_ref()[j].as_slice()[row];
            subtract(&mut columns.as_mut()[j], factor, &column);
            subtract(&mut inverse.as_mut()[j], factor, &own_inverse);
        }
    }
    Some(inverse)
}

fn subtract<S: StateVector>(from: &mut S, factor: f64, vector: &S) {
    for (entry, component) in from.as_mut_slice().iter_mut().zip(vector.as_slice()) {
        *entry -= factor * component;
    }
}
