//! `eval`: everything that is derived, evaluated by the emitted code at given states.

mod input;
mod report;

use std::io::{BufWriter, Write};

use dalembert::describe::Description;
use dalembert::impacts::law::Law;
use dalembert::{Fault, StateError};
use serde_json::{Map, Value, json};

use crate::Streams;
use crate::args::{EvalArgs, OffConstraint};
use crate::entry::{AnyModel, Entry, Origin};
use crate::error::{self, CliError};
use crate::exit::Exit;
use crate::json;
use crate::names;
use crate::state_input::build_model;
use input::Given;
use report::Collected;

/// What is printed first of a state, in this order; `null` where a model has no such quantity. Whatever else a model
/// reports follows, then its impacts.
const KEYS: [&str; 15] = [
    "q",
    "qdot",
    "p",
    "pdot",
    "acceleration",
    "multipliers",
    "metric",
    "W",
    "constraint_mass",
    "constraint_mass_inverse",
    "pi_D",
    "energy",
    "density_form_theta",
    "divergence_mu_C",
    "log_density",
];

/// Carries out `eval`.
///
/// # Errors
/// Bad flags, or input that is not an array of states of this model. A state at which something does not exist
/// is not an error: it is reported in its place, and the exit is [`Exit::Other`].
pub fn run(models: &[Entry], args: &EvalArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    let model = build_model(models, &args.model)?;
    let states = input::read(&model.description(), args.input.as_deref(), streams.input)?;
    let laws = laws(args);
    let results: Vec<_> = states
        .iter()
        .map(|state| evaluate(model.as_ref(), state, &laws))
        .collect();
    let exit = if results.iter().all(Result::is_ok) {
        Exit::Reached
    } else {
        Exit::Other
    };

    let description = model.description();
    let rows = results
        .into_iter()
        .map(|result| result.unwrap_or_else(|error| refusal(&description, &error)));
    let mut output = BufWriter::new(&mut *streams.output);
    json::write_array(&mut output, rows)?;
    output.flush()?;
    Ok(exit)
}

/// The impulses without a coefficient, and those whose coefficient was given.
fn laws(args: &EvalArgs) -> Vec<Law> {
    let plain = Law::NAMES
        .iter()
        .filter(|(_, takes_coefficient)| !takes_coefficient);
    let mut laws: Vec<Law> = plain
        .filter_map(|(name, _)| Law::from_name(name, 0.0))
        .filter(|law| !law.is_map())
        .collect();
    laws.extend(args.restitution.map(Law::Restitution));
    laws.extend(args.newton.map(Law::Newton));
    laws
}

fn evaluate(model: &dyn AnyModel, given: &Given, laws: &[Law]) -> Result<Value, StateError> {
    let origin = Origin {
        q: given.q.clone(),
        rates: given.rates.clone(),
        policy: OffConstraint::Keep,
    };
    let state = model.state(given.t, &origin)?;
    let mut collected = Collected::at(model, given.t, &state)?;
    let mut row: Map<String, Value> = KEYS
        .iter()
        .map(|&key| (key.to_owned(), collected.take(key)))
        .collect();
    row.extend(collected.take_others());
    let mut impacts = Map::new();
    for (index, surface) in names::surfaces(&model.description()).enumerate() {
        let laws = evaluate_laws(model, given.t, &state, &collected, index, laws);
        let quantity = |name: &str| {
            collected
                .contact_scalar(surface, name)
                .map_or(Value::Null, json::number)
        };
        let fields =
            json!({ "gap": quantity("gap"), "gap_rate": quantity("gap_rate"), "laws": laws });
        impacts.insert(surface.to_owned(), fields);
    }
    row.insert("impacts".to_owned(), impacts.into());
    Ok(row.into())
}

/// The laws of one surface, a declared reset after the impulses. Where no impulse exists (its gradient may vanish away
/// from the surface) that is said instead; it is no fault of the state.
fn evaluate_laws(
    model: &dyn AnyModel,
    t: f64,
    state: &[f64],
    collected: &Collected,
    surface: usize,
    laws: &[Law],
) -> Value {
    let description = model.description();
    let fault = |fault: &Fault| refusal(&description, &StateError::Fault(*fault));
    let name = description.surfaces[surface].name;
    let mut results = Map::new();
    match collected.contact(name) {
        Some(contact) => {
            for &law in laws {
                let after = Collected::at(model, t, &model.impact(state, &contact, law));
                let result = match after {
                    Ok(after) => struck(after, name).into(),
                    Err(error) => fault(&error),
                };
                results.insert(law.name().to_owned(), result);
            }
        }
        None if collected.reset(name).is_none() => {
            return fault(&Fault::SingularSurface { surface });
        }
        None => {}
    }
    if let Some(reset) = collected.reset(name) {
        let after = model
            .state(t, &reset)
            .and_then(|state| Ok(Collected::at(model, t, &state)?));
        let result = match after {
            Ok(after) => {
                let mut fields = struck(after, name);
                fields.insert("q_plus".to_owned(), json::vector(&reset.q));
                fields.into()
            }
            Err(error) => refusal(&description, &error),
        };
        results.insert(Law::Reset.name().to_owned(), result);
    }
    results.into()
}

/// What is printed of a state after an impact.
fn struck(mut after: Collected, surface: &str) -> Map<String, Value> {
    let gap_rate = after.contact_scalar(surface, "gap_rate");
    let fields = [
        ("qdot_plus", after.take("qdot")),
        ("p_plus", after.take("p")),
        ("gap_rate_plus", gap_rate.map_or(Value::Null, json::number)),
        ("energy_plus", after.take("energy")),
    ];
    fields
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// `{"error": {"kind", "message"}}`
fn refusal(description: &Description, error: &StateError) -> Value {
    let kind = match error {
        StateError::Fault(fault) => error::fault_kind(fault),
        StateError::OutsideChart { .. } => "outside_chart",
        StateError::NotFinite { .. } => "not_finite",
        _ => "state_refused",
    };
    json!({ "error": { "kind": kind, "message": error::state_text(description, error) } })
}
