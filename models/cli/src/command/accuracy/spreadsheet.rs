//! A study as CSV, a row for each integrator at each tolerance.

use std::io::{self, Write};

use dalembert_driver::accuracy::{Sample, Study};

use crate::table::write_rows;

const HEAD: [&str; 14] = [
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
    "work",
    "microseconds_per_unit",
];

/// Writes the table.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, study: &Study) -> io::Result<()> {
    write_rows(output, |writer| {
        writer.write_record(HEAD)?;
        let mut rows = study.samples.iter().map(row);
        rows.try_for_each(|row| writer.write_record(row))
    })
}

fn row(sample: &Sample) -> [String; 14] {
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
        sample.work.to_string(),
        sample.microseconds.to_string(),
    ]
}
