//! The rows of a finished journal as Parquet.

use std::fs::File;
use std::path::Path;

use dalembert_driver::ensemble::parquet::{Result, Writer};
use dalembert_driver::ensemble::row::Columns;
use serde_json::{Map, Value};

use super::journal;

/// Writes the rows of a journal.
///
/// # Errors
/// An I/O error of one of the files.
pub fn write(
    path: &Path,
    rows: &Path,
    columns: &Columns,
    metadata: &Map<String, Value>,
    first_member: u64,
) -> Result<()> {
    let entries = metadata.iter().map(|(key, value)| {
        // A string is written as it is; any other value as JSON.
        let text = value.as_str().map(str::to_owned);
        (
            format!("dalembert.{key}"),
            text.unwrap_or_else(|| value.to_string()),
        )
    });
    let mut writer = Writer::new(File::create(path)?, columns, entries)?;
    let mut failed = None;
    journal::read_rows(rows, columns, first_member, &mut |row| {
        failed = failed.take().or(writer.add(row.clone()).err());
    })?;
    failed.map_or(Ok(()), Err)?;
    writer.finish().map(drop)
}
