//! Converts flags to a model with its parameters, and to the initial state of a run.

use std::path::Path;

use dalembert_driver::{AnyModel, Beginning, Component, OffConstraint, Origin, Rates};

use crate::args::{ModelArgs, RunArgs, StateArgs};
use crate::entry::Entry;
use crate::error::CliError;
use crate::names;
use crate::scalar;

/// The model of this name in the list.
///
/// # Errors
/// No model has this name.
pub fn find_model<'a>(models: &'a [Entry], name: &str) -> Result<&'a Entry, CliError> {
    let names = models.iter().map(Entry::name);
    let found = names::find("MODEL", "model", name, names);
    let place = found.map_err(|unknown| match beside(name) {
        Some(file) => CliError::Input {
            place: "MODEL".to_owned(),
            reason: format!("unknown model `{name}`; the file is named `{file}`"),
        },
        None if name.contains('.') => CliError::Input {
            place: "MODEL".to_owned(),
            reason: format!(
                "there is no file `{name}`; the name of a file with models ends with `.dal`"
            ),
        },
        None => unknown,
    })?;
    Ok(&models[place])
}

/// The model file of this name without its extension, if there is one.
fn beside(name: &str) -> Option<String> {
    let file = format!("{name}.dal");
    Path::new(&file).is_file().then_some(file)
}

/// The model that a command names, in its scene and first mode, with `--set` applied and every parameter checked.
///
/// # Errors
/// An unknown name, a value that is not a number, a value that contradicts the parameter's declaration.
pub fn build_model(models: &[Entry], args: &ModelArgs) -> Result<Box<dyn AnyModel>, CliError> {
    let entry = find_model(models, &args.model)?;
    let scene = names::find("--scene", "scene", &args.scene, entry.scenes())?;
    let mut model = entry.with_defaults(scene);
    for text in &args.set {
        set_parameter(model.as_mut(), text)?;
    }
    if let Some(name) = &args.mode {
        let modes = &model.description().modes;
        if modes.is_empty() {
            return Err(CliError::Usage("--mode: the model has no modes"));
        }
        let names = modes.iter().map(|mode| mode.name);
        model.set_mode(names::find("--mode", "mode", name, names)?);
    }
    let checked = model.check_parameters();
    checked.map_err(|error| CliError::state("--set", model.description(), error.into()))?;
    Ok(model)
}

/// The model of a run, with constant inputs from the flags.
///
/// # Errors
/// The errors of [`build_model`]; an unknown input, or a value that is not a number.
pub fn build_run(models: &[Entry], args: &RunArgs) -> Result<Box<dyn AnyModel>, CliError> {
    let mut model = build_model(models, &args.model)?;
    for text in &args.input {
        set_input(model.as_mut(), text)?;
    }
    Ok(model)
}

/// Sets a parameter from `NAME=VALUE`.
///
/// # Errors
/// An unknown name, a value that is not a number or contradicts the declaration.
pub fn set_parameter(model: &mut dyn AnyModel, text: &str) -> Result<(), CliError> {
    let (name, value) = names::assignment("--set", text, "NAME=VALUE,..")?;
    let parameters = &model.description().parameters;
    let accepted = parameters.iter().map(|parameter| parameter.name);
    let index = names::find("--set", "parameter", name, accepted)
        .map_err(|error| of_another_flag(model, "--set", text, error))?;
    let assumption = parameters[index].assumption;
    match scalar::parse(value) {
        Ok(number) if assumption.holds(number) => {
            model.set_parameter(index, number);
            Ok(())
        }
        Ok(_) => Err(CliError::value(
            format!("--set {name}"),
            value,
            format!("a value {assumption}"),
        )),
        Err(expected) => Err(CliError::value(format!("--set {name}"), value, expected)),
    }
}

/// The error for an unknown name in `NAME=VALUE`, or advice if another flag takes the name.
fn of_another_flag(model: &dyn AnyModel, flag: &str, text: &str, unknown: CliError) -> CliError {
    let Some((name, _)) = text.split_once('=') else {
        return unknown;
    };
    let description = model.description();
    let is = |accepted: &[&str]| {
        let accepted = accepted.iter().copied();
        names::find("", "", name.trim(), accepted).is_ok()
    };
    let parameters: Vec<&str> = description.parameters.iter().map(|it| it.name).collect();
    let other = if Component::find(model, name.trim()).is_ok() {
        "--initial"
    } else if is(&parameters) {
        "--set"
    } else if is(model.inputs()) {
        "--input"
    } else {
        return unknown;
    };
    CliError::value(flag, text, format!("{other} {text}"))
}

/// Sets an input to a constant value from `NAME=VALUE`.
///
/// # Errors
/// An unknown input, or a value that is not a number.
pub fn set_input(model: &mut dyn AnyModel, text: &str) -> Result<(), CliError> {
    let (name, value) = names::assignment("--input", text, "NAME=VALUE,..")?;
    let index = names::find("--input", "input", name, model.inputs().iter().copied())
        .map_err(|error| of_another_flag(model, "--input", text, error))?;
    match scalar::parse(value) {
        Ok(number) if number.is_finite() => {
            let after = model.description().parameters.len();
            model.set_parameter(after + index, number);
            Ok(())
        }
        _ => Err(CliError::value(
            format!("--input {name}"),
            value,
            format!(
                "a constant number, such as 0.5 or -pi/2; a law of time and state is given by --feedback {name}={value}"
            ),
        )),
    }
}

/// The state that the flags describe, at `t = 0`.
///
/// # Errors
/// An error of the flags, or a state that the system refuses.
pub fn initial_state(model: &dyn AnyModel, args: &StateArgs) -> Result<Origin, CliError> {
    initial_state_with(model, args, |_| Ok(()))
}

/// The state that the flags describe, after `change` has modified it.
///
/// # Errors
/// The errors of [`initial_state`], and those of `change`.
pub fn initial_state_with(
    model: &dyn AnyModel,
    args: &StateArgs,
    change: impl FnOnce(&mut Beginning) -> Result<(), CliError>,
) -> Result<Origin, CliError> {
    let mut beginning = beginning(model, args)?;
    change(&mut beginning)?;
    let refuse = |error| CliError::state(place(&beginning, args), model.description(), error);
    beginning.settle(model, args.off_constraint).map_err(refuse)
}

/// The state of the model's `initial`. The constraints determine the components that it does not name.
///
/// # Errors
/// A state that the system refuses.
pub fn declared_state(model: &dyn AnyModel) -> Result<Origin, CliError> {
    Beginning::Named(model.initial())
        .settle(model, OffConstraint::Error)
        .map_err(|error| CliError::state(DECLARED, model.description(), error))
}

/// Origin of a state that no flag changes, for messages.
const DECLARED: &str = "the model's `initial`";

/// The state that the flags describe, before it is completed and checked.
///
/// # Errors
/// An error of the flags.
pub fn beginning(model: &dyn AnyModel, args: &StateArgs) -> Result<Beginning, CliError> {
    let vector = |flag: &str, text: &str| numbers(model, flag, text);
    if model.description().is_first_order {
        return beginning_of_first_order(model, args);
    }
    let (q, rates) = match (&args.q, &args.qdot, &args.p) {
        (Some(q), Some(qdot), None) => {
            let q = vector("--q", q)?;
            (q, Rates::Velocities(vector("--qdot", qdot)?))
        }
        (Some(q), None, Some(p)) => (vector("--q", q)?, Rates::Momenta(vector("--p", p)?)),
        (None, None, None) => return changed(model, &args.initial),
        (Some(_), ..) => return Err(CliError::Usage("--q needs --qdot or --p")),
        (None, ..) => return Err(CliError::Usage("--qdot and --p need --q")),
    };
    Ok(Beginning::Given { q, rates })
}

/// The state of a first-order system: its rates follow from the positions.
fn beginning_of_first_order(model: &dyn AnyModel, args: &StateArgs) -> Result<Beginning, CliError> {
    if args.qdot.is_some() || args.p.is_some() {
        let text = "--qdot and --p: a first-order system has rates that follow from --q alone";
        return Err(CliError::Usage(text));
    }
    match &args.q {
        None => changed(model, &args.initial),
        Some(q) => {
            let q = numbers(model, "--q", q)?;
            let rates = Rates::Velocities(vec![0.0; q.len()]);
            Ok(Beginning::Given { q, rates })
        }
    }
}

/// The model's `initial` with changes `name=value`.
fn changed(model: &dyn AnyModel, changes: &[String]) -> Result<Beginning, CliError> {
    let mut beginning = Beginning::Named(model.initial());
    for change in changes
        .iter()
        .flat_map(|list| list.split(','))
        .filter(|change| !change.trim().is_empty())
    {
        apply_change(model, &mut beginning, change)?;
    }
    Ok(beginning)
}

/// The flags that give the state, for messages.
fn place(beginning: &Beginning, args: &StateArgs) -> &'static str {
    match beginning {
        Beginning::Named(_) if args.initial.is_empty() => DECLARED,
        Beginning::Named(_) => "--initial",
        Beginning::Given {
            rates: Rates::Velocities(_),
            ..
        } => "--q, --qdot",
        Beginning::Given { .. } => "--q, --p",
    }
}

/// Applies one `name=value` of `--initial`.
fn apply_change(
    model: &dyn AnyModel,
    beginning: &mut Beginning,
    change: &str,
) -> Result<(), CliError> {
    let (name, value) = names::assignment("--initial", change, "NAME=VALUE,..")?;
    let found = Component::find(model, name);
    let component = found.map_err(|unknown| {
        let place = "--initial".to_owned();
        of_another_flag(
            model,
            "--initial",
            change,
            CliError::Unknown { place, unknown },
        )
    })?;
    let number = scalar::parse(value)
        .map_err(|expected| CliError::value(format!("--initial {name}"), value, expected))?;
    beginning.set(component, number);
    Ok(())
}

/// Parses a comma-separated list of one number per coordinate.
fn numbers(model: &dyn AnyModel, flag: &str, text: &str) -> Result<Vec<f64>, CliError> {
    let names: Vec<_> = names::coordinates(model.description()).collect();
    let given: Vec<_> = match text.trim() {
        "" => Vec::new(),
        list => list.split(',').collect(),
    };
    if given.len() != names.len() {
        return Err(CliError::Length {
            place: flag.to_owned(),
            names,
            got: given.len(),
        });
    }
    let number = |(value, name): (&&str, &&str)| {
        scalar::parse(value)
            .map_err(|expected| CliError::value(format!("{flag} ({name})"), *value, expected))
    };
    given.iter().zip(&names).map(number).collect()
}
