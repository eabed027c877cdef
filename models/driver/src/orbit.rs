//! Periodic orbits and Lyapunov exponents of a model whose type is erased.

use dalembert::contract::Variational;
use dalembert::describe::VariationalVisitor;
use dalembert::integrate::Chosen;
use dalembert::law::Law;
use dalembert::variations::orbit::ITERATIONS;
use dalembert::variations::{Orbit, OrbitError, Section, SectionError};
use dalembert::{
    Instance, Policies, Scene, SceneEffects, StateError, StateVector, Taylor, Tolerance,
};

use crate::model::Point;
use crate::refusal::Refusal;
use crate::typed::point;

/// Request for a periodic orbit, or for an exponent.
#[derive(Debug, Clone)]
pub struct Search {
    /// The index of the surface that is the section.
    pub surface: usize,
    /// Number of returns in a period, or over which deviations grow.
    pub returns: u32,
    /// Longest time of one return.
    pub horizon: f64,
    /// The tolerance of the integrator.
    pub tolerance: Tolerance,
    /// Laws by index of the surface, instead of the declared ones; of two for one surface the later counts.
    pub laws: Vec<(usize, Law)>,
    /// Policies of impacts after which the law alone does not determine the motion.
    pub policies: Policies,
}

/// A periodic orbit as plain data.
#[derive(Debug, Clone)]
pub struct Found {
    /// The period.
    pub period: f64,
    /// The point of the section.
    pub before: Point,
    /// The state after the event at the section.
    pub after: Point,
    /// Distance between the point of the section and its image.
    pub residual: f64,
    /// Number of Newton steps.
    pub iterations: u32,
    /// Directions of the section, each in components of the state.
    pub directions: Vec<Vec<f64>>,
    /// The derivative of the return in these directions, row after row.
    pub derivative: Vec<f64>,
    /// The Floquet multipliers: real and imaginary parts.
    pub multipliers: Vec<[f64; 2]>,
}

/// Searches for an orbit of a model of any type, from the first arrival from this state on.
pub(crate) struct Finder<'a> {
    pub search: &'a Search,
    pub q: &'a [f64],
    pub qdot: &'a [f64],
}

impl VariationalVisitor for Finder<'_> {
    /// The inner error explains why there is no orbit, the outer one why no run starts.
    type Output = Result<Result<Found, OrbitError>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let start = started(system, self.q, self.qdot)?;
        let mut stepper = Taylor::new(self.search.tolerance);
        let mut section =
            section(system, self.search, &mut stepper).with_returns(self.search.returns);
        let orbit = section
            .arrive(&start, &mut [])
            .map_err(OrbitError::from)
            .and_then(|first| section.periodic(&first.before, ITERATIONS));
        match orbit {
            Ok(orbit) => Ok(Ok(found(system, &orbit))),
            Err(error) => begun(error).map(Err),
        }
    }
}

/// Computes the exponent of a model of any type, from the first arrival from this state on.
pub(crate) struct Measurer<'a> {
    pub search: &'a Search,
    pub q: &'a [f64],
    pub qdot: &'a [f64],
}

impl VariationalVisitor for Measurer<'_> {
    /// The inner error explains why there is no exponent, the outer one why no run starts.
    type Output = Result<Result<f64, OrbitError>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let start = started(system, self.q, self.qdot)?;
        let mut stepper = Taylor::new(self.search.tolerance);
        let mut section = section(system, self.search, &mut stepper);
        match section.exponent(&start, self.search.returns) {
            Ok(exponent) => Ok(Ok(exponent)),
            Err(error) => begun(error).map(Err),
        }
    }
}

/// The error, unless it is that no run starts.
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

/// The section of a search, with one return.
fn section<'a, S: Instance + Scene + Variational>(
    system: &'a S,
    search: &Search,
    stepper: &'a mut Taylor<S>,
) -> Section<'a, S, Chosen<'a, S>, S::Effects> {
    let mut effects = system.effects();
    for &(surface, law) in &search.laws {
        effects.set_law(surface, law);
    }
    effects.set_policies(search.policies);
    Section::new(
        system,
        Chosen::new(stepper),
        effects,
        search.surface,
        search.horizon,
    )
}

fn found<S: Instance + Variational>(system: &S, orbit: &Orbit<S>) -> Found {
    let dimension = orbit.dimension;
    let columns = &orbit.derivative.as_ref()[..dimension];
    let rows = (0..dimension).flat_map(|i| columns.iter().map(move |column| column.as_slice()[i]));
    Found {
        period: orbit.point.time,
        before: point(system, 0.0, &orbit.point.before),
        after: point(system, 0.0, &orbit.point.after),
        residual: orbit.residual,
        iterations: orbit.iterations,
        directions: orbit.directions.as_ref()[..dimension]
            .iter()
            .map(|direction| direction.as_slice().to_vec())
            .collect(),
        derivative: rows.collect(),
        multipliers: orbit.multipliers.iter().collect(),
    }
}
