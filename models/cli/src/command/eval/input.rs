//! Reads states: a JSON array of `{"q": [..], "qdot": [..], "t": 0}`, where `p` may replace `qdot`. Values are JSON
//! numbers or decimal strings. A first-order system takes `q` alone; a model with inputs also takes `inputs: [..]`.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use dalembert::describe::Description;
use dalembert_driver::Rates;
use serde_json::{Map, Value};

use crate::error::CliError;
use crate::{json, names, scalar};

/// A state as given in the input.
#[derive(Debug, PartialEq)]
pub struct Given {
    /// Time; 0 if it was not given.
    pub t: f64,
    /// Positions.
    pub q: Vec<f64>,
    /// Velocities or momenta.
    pub rates: Rates,
    /// The inputs; 0 if they were not given.
    pub inputs: Vec<f64>,
}

/// Largest input, in bytes. States are kept in memory, where they take several times as much.
const MOST: u64 = 1 << 28;

/// Reads all states from the file, or from `stdin` if no file is given or the path is `-`.
///
/// # Errors
/// [`CliError::File`] if the input cannot be read, [`CliError::Input`] if it is not an array of states,
/// [`CliError::Length`] if a state has the wrong number of components.
pub fn read(
    description: &Description,
    inputs: &[&'static str],
    path: Option<&Path>,
    stdin: &mut dyn Read,
) -> Result<Vec<Given>, CliError> {
    let (place, bytes) = match path.filter(|path| path.as_os_str() != "-") {
        Some(path) => {
            let failed = |source| CliError::File {
                flag: "--input",
                path: path.to_owned(),
                source,
            };
            let mut file = File::open(path).map_err(failed)?;
            (
                format!("--input {}", path.display()),
                read_bytes(&mut file).map_err(failed)?,
            )
        }
        None => ("standard input".to_owned(), read_bytes(stdin)?),
    };
    if bytes.len() as u64 > MOST {
        let reason = format!("the input exceeds the limit of {MOST} bytes; divide the states");
        return Err(invalid(&place, reason));
    }
    let value = json::parse(&bytes).map_err(|error| invalid(&place, error.to_string()))?;
    let Value::Array(states) = value else {
        return Err(invalid(
            &place,
            "expected a JSON array of states: [{\"q\": [..], \"qdot\": [..]}, ..]",
        ));
    };
    states
        .iter()
        .enumerate()
        .map(|(index, state)| {
            parse(
                description,
                inputs,
                &format!("{place}, state {index}"),
                state,
            )
        })
        .collect()
}

/// Reads at most one byte more than the limit, so that a longer input is noticed.
fn read_bytes(input: &mut dyn Read) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(MOST + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn parse(
    description: &Description,
    inputs: &[&'static str],
    place: &str,
    state: &Value,
) -> Result<Given, CliError> {
    let Value::Object(state) = state else {
        return Err(invalid(
            place,
            "expected an object with \"q\" and \"qdot\" or \"p\"",
        ));
    };
    let accepted: &[&str] = match description.is_first_order {
        true => &["q", "t"],
        false => &["q", "qdot", "p", "t"],
    };
    for key in state.keys() {
        let supplied = (!inputs.is_empty()).then_some("inputs");
        names::find(place, "key", key, accepted.iter().copied().chain(supplied))?;
    }
    let names: Vec<_> = names::coordinates(description).collect();
    let vector = |key: &str| {
        let value = state.get(key)?;
        Some(vector(&names, &format!("{place}, {key}"), value))
    };
    let supplied = state.get("inputs");
    let supplied = supplied.map(|value| self::vector(inputs, &format!("{place}, inputs"), value));
    let Some(q) = vector("q") else {
        return Err(invalid(place, "\"q\" is missing"));
    };
    let rates = match (vector("qdot"), vector("p")) {
        (Some(qdot), None) => Rates::Velocities(qdot?),
        (None, Some(p)) => Rates::Momenta(p?),
        (None, None) if description.is_first_order => {
            Rates::Velocities(vec![0.0; description.coordinates.len()])
        }
        _ => return Err(invalid(place, "expected one of \"qdot\" and \"p\"")),
    };
    Ok(Given {
        t: time(place, state)?,
        q: q?,
        rates,
        inputs: supplied.unwrap_or_else(|| Ok(vec![0.0; inputs.len()]))?,
    })
}

fn time(place: &str, state: &Map<String, Value>) -> Result<f64, CliError> {
    state
        .get("t")
        .map_or(Ok(0.0), |value| number(&format!("{place}, t"), value))
}

fn vector(names: &[&'static str], place: &str, value: &Value) -> Result<Vec<f64>, CliError> {
    let Value::Array(values) = value else {
        return Err(invalid(place, "expected an array of numbers"));
    };
    if values.len() != names.len() {
        return Err(CliError::Length {
            place: place.to_owned(),
            names: names.to_vec(),
            got: values.len(),
        });
    }
    values
        .iter()
        .zip(names)
        .map(|(value, name)| number(&format!("{place} ({name})"), value))
        .collect()
}

fn number(place: &str, value: &Value) -> Result<f64, CliError> {
    let number = match value {
        Value::Number(number) => number.as_f64().filter(|number| number.is_finite()),
        Value::String(text) => scalar::parse(text).ok(),
        _ => None,
    };
    number.ok_or_else(|| {
        CliError::value(
            place,
            value.to_string(),
            "a finite number, or a string that contains one",
        )
    })
}

fn invalid(place: &str, reason: impl Into<String>) -> CliError {
    CliError::Input {
        place: place.to_owned(),
        reason: reason.into(),
    }
}
