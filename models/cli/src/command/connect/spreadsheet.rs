//! Motions between two configurations as CSV, one row per motion.

use std::io::{self, Write};

use dalembert_driver::{Connection, Point};

use super::Finished;
use crate::{names, table};

/// Writes the columns: number of impacts, action, velocities at the start, positions and velocities at the end, residual.
/// Then come lists with spaces between their items: times and surfaces of the impacts, times of the conjugate points.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let description = finished.model.description();
    let coordinates = || names::coordinates(description);
    let mut header = vec!["impacts".to_owned(), "action".to_owned()];
    header.extend(coordinates().map(names::velocity));
    header.extend(coordinates().map(|name| format!("end.{name}")));
    header.extend(coordinates().map(|name| format!("end.{}", names::velocity(name))));
    let lists = ["residual", "times", "surfaces", "conjugate"];
    header.extend(lists.map(str::to_owned));
    let surface = |index: usize| names::surfaces(description).nth(index).unwrap_or_default();
    table::write_rows(output, |writer| {
        writer.write_record(&header)?;
        for connection in &finished.connected.connections {
            writer.write_record(row(connection, &surface))?;
        }
        Ok(())
    })
}

fn row<'a>(connection: &Connection, surface: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let Connection {
        first,
        last,
        bounces,
        conjugate,
        ..
    } = connection;
    let Point { q, qdot, .. } = last;
    let numbers = first
        .qdot
        .iter()
        .chain(q)
        .chain(qdot)
        .chain([&connection.residual]);
    let mut row = vec![bounces.len().to_string(), number(&connection.action)];
    row.extend(numbers.map(number));
    row.push(list(bounces.iter().map(|bounce| number(&bounce.t))));
    row.push(list(
        bounces
            .iter()
            .map(|bounce| surface(bounce.surface).to_owned()),
    ));
    row.push(list(conjugate.iter().map(|it| number(&it.t))));
    row
}

fn number(value: &f64) -> String {
    format!("{value:?}")
}

fn list(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<String>>().join(" ")
}
