//! Extremals over a varied quantity as CSV: the varied value, then the columns of a single search.

use std::io::{self, Write};

use super::super::spreadsheet::{header, row};
use super::Sweep;
use crate::table;

/// Writes a row for each extremal, in the order of the values and then of the costs.
pub(super) fn write(output: &mut dyn Write, sweep: &Sweep<'_>) -> io::Result<()> {
    table::write_rows(output, |writer| {
        let columns = sweep.made().next().map(|(_, finished)| header(finished));
        let columns = columns.unwrap_or_default().into_iter();
        writer.write_record([format!("in.{}", sweep.name)].into_iter().chain(columns))?;
        for (value, finished) in sweep.made() {
            for extremal in &finished.controlled.extremals {
                let cells = row(finished, extremal).into_iter();
                writer.write_record([format!("{value:?}")].into_iter().chain(cells))?;
            }
        }
        Ok(())
    })
}
