//! Tables as CSV; that of a run has samples and impacts: `t`, coordinates, velocities, `energy` (but of first-order systems),
//! outputs, `event`.

use std::io::{self, Write};

use dalembert::describe::Description;

use crate::driver::Impact;
use crate::entry::Point;
use crate::names;

/// Writes samples and impacts in order of time. The row of an impact shows the state after it and names the
/// surface in the column `event`; a sample at that very instant follows it.
///
/// # Errors
/// Whatever the stream says.
pub fn write(
    output: &mut dyn Write,
    description: &Description,
    samples: &[(f64, Point)],
    impacts: &[Impact],
) -> io::Result<()> {
    write_rows(output, |writer| {
        write_run(writer, description, samples, impacts)
    })
}

/// Writes rows of CSV, to the end.
///
/// # Errors
/// Whatever the stream says, or that a row has another length than the first.
pub fn write_rows(
    output: &mut dyn Write,
    rows: impl FnOnce(&mut csv::Writer<&mut dyn Write>) -> csv::Result<()>,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(output);
    rows(&mut writer).map_err(|error| match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    })?;
    writer.flush()
}

fn write_run(
    writer: &mut csv::Writer<&mut dyn Write>,
    description: &Description,
    samples: &[(f64, Point)],
    impacts: &[Impact],
) -> csv::Result<()> {
    writer.write_record(header(description))?;
    let struck = |impact: &Impact| {
        let event = surface(description, impact);
        row(description, impact.t, &impact.after, event)
    };
    let mut impacts = impacts.iter().peekable();
    for (t, point) in samples {
        while let Some(impact) = impacts.next_if(|impact| impact.t <= *t) {
            writer.write_record(struck(impact))?;
        }
        writer.write_record(row(description, *t, point, ""))?;
    }
    for impact in impacts {
        writer.write_record(struck(impact))?;
    }
    Ok(())
}

fn header(description: &Description) -> Vec<String> {
    let mut header = vec!["t".to_owned()];
    header.extend(names::coordinates(description).map(str::to_owned));
    header.extend(names::coordinates(description).map(names::velocity));
    header.extend(energy(description).map(|()| "energy".to_owned()));
    header.extend(description.outputs.iter().map(|&output| output.to_owned()));
    header.extend((!description.modes.is_empty()).then(|| "mode".to_owned()));
    header.push("event".to_owned());
    header
}

/// Something where there is an energy.
fn energy(description: &Description) -> Option<()> {
    (!description.is_first_order).then_some(())
}

fn row(description: &Description, t: f64, point: &Point, event: &str) -> Vec<String> {
    let numbers = [t]
        .into_iter()
        .chain(point.q.iter().chain(&point.qdot).copied());
    let numbers = numbers
        .chain(energy(description).map(|()| point.energy))
        .chain(point.outputs.iter().copied());
    // `Debug` writes the shortest decimal that reads back to the same number, with an exponent where that is short.
    let has_modes = !description.modes.is_empty();
    numbers
        .map(|number| match has_modes && number.is_nan() {
            // What the mode does not have.
            true => String::new(),
            false => format!("{number:?}"),
        })
        .chain(has_modes.then(|| point.mode.unwrap_or_default().to_owned()))
        .chain([event.to_owned()])
        .collect()
}

fn surface(description: &Description, impact: &Impact) -> &'static str {
    description
        .surfaces
        .get(impact.surface)
        .map_or("", |surface| surface.name)
}
