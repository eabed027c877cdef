//! Parser of rows from lines of CSV.

use std::borrow::Cow;

use dalembert_driver::ensemble::row::{Columns, Field, Kind, Row};

/// Parses a line of CSV as a row; `None` if it does not fit the columns.
pub fn parse(columns: &Columns, line: &[u8]) -> Option<Row> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line);
    let record = reader.records().next()?.ok()?;
    if record.len() != columns.iter().len() {
        return None;
    }
    let fields = record.iter().zip(columns.iter());
    let fields = fields.map(|(text, (_, kind))| {
        Some(match kind {
            Kind::Integer => Field::Integer(text.parse().ok()?),
            Kind::Number => Field::Number(text.parse().ok()?),
            Kind::Text => Field::Text(Cow::Owned(text.to_owned())),
        })
    });
    fields.collect()
}

/// Unnamed columns of these types, for tests.
#[cfg(test)]
pub fn unnamed(kinds: &[Kind]) -> Columns {
    Columns::new(kinds.iter().map(|&kind| ("c".to_owned(), kind)).collect())
}

#[cfg(test)]
mod tests {
    use dalembert_driver::ensemble::row::csv_line;

    use super::*;

    #[test]
    fn lines_read_back_to_the_same_row() {
        let columns = unnamed(&[Kind::Integer, Kind::Number, Kind::Number, Kind::Text]);
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
        assert_eq!(parse(&columns, &line), Some(row));
        for torn in [&b"1,0.1,2"[..], b"1,x,2,y\n", b"", b"1,0.1,2,y,z\n"] {
            assert_eq!(parse(&columns, torn), None);
        }
    }
}
