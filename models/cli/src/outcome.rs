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

/// The details of an outcome besides its kind and its time, in the model's names.
pub fn details(description: &Description, outcome: &Outcome) -> Details {
    let facts = outcome::details(description, outcome).into_iter();
    facts.map(|(name, fact)| (name, value(fact))).collect()
}

fn value(fact: Fact) -> Value {
    match fact {
        Fact::Number(number) => json::number(number),
        Fact::Index(index) => Value::from(index),
        Fact::Name(name) => Value::from(name),
        Fact::List(facts) => Value::Array(facts.into_iter().map(value).collect()),
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

/// Details of the event at which a run has no derivative.
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
