//! An orbit in a few lines of text.

use std::io::{self, Write};

use dalembert::describe::Description;
use dalembert_driver::Point;

use super::Finished;
use crate::{names, outcome};

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let (description, search) = (finished.model.description(), &finished.search);
    match finished.scene {
        "all" => writeln!(output, "{}", description.name)?,
        scene => writeln!(output, "{}, scene {scene}", description.name)?,
    }
    let surface = description.surfaces[search.surface].name;
    let returns = match search.returns {
        1 => "1 return".to_owned(),
        several => format!("{several} returns"),
    };
    writeln!(output, "  section      {surface}, {returns}")?;
    let found = match &finished.result {
        Err(missed) => {
            let (kind, details) = outcome::missed(description, missed);
            let details: String = details
                .iter()
                .map(|(name, detail)| format!(", {name} {detail}"))
                .collect();
            writeln!(output, "  outcome      {kind}{details}")?;
            return outcome::remarks_on_orbit(description, missed)
                .iter()
                .try_for_each(|(title, text)| writeln!(output, "  {title:<11}  {text}"));
        }
        Ok(found) => found,
    };
    let steps = match found.iterations {
        1 => "1 step".to_owned(),
        several => format!("{several} steps"),
    };
    writeln!(
        output,
        "  outcome      found in {steps}, closes up to {:.1e}",
        found.residual
    )?;
    writeln!(output, "  period       {}", found.period)?;
    writeln!(
        output,
        "  before       {}",
        state(description, &found.before)
    )?;
    writeln!(
        output,
        "  after        {}",
        state(description, &found.after)
    )?;
    let multipliers: Vec<String> = found
        .multipliers
        .iter()
        .map(|multiplier| complex(*multiplier))
        .collect();
    writeln!(output, "  multipliers  {}", multipliers.join(", "))
}

/// The names of the components of a state.
pub(super) fn components(description: &Description) -> Vec<String> {
    let positions = names::coordinates(description).map(str::to_owned);
    if description.is_first_order {
        return positions.collect();
    }
    let quasi = description.quasi_velocities.iter();
    match description.quasi_velocities.is_empty() {
        false => positions
            .chain(quasi.map(|quasi| (*quasi).to_owned()))
            .collect(),
        true => {
            let momenta = names::coordinates(description).map(names::momentum);
            positions.chain(momenta).collect()
        }
    }
}

/// Positions and velocities by name.
fn state(description: &Description, point: &Point) -> String {
    let positions = names::coordinates(description).map(str::to_owned);
    let mut parts: Vec<String> = positions
        .zip(&point.q)
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    if !description.is_first_order {
        let velocities = names::coordinates(description).map(names::velocity);
        let values = velocities.zip(&point.qdot);
        parts.extend(values.map(|(name, value)| format!("{name} = {value}")));
    }
    parts.join(", ")
}

/// A complex number.
fn complex([re, im]: [f64; 2]) -> String {
    match im {
        0.0 => format!("{re}"),
        im if im < 0.0 => format!("{re} - {}i", -im),
        im => format!("{re} + {im}i"),
    }
}
