//! Manifest of the pictures of a gallery as JSON.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::{Plate, Print};
use crate::error::CliError;
use crate::json::{Document, number};

/// Writes the manifest, with a row for each picture.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(
    output: &mut dyn Write,
    plates: &[Plate<'_>],
    prints: &[Result<Print, CliError>],
) -> io::Result<()> {
    let mut document = Document::begin(output)?;
    document.field("version", env!("CARGO_PKG_VERSION"))?;
    let pairs = plates.iter().zip(prints);
    document.rows("pictures", pairs.map(|(plate, print)| row(plate, print)))?;
    document.end()
}

fn row(plate: &Plate<'_>, print: &Result<Print, CliError>) -> Value {
    let mut row = json!({
        "picture": plate.name(),
        "model": plate.figure.model,
        "figure": plate.figure.name,
        "source": plate.figure.source,
        "command": plate.command(),
    });
    match print {
        Ok(print) => {
            row["file"] = plate.file().into();
            row["outcome"] = print.outcome.as_str().into();
            row["seconds"] = number(print.seconds);
        }
        Err(error) => row["error"] = error.to_string().into(),
    }
    row
}
