//! Members from a table, one per row.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use dalembert::describe::Description;
use dalembert_driver::ensemble::row::INPUT;
use dalembert_driver::ensemble::{Members, Quantity};

use super::vary;
use crate::error::CliError;
use crate::names;
use crate::scalar;
use crate::sink::is_stdout;

/// Fixed columns of tables that are skipped, because they do not vary a member.
const OTHERS: [&str; 8] = [
    TIME,
    "energy",
    "event",
    MODE,
    "member",
    "outcome",
    "energy_change",
    "reason",
];

/// The column with the mode of a row.
const MODE: &str = "mode";

/// The column with the time of a row.
const TIME: &str = "t";

/// Where and when all members start.
#[derive(Debug, Clone, Copy, Default)]
pub struct Start<'a> {
    /// The mode, for a model with modes.
    pub mode: Option<&'a str>,
    /// True if the motion depends on the time of the start, which is 0.
    pub depends_on_time: bool,
}

/// Limits on the size of a table, which is kept in memory.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Largest size in bytes of a row together with the input skipped before it.
    row: usize,
    /// Largest number of rows.
    members: usize,
}

const LIMITS: Limits = Limits {
    row: 1 << 20,
    members: 10_000_000,
};

/// Reads the members. In a table written by `ensemble`, only the columns `in.NAME` count. Columns without any value
/// belong to coordinates that the mode of the start lacks; they are left out.
///
/// # Errors
/// A file that cannot be read, a column that the model does not have, a field that is not a number, a row in another
/// mode, a row at another time than 0 if the motion depends on time, a row of more than a mebibyte, more than ten million
/// rows.
pub fn read(
    path: &Path,
    stdin: &mut dyn Read,
    description: &Description,
    start: Start<'_>,
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
    parse(&place, file, description, start, LIMITS)
}

/// Parses the members of a table.
fn parse(
    place: &str,
    file: impl Read,
    description: &Description,
    Start {
        mode,
        depends_on_time,
    }: Start<'_>,
    limits: Limits,
) -> Result<Members, CliError> {
    let invalid = |reason: String| CliError::Input {
        place: place.to_owned(),
        reason,
    };
    let since_row = Cell::new(0);
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(Bounded {
            file,
            since_row: &since_row,
            most: limits.row,
        });
    let header = reader
        .headers()
        .map_err(|error| invalid(error.to_string()))?;
    let place_of = |column: &str| header.iter().position(|name| name == column);
    let mode_column = names::of_run(description, MODE);
    let in_mode = mode.and_then(|mode| Some((place_of(&mode_column)?, mode)));
    let is_state = !header.iter().any(|name| name.starts_with(INPUT));
    let time = place_of(TIME).filter(|_| depends_on_time && is_state);
    let mut columns = columns(place, header, description)?;
    if columns.is_empty() {
        return Err(invalid(
            "no column has the name of a coordinate, a velocity or a parameter".to_owned(),
        ));
    }
    let mut rows = Vec::new();
    let mut members = 0;
    // The places of fields without a value.
    let mut gaps = vec![Vec::new(); columns.len()];
    for record in reader.records() {
        let record = record.map_err(|error| invalid(error.to_string()))?;
        since_row.set(0);
        members += 1;
        if members > limits.members {
            return Err(invalid(format!(
                "the file exceeds the limit of {} rows; divide it",
                limits.members
            )));
        }
        let line = record.position().map_or(0, csv::Position::line);
        let place = |name: &str| format!("{place}, line {line}, column `{name}`");
        if let Some((index, mode)) = in_mode {
            let found = record.get(index).unwrap_or_default();
            if found != mode {
                let expected = format!("`{mode}`, the mode in which the members start (--mode)");
                return Err(CliError::value(place(&mode_column), found, expected));
            }
        }
        if let Some(found) = time.and_then(|index| record.get(index))
            && scalar::parse(found) != Ok(0.0)
        {
            let expected = "0, the time at which members start, as the motion depends on time";
            return Err(CliError::value(place(TIME), found, expected));
        }
        for ((index, name, _), gaps) in columns.iter().zip(&mut gaps) {
            let text = record.get(*index).unwrap_or_default();
            let number = match scalar::parse(text) {
                Err(_) if text.is_empty() && mode.is_some() => {
                    gaps.push(line);
                    f64::NAN
                }
                number => {
                    number.map_err(|expected| CliError::value(place(name), text, expected))?
                }
            };
            rows.push(number);
        }
    }
    leave_out(place, &mut columns, &mut rows, &gaps)?;
    let named = columns
        .into_iter()
        .map(|(_, name, quantity)| (name, quantity));
    Ok(Members::listed(named.collect(), rows, 0))
}

/// Removes the columns that have no value in any row. `gaps` are the lines without a value, for each column.
fn leave_out(
    place: &str,
    columns: &mut Vec<(usize, String, Quantity)>,
    rows: &mut Vec<f64>,
    gaps: &[Vec<u64>],
) -> Result<(), CliError> {
    let (width, members) = (columns.len(), rows.len() / columns.len());
    for ((_, name, _), gaps) in columns.iter().zip(gaps) {
        if let Some(line) = gaps.first().filter(|_| gaps.len() < members) {
            let place = format!("{place}, line {line}, column `{name}`");
            return Err(CliError::value(
                place,
                "",
                "a number in every row, or in none",
            ));
        }
    }
    let is_kept = |index: usize| gaps[index % width].is_empty();
    *rows = (rows.iter().enumerate())
        .filter_map(|(index, value)| is_kept(index).then_some(*value))
        .collect();
    let mut index = 0..;
    columns.retain(|_| index.next().is_some_and(is_kept));
    Ok(())
}

/// A reader that stops at a limit of bytes after the last accepted row.
struct Bounded<'a, R> {
    file: R,
    /// Bytes read since the last accepted row.
    since_row: &'a Cell<usize>,
    most: usize,
}

impl<R: Read> Read for Bounded<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.since_row.get() > self.most {
            let text = format!("a row exceeds the limit of {} bytes", self.most);
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        let read = self.file.read(buffer)?;
        self.since_row.set(self.since_row.get() + read);
        Ok(read)
    }
}

/// The columns of varied quantities: index, name and quantity.
fn columns(
    place: &str,
    header: &csv::StringRecord,
    description: &Description,
) -> Result<Vec<(usize, String, Quantity)>, CliError> {
    let is_ensemble = header.iter().any(|name| name.starts_with(INPUT));
    let all = Quantity::all(description);
    let is_quantity = |name: &str| all.iter().any(|(known, _)| known == name);
    // A table written by `ensemble` has no such column.
    if is_ensemble && let Some(name) = header.iter().find(|name| is_quantity(name)) {
        let expected = format!("`{INPUT}{name}`, as other columns begin with `{INPUT}`");
        return Err(CliError::value(place, name, expected));
    }
    let of_run = OTHERS.iter().map(|name| names::of_run(description, name));
    let others: Vec<String> = of_run.chain(names::outputs(description)).collect();
    let ours = |name: &str| match is_ensemble {
        true => name.strip_prefix(INPUT).map(str::to_owned),
        false => {
            let is_other = others.iter().any(|other| other == name);
            (is_quantity(name) || !is_other).then(|| name.to_owned())
        }
    };
    let named = header.iter().enumerate();
    let mut columns: Vec<(usize, String, Quantity)> = Vec::new();
    for (index, name) in named.filter_map(|(index, name)| Some((index, ours(name)?))) {
        let (name, quantity) = vary::find(place, &name, description)?;
        if columns.iter().any(|(.., other)| *other == quantity) {
            return Err(CliError::value(place, name, "every column once"));
        }
        columns.push((index, name, quantity));
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use dalembert::describe::{CoordinateInfo, Topology};
    use dalembert::erased::Held;

    use super::*;

    const POINT: Description = Description {
        type_name: "Point",
        name: "point",
        documentation: Held::Static(""),
        source: Held::Static(""),
        is_first_order: false,
        coordinates: Held::Static(&[CoordinateInfo {
            name: "x",
            topology: Topology::Line,
        }]),
        parameters: Held::Static(&[]),
        constraints: Held::Static(&[]),
        quasi_velocities: Held::Static(&[]),
        forces: Held::Static(&[]),
        surfaces: Held::Static(&[]),
        outputs: Held::Static(&[]),
        integrals: Held::Static(&[]),
        scenes: Held::Static(&["all"]),
        modes: Held::Static(&[]),
        view: None,
    };

    fn count(table: impl Read) -> Result<u64, String> {
        let limits = Limits {
            row: 100_000,
            members: 1000,
        };
        let members = parse("--from table.csv", table, &POINT, Start::default(), limits);
        members
            .map(|members| members.count())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn tables_within_the_limits_are_read() {
        let table = "x\n".to_owned() + &"1\n".repeat(1000);
        assert_eq!(count(table.as_bytes()), Ok(1000));
        let wide = format!("x,t\n1,\"{}\"\n", "\n".repeat(90_000));
        assert_eq!(count(wide.as_bytes()), Ok(1));
    }

    #[test]
    fn a_table_without_end_is_refused_with_its_limit() {
        let refused = |table: &mut dyn Read, limit: &str| {
            let error = count(table).expect_err("a table that is too long");
            assert!(
                error.contains("--from table.csv") && error.contains(limit),
                "{error}"
            );
        };
        refused(&mut io::repeat(0), "100000 bytes");
        refused(&mut io::repeat(b'\n'), "100000 bytes");
        refused(
            &mut "x\n".as_bytes().chain(io::repeat(b'1')),
            "100000 bytes",
        );
        let quoted = b"x,t\n1,a\"b\n2,\"".as_slice();
        refused(&mut quoted.chain(io::repeat(b'\n')), "100000 bytes");
        let rows = "x\n".to_owned() + &"1\n".repeat(1001);
        refused(&mut rows.as_bytes(), "1000 rows");
    }

    /// Tables of runs tell an output from another column of the same name.
    #[test]
    fn outputs_with_the_names_of_other_columns_are_skipped() {
        let description = Description {
            outputs: Held::Static(&["x", "x_dot", "event", "height"]),
            ..POINT
        };
        let outputs: Vec<String> = names::outputs(&description).collect();
        assert_eq!(outputs, ["out.x", "out.x_dot", "out.event", "height"]);
        let table = format!(
            "t,x,x_dot,energy,{},event\n0,1,2,3,4,5,6,7,\n",
            outputs.join(",")
        );
        let limits = Limits {
            row: 100_000,
            members: 1000,
        };
        let members = parse(
            "--from table.csv",
            table.as_bytes(),
            &description,
            Start::default(),
            limits,
        );
        let members = members.expect("members");
        assert_eq!(members.names(), ["x", "x_dot"]);
        assert_eq!(members.values(0), [1.0, 2.0]);
    }
}
