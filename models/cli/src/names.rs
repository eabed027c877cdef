//! Finding what a flag names: models, parameters, coordinates and their velocities, surfaces, scenes.

use dalembert::describe::Description;

use crate::error::CliError;

/// The position of `given` among `accepted`.
///
/// # Errors
/// [`CliError::Unknown`] with the nearest name and all of them.
pub fn find<'a>(
    place: &str,
    what: &'static str,
    given: &str,
    accepted: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, CliError> {
    accepted
        .clone()
        .position(|name| name == given)
        .ok_or_else(|| CliError::Unknown {
            place: place.to_owned(),
            what,
            given: given.to_owned(),
            accepted: accepted.map(str::to_owned).collect(),
        })
}

/// `name=value`, split at the first equals sign.
///
/// # Errors
/// [`CliError::Value`] without one.
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

/// The name of a coordinate's velocity: `x_dot`, `theta_dot.3`.
pub fn velocity(coordinate: &str) -> String {
    match coordinate.split_once('.') {
        Some((family, member)) => format!("{family}_dot.{member}"),
        None => format!("{coordinate}_dot"),
    }
}

/// The name of a coordinate's momentum: `p_x`, `p_theta.3`.
pub fn momentum(coordinate: &str) -> String {
    format!("p_{coordinate}")
}

/// The coordinates' names in order.
pub fn coordinates(
    description: &Description,
) -> impl Iterator<Item = &'static str> + Clone + use<> {
    description
        .coordinates
        .iter()
        .map(|coordinate| coordinate.name)
}

/// The surfaces' names in order.
pub fn surfaces(description: &Description) -> impl Iterator<Item = &'static str> + Clone + use<> {
    description.surfaces.iter().map(|surface| surface.name)
}

/// The first line of the model's documentation.
pub fn summary(description: &Description) -> &'static str {
    description
        .documentation
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty())
        .unwrap_or_default()
}
