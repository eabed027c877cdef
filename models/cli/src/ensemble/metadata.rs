//! Metadata that identify an ensemble in its files.

use clap::ValueEnum;
use dalembert::describe::Description;
use dalembert_driver::ensemble::density::Density;
use dalembert_driver::ensemble::runner::Shared;
use dalembert_driver::{AnyModel, Beginning, Rates};
use serde_json::{Map, Value, json};

use super::fingerprint::fingerprint;
use super::members::{self, Shard};
use crate::args::{RunArgs, StateArgs};
use crate::error::CliError;
use crate::json::{named, number};
use crate::names;
use crate::state_input;

/// All inputs on which rows and counts depend. Keys are the same for all flags; flags that were not given are `null`.
///
/// # Errors
/// An error of the flags of the state.
pub fn metadata(
    model: &dyn AnyModel,
    run: &RunArgs,
    shared: &Shared<'_>,
    shard: Shard,
) -> Result<Map<String, Value>, CliError> {
    let description = model.description();
    let Shared {
        settings,
        members,
        density,
        ..
    } = shared;
    let names = description.parameters.iter().map(|it| it.name);
    let values: Vec<f64> = (0..description.parameters.len())
        .map(|index| model.parameter(index))
        .collect();
    let laws = settings.laws.iter();
    let laws: Vec<Value> = laws
        .map(|(surface, law)| {
            let surface = names::surfaces(description).nth(*surface);
            json!({ "surface": surface, "law": law.to_string() })
        })
        .collect();
    let range = shard.range(members.count());
    let value = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "model": description.name,
        "scene": run.model.scene,
        "mode": model.present_mode(),
        "model_hash": fingerprint(description.source.as_bytes()),
        "model_source": *description.source,
        "parameters": named(names, &values),
        "start": start(model, description, &run.state)?,
        "members": members::metadata(members),
        "shard": {
            "index": shard.index,
            "of": shard.of,
            "first": range.start,
            "members": range.end - range.start,
        },
        "form": settings.form.name(),
        "integrator": settings.integrator.name(),
        "tol": number(settings.tol),
        "step": settings.step.map(number),
        "max_step": settings.max_step.map(number),
        "until": number(settings.until),
        "impacts": settings.impacts,
        "steps": settings.steps,
        "laws": laws,
        "rest": word(run.policies.rest),
        "penetration": word(run.policies.penetration),
        "corner": word(run.policies.corner),
        "split": word(run.policies.split),
        "projection": settings.projection,
        "density": density.map(measured),
    });
    match value {
        Value::Object(metadata) => Ok(metadata),
        _ => Ok(Map::new()),
    }
}

/// Metadata that identify a density.
pub fn measured(density: &Density) -> Value {
    let axes = density.axes.each_ref();
    let axes =
        axes.map(|axis| json!({ "name": axis.name, "range": axis.range, "bins": axis.bins }));
    json!({ "axes": axes, "every": density.every, "discard": density.discard })
}

/// The common start of the members. It does not contain varied values.
fn start(
    model: &dyn AnyModel,
    description: &Description,
    args: &StateArgs,
) -> Result<Value, CliError> {
    let (q, rates, given) = match state_input::beginning(model, args)? {
        Beginning::Named(start) => {
            let given = start.named;
            (start.q, Rates::Velocities(start.qdot), given)
        }
        Beginning::Given { q, rates } => {
            let given = vec![true; q.len()];
            (q, rates, given)
        }
    };
    let coordinates = || names::coordinates(description);
    let (kind, rates) = match rates {
        Rates::Velocities(qdot) => ("qdot", qdot),
        Rates::Momenta(p) => ("p", p),
    };
    // Velocities that the start does not name follow from the constraints.
    let known = coordinates().zip(&rates).zip(given);
    let known = known
        .filter(|(_, given)| *given)
        .map(|((name, &rate), _)| (name.to_owned(), number(rate)));
    Ok(json!({
        "q": named(coordinates(), &q),
        kind: known.collect::<Map<_, _>>(),
        "off_constraint": args.off_constraint.name(),
    }))
}

/// A value of a flag as it is written on the command line.
fn word(value: impl ValueEnum) -> Option<String> {
    let value = value.to_possible_value()?;
    Some(value.get_name().to_owned())
}
