//! Tables as CSV. The table of a run has a row for each sample and each impact, with the columns `t`, coordinates,
//! velocities, `energy` (except for first-order systems), outputs, `mode` (for models with modes), `event`.

use std::io::{self, Write};

use dalembert::describe::Description;
use dalembert_driver::{Contact, Impact, Point};

use crate::error::CliError;
use crate::names;
use crate::record::Keep;
use crate::sink::Stream;

/// The table of a run, which is written during the run. The row of an impact shows the state after it and names the
/// surface in the column `event`. A sample at the same time follows it.
pub struct RunTable<'a> {
    description: &'a Description,
    writer: csv::Writer<Stream<'a>>,
    has_header: bool,
}

impl<'a> RunTable<'a> {
    /// A table without rows and without a header.
    pub fn new(description: &'a Description, stream: Stream<'a>) -> Self {
        Self {
            description,
            writer: csv::Writer::from_writer(stream),
            has_header: false,
        }
    }

    /// Writes the remaining output.
    ///
    /// # Errors
    /// An I/O error of the file or stream.
    pub fn finish(mut self) -> Result<(), CliError> {
        let finished = self.head().and_then(|()| self.writer.flush());
        finished.map_err(|source| self.failed(source))
    }

    /// Writes the header before the first row.
    fn head(&mut self) -> io::Result<()> {
        if self.has_header {
            return Ok(());
        }
        self.has_header = true;
        let header = header(self.description);
        self.writer.write_record(header).map_err(io_error)
    }

    fn row(&mut self, t: f64, point: &Point, event: &str) -> io::Result<()> {
        self.head()?;
        let row = row(self.description, t, point, event);
        self.writer.write_record(row).map_err(io_error)
    }
}

impl Keep for RunTable<'_> {
    fn sample(&mut self, t: f64, point: &Point) -> io::Result<()> {
        self.row(t, point, "")
    }

    fn impact(&mut self, impact: &Impact) -> io::Result<()> {
        let surface = surface(self.description, impact);
        self.row(impact.t, &impact.after, surface)
    }

    fn contact(&mut self, _contact: &Contact) -> io::Result<()> {
        Ok(())
    }

    fn failed(&self, error: io::Error) -> CliError {
        self.writer.get_ref().failed(error)
    }
}

/// Writes all rows of a CSV table.
///
/// # Errors
/// An I/O error of the stream, or a row whose length differs from that of the first.
pub fn write_rows(
    output: &mut dyn Write,
    rows: impl FnOnce(&mut csv::Writer<&mut dyn Write>) -> csv::Result<()>,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(output);
    rows(&mut writer).map_err(io_error)?;
    writer.flush()
}

fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    }
}

fn header(description: &Description) -> Vec<String> {
    let mut header = vec!["t".to_owned()];
    header.extend(names::coordinates(description).map(str::to_owned));
    header.extend(names::coordinates(description).map(names::velocity));
    header.extend(energy(description).map(|()| "energy".to_owned()));
    header.extend(names::outputs(description));
    header.extend((!description.modes.is_empty()).then(|| names::of_run(description, "mode")));
    header.push(names::of_run(description, "event"));
    header
}

/// `Some` for a model with an energy.
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
    let has_modes = !description.modes.is_empty();
    numbers
        .map(|number| match has_modes && number.is_nan() {
            // The mode lacks this quantity. For other numbers, `Debug` writes the shortest decimal that parses to the
            // same number.
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
