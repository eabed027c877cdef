//! `list`: the models with their numbers of coordinates (N), constraints (M) and surfaces (S), and the first line of
//! their documentation.

use std::io::Write;

use dalembert::describe::Description;
use serde_json::{Value, json};

use crate::Streams;
use crate::args::{Format, ListArgs};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::json::write_array;
use crate::names;
use crate::sink::{self, Sink};

/// Carries out `list`.
///
/// # Errors
/// An output that fails.
pub fn run(models: &[Entry], args: &ListArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    let array = |output: &mut dyn Write| write_array(output, models.iter().map(entry_json));
    let json = Sink::open_given("--json", args.json.as_deref())?;
    if sink::write_document(json, streams, array)? {
        return Ok(Exit::Reached);
    }
    match args.format {
        Format::Text => write_text(models, streams.output)?,
        Format::Json => array(streams.output)?,
    }
    Ok(Exit::Reached)
}

fn write_text(models: &[Entry], output: &mut dyn Write) -> Result<(), CliError> {
    let width = models
        .iter()
        .map(|entry| entry.name().chars().count())
        .max()
        .unwrap_or(0)
        .max(5);
    writeln!(
        output,
        "{:width$}  {:>3} {:>3} {:>3}",
        "model", "N", "M", "S"
    )?;
    for description in models.iter().map(Entry::description) {
        let Description {
            name,
            coordinates,
            constraints,
            surfaces,
            ..
        } = description;
        let (n, m, s) = (coordinates.len(), constraints.len(), surfaces.len());
        let line = format!(
            "{name:width$}  {n:>3} {m:>3} {s:>3}  {}",
            names::summary(description)
        );
        writeln!(output, "{}", line.trim_end())?;
    }
    Ok(())
}

fn entry_json(entry: &Entry) -> Value {
    let description = entry.description();
    json!({
        "name": description.name,
        "N": description.coordinates.len(),
        "M": description.constraints.len(),
        "S": description.surfaces.len(),
        "documentation": names::summary(description),
        "coordinates": names::coordinates(description).collect::<Vec<_>>(),
        "parameters": description.parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>(),
        "constraints": description.constraints.iter().map(|constraint| constraint.name).collect::<Vec<_>>(),
        "surfaces": names::surfaces(description).collect::<Vec<_>>(),
        "modes": description.modes.iter().map(|mode| mode.name).collect::<Vec<_>>(),
        "scenes": entry.scenes().collect::<Vec<_>>(),
    })
}
