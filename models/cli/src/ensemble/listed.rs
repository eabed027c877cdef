//! Members from a table, one a row.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use dalembert::describe::Description;

use super::members::Members;
use super::vary::Quantity;
use crate::error::CliError;
use crate::scalar;
use crate::sink::is_stdout;

/// What columns of the tables that this command line writes are called besides what members can differ in.
const OTHERS: [&str; 7] = [
    "t",
    "energy",
    "event",
    "member",
    "outcome",
    "energy_change",
    "reason",
];

/// Beginning of the names of columns that `ensemble --csv` writes for what was varied.
pub const INPUT: &str = "in.";

/// Reads the members. In a table that `ensemble` wrote they are the columns `in.NAME`.
///
/// # Errors
/// A file that cannot be read, a column that a model does not have, a field that is no number.
pub fn read(
    path: &Path,
    stdin: &mut dyn Read,
    description: &Description,
) -> Result<Members, CliError> {
    let file: Box<dyn Read + '_> = if is_stdout(path) {
        Box::new(stdin)
    } else {
        let opened = File::open(path).map_err(|source| CliError::File {
            flag: "--from",
            path: path.to_owned(),
            source,
        });
        Box::new(opened?)
    };
    let place = format!("--from {}", path.display());
    let invalid = |reason: String| CliError::Input {
        place: place.clone(),
        reason,
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(file);
    let header = reader
        .headers()
        .map_err(|error| invalid(error.to_string()))?;
    let columns = columns(&place, header, description)?;
    if columns.is_empty() {
        return Err(invalid(
            "no column is named like a coordinate, a velocity or a parameter".to_owned(),
        ));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| invalid(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        for (index, name, _) in &columns {
            let text = record.get(*index).unwrap_or_default();
            let place = || format!("{place}, line {line}, column `{name}`");
            let number = scalar::parse(text);
            rows.push(number.map_err(|expected| CliError::value(place(), text, expected))?);
        }
    }
    let named = columns
        .into_iter()
        .map(|(_, name, quantity)| (name, quantity));
    Ok(Members::listed(named.collect(), rows))
}

/// The columns that members are made of: index, name and quantity.
fn columns(
    place: &str,
    header: &csv::StringRecord,
    description: &Description,
) -> Result<Vec<(usize, String, Quantity)>, CliError> {
    let is_ensemble = header.iter().any(|name| name.starts_with(INPUT));
    let ours = |name: &str| match is_ensemble {
        true => name.strip_prefix(INPUT).map(str::to_owned),
        false => {
            let is_other = OTHERS.contains(&name) || description.outputs.contains(&name);
            let is_input = Quantity::all(description)
                .iter()
                .any(|(own, _)| own == name);
            (is_input || !is_other).then(|| name.to_owned())
        }
    };
    let named = header.iter().enumerate();
    let mut columns: Vec<(usize, String, Quantity)> = Vec::new();
    for (index, name) in named.filter_map(|(index, name)| Some((index, ours(name)?))) {
        let quantity = Quantity::find(place, &name, description)?;
        if columns.iter().any(|(.., other)| *other == quantity) {
            return Err(CliError::value(place, name, "every column once"));
        }
        columns.push((index, name, quantity));
    }
    Ok(columns)
}
