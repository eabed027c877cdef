//! The rows of a finished journal as Parquet: the same columns and values, uncompressed, in groups of [`GROUP`] rows.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use dalembert_driver::ensemble::row::{Columns, Field, Kind, Row};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use serde_json::{Map, Value};

use super::journal;

/// Number of rows in a row group, which is held in memory.
const GROUP: usize = 1 << 14;

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
        let value = value
            .as_str()
            .map_or_else(|| value.to_string(), str::to_owned);
        KeyValue::new(format!("dalembert.{key}"), value)
    });
    let properties = WriterProperties::builder()
        .set_key_value_metadata(Some(entries.collect()))
        .build();
    let file = File::create(path)?;
    let mut writer = SerializedFileWriter::new(file, schema(columns)?, Arc::new(properties))?;
    let mut group = Vec::new();
    let mut failed = None;
    journal::read_rows(rows, columns, first_member, &mut |row| {
        group.push(row.clone());
        if group.len() == GROUP {
            let written = write_group(&mut writer, columns, &group);
            failed = failed.take().or(written.err());
            group.clear();
        }
    })?;
    if let Some(error) = failed {
        return Err(error);
    }
    if !group.is_empty() {
        write_group(&mut writer, columns, &group)?;
    }
    writer.close().map(drop)
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

fn write_group(
    writer: &mut SerializedFileWriter<File>,
    columns: &Columns,
    rows: &[Row],
) -> Result<()> {
    let mut group = writer.next_row_group()?;
    for (index, (_, kind)) in columns.iter().enumerate() {
        let missing = || ParquetError::General("fewer columns than the schema has".to_owned());
        let mut column = group.next_column()?.ok_or_else(missing)?;
        let fields = rows.iter().map(|row| &row[index]);
        write_column(&mut column, kind, fields)?;
        column.close()?;
    }
    group.close().map(drop)
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
            let values: Vec<i64> = fields.map(integer).collect();
            column
                .typed::<Int64Type>()
                .write_batch(&values, None, None)?;
        }
        Kind::Number => {
            let number = |field: &Field| match field {
                Field::Number(value) => *value,
                _ => f64::NAN,
            };
            let values: Vec<f64> = fields.map(number).collect();
            column
                .typed::<DoubleType>()
                .write_batch(&values, None, None)?;
        }
        Kind::Text => {
            let text = |field: &Field| match field {
                Field::Text(value) => ByteArray::from(value.as_ref()),
                _ => ByteArray::from(""),
            };
            let values: Vec<ByteArray> = fields.map(text).collect();
            column
                .typed::<ByteArrayType>()
                .write_batch(&values, None, None)?;
        }
    }
    Ok(())
}
