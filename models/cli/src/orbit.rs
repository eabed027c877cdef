//! Periodic orbits of a model, behind a trait that knows nothing of its type.

use dalembert::contract::Variational;
use dalembert::describe::{Description, VariationalVisitor};
use dalembert::integrate::Chosen;
use dalembert::law::Law;
use dalembert::variations::orbit::ITERATIONS;
use dalembert::variations::{Orbit, OrbitError, Section, SectionError, Undefined};
use dalembert::{Instance, Outcome, Policies, Scene, SceneEffects, StateVector, Taylor, Tolerance};
use serde_json::Value;

use crate::driver::details;
use crate::entry::{Point, point};
use crate::{json, names};

/// What is looked for.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    pub surface: usize,
    pub returns: u32,
    pub horizon: f64,
    pub tolerance: Tolerance,
    /// Laws by index of the surface, instead of the declared ones; a later one counts.
    pub laws: Vec<(usize, Law)>,
    pub policies: Policies,
}

/// An orbit, in numbers.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub period: f64,
    /// The point of the section, and the state after what happens there.
    pub before: Point,
    pub after: Point,
    pub residual: f64,
    pub iterations: u32,
    /// Directions of the section, each in components of the state.
    pub directions: Vec<Vec<f64>>,
    /// The derivative of the return in these directions, row after row.
    pub derivative: Vec<f64>,
    /// Real and imaginary parts.
    pub multipliers: Vec<[f64; 2]>,
}

/// Why there is none: a kind, and what it says besides, by name.
#[derive(Debug, Clone)]
pub(crate) struct Missed {
    pub kind: &'static str,
    pub details: Vec<(&'static str, Value)>,
}

/// Looks for an orbit of whatever model it is shown, from the first arrival from this state on.
pub(crate) struct Finder<'a> {
    pub search: &'a Search,
    pub q: &'a [f64],
    pub qdot: &'a [f64],
}

impl VariationalVisitor for Finder<'_> {
    /// `Err` of the inner result where there is no orbit, of the outer where no run begins.
    type Output = Result<Result<Found, Missed>, String>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        let search = self.search;
        let mut effects = system.effects();
        for &(surface, law) in &search.laws {
            effects.set_law(surface, law);
        }
        effects.set_policies(search.policies);
        let [mut q, mut qdot] = [system.zero_vector(); 2];
        q.as_mut_slice().copy_from_slice(self.q);
        qdot.as_mut_slice().copy_from_slice(self.qdot);
        let start = system.state_unchecked(0.0, &q, &qdot);
        let start = start.map_err(|fault| fault.to_string())?;
        let mut stepper = Taylor::new(search.tolerance);
        let mut section = Section::new(
            system,
            Chosen::new(&mut stepper),
            effects,
            search.surface,
            search.horizon,
        )
        .with_returns(search.returns);
        let orbit = section
            .arrive(&start, &mut [])
            .map_err(OrbitError::from)
            .and_then(|first| section.periodic(&first.before, ITERATIONS));
        match orbit {
            Ok(orbit) => Ok(Ok(found(system, &orbit))),
            Err(OrbitError::Section(SectionError::Start(error))) => Err(error.to_string()),
            Err(error) => Ok(Err(missed(system.description(), &error))),
        }
    }
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

fn missed(description: &Description, error: &OrbitError) -> Missed {
    let (kind, details) = match error {
        OrbitError::Section(SectionError::Ended(Outcome::Done)) => ("no_return", Vec::new()),
        OrbitError::Section(SectionError::Ended(outcome)) => {
            (outcome.kind(), details(description, outcome))
        }
        OrbitError::Section(SectionError::Undefined(undefined)) => {
            (undefined.kind(), place(description, undefined))
        }
        OrbitError::DependsOnTime => ("depends_on_time", Vec::new()),
        OrbitError::NotConverged {
            residual,
            iterations,
        } => {
            let details = vec![
                ("residual", json::number(*residual)),
                ("iterations", Value::from(*iterations)),
            ];
            ("not_converged", details)
        }
        _ => ("no_multipliers", Vec::new()),
    };
    Missed { kind, details }
}

/// Where a run has no derivative.
fn place(description: &Description, undefined: &Undefined) -> Vec<(&'static str, Value)> {
    match *undefined {
        Undefined::Graze { t, surface }
        | Undefined::Corner { t, surface }
        | Undefined::Held { t, surface }
        | Undefined::Unlawful { t, surface }
        | Undefined::Refracted { t, surface } => {
            let name = names::surfaces(description).nth(surface);
            vec![("surface", name.into()), ("after", json::number(t))]
        }
        Undefined::NotFinite { t } => vec![("after", json::number(t))],
        _ => Vec::new(),
    }
}
