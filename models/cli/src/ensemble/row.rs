//! The table of an ensemble: its columns, one row per member, and rows as lines of CSV.

use std::borrow::Cow;

use dalembert::describe::Description;
use dalembert::integrate::Counters;

use super::listed::INPUT;
use super::members::Members;
use crate::{names, outcome};

/// Type of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A count or an index.
    Integer,
    /// A number; NaN for a missing one.
    Number,
    /// A text.
    Text,
}

/// A field of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// A count or an index.
    Integer(u64),
    /// A number; NaN for a missing one.
    Number(f64),
    /// A text.
    Text(Cow<'static, str>),
}

/// A row, in the order of the columns.
pub type Row = Vec<Field>;

/// The columns.
#[derive(Debug, Clone)]
pub struct Columns {
    columns: Vec<(String, Kind)>,
}

impl Columns {
    /// The columns for these members of a model.
    pub fn of(description: &Description, members: &Members) -> Self {
        let coordinates = names::coordinates(description);
        let velocities = coordinates.clone().map(names::velocity);
        let mut columns = vec![("member".to_owned(), Kind::Integer)];
        let mut add = |kind: Kind, names: &mut dyn Iterator<Item = String>| {
            columns.extend(names.map(|name| (name, kind)));
        };
        let inputs = members.names().iter();
        add(
            Kind::Number,
            &mut inputs.map(|name| format!("{INPUT}{name}")),
        );
        add(Kind::Text, &mut ["outcome".to_owned()].into_iter());
        let last = coordinates.map(str::to_owned).chain(velocities);
        let last = ["t".to_owned()]
            .into_iter()
            .chain(last.map(|name| format!("end.{name}")));
        add(
            Kind::Number,
            &mut last.chain(["energy", "energy_change"].map(str::to_owned)),
        );
        let outputs = description.outputs.iter();
        add(Kind::Number, &mut outputs.map(|name| format!("out.{name}")));
        let surfaces = names::surfaces(description);
        add(
            Kind::Integer,
            &mut surfaces.map(|name| format!("impacts.{name}")),
        );
        let counters = outcome::counters(&Counters::default()).into_iter();
        let counters = counters.map(|(name, _)| name.to_owned());
        add(
            Kind::Integer,
            &mut ["contacts".to_owned()].into_iter().chain(counters),
        );
        add(Kind::Text, &mut ["reason".to_owned()].into_iter());
        Self { columns }
    }

    /// Columns of these names and types.
    pub fn new(columns: Vec<(String, Kind)>) -> Self {
        Self { columns }
    }

    /// Unnamed columns of these types, for tests.
    #[cfg(test)]
    pub fn unnamed(kinds: &[Kind]) -> Self {
        let columns = kinds.iter().map(|&kind| ("c".to_owned(), kind));
        Self {
            columns: columns.collect(),
        }
    }

    /// Names and types.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, Kind)> {
        self.columns
            .iter()
            .map(|(name, kind)| (name.as_str(), *kind))
    }

    /// The position of a column.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|(known, _)| known == name)
    }

    /// The header as a line of CSV.
    pub fn header(&self) -> Vec<u8> {
        line(
            self.columns
                .iter()
                .map(|(name, _)| Cow::Borrowed(name.as_str())),
        )
    }

    /// Parses a line of CSV as a row.
    pub fn parse(&self, line: &[u8]) -> Option<Row> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(line);
        let record = reader.records().next()?.ok()?;
        if record.len() != self.columns.len() {
            return None;
        }
        let fields = record.iter().zip(&self.columns);
        let fields = fields.map(|(text, (_, kind))| {
            Some(match kind {
                Kind::Integer => Field::Integer(text.parse().ok()?),
                Kind::Number => Field::Number(text.parse().ok()?),
                Kind::Text => Field::Text(Cow::Owned(text.to_owned())),
            })
        });
        fields.collect()
    }
}

/// A row as a line of CSV. No field contains a line end.
pub fn csv_line(row: &Row) -> Vec<u8> {
    line(row.iter().map(|field| match field {
        Field::Integer(value) => Cow::Owned(value.to_string()),
        // The shortest decimal that parses to the same number.
        Field::Number(value) => Cow::Owned(format!("{value:?}")),
        Field::Text(text) => Cow::Borrowed(text.as_ref()),
    }))
}

fn line<'a>(fields: impl Iterator<Item = Cow<'a, str>>) -> Vec<u8> {
    let mut line = Vec::new();
    for (index, field) in fields.enumerate() {
        if index > 0 {
            line.push(b',');
        }
        if field.contains([',', '"']) {
            let quoted = format!("\"{}\"", field.replace('"', "\"\""));
            line.extend_from_slice(quoted.as_bytes());
        } else {
            line.extend_from_slice(field.as_bytes());
        }
    }
    line.push(b'\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back_to_the_same_row() {
        let columns = Columns::unnamed(&[Kind::Integer, Kind::Number, Kind::Number, Kind::Text]);
        let row = vec![
            Field::Integer(u64::MAX),
            Field::Number(0.1),
            Field::Number(f64::NEG_INFINITY),
            Field::Text(Cow::Borrowed("\"floor\", at 2.5")),
        ];
        let line = csv_line(&row);
        assert_eq!(
            line,
            b"18446744073709551615,0.1,-inf,\"\"\"floor\"\", at 2.5\"\n"
        );
        assert_eq!(columns.parse(&line), Some(row));
        for torn in [&b"1,0.1,2"[..], b"1,x,2,y\n", b"", b"1,0.1,2,y,z\n"] {
            assert_eq!(columns.parse(torn), None);
        }
    }
}
