//! Lookup of names given by flags: models, parameters, coordinates and their velocities, surfaces, scenes.

use dalembert::describe::Description;
use dalembert_driver::names;
pub use dalembert_driver::names::{
    column, coordinates, is_quantity, momentum, of_run, outputs, surfaces, velocity,
};

use crate::error::CliError;

/// The position of `given` among `accepted`.
///
/// # Errors
/// [`CliError::Unknown`], with the nearest accepted name and all of them.
pub fn find<'a>(
    place: &str,
    what: &'static str,
    given: &str,
    accepted: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, CliError> {
    names::find(what, given, accepted).map_err(|unknown| CliError::Unknown {
        place: place.to_owned(),
        unknown,
    })
}

/// Splits `name=value` at the first equals sign.
///
/// # Errors
/// [`CliError::Value`] if there is no equals sign.
pub fn assignment<'a>(
    place: &str,
    text: &'a str,
    expected: &str,
) -> Result<(&'a str, &'a str), CliError> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| CliError::value(place, text, expected))?;
    Ok((name.trim(), value.trim()))
}

/// The name of the model, and that of its scene unless it is the model itself.
pub fn titled(description: &Description, scene: &str) -> String {
    match scene {
        "all" => description.name.to_owned(),
        scene => format!("{}, scene {scene}", description.name),
    }
}

/// The first line of the model's documentation that is not empty.
pub fn summary(description: &Description) -> &str {
    description
        .documentation
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty())
        .unwrap_or_default()
}
