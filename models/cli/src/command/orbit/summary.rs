//! An orbit in a few lines of text.

use std::io::{self, Write};

use dalembert::OrbitError;
use dalembert::describe::Description;
use dalembert_driver::{Found, Point, Symmetries};

use super::Finished;
use crate::error::counted;
use crate::scalar::full;
use crate::{names, outcome};

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_, Found>) -> io::Result<()> {
    let description = finished.model.description();
    head(output, finished)?;
    let found = match &finished.result {
        Err(missed) => return tell_missed(output, finished, missed),
        Ok(found) => found,
    };
    writeln!(
        output,
        "  outcome      found in {}, closes up to {:.1e}",
        counted(found.iterations as usize, "step"),
        found.residual
    )?;
    writeln!(output, "  period       {}", found.period)?;
    let symmetries = finished.search.modulo.iter();
    let fields = symmetries.flat_map(Symmetries::generators);
    for (field, factor) in fields.zip(&found.element) {
        writeln!(output, "  advance      {factor} along {}", field.name)?;
    }
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
        .map(|multiplier| complex(*multiplier, full))
        .collect();
    writeln!(output, "  multipliers  {}", multipliers.join(", "))?;
    momenta(output, finished)
}

/// Names the multipliers 1 that conserved momenta of the symmetries cause.
fn momenta(output: &mut dyn Write, finished: &Finished<'_, Found>) -> io::Result<()> {
    let symmetries = finished.search.modulo.iter();
    let mut kept = symmetries
        .flat_map(Symmetries::generators)
        .filter(|field| field.keeps_momentum);
    kept.try_for_each(|field| {
        let name = &field.name;
        writeln!(
            output,
            "  conserved    the momentum of {name}: a multiplier 1"
        )
    })
}

/// Writes the model, its scene, the section and the symmetries.
pub(super) fn head<T>(output: &mut dyn Write, finished: &Finished<'_, T>) -> io::Result<()> {
    writeln!(output, "{}", title(finished))?;
    writeln!(output, "  section      {}", section(finished))?;
    let Some(symmetries) = &finished.search.modulo else {
        return Ok(());
    };
    let fields = symmetries.generators().iter();
    let fields: Vec<&str> = fields.map(|field| field.name.as_str()).collect();
    writeln!(output, "  modulo       {}", fields.join(", "))
}

/// The model and its scene.
pub(super) fn title<T>(finished: &Finished<'_, T>) -> String {
    let name = finished.model.description().name;
    match finished.scene {
        "all" => name.to_owned(),
        scene => format!("{name}, scene {scene}"),
    }
}

/// `wall, 2 returns`
pub(super) fn section<T>(finished: &Finished<'_, T>) -> String {
    let search = &finished.search;
    let surface = finished.model.description().surfaces[search.surface].name;
    format!("{surface}, {}", counted(search.returns as usize, "return"))
}

/// Writes the reason why no orbit was found.
pub(super) fn tell_missed<T>(
    output: &mut dyn Write,
    finished: &Finished<'_, T>,
    missed: &OrbitError,
) -> io::Result<()> {
    let description = finished.model.description();
    let (kind, details) = outcome::missed(description, missed);
    let details: String = details
        .iter()
        .map(|(name, detail)| format!(", {name} {detail}"))
        .collect();
    writeln!(output, "  outcome      {kind}{details}")?;
    let remarks = match &finished.drift {
        Some(drift) => drift.remarks().to_vec(),
        None => outcome::remarks_on_orbit(description, missed),
    };
    remarks
        .iter()
        .try_for_each(|(title, text)| writeln!(output, "  {title:<11}  {text}"))
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
        .map(|(name, value)| format!("{name} = {}", full(*value)))
        .collect();
    if !description.is_first_order {
        let velocities = names::coordinates(description).map(names::velocity);
        let values = velocities.zip(&point.qdot);
        parts.extend(values.map(|(name, value)| format!("{name} = {}", full(*value))));
    }
    parts.join(", ")
}

/// A complex number; `number` formats its parts.
pub(super) fn complex([re, im]: [f64; 2], number: impl Fn(f64) -> String) -> String {
    match im {
        0.0 => number(re),
        im if im < 0.0 => format!("{} - {}i", number(re), number(-im)),
        im => format!("{} + {}i", number(re), number(im)),
    }
}
