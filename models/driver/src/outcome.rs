//! Outcomes of runs, in the names of the model.

use dalembert::Outcome;
use dalembert::describe::Description;
use dalembert::integrate::Counters;

use crate::names;

/// A fact about an outcome.
#[derive(Debug, Clone, PartialEq)]
pub enum Fact {
    /// A number.
    Number(f64),
    /// An index.
    Index(usize),
    /// A declared name.
    Name(&'static str),
    /// Several facts.
    List(Vec<Fact>),
}

/// The facts of an outcome besides its kind and its time, in the model's names.
pub fn details(description: &Description, outcome: &Outcome) -> Vec<(&'static str, Fact)> {
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
            vec![("accumulates_at", Fact::Number(t)), surface(index)]
        }
        Outcome::Ambiguous { surfaces } => {
            let named = surfaces.map(|index| surface(index).1);
            vec![("surfaces", Fact::List(named.into()))]
        }
        Outcome::StillPenetrating {
            surface: index,
            rho,
        } => vec![surface(index), ("rho", Fact::Number(rho))],
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
        } => vec![surface(index), ("gap", Fact::Number(gap))],
        Outcome::LeftChart { coordinate: index } => vec![("coordinate", coordinate(index))],
        Outcome::MetricNotPositive { pivot, value } => {
            vec![
                ("coordinate", coordinate(pivot)),
                ("value", Fact::Number(value)),
            ]
        }
        Outcome::SingularConstraint {
            constraint: index,
            condition,
        } => {
            vec![constraint(index), ("condition", Fact::Number(condition))]
        }
        Outcome::SingularFrame { quasi } => vec![("quasi_velocity", quasi_velocity(quasi))],
        Outcome::ProjectionFailed { constraint: index } => vec![constraint(index)],
        Outcome::NonFinite { component } => vec![("component", Fact::Index(component))],
        _ => Vec::new(),
    }
}

/// A declared name; the index itself past the last.
fn name(mut names: impl Iterator<Item = &'static str>, index: usize) -> Fact {
    names.nth(index).map_or(Fact::Index(index), Fact::Name)
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
