//! Outcomes of runs, in the names of the model.

use dalembert::describe::Description;
use dalembert::integrate::Counters;
use dalembert::{Fault, Outcome};

use crate::{names, words};

/// A fact about an outcome.
#[derive(Debug, Clone, PartialEq)]
pub enum Fact {
    /// A number.
    Number(f64),
    /// An index.
    Index(usize),
    /// A truth value.
    Flag(bool),
    /// A declared name.
    Name(&'static str),
    /// Several facts.
    List(Vec<Fact>),
}

/// The facts of an outcome apart from its kind and its time, in the model's names.
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
        | Outcome::Squeezed { surface: index }
        | Outcome::LeftMode { surface: index }
        | Outcome::Trapped { surface: index }
        | Outcome::Untaken { surface: index }
        | Outcome::NoReset { surface: index }
        | Outcome::TangentialCrossing { surface: index }
        | Outcome::UndefinedGap { surface: index }
        | Outcome::SingularSurface { surface: index } => vec![surface(index)],
        Outcome::StoppedAt {
            surface: index,
            graze,
        } => vec![surface(index), ("graze", Fact::Flag(graze))],
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

/// The event that ended a run, as a sentence in the model's names; `None` for a run that reached its end.
pub fn explanation(description: &Description, outcome: &Outcome) -> Option<String> {
    let surface = |index: usize| declared(names::surfaces(description), index);
    let coordinate = |index: usize| declared(names::coordinates(description), index);
    Some(match *outcome {
        Outcome::Done => return None,
        Outcome::Zeno { t, surface: index } => {
            format!("impacts on `{}` accumulate at t = {t}", surface(index))
        }
        Outcome::Spasmodic { t, surface: index } => format!(
            "impacts on `{}` accumulate at t = {t} while the energy grows",
            surface(index)
        ),
        Outcome::Ambiguous {
            surfaces: [first, last],
        } if first != last => format!(
            "`{}` and `{}` are hit at one time, and the motion afterwards depends on the order of the impacts",
            surface(first),
            surface(last)
        ),
        Outcome::Ambiguous { .. } => "more than one motion is possible after the event".to_owned(),
        Outcome::StillPenetrating { surface: index, .. } => format!(
            "after the impact on `{}` the motion still leads into it",
            surface(index)
        ),
        Outcome::NoReset { surface: index } => {
            format!("`{}` declares no reset", surface(index))
        }
        Outcome::StoppedAt {
            surface: index,
            graze,
        } => match graze {
            false => format!("the motion reached `{}`, which ends it", surface(index)),
            true => format!(
                "the motion reached or touched `{}`, which ends it: rounding decides",
                surface(index)
            ),
        },
        Outcome::LeftMode { surface: index } => format!(
            "the mode ends at `{}`, which leads to another mode",
            surface(index)
        ),
        Outcome::Untaken { surface: index } => format!(
            "the motion reached `{}`, where the conditions of no transition hold",
            surface(index)
        ),
        Outcome::Trapped { surface: index } => format!(
            "at `{}` the modes lead to each other at one time, and the motion continues in none of them",
            surface(index)
        ),
        Outcome::Squeezed { surface: index } => format!(
            "`{}` and other surfaces close on each other, and leave no motion between them",
            surface(index)
        ),
        Outcome::Contact { surface: index } => format!(
            "the state rests on `{}`, and the motion presses into it",
            surface(index)
        ),
        Outcome::UndefinedGap { surface: index } => format!(
            "the gap of `{}` has no value beyond this state, whether the surface counts there or not",
            surface(index)
        ),
        Outcome::TangentialCrossing { surface: index } => {
            format!("`{}` was crossed at gap rate 0", surface(index))
        }
        Outcome::StartsInside {
            surface: index,
            gap,
        } => format!(
            "the gap of `{}` is {gap:e} at the start or after a reset",
            surface(index)
        ),
        Outcome::BeginsBehind {
            surface: index,
            gap,
        } => format!(
            "a condition of `{}` begins to hold where its gap is {gap:e}",
            surface(index)
        ),
        Outcome::LeftChart { coordinate: index } => format!(
            "coordinate `{}` reached the end of its interval",
            coordinate(index)
        ),
        Outcome::ResetOffConstraint {
            surface: index,
            constraint,
        } => format!(
            "the reset at `{}` violates constraint `{}`",
            surface(index),
            words::of_constraint(description, constraint)
        ),
        Outcome::MetricNotPositive { pivot, value } => {
            words::fault_text(description, &Fault::MetricNotPositive { pivot, value })
        }
        Outcome::SingularConstraint {
            constraint,
            condition,
        } => words::fault_text(
            description,
            &Fault::SingularConstraint {
                constraint,
                condition,
            },
        ),
        Outcome::SingularFrame { quasi } => {
            words::fault_text(description, &Fault::SingularFrame { quasi })
        }
        Outcome::SingularSurface { surface } => {
            words::fault_text(description, &Fault::SingularSurface { surface })
        }
        ref other => other.to_string(),
    })
}

/// A declared name; the index itself if it is past the last name.
fn declared(mut names: impl Iterator<Item = &'static str>, index: usize) -> String {
    names
        .nth(index)
        .map_or_else(|| index.to_string(), str::to_owned)
}

/// A declared name as a fact; the index itself if it is past the last name.
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
