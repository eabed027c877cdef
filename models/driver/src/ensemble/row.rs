//! The table of an ensemble: its columns, one row per member, and rows as lines of CSV.

use std::borrow::Cow;

use dalembert::describe::Description;
use dalembert::integrate::Counters;

use super::members::Members;
use crate::{names, outcome};

/// Prefix of the names of columns of varied quantities.
pub const INPUT: &str = "in.";

/// Prefix of the names of columns of outputs.
pub const OUTPUT: &str = "out.";

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

/// The outcome of members that are behind a surface, nearly always at their start.
const BEHIND: &str = "starts_inside";

/// True for the row of a member that is behind a surface. It does not count in statistics.
pub fn is_behind(row: &[Field]) -> bool {
    let mut texts = row.iter();
    texts.any(|field| matches!(field, Field::Text(text) if text == BEHIND))
}

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
        add(
            Kind::Number,
            &mut outputs.map(|name| format!("{OUTPUT}{name}")),
        );
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

    /// Columns with these names and types.
    pub fn new(columns: Vec<(String, Kind)>) -> Self {
        Self { columns }
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
