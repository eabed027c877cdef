//! Motions between two configurations in a few lines of text.

use std::io::{self, Write};

use dalembert::describe::Description;
use dalembert_driver::{Connection, Point};

use super::Finished;
use crate::{ends, error, names};

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let (model, connected) = (finished.model, &finished.connected);
    let description = model.description();
    writeln!(output, "{}", title(finished))?;
    let boundary = &finished.boundary;
    let from: Vec<Option<f64>> = boundary.from.iter().copied().map(Some).collect();
    writeln!(
        output,
        "  from        {}",
        configuration(description, &from)
    )?;
    let to = configuration(description, &boundary.to);
    writeln!(output, "  to          {to} at t = {}", boundary.time)?;
    writeln!(output, "  search      {}", search(finished))?;
    writeln!(output, "  coverage    {}", doubt(finished))?;
    writeln!(output, "  found       {}", counted(finished))?;
    if boundary.envelope > 0 {
        let points = error::counted(connected.envelope.len(), "conjugate point");
        let starts = error::counted(2 * boundary.envelope, "start");
        writeln!(output, "  envelope    {points} of {starts}")?;
    }
    for (index, connection) in connected.connections.iter().enumerate() {
        writeln!(output)?;
        write_motion(output, description, index + 1, connection)?;
    }
    Ok(())
}

/// The model and its scene.
pub(super) fn title(finished: &Finished<'_>) -> String {
    names::titled(finished.model.description(), finished.scene)
}

/// The configurations and the time.
pub(super) fn subtitle(finished: &Finished<'_>) -> String {
    let description = finished.model.description();
    let boundary = &finished.boundary;
    let from: Vec<Option<f64>> = boundary.from.iter().copied().map(Some).collect();
    format!(
        "from {} to {} in time {}",
        configuration(description, &from),
        configuration(description, &boundary.to),
        boundary.time
    )
}

/// The numbers of motions by their number of impacts.
pub(super) fn counted(finished: &Finished<'_>) -> String {
    let all = &finished.connected.connections;
    let groups = all.chunk_by(|left, right| left.bounces.len() == right.bounces.len());
    let groups = groups.map(|group| {
        let impacts = error::counted(group[0].bounces.len(), "impact");
        format!("{} with {impacts}", group.len())
    });
    match all.len() {
        0 => "no motion".to_owned(),
        count => {
            let groups: Vec<String> = groups.collect();
            format!("{}: {}", error::counted(count, "motion"), groups.join(", "))
        }
    }
}

fn search(finished: &Finished<'_>) -> String {
    let connected = &finished.connected;
    format!(
        "{}, {}, starts of kinetic energy up to {:.4e}",
        error::counted(connected.directions, "direction"),
        error::counted(connected.runs as usize, "run"),
        connected.kinetic,
    )
}

/// Reasons why the search is not exhaustive.
fn doubt(finished: &Finished<'_>) -> String {
    let connected = &finished.connected;
    let faster = match connected.is_bounded {
        true => "faster starts have too many impacts or no motion to the end",
        false => "faster starts were not tried (--energy)",
    };
    let doubts = ends::doubts(connected.unresolved, connected.given_up);
    format!("a scan samples starts, so motions may be missed; {faster}{doubts}")
}

fn write_motion(
    output: &mut dyn Write,
    description: &Description,
    number: usize,
    connection: &Connection,
) -> io::Result<()> {
    let impacts = error::counted(connection.bounces.len(), "impact");
    writeln!(
        output,
        "  motion {number}    {impacts}, action {:?}",
        connection.action
    )?;
    writeln!(
        output,
        "    start     {}",
        velocities(description, &connection.first)
    )?;
    writeln!(
        output,
        "    end       {}",
        velocities(description, &connection.last)
    )?;
    for bounce in &connection.bounces {
        let surface = names::surfaces(description).nth(bounce.surface);
        writeln!(
            output,
            "    impact    t = {:?}, {}",
            bounce.t,
            surface.unwrap_or_default()
        )?;
    }
    writeln!(output, "    residual  {:.1e}", connection.residual)?;
    if !connection.is_isolated {
        let family = match connection.family {
            1 => "no".to_owned(),
            several => format!("no, one of {several} found in a family of equal action"),
        };
        writeln!(
            output,
            "    isolated  {family}: neighbouring starts reach the end too, to first order"
        )?;
    }
    if connection.conjugate.is_empty() {
        let end = if connection.is_isolated {
            "none"
        } else {
            "the end"
        };
        return writeln!(output, "    conjugate {end}");
    }
    connection.conjugate.iter().try_for_each(|conjugate| {
        let q: Vec<Option<f64>> = conjugate.at.q.iter().copied().map(Some).collect();
        let q = configuration(description, &q);
        writeln!(output, "    conjugate t = {:?}, {q}", conjugate.t)
    })
}

/// Positions by name.
fn configuration(description: &Description, q: &[Option<f64>]) -> String {
    let pairs = names::coordinates(description).zip(q);
    let parts: Vec<String> = pairs
        .filter_map(|(name, value)| value.map(|value| format!("{name} = {value:?}")))
        .collect();
    parts.join(", ")
}

/// Velocities by name.
fn velocities(description: &Description, point: &Point) -> String {
    let names = names::coordinates(description).map(names::velocity);
    let parts: Vec<String> = names
        .zip(&point.qdot)
        .map(|(name, value)| format!("{name} = {value:?}"))
        .collect();
    parts.join(", ")
}
