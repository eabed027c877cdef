//! Periodic orbits: fixed points of the Poincare map of a section, by Newton's method with its derivative.

use core::fmt;

use super::chart::{Chart, Fixed, add, columns, dot, least_squares};
use super::eigenvalues::{Multipliers, eigenvalues};
use super::group::{Element, GENERATORS, align, pull};
use super::section::{Arrival, Passed, Section, SectionError};
use super::{Tangent, Undefined};
use crate::contract::Variational;
use crate::describe::{Instance, Topology};
use crate::effects::Effect;
use crate::integrate::Stepper;
use crate::state::StateVector;

/// Default maximum number of Newton steps.
pub const ITERATIONS: u32 = 50;

/// Maximum number of halvings of one step.
const HALVINGS: u32 = 12;

/// Residual that counts as 0, relative to the size of the state times the amplification of the orbit, or to 1 if that
/// is larger.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// The same bound in units of the integrator's tolerance. The larger of the two bounds applies.
const STEPS: f64 = 16.0;

/// Ratio of the decrease of the miss to that of the linear model above which the model is trusted more, and below which it
/// is trusted less, and the factor by which the damping changes then.
const TRUSTED: f64 = 0.75;
const DISTRUSTED: f64 = 0.25;
const EASED: f64 = 0.25;

/// A closed point is final if its residual exceeds this multiple of the residual before it.
const LAST_GAIN: f64 = 0.25;

/// Allowed residual of a closed orbit, relative to its length.
const CLOSED: f64 = 1e-6;

/// A periodic orbit: a point of a section that returns to itself.
pub struct Orbit<Sys: Variational> {
    /// The point of the section, with the states before and after the transition there; the time is the period.
    pub point: Arrival<Sys::State>,
    /// Distance of the point from its image, in units of the components of the state.
    pub residual: f64,
    /// Number of Newton steps.
    pub iterations: u32,
    /// Number of directions of the section within the constraints, without those of the group. For a state `(q, u)` of
    /// N coordinates and N - M quasi-velocities, without a group, it is 2 N - M - 1.
    pub dimension: usize,
    /// The first `dimension` columns are directions along the section, orthonormal in units of the components.
    pub directions: Sys::Columns,
    /// The leading square of size `dimension` is the derivative of the Poincare map in these directions: the
    /// monodromy matrix, without the direction of the motion.
    pub derivative: Sys::Columns,
    /// Eigenvalues of `derivative`: the Floquet multipliers of the orbit, without the multiplier 1 along the motion.
    /// Every conserved quantity, and every coordinate that nothing depends on, gives a multiplier 1. For an orbit
    /// modulo a group, the directions of the group are left out.
    pub multipliers: Multipliers<Sys::State>,
    /// The element of the group that takes the point to its image, see [`Section::modulo`].
    pub element: Element,
}

/// Reason why no orbit was found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum OrbitError {
    /// A trial point is not mapped back to the section, or its map has no derivative.
    Section(SectionError),
    /// The motion or its transitions depend on time, so that successive returns have different maps.
    DependsOnTime,
    /// Newton's method does not converge.
    NotConverged {
        /// Least distance of a point from its image, in units of the components of the state.
        residual: f64,
        /// Number of steps.
        iterations: u32,
    },
    /// The multipliers are not finite.
    NoMultipliers,
}

impl fmt::Display for OrbitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Section(error) => error.fmt(f),
            Self::DependsOnTime => write!(
                f,
                "the system depends on time, so its return map is not the same at all times"
            ),
            Self::NotConverged {
                residual,
                iterations,
            } => write!(
                f,
                "no periodic orbit was found in {iterations} steps; the best point differs from its image by {residual:e}"
            ),
            Self::NoMultipliers => write!(f, "the multipliers are not finite"),
        }
    }
}

impl core::error::Error for OrbitError {}

impl From<SectionError> for OrbitError {
    fn from(error: SectionError) -> Self {
        Self::Section(error)
    }
}

impl From<Undefined> for OrbitError {
    fn from(undefined: Undefined) -> Self {
        Self::Section(undefined.into())
    }
}

/// A point of the section and its return.
pub(super) struct Trial<Sys: Variational> {
    pub(super) point: Sys::State,
    pub(super) chart: Chart<Sys>,
    pub(super) passed: Passed<Sys>,
    /// Image minus point.
    change: Sys::State,
    /// The same along the directions.
    pub(super) miss: Sys::State,
    pub(super) residual: f64,
    pub(super) derivative: Sys::Columns,
    /// The element of the group whose inverse was applied to the image.
    pub(super) element: Element,
    /// Change of the point that keeps it on the section, per unit of the parameter; 0 without a parameter.
    pub(super) shift: Sys::State,
    /// Change of the miss along the directions, per unit of the parameter; 0 without a parameter.
    pub(super) slope: Sys::State,
}

impl<'a, Sys, Step, Effects> Section<'a, Sys, Step, Effects>
where
    Sys: Variational + Instance,
    Step: Stepper<Sys>,
    Effects: Effect<Sys>,
{
    /// The periodic orbit near a point on or near the section, by Newton's method in at most `iterations` steps
    /// ([`ITERATIONS`] is enough).
    ///
    /// Angles need to return only up to full turns. If orbits form a family, as in every conservative system, the
    /// iteration converges to a member near the point. A step that does not bring point and image closer is halved.
    ///
    /// # Errors
    /// [`OrbitError::Section`] where a point is not mapped back or the map has no derivative,
    /// [`OrbitError::DependsOnTime`] for a system that depends on time, [`OrbitError::NotConverged`]
    /// after the last step, [`OrbitError::NoMultipliers`] if the eigenvalues are not finite.
    pub fn periodic(
        &mut self,
        near: &Sys::State,
        iterations: u32,
    ) -> Result<Orbit<Sys>, OrbitError> {
        if self.system.depends_on_time() {
            return Err(OrbitError::DependsOnTime);
        }
        let fixed = Fixed::of(self.system, self.surface, 0.0, near)?;
        let mut trial = self.attempt(&fixed, *near, None, None)?;
        let (mut made, mut damping) = (0, 1.0);
        while trial.residual > 0.0 && made < iterations {
            made += 1;
            let Some(better) = self.improve(&fixed, &trial, &mut damping)? else {
                break;
            };
            let is_last = better.residual > LAST_GAIN * trial.residual;
            trial = better;
            if is_last && self.is_closed(&trial)? {
                break;
            }
        }
        match self.is_closed(&trial)? {
            true => finish(self.system, trial, made),
            false => Err(OrbitError::NotConverged {
                residual: trial.residual,
                iterations: made,
            }),
        }
    }

    /// True if a point is its own image up to errors of rounding and of the integrator, and the residual is small
    /// relative to the length of the orbit. The second condition excludes a motion that comes to rest: it returns to
    /// its point, but is no orbit.
    pub(super) fn is_closed(&self, trial: &Trial<Sys>) -> Result<bool, Undefined> {
        let mut rate = self.system.zero_state();
        self.system.rate(0.0, &trial.point, &mut rate)?;
        let way = trial.chart.size(&rate) * trial.passed.time;
        let size = trial.chart.size(&trial.point) * amplification::<Sys>(trial);
        // A point at 0 has no size of its own. A small orbit has small errors.
        let size = size.max(way.min(1.0));
        let least = f64::max(ROUNDING, STEPS * self.tolerance) * size;
        Ok(trial.residual <= f64::min(least, CLOSED * way))
    }

    /// A better point along the Newton step, if one is found. Adapts the damping of the next step to how well the linear
    /// model has predicted this one.
    fn improve(
        &mut self,
        fixed: &Fixed<Sys>,
        trial: &Trial<Sys>,
        damping: &mut f64,
    ) -> Result<Option<Trial<Sys>>, OrbitError> {
        let (step, predicted) = newton(self.system, trial, *damping);
        let mut factor = 1.0;
        let mut failure = None;
        for _ in 0..HALVINGS {
            let mut point = trial.point;
            add(&mut point, factor, &step);
            match self.attempt(fixed, point, None, Some(trial.element)) {
                Ok(better) if is_nearer(&better, trial) => {
                    let [before, after] =
                        [trial, &better].map(|it| length(&trial.chart, &it.change));
                    let gain = (before - after) / (before - predicted);
                    if gain > TRUSTED {
                        *damping *= EASED;
                    } else if gain < DISTRUSTED {
                        *damping = (*damping / EASED).min(1.0);
                    }
                    return Ok(Some(better));
                }
                Ok(_) => failure = None,
                Err(error) => failure = Some(error),
            }
            factor *= 0.5;
        }
        match failure {
            Some(error) => Err(error),
            None => Ok(None),
        }
    }

    /// Moves a point onto the section and maps it. Computes the derivatives of the image along the directions of the
    /// section and, if given, by a parameter.
    pub(super) fn attempt(
        &mut self,
        fixed: &Fixed<Sys>,
        point: Sys::State,
        parameter: Option<usize>,
        near: Option<Element>,
    ) -> Result<Trial<Sys>, OrbitError> {
        let (chart, point) = Chart::onto(self.system, (fixed, self.group), 0.0, point)?;
        let dimension = chart.dimension();
        let mut tangents = Sys::tangents();
        for (index, tangent) in tangents.as_mut()[..dimension].iter_mut().enumerate() {
            *tangent = Tangent::of_state(chart.direction(index));
        }
        let mut shift = self.system.zero_state();
        let mut carried = dimension;
        if let Some(parameter) = parameter {
            // The section has at least one equation, so it has fewer directions than the state has components, and
            // there is room for one direction more.
            shift = Chart::shift(self.system, fixed, 0.0, &point, parameter)?;
            tangents.as_mut()[dimension] = Tangent {
                state: shift,
                ..Tangent::of_parameter(parameter)
            };
            carried += 1;
        }
        let tangents = &mut tangents.as_mut()[..carried];
        let passed = self.pass(&point, self.returns, tangents)?;
        let (mut image, mut element) = (passed.event.before, [0.0; GENERATORS]);
        if let Some(group) = self.group {
            element = align(self.system, group, &chart, [&point, &image], near)?;
            pull(self.system, group, &element, &mut image, tangents)?;
        }
        let mut derivative = columns(self.system);
        let images = tangents[..dimension].iter();
        for (column, image) in derivative.as_mut().iter_mut().zip(images) {
            *column = chart.components(&image.state);
        }
        let slope = match tangents.get(dimension) {
            Some(image) => {
                let mut change = image.state;
                add(&mut change, -1.0, &shift);
                chart.components(&change)
            }
            None => self.system.zero_state(),
        };
        let mut change = image;
        add(&mut change, -1.0, &point);
        close_angles(self.system, &mut change);
        Ok(Trial {
            point,
            chart,
            passed,
            change,
            miss: chart.components(&change),
            residual: chart.size(&change),
            derivative,
            element,
            shift,
            slope,
        })
    }
}

/// The orbit of a point that returns to itself.
fn finish<Sys: Variational>(
    system: &Sys,
    trial: Trial<Sys>,
    iterations: u32,
) -> Result<Orbit<Sys>, OrbitError> {
    let dimension = trial.chart.dimension();
    let mut directions = columns(system);
    for (index, direction) in directions.as_mut()[..dimension].iter_mut().enumerate() {
        *direction = trial.chart.direction(index);
    }
    let mut work = trial.derivative;
    let multipliers = eigenvalues(work.as_mut(), dimension);
    Ok(Orbit {
        point: Arrival::of(trial.passed.time, &trial.passed.event),
        residual: trial.residual,
        iterations,
        dimension,
        directions,
        derivative: trial.derivative,
        element: trial.element,
        multipliers: multipliers.ok_or(OrbitError::NoMultipliers)?,
    })
}

/// Newton step from a point: `(derivative - 1) step = -miss`, damped by the size of the miss relative to that of the point
/// (Levenberg-Marquardt), times a factor. Returns the length of the miss that the linear model predicts, too.
///
/// Near a family of orbits, `derivative - 1` along the family is as small as the miss, but not 0: undamped steps would
/// wander along the family. Damped steps converge quadratically to a nearby orbit (J. Fan, Y. Yuan, Computing 74
/// (2005)).
fn newton<Sys: Variational>(system: &Sys, trial: &Trial<Sys>, factor: f64) -> (Sys::State, f64) {
    let dimension = trial.chart.dimension();
    let (mut matrix, mut turned) = (trial.derivative, columns(system));
    for (i, column) in matrix.as_mut()[..dimension].iter_mut().enumerate() {
        column.as_mut_slice()[i] -= 1.0;
    }
    let miss = crate::math::sqrt(dot(&trial.miss, &trial.miss));
    let squares = matrix.as_ref()[..dimension].iter().map(|it| dot(it, it));
    let scale = squares.fold(0.0, f64::max).min(1.0);
    let damping = factor * scale * miss / (miss + trial.chart.size(&trial.point));
    let (mut slopes, turned) = (matrix, turned.as_mut());
    let solution = least_squares(slopes.as_mut(), turned, dimension, &trial.miss, damping);
    let (mut step, mut left) = (system.zero_state(), trial.miss);
    for (index, component) in solution.as_slice()[..dimension].iter().enumerate() {
        add(&mut step, -component, &trial.chart.direction(index));
        add(&mut left, -component, &matrix.as_ref()[index]);
    }
    (step, crate::math::sqrt(dot(&left, &left)))
}

/// The length of a change, in units of a chart.
fn length<Sys: Variational>(chart: &Chart<Sys>, change: &Sys::State) -> f64 {
    let parts = change.as_slice().iter().zip(chart.scale().as_slice());
    let squares = parts.map(|(part, scale)| (part / scale) * (part / scale));
    crate::math::sqrt(squares.sum::<f64>())
}

/// True if `better` is closer to its image than `trial`, in the largest component or in length, both in the units of
/// `trial`. A sufficiently short Newton step always lowers the length.
fn is_nearer<Sys: Variational>(better: &Trial<Sys>, trial: &Trial<Sys>) -> bool {
    let chart = &trial.chart;
    chart.size(&better.change) < trial.residual
        || length(chart, &better.change) < length(chart, &trial.change)
}

/// The Frobenius norm of the derivative, at least 1: an upper bound on the factor by which the map lengthens a
/// direction.
fn amplification<Sys: Variational>(trial: &Trial<Sys>) -> f64 {
    let columns = trial.derivative.as_ref()[..trial.chart.dimension()].iter();
    let squares = columns.map(|column| dot(column, column)).sum::<f64>();
    f64::max(crate::math::sqrt(squares), 1.0)
}

/// Removes full turns from the changes of angles.
fn close_angles<Sys: Instance>(system: &Sys, change: &mut Sys::State) {
    let coordinates = system.description().coordinates.iter();
    for (difference, coordinate) in change.as_mut_slice().iter_mut().zip(coordinates) {
        if coordinate.topology == Topology::Circle {
            let turn = 2.0 * core::f64::consts::PI;
            *difference -= turn * libm::round(*difference / turn);
        }
    }
}
