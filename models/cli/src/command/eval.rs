//! `eval`: evaluates all derived quantities at given states.

mod impact;
mod input;
mod report;

use std::io::{BufWriter, Write};

use dalembert::StateError;
use dalembert::describe::Description;
use dalembert::law::Law;
use dalembert_driver::{AnyModel, OffConstraint, Origin, words};
use serde_json::{Map, Value, json};

use crate::Streams;
use crate::args::EvalArgs;
use crate::entry::Entry;
use crate::error::{self, CliError};
use crate::exit::Exit;
use crate::json;
use crate::names;
use crate::state_input::build_model;
use impact::Moment;
use input::Given;
use report::Collected;

/// Keys that are printed first for a state, in this order, with `null` for a quantity that the model does not have. The
/// other reported quantities follow, then the impacts.
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
/// Invalid flags, or input that is not an array of states of this model. A state at which a quantity does not exist is
/// not an error: it is reported in place of its values, and the exit is [`Exit::Other`].
pub fn run(models: &[Entry], args: &EvalArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    let mut model = build_model(models, &args.model)?;
    let description = model.description();
    let path = args.input.as_deref();
    let states = input::read(description, model.inputs(), path, streams.input)?;
    let laws = laws(args);
    let after = description.parameters.len();
    let results: Vec<_> = states
        .iter()
        .map(|state| {
            for (index, value) in state.inputs.iter().enumerate() {
                model.set_parameter(after + index, *value);
            }
            evaluate(model.as_ref(), state, &laws)
        })
        .collect();
    let exit = if results.iter().all(Result::is_ok) {
        Exit::Reached
    } else {
        Exit::Other
    };

    let description = model.description();
    let rows = results
        .into_iter()
        .map(|result| result.unwrap_or_else(|error| refusal(description, &error)));
    let mut output = BufWriter::new(&mut *streams.output);
    json::write_array(&mut output, rows)?;
    output.flush()?;
    Ok(exit)
}

/// The impulsive laws: those without a coefficient, and those whose coefficient is given.
fn laws(args: &EvalArgs) -> Vec<Law> {
    let plain = Law::NAMES
        .iter()
        .filter(|(_, takes_coefficient)| !takes_coefficient);
    let mut laws: Vec<Law> = plain
        .filter_map(|(name, _)| Law::from_name(name, 0.0))
        .filter(Law::is_impulse)
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
    for (index, surface) in names::surfaces(model.description()).enumerate() {
        let moment = Moment {
            t: given.t,
            state: &state,
            collected: &collected,
        };
        impacts.insert(
            surface.to_owned(),
            impact::evaluate(model, &moment, index, laws),
        );
    }
    row.insert("impacts".to_owned(), impacts.into());
    Ok(row.into())
}

/// `{"error": {"kind", "message"}}`
fn refusal(description: &Description, error: &StateError) -> Value {
    let kind = match error {
        StateError::Fault(fault) => words::fault_kind(fault),
        StateError::OutsideChart { .. } => "outside_chart",
        StateError::NotFinite { .. } => "not_finite",
        _ => "state_refused",
    };
    json!({ "error": { "kind": kind, "message": error::state_text(description, error) } })
}
