//! Periodic orbits, their branches, and Lyapunov exponents of a system of any type, as plain data.

use dalembert::contract::Variational;
use dalembert::describe::VariationalVisitor;
use dalembert::integrate::Chosen;
use dalembert::law::Law;
use dalembert::variations::group::{Element, Group};
use dalembert::variations::orbit::ITERATIONS;
use dalembert::variations::{Orbit, OrbitError, Section, SectionError};
use dalembert::{
    Instance, Policies, Scene, SceneEffects, StateError, StateVector, Taylor, Tolerance,
};

use crate::continuation::curves::{Plane, curves};
use crate::continuation::family::Failure;
use crate::continuation::indicator::Precision;
use crate::continuation::orbits::Orbits;
use crate::continuation::trace::{Tracer, Watch};
use crate::continuation::{Branch, Continuation};
use crate::model::{Point, point};
use crate::modulo::Symmetries;
use crate::refusal::Refusal;

/// Request for a periodic orbit, or for a Lyapunov exponent.
#[derive(Debug, Clone)]
pub struct Search {
    /// The index of the surface that is the section.
    pub surface: usize,
    /// Number of returns in a period, or number of returns over which the growth of deviations is measured.
    pub returns: u32,
    /// Longest time of one return.
    pub horizon: f64,
    /// The tolerance of the integrator.
    pub tolerance: Tolerance,
    /// Laws that replace the declared ones, by index of the surface. The last entry for a surface counts.
    pub laws: Vec<(usize, Law)>,
    /// Policies of impacts after which the law alone does not determine the motion.
    pub policies: Policies,
    /// The symmetries up to which the orbit closes.
    pub modulo: Option<Symmetries>,
}

/// A periodic orbit as plain data.
#[derive(Debug, Clone)]
pub struct Found {
    /// The period.
    pub period: f64,
    /// The point of the section: the state before the event.
    pub before: Point,
    /// The state after the event.
    pub after: Point,
    /// Distance between the point of the section and its image.
    pub residual: f64,
    /// The combination of the symmetries whose flow takes the point to its image: one factor per symmetry.
    pub element: Vec<f64>,
    /// Number of Newton steps.
    pub iterations: u32,
    /// Directions of the section, each in components of the state.
    pub directions: Vec<Vec<f64>>,
    /// The derivative of the return map in these directions, row by row.
    pub derivative: Vec<f64>,
    /// The Floquet multipliers: real and imaginary parts.
    pub multipliers: Vec<[f64; 2]>,
}

/// A computation on the section of a search, for a system of any type.
pub(crate) trait Work {
    /// Its result.
    type Output;

    /// Computes the result from the first arrival after a start.
    fn on<S: Instance + Scene + Variational>(
        self,
        system: &S,
        start: &S::State,
        search: &Search,
    ) -> Result<Self::Output, OrbitError>;
}

/// Visitor that makes a computation from this state on.
pub(crate) struct Visit<'a, W> {
    pub search: &'a Search,
    pub q: &'a [f64],
    pub qdot: &'a [f64],
    pub work: W,
}

impl<W: Work> VariationalVisitor for Visit<'_, W> {
    /// The inner error says why the computation fails, the outer one why no run starts.
    type Output = Result<Result<W::Output, OrbitError>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let start = started(system, self.q, self.qdot)?;
        match self.work.on(system, &start, self.search) {
            Ok(output) => Ok(Ok(output)),
            Err(error) => begun(error).map(Err),
        }
    }
}

/// Search for an orbit.
pub(crate) struct ForOrbit;

impl Work for ForOrbit {
    type Output = Found;

    fn on<S: Instance + Scene + Variational>(
        self,
        system: &S,
        start: &S::State,
        search: &Search,
    ) -> Result<Found, OrbitError> {
        let orbit = orbit(system, start, search)?;
        Ok(found(system, search, &orbit))
    }
}

/// Computation of a return without its derivative.
pub(crate) struct ForReturn;

impl Work for ForReturn {
    type Output = [Point; 2];

    fn on<S: Instance + Scene + Variational>(
        self,
        system: &S,
        start: &S::State,
        search: &Search,
    ) -> Result<[Point; 2], OrbitError> {
        let mut stepper = Taylor::new(search.tolerance);
        let mut section =
            section(system, search, search.horizon, &mut stepper).with_returns(search.returns);
        let first = section.arrive(start, &mut [])?.before;
        let next = section.next(&first, &mut [])?.before;
        Ok([first, next].map(|state| point(system, 0.0, &state)))
    }
}

/// Object that a Lyapunov exponent is measured on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Growth {
    /// A small deviation over the returns of the search.
    OfDeviation,
    /// The periodic orbit through the first arrival, which has as many returns as the search.
    OfOrbit,
}

/// Computation of a Lyapunov exponent.
pub(crate) struct ForExponent(pub Growth);

impl Work for ForExponent {
    type Output = f64;

    fn on<S: Instance + Scene + Variational>(
        self,
        system: &S,
        start: &S::State,
        search: &Search,
    ) -> Result<f64, OrbitError> {
        let mut stepper = Taylor::new(search.tolerance);
        let mut section = section(system, search, search.horizon, &mut stepper);
        match self.0 {
            Growth::OfDeviation => section.exponent(start, search.returns),
            Growth::OfOrbit => {
                let whole = section
                    .with_returns(search.returns)
                    .exponent_of_orbit(start)?;
                Ok(whole / f64::from(search.returns.max(1)))
            }
        }
    }
}

/// Continuation of an orbit.
pub(crate) struct ForBranch<'a> {
    pub request: Continuation,
    pub watch: Watch<'a>,
}

impl Work for ForBranch<'_> {
    type Output = Branch;

    fn on<S: Instance + Scene + Variational>(
        self,
        system: &S,
        start: &S::State,
        search: &Search,
    ) -> Result<Branch, OrbitError> {
        let orbit = orbit(system, start, search)?;
        let Continuation {
            extent,
            across,
            points,
        } = self.request;
        let mut family = Orbits::new(system, search, extent.parameter, &orbit)?;
        let precision = Precision::of(search.tolerance.relative());
        let mut tracer = Tracer::new(&mut family, extent, points, self.watch, precision);
        let value = system.parameter(extent.parameter);
        let state = orbit.point.before;
        let branch = tracer.branch(state.as_slice(), value);
        let mut branch = branch.map_err(|failure| match failure {
            Failure::Missed(error) => error,
            Failure::NotKnown => OrbitError::NoMultipliers,
            _ => OrbitError::NotConverged {
                residual: orbit.residual,
                iterations: orbit.iterations,
            },
        })?;
        if let Some(across) = across {
            let plane = Plane {
                extents: [extent, across],
                value: system.parameter(across.parameter),
                points,
            };
            branch.curves = curves(&mut family, &branch, plane, self.watch, precision);
        }
        Ok(branch)
    }
}

/// The orbit near the first arrival after a start.
fn orbit<S: Instance + Scene + Variational>(
    system: &S,
    start: &S::State,
    search: &Search,
) -> Result<Orbit<S>, OrbitError> {
    let mut stepper = Taylor::new(search.tolerance);
    let mut section =
        section(system, search, search.horizon, &mut stepper).with_returns(search.returns);
    let first = section.arrive(start, &mut [])?;
    section.periodic(&first.before, ITERATIONS)
}

/// Separates a refused start from other errors.
fn begun(error: OrbitError) -> Result<OrbitError, Refusal> {
    match error {
        OrbitError::Section(SectionError::Start(error)) => Err(error.into()),
        error => Ok(error),
    }
}

/// The state at these positions and velocities.
fn started<S: Instance>(system: &S, q: &[f64], qdot: &[f64]) -> Result<S::State, Refusal> {
    let [mut own_q, mut own_qdot] = [system.zero_vector(); 2];
    own_q.as_mut_slice().copy_from_slice(q);
    own_qdot.as_mut_slice().copy_from_slice(qdot);
    let start = system.state_unchecked(0.0, &own_q, &own_qdot);
    Ok(start.map_err(StateError::from)?)
}

/// The section of a search with a single return, which takes at most the time `horizon`.
pub(crate) fn section<'a, S: Instance + Scene + Variational>(
    system: &'a S,
    search: &'a Search,
    horizon: f64,
    stepper: &'a mut Taylor<S>,
) -> Section<'a, S, Chosen<'a, S>, S::Effects> {
    let mut effects = system.effects();
    for &(surface, law) in &search.laws {
        effects.set_law(surface, law);
    }
    effects.set_policies(search.policies);
    let section = Section::new(
        system,
        Chosen::new(stepper),
        effects,
        search.surface,
        horizon,
    );
    match &search.modulo {
        Some(symmetries) => section.modulo(symmetries),
        None => section,
    }
}

impl Search {
    /// The leading coordinates of an element, one per symmetry.
    pub(crate) fn factors(&self, element: &Element) -> Vec<f64> {
        let count = self.modulo.as_ref().map_or(0, Group::dimension);
        element[..count.min(element.len())].to_vec()
    }
}

fn found<S: Instance + Variational>(system: &S, search: &Search, orbit: &Orbit<S>) -> Found {
    let dimension = orbit.dimension;
    let columns = &orbit.derivative.as_ref()[..dimension];
    let rows = (0..dimension).flat_map(|i| columns.iter().map(move |column| column.as_slice()[i]));
    Found {
        period: orbit.point.time,
        before: point(system, 0.0, &orbit.point.before),
        after: point(system, 0.0, &orbit.point.after),
        residual: orbit.residual,
        element: search.factors(&orbit.element),
        iterations: orbit.iterations,
        directions: orbit.directions.as_ref()[..dimension]
            .iter()
            .map(|direction| direction.as_slice().to_vec())
            .collect(),
        derivative: rows.collect(),
        multipliers: orbit.multipliers.iter().collect(),
    }
}
