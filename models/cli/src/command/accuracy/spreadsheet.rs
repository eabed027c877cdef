//! A study as CSV, a row for each integrator at each tolerance.

use std::io::{self, Write};

use crate::accuracy::{Sample, Study};

const HEAD: [&str; 13] = [
    "integrator",
    "tol",
    "step",
    "error",
    "ends_as_reference",
    "outcome",
    "t",
    "impacts",
    "rate_evaluations",
    "coefficients",
    "accepted",
    "rejected",
    "microseconds_per_unit",
];

/// Writes the table.
///
/// # Errors
/// Whatever the stream says.
pub fn write(output: &mut dyn Write, study: &Study) -> io::Result<()> {
    let rows = write_rows(csv::Writer::from_writer(output), study);
    rows.map_err(|error| match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        kind => io::Error::other(format!("{kind:?}")),
    })
}

fn write_rows(mut writer: csv::Writer<&mut dyn Write>, study: &Study) -> csv::Result<()> {
    writer.write_record(HEAD)?;
    for sample in &study.samples {
        writer.write_record(row(sample))?;
    }
    writer.flush()?;
    Ok(())
}

fn row(sample: &Sample) -> [String; 13] {
    let counters = &sample.counters;
    [
        sample.integrator.name().to_owned(),
        format!("{:e}", sample.tol),
        sample.step.map_or(String::new(), |step| step.to_string()),
        format!("{:e}", sample.error),
        sample.agrees.to_string(),
        sample.outcome.kind().to_owned(),
        sample.t.to_string(),
        counters.impacts.to_string(),
        counters.rate_evaluations.to_string(),
        counters.coefficients.to_string(),
        counters.accepted.to_string(),
        counters.rejected.to_string(),
        sample.microseconds.to_string(),
    ]
}
