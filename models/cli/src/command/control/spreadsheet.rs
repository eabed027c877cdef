//! Extremals as CSV: one row for each, and the motion along one of them.

use std::io::{self, Write};

use dalembert_driver::{Extremal, Point};

use super::Finished;
use super::summary::verdict;
use crate::{names, table};

/// Writes a row for each extremal: number of impacts, cost, terminal cost, costate at the start, state and costate at
/// the end, H* at the start, residual, second-order test. Then come two lists with spaces between their items: times and
/// surfaces of the impacts.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    table::write_rows(output, |writer| {
        writer.write_record(header(finished))?;
        for extremal in &finished.controlled.extremals {
            writer.write_record(row(finished, extremal))?;
        }
        Ok(())
    })
}

/// The names of the columns.
pub(super) fn header(finished: &Finished<'_>) -> Vec<String> {
    let mut header: Vec<String> = ["impacts", "cost", "terminal"].map(str::to_owned).into();
    header.extend(finished.states().map(|name| format!("costate.{name}")));
    header.extend(finished.states().map(|name| format!("end.{name}")));
    header.extend(finished.states().map(|name| format!("end.costate.{name}")));
    let last = [
        "hamiltonian",
        "residual",
        "second_order",
        "times",
        "surfaces",
    ];
    header.extend(last.map(str::to_owned));
    header
}

/// The row of an extremal.
pub(super) fn row(finished: &Finished<'_>, extremal: &Extremal) -> Vec<String> {
    let surface = |index: usize| {
        let mut surfaces = names::surfaces(finished.description());
        surfaces.nth(index).unwrap_or_default()
    };
    let Extremal { first, last, .. } = extremal;
    let numbers = [extremal.cost, extremal.terminal].into_iter();
    let ends = first.costate.iter().chain(&last.state).chain(&last.costate);
    let numbers = numbers
        .chain(ends.copied())
        .chain([first.hamiltonian, extremal.residual]);
    let mut row = vec![extremal.kicks.len().to_string()];
    row.extend(numbers.map(|value| number(&value)));
    row.push(verdict(extremal).0.to_owned());
    let kicks = extremal.kicks.iter();
    row.push(list(kicks.clone().map(|kick| number(&kick.before.t))));
    row.push(list(kicks.map(|kick| surface(kick.surface).to_owned())));
    row
}

/// Writes a motion: time, components, inputs and H*.
pub(super) fn write_motion(
    output: &mut dyn Write,
    finished: &Finished<'_>,
    rows: &[(f64, Point)],
) -> io::Result<()> {
    let shown = finished.inputs().count() + 1;
    let outputs = finished.description().outputs.iter().copied().take(shown);
    let names = names::coordinates(finished.description()).chain(outputs);
    table::write_rows(output, |writer| {
        writer.write_record(["t"].into_iter().chain(names))?;
        for (t, point) in rows {
            let values = [t].into_iter().chain(&point.q);
            let values = values.chain(point.outputs.iter().take(shown));
            writer.write_record(values.map(number))?;
        }
        Ok(())
    })
}

fn number(value: &f64) -> String {
    format!("{value:?}")
}

fn list(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<String>>().join(" ")
}
