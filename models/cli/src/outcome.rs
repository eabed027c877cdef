//! Ends of runs and of searches for orbits, in the names of the model.

use dalembert::Outcome;
use dalembert::describe::Description;
use dalembert::integrate::Counters;
use dalembert::variations::{OrbitError, SectionError, Undefined};
use serde_json::Value;

use crate::{json, names};

/// Facts that go with a kind, by name.
pub type Details = Vec<(&'static str, Value)>;

/// A kind, and what it says besides.
pub type Told = (&'static str, Details);

/// The facts of an outcome besides its kind and its time, in the model's names.
pub fn details(description: &Description, outcome: &Outcome) -> Details {
    let surface = |index: usize| ("surface", name(names::surfaces(description), index));
    let constraint = |index: usize| {
        (
            "constraint",
            name(description.constraints.iter().map(|it| it.name), index),
        )
    };
    let quasi_velocity = |index: usize| name(description.quasi_velocities.iter().copied(), index);
    let coordinate = |index: usize| name(names::coordinates(description), index);
    match *outcome {
        Outcome::Zeno { t, surface: index } | Outcome::Spasmodic { t, surface: index } => {
            vec![("accumulates_at", json::number(t)), surface(index)]
        }
        Outcome::Ambiguous { surfaces } => {
            let [first, last] = surfaces.map(|index| surface(index).1);
            vec![("surfaces", Value::from(vec![first, last]))]
        }
        Outcome::StillPenetrating {
            surface: index,
            rho,
        } => vec![surface(index), ("rho", json::number(rho))],
        Outcome::ResetOffConstraint {
            surface: index,
            constraint: broken,
        } => vec![surface(index), constraint(broken)],
        Outcome::Contact { surface: index }
        | Outcome::LeftMode { surface: index }
        | Outcome::Trapped { surface: index }
        | Outcome::Untaken { surface: index }
        | Outcome::NoReset { surface: index }
        | Outcome::TangentialCrossing { surface: index }
        | Outcome::SingularSurface { surface: index } => vec![surface(index)],
        Outcome::StartsInside {
            surface: index,
            gap,
        }
        | Outcome::BeginsBehind {
            surface: index,
            gap,
        } => vec![surface(index), ("gap", json::number(gap))],
        Outcome::LeftChart { coordinate: index } => vec![("coordinate", coordinate(index))],
        Outcome::MetricNotPositive { pivot, value } => {
            vec![
                ("coordinate", coordinate(pivot)),
                ("value", json::number(value)),
            ]
        }
        Outcome::SingularConstraint {
            constraint: index,
            condition,
        } => {
            vec![constraint(index), ("condition", json::number(condition))]
        }
        Outcome::SingularFrame { quasi } => vec![("quasi_velocity", quasi_velocity(quasi))],
        Outcome::ProjectionFailed { constraint: index } => vec![constraint(index)],
        Outcome::NonFinite { component } => vec![("component", component.into())],
        _ => Vec::new(),
    }
}

/// A declared name; the index itself past the last.
fn name(mut names: impl Iterator<Item = &'static str>, index: usize) -> Value {
    names
        .nth(index)
        .map_or_else(|| Value::from(index), Value::from)
}

/// Counts of work by name.
pub fn counters(counters: &Counters) -> Vec<(&'static str, u64)> {
    vec![
        ("rate_evaluations", counters.rate_evaluations),
        ("expansions", counters.expansions),
        ("coefficients", counters.coefficients),
        ("accepted", counters.accepted),
        ("rejected", counters.rejected),
        ("dense_constructions", counters.dense_constructions),
        ("event_evaluations", counters.event_evaluations),
        ("crossings", counters.crossings),
        ("impacts", counters.impacts),
        ("projections", counters.projections),
    ]
}

/// The kind of an orbit that was not found, and what it says besides, by name.
pub fn missed(description: &Description, error: &OrbitError) -> Told {
    match error {
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
    }
}

/// Where a run has no derivative.
fn place(description: &Description, undefined: &Undefined) -> Details {
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
