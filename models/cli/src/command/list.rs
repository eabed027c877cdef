//! `list`: the models with their numbers of coordinates (N), constraints (M) and surfaces (S), and the first line of
//! their documentation.

use std::io::Write;

use dalembert::describe::Description;
use serde_json::{Value, json};

use crate::args::{Format, ListArgs};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::names;

/// Carries out `list`.
///
/// # Errors
/// [`CliError::Stream`] if the output fails.
pub fn run(models: &[Entry], args: &ListArgs, output: &mut dyn Write) -> Result<Exit, CliError> {
    match args.format {
        Format::Text => write_text(models, output)?,
        Format::Json => crate::json::write_array(output, models.iter().map(entry_json))?,
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
