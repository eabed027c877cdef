//! Rows as Parquet: the columns and values of the CSV, uncompressed, in groups of [`GROUP`] rows.

use std::io::Write;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
pub use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use super::row::{Columns, Field, Kind, Row, csv_line};

/// Number of rows in a row group, which is held in memory.
const GROUP: usize = 1 << 14;

/// Writes rows one by one.
pub struct Writer<W: Write + Send> {
    columns: Columns,
    writer: SerializedFileWriter<W>,
    group: Vec<Row>,
}

impl<W: Write + Send> Writer<W> {
    /// A writer of rows with these columns. The entries of the metadata are keys and values.
    ///
    /// # Errors
    /// An I/O error.
    pub fn new(
        out: W,
        columns: &Columns,
        metadata: impl IntoIterator<Item = (String, String)>,
    ) -> Result<Self> {
        let entries = metadata.into_iter();
        let entries = entries.map(|(key, value)| KeyValue::new(key, value));
        let properties = WriterProperties::builder()
            .set_key_value_metadata(Some(entries.collect()))
            .build();
        Ok(Self {
            columns: columns.clone(),
            writer: SerializedFileWriter::new(out, schema(columns)?, Arc::new(properties))?,
            group: Vec::new(),
        })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// An I/O error.
    pub fn add(&mut self, row: Row) -> Result<()> {
        self.group.push(row);
        if self.group.len() < GROUP {
            return Ok(());
        }
        self.write_group()
    }

    /// Writes what is left and the end of the file, and gives back what was written to.
    ///
    /// # Errors
    /// An I/O error.
    pub fn finish(mut self) -> Result<W> {
        if !self.group.is_empty() {
            self.write_group()?;
        }
        self.writer.into_inner()
    }

    fn write_group(&mut self) -> Result<()> {
        let mut group = self.writer.next_row_group()?;
        for (index, (_, kind)) in self.columns.iter().enumerate() {
            let missing = || ParquetError::General("fewer columns than the schema has".to_owned());
            let mut column = group.next_column()?.ok_or_else(missing)?;
            write_column(&mut column, kind, self.group.iter().map(|row| &row[index]))?;
            column.close()?;
        }
        self.group.clear();
        group.close().map(drop)
    }
}

fn schema(columns: &Columns) -> Result<TypePtr> {
    let fields: Result<Vec<TypePtr>> = columns
        .iter()
        .map(|(name, kind)| {
            let (physical, logical) = match kind {
                Kind::Integer => (Physical::INT64, Some(LogicalType::integer(64, false))),
                Kind::Number => (Physical::DOUBLE, None),
                Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let field = Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::REQUIRED)
                .with_logical_type(logical)
                .build();
            field.map(Arc::new)
        })
        .collect();
    let schema = Type::group_type_builder("member")
        .with_fields(fields?)
        .build();
    schema.map(Arc::new)
}

fn write_column<'a>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    fields: impl Iterator<Item = &'a Field>,
) -> Result<()> {
    match kind {
        Kind::Integer => {
            let integer = |field: &Field| match field {
                Field::Integer(value) => *value as i64,
                _ => 0,
            };
            write_values::<Int64Type>(column, fields.map(integer).collect())
        }
        Kind::Number => {
            let number = |field: &Field| match field {
                Field::Number(value) => *value,
                _ => f64::NAN,
            };
            write_values::<DoubleType>(column, fields.map(number).collect())
        }
        Kind::Text => {
            let text = |field: &Field| match field {
                Field::Text(value) => ByteArray::from(value.as_ref()),
                _ => ByteArray::from(""),
            };
            write_values::<ByteArrayType>(column, fields.map(text).collect())
        }
    }
}

fn write_values<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: Vec<T::T>,
) -> Result<()> {
    let written = column.typed::<T>().write_batch(&values, None, None);
    written.map(drop)
}

/// All values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Counts and indices.
    Integers(Vec<u64>),
    /// Numbers.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// The columns and the number of rows of a file.
///
/// # Errors
/// A file without the structure that [`Writer`] writes.
pub fn columns(file: &Bytes) -> Result<(Columns, usize)> {
    let reader = SerializedFileReader::new(file.clone())?;
    let metadata = reader.metadata().file_metadata();
    let fields = metadata.schema_descr().columns().iter();
    let fields: Result<Vec<(String, Kind)>> = fields
        .map(|field| {
            let kind = match field.physical_type() {
                Physical::INT64 => Kind::Integer,
                Physical::DOUBLE => Kind::Number,
                Physical::BYTE_ARRAY => Kind::Text,
                other => return Err(ParquetError::General(format!("a column of type {other}"))),
            };
            Ok((field.name().to_owned(), kind))
        })
        .collect();
    Ok((Columns::new(fields?), metadata.num_rows() as usize))
}

/// The values of a column of a file.
///
/// # Errors
/// A file that [`Writer`] did not write, or without this column.
pub fn column(file: &Bytes, place: usize) -> Result<Values> {
    let reader = SerializedFileReader::new(file.clone())?;
    let rows = reader.metadata().file_metadata().num_rows() as usize;
    if place
        >= reader
            .metadata()
            .file_metadata()
            .schema_descr()
            .num_columns()
    {
        return Err(ParquetError::General(format!("no column {place}")));
    }
    let (mut integers, mut numbers, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for group in 0..reader.num_row_groups() {
        match reader.get_row_group(group)?.get_column_reader(place)? {
            ColumnReader::Int64ColumnReader(column) => read_values(column, &mut integers)?,
            ColumnReader::DoubleColumnReader(column) => read_values(column, &mut numbers)?,
            ColumnReader::ByteArrayColumnReader(column) => read_values(column, &mut texts)?,
            _ => return Err(ParquetError::General("a column of another type".to_owned())),
        }
    }
    let values = if !texts.is_empty() {
        let texts = texts.iter().map(|text| text.as_utf8().map(str::to_owned));
        Values::Texts(texts.collect::<Result<_>>()?)
    } else if !numbers.is_empty() {
        Values::Numbers(numbers)
    } else {
        Values::Integers(integers.into_iter().map(|value| value as u64).collect())
    };
    let found = match &values {
        Values::Integers(values) => values.len(),
        Values::Numbers(values) => values.len(),
        Values::Texts(values) => values.len(),
    };
    if found == rows {
        Ok(values)
    } else {
        Err(ParquetError::General(format!(
            "{found} values in {rows} rows"
        )))
    }
}

fn read_values<T: DataType>(mut column: ColumnReaderImpl<T>, values: &mut Vec<T::T>) -> Result<()> {
    column
        .read_records(usize::MAX, None, None, values)
        .map(drop)
}

/// The rows of a file as lines of CSV, without a header.
///
/// # Errors
/// A file that [`Writer`] did not write.
pub fn csv_lines(file: &Bytes) -> Result<Vec<u8>> {
    let (columns, rows) = columns(file)?;
    let values: Result<Vec<Values>> = (0..columns.iter().len())
        .map(|place| column(file, place))
        .collect();
    let mut values: Vec<_> = values?.into_iter().map(fields).collect();
    let mut lines = Vec::new();
    for _ in 0..rows {
        let row: Row = values.iter_mut().filter_map(Iterator::next).collect();
        lines.append(&mut csv_line(&row));
    }
    Ok(lines)
}

fn fields(values: Values) -> Box<dyn Iterator<Item = Field>> {
    match values {
        Values::Integers(values) => Box::new(values.into_iter().map(Field::Integer)),
        Values::Numbers(values) => Box::new(values.into_iter().map(Field::Number)),
        Values::Texts(values) => Box::new(values.into_iter().map(|it| Field::Text(it.into()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> (Columns, Vec<Row>) {
        let columns = [
            ("member", Kind::Integer),
            ("end.x", Kind::Number),
            ("outcome", Kind::Text),
        ];
        let columns = columns.map(|(name, kind)| (name.to_owned(), kind));
        let rows = (0..GROUP + 3).map(|member| {
            vec![
                Field::Integer(u64::MAX - member as u64),
                Field::Number([0.1, -0.0, f64::NAN, f64::INFINITY, 1e-320][member % 5]),
                Field::Text(["done", "a, \"b\"", "", "größer"][member % 4].into()),
            ]
        });
        (Columns::new(columns.to_vec()), rows.collect())
    }

    fn written(columns: &Columns, rows: &[Row]) -> Bytes {
        let metadata = [("dalembert.model".to_owned(), "ball".to_owned())];
        let mut writer = Writer::new(Vec::new(), columns, metadata).unwrap();
        for row in rows {
            writer.add(row.clone()).unwrap();
        }
        Bytes::from(writer.finish().unwrap())
    }

    #[test]
    fn rows_are_read_back_to_the_bit() {
        let (columns, rows) = table();
        let file = written(&columns, &rows);
        let lines: Vec<u8> = rows.iter().flat_map(csv_line).collect();
        assert!(csv_lines(&file).unwrap() == lines);
        let (read, count) = super::columns(&file).unwrap();
        assert!(read.iter().eq(columns.iter()) && count == rows.len());
        let Values::Numbers(numbers) = column(&file, 1).unwrap() else {
            panic!("a column of numbers");
        };
        assert_eq!(numbers[1].to_bits(), (-0.0_f64).to_bits());
        assert_eq!(
            numbers[GROUP],
            [0.1, -0.0, f64::NAN, f64::INFINITY, 1e-320][GROUP % 5]
        );
    }

    #[test]
    fn a_file_without_rows_has_columns() {
        let (columns, _) = table();
        let file = written(&columns, &[]);
        assert_eq!(csv_lines(&file).unwrap(), b"");
        assert_eq!(super::columns(&file).unwrap().1, 0);
    }

    #[test]
    fn files_that_are_cut_are_errors() {
        let (columns, rows) = table();
        let file = written(&columns, &rows[..7]);
        for length in [0, 3, file.len() / 2, file.len() - 1] {
            assert!(csv_lines(&file.slice(..length)).is_err(), "{length}");
        }
        assert!(column(&file, 3).is_err());
    }
}
