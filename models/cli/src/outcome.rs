//! Outcomes of runs and of searches for orbits, in the names of the model.

use dalembert::Outcome;
use dalembert::describe::Description;
use dalembert::variations::{OrbitError, SectionError, Undefined};
pub use dalembert_driver::outcome::counters;
use dalembert_driver::outcome::{self, Fact};
use serde_json::Value;

use crate::{json, names};

/// Details of an outcome, by name.
pub type Details = Vec<(&'static str, Value)>;

/// The kind of an outcome, and its details.
pub type Told = (&'static str, Details);

/// The details of an outcome except its kind and its time, in the model's names.
pub fn details(description: &Description, outcome: &Outcome) -> Details {
    let facts = outcome::details(description, outcome).into_iter();
    facts.map(|(name, fact)| (name, value(fact))).collect()
}

fn value(fact: Fact) -> Value {
    match fact {
        Fact::Number(number) => json::number(number),
        Fact::Index(index) => Value::from(index),
        Fact::Flag(flag) => Value::from(flag),
        Fact::Name(name) => Value::from(name),
        Fact::List(facts) => Value::Array(facts.into_iter().map(value).collect()),
    }
}

/// Lines about a run that did not reach its end, each with a title: the reason, and a remedy if one is known. With
/// `rests`, the run had `--rest contact`.
pub fn remarks(
    description: &Description,
    outcome: &Outcome,
    rests: bool,
) -> Vec<(&'static str, String)> {
    let reason = outcome::explanation(description, outcome);
    let remedy = remedy(outcome, rests).map(str::to_owned);
    [("reason", reason), ("try", remedy)]
        .into_iter()
        .filter_map(|(title, text)| Some((title, text?)))
        .collect()
}

/// A remedy against the end of a run, in terms of flags and declarations. With `rests`, the run had `--rest contact`.
const fn remedy(outcome: &Outcome, rests: bool) -> Option<&'static str> {
    Some(match outcome {
        Outcome::Zeno { .. } | Outcome::Contact { .. } if rests => return None,
        Outcome::Zeno { .. } => {
            "--rest contact, which continues along the surface after the accumulation"
        }
        Outcome::Contact { .. } => "--rest contact, which continues along the surface",
        Outcome::Squeezed { .. } => {
            "surfaces that leave room, or a condition (`when`) under which one of them no longer counts"
        }
        Outcome::Spasmodic { .. } => "another --law, unless impacts are meant to add energy",
        Outcome::Ambiguous { .. } => {
            "--corner ascending or --corner descending; at a transition, --split first"
        }
        Outcome::StillPenetrating { .. } => "another --law, or --penetration repeat",
        Outcome::ResetOffConstraint { .. } => {
            "a reset whose velocities satisfy the constraint at the new position"
        }
        Outcome::NoReset { .. } => "another --law",
        Outcome::LeftMode { .. } => "a run of the whole model",
        Outcome::Untaken { .. } => "a transition for the remaining case, declared with `otherwise`",
        Outcome::Trapped { .. } => "resets or surfaces that separate the modes",
        Outcome::TangentialCrossing { .. } => {
            "another start: the motion does not depend continuously on this one"
        }
        Outcome::StartsInside { .. } => "a start, or a reset, with positive gap",
        Outcome::BeginsBehind { .. } => {
            "a second surface for the other case, declared with `otherwise`"
        }
        Outcome::LeftChart { .. } => "a larger interval, or other coordinates",
        Outcome::MetricNotPositive { .. } => "other parameters, or a corrected Lagrangian",
        Outcome::SingularConstraint { .. } => {
            "a start that stays away from states with dependent constraints"
        }
        Outcome::SingularFrame { .. } => "--form global, or another frame",
        Outcome::SingularSurface { .. } => {
            "a gap that the motion can change within the constraints"
        }
        Outcome::NonFinite { .. } | Outcome::UndefinedGap { .. } | Outcome::LeftDomain => {
            "another start, or shorter steps (--max-step, --step): a function has no value beyond this state"
        }
        Outcome::StepUnderflow { .. } => {
            "a start away from the singularity; for a stiff motion, --integrator gauss6"
        }
        Outcome::NotConverged { .. } => "a shorter --step",
        Outcome::StepBudget => "a larger --steps",
        Outcome::ImpactBudget => "a larger --impacts",
        Outcome::ProjectionFailed { .. } => "a smaller --tol, or a shorter --step",
        _ => return None,
    })
}

/// Lines about a failed search for an orbit, each with a title: the reason, and a remedy if one is known.
pub fn remarks_on_orbit(
    description: &Description,
    error: &OrbitError,
) -> Vec<(&'static str, String)> {
    let (reason, remedy) = match error {
        OrbitError::Section(SectionError::Ended(Outcome::Done)) => (
            "the motion did not return to the surface in time".to_owned(),
            Some("a larger --until, or a start whose motion reaches the surface"),
        ),
        OrbitError::Section(SectionError::Ended(outcome)) => {
            return remarks(description, outcome, false);
        }
        OrbitError::NotConverged { .. } => (
            "Newton's method did not converge".to_owned(),
            Some("a start closer to the orbit, another --period, or a smaller --tol"),
        ),
        OrbitError::DependsOnTime => (
            error.to_string(),
            Some("a coordinate with constant rate in place of the time"),
        ),
        OrbitError::Section(SectionError::Undefined(undefined)) => {
            (without_derivative(description, undefined), None)
        }
        other => (other.to_string(), None),
    };
    let remedy = remedy.map(|text| ("try", text.to_owned()));
    [("reason", reason)].into_iter().chain(remedy).collect()
}

/// Why the motion has no derivative, with the name of the surface.
fn without_derivative(description: &Description, undefined: &Undefined) -> String {
    let text = undefined.to_string();
    match surface_of(undefined).and_then(|(index, _)| {
        let name = names::surfaces(description).nth(index)?;
        Some((index, name))
    }) {
        Some((index, name)) => ["surface", "transition"].iter().fold(text, |text, noun| {
            text.replacen(&format!("{noun} {index}"), &format!("`{name}`"), 1)
        }),
        None => text,
    }
}

/// The surface and the time of an event at which the run has no derivative.
const fn surface_of(undefined: &Undefined) -> Option<(usize, f64)> {
    match *undefined {
        Undefined::Graze { t, surface }
        | Undefined::Corner { t, surface }
        | Undefined::Held { t, surface }
        | Undefined::Unlawful { t, surface }
        | Undefined::Refracted { t, surface } => Some((surface, t)),
        _ => None,
    }
}

/// The kind of a failed search for an orbit, and its details by name.
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

/// Details of the event at which the run has no derivative: its surface and its time.
fn place(description: &Description, undefined: &Undefined) -> Details {
    match (surface_of(undefined), undefined) {
        (Some((surface, t)), _) => {
            let name = names::surfaces(description).nth(surface);
            vec![("surface", name.into()), ("after", json::number(t))]
        }
        (None, Undefined::NotFinite { t }) => vec![("after", json::number(*t))],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outcomes that may end a run of the command line before its end.
    const OUTCOMES: [Outcome; 26] = [
        Outcome::UndefinedGap { surface: 0 },
        Outcome::Zeno { t: 1.0, surface: 0 },
        Outcome::Spasmodic { t: 1.0, surface: 0 },
        Outcome::Ambiguous { surfaces: [0, 1] },
        Outcome::StillPenetrating {
            surface: 0,
            rho: 0.5,
        },
        Outcome::ResetOffConstraint {
            surface: 0,
            constraint: 0,
        },
        Outcome::NoReset { surface: 0 },
        Outcome::LeftMode { surface: 0 },
        Outcome::Untaken { surface: 0 },
        Outcome::Trapped { surface: 0 },
        Outcome::Contact { surface: 0 },
        Outcome::Squeezed { surface: 0 },
        Outcome::TangentialCrossing { surface: 0 },
        Outcome::StartsInside {
            surface: 0,
            gap: -1.0,
        },
        Outcome::BeginsBehind {
            surface: 0,
            gap: -1.0,
        },
        Outcome::LeftChart { coordinate: 0 },
        Outcome::MetricNotPositive {
            pivot: 0,
            value: 0.0,
        },
        Outcome::SingularConstraint {
            constraint: 0,
            condition: 1e20,
        },
        Outcome::SingularFrame { quasi: 0 },
        Outcome::SingularSurface { surface: 0 },
        Outcome::NonFinite { component: 0 },
        Outcome::StepUnderflow { t: 1.0 },
        Outcome::LeftDomain,
        Outcome::NotConverged { t: 1.0 },
        Outcome::StepBudget,
        Outcome::ProjectionFailed { constraint: 0 },
    ];

    #[test]
    fn surfaces_without_a_derivative_are_named() {
        let (t, surface) = (1.0, 0);
        for undefined in [
            Undefined::Graze { t, surface },
            Undefined::Corner { t, surface },
            Undefined::Held { t, surface },
            Undefined::Unlawful { t, surface },
            Undefined::Refracted { t, surface },
        ] {
            let text = undefined.to_string();
            let is_numbered = text.contains("surface 0") || text.contains("transition 0");
            assert!(is_numbered, "{text}");
        }
    }

    #[test]
    fn every_end_before_the_end_has_a_remedy() {
        for outcome in OUTCOMES {
            assert!(remedy(&outcome, false).is_some(), "{}", outcome.kind());
        }
        assert_eq!(remedy(&Outcome::Done, false), None);
        assert_eq!(remedy(&Outcome::Contact { surface: 0 }, true), None);
    }
}
