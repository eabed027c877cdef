//! JSON of the command line: keys in the order of the interface, one row per line, numbers that parse to the same
//! `f64`, `null` for infinities and NaN.

use std::fmt;
use std::io::{self, Write};

use dalembert_driver::AnyModel;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use crate::spool::Spool;

/// Parses JSON whose objects have every key at most once.
///
/// # Errors
/// A text that is not JSON, or a duplicate key, with its position.
pub fn parse(text: &[u8]) -> serde_json::Result<Value> {
    serde_json::from_slice(text).map(|Unique(value)| value)
}

/// A value whose objects have unique keys; [`Value`] silently takes the last of two equal keys.
struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(UniqueVisitor).map(Self)
    }
}

struct UniqueVisitor;

impl<'de> Visitor<'de> for UniqueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        while let Some(Unique(element)) = elements.next_element()? {
            array.push(element);
        }
        Ok(Value::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some((key, Unique(value))) = entries.next_entry::<String, Unique>()? {
            if object.contains_key(&key) {
                return Err(A::Error::custom(format_args!(
                    "the key `{key}` occurs twice; expected every key once"
                )));
            }
            object.insert(key, value);
        }
        Ok(Value::Object(object))
    }
}

/// A number; `null` if it is not finite.
pub fn number(value: f64) -> Value {
    Value::from(value)
}

/// A vector.
pub fn vector(values: &[f64]) -> Value {
    values.iter().copied().map(number).collect()
}

/// A matrix as an array of its rows, 1 x 1 included.
pub fn matrix(columns: usize, values: &[f64]) -> Value {
    match columns {
        0 => Value::Array(Vec::new()),
        _ => values.chunks(columns).map(vector).collect(),
    }
}

/// An object of named numbers.
pub fn named<'a>(names: impl Iterator<Item = &'a str>, values: &[f64]) -> Value {
    let pairs = names
        .zip(values)
        .map(|(name, &value)| (name.to_owned(), number(value)));
    Value::Object(pairs.collect())
}

/// Writes an array with one element per line.
///
/// # Errors
/// An I/O error of the stream.
pub fn write_array(output: &mut dyn Write, rows: impl Iterator<Item = Value>) -> io::Result<()> {
    write_rows(output, rows)?;
    writeln!(output)
}

/// An object that is written key by key, one per line. Long arrays therefore need not be kept in memory as values.
pub struct Document<'a> {
    output: &'a mut dyn Write,
    empty: bool,
}

impl<'a> Document<'a> {
    /// Begins the object.
    ///
    /// # Errors
    /// An I/O error of the stream, as for every method.
    pub fn begin(output: &'a mut dyn Write) -> io::Result<Self> {
        write!(output, "{{")?;
        Ok(Self {
            output,
            empty: true,
        })
    }

    /// Begins the object of a command that runs a model, and writes the name, the scene and the parameters of the
    /// model.
    ///
    /// # Errors
    /// An I/O error of the stream.
    pub fn of_model(
        output: &'a mut dyn Write,
        model: &dyn AnyModel,
        scene: &str,
    ) -> io::Result<Self> {
        let description = model.description();
        let parameters = description.parameters.iter();
        let values: Vec<f64> = (0..parameters.len())
            .map(|index| model.parameter(index))
            .collect();
        let mut document = Self::begin(output)?;
        document.field("model", description.name)?;
        document.field("scene", scene)?;
        document.field("parameters", named(parameters.map(|it| it.name), &values))?;
        Ok(document)
    }

    /// Writes a key with a value on its line.
    pub fn field(&mut self, key: &str, value: impl Into<Value>) -> io::Result<()> {
        self.key(key)?;
        write!(self.output, "{}", value.into())
    }

    /// Writes a key with an array, one element per line.
    pub fn rows(&mut self, key: &str, rows: impl Iterator<Item = Value>) -> io::Result<()> {
        self.key(key)?;
        write_rows(self.output, rows)
    }

    /// Writes a key with an array of kept rows.
    pub fn spooled(&mut self, key: &str, rows: &Spool) -> io::Result<()> {
        self.key(key)?;
        rows.write(self.output)
    }

    /// Closes the object.
    pub fn end(self) -> io::Result<()> {
        writeln!(self.output, "\n}}")
    }

    fn key(&mut self, key: &str) -> io::Result<()> {
        let separator = if self.empty { "" } else { "," };
        self.empty = false;
        write!(self.output, "{separator}\n{}: ", Value::from(key))
    }
}

fn write_rows(output: &mut dyn Write, rows: impl Iterator<Item = Value>) -> io::Result<()> {
    write!(output, "[")?;
    let mut empty = true;
    for row in rows {
        write!(output, "{}\n{row}", if empty { "" } else { "," })?;
        empty = false;
    }
    write!(output, "{}]", if empty { "" } else { "\n" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for value in [
            0.1,
            -0.0,
            5e-324,
            f64::MAX,
            1.0 / 3.0,
            2.225_073_858_507_201e-308,
            123_456_789_012_345_680.0,
        ] {
            let text = number(value).to_string();
            let back = serde_json::from_str(&text)
                .ok()
                .and_then(|back: Value| back.as_f64());
            assert_eq!(back.map(f64::to_bits), Some(value.to_bits()), "{text}");
        }
    }

    #[test]
    fn texts_are_read_as_without_the_check_of_keys() {
        let text =
            r#"[null, true, -3, 18446744073709551615, 0.1, "\u00e9", {"a": {"b": []}, "c": 1e-7}]"#;
        let plain: Value = serde_json::from_str(text).unwrap();
        assert_eq!(parse(text.as_bytes()).unwrap(), plain);
        for text in [
            r#"{"a": 1, "b": {"c": 1, "\u0063": 2}}"#,
            r#"[{"c": 1, "c": 1}]"#,
        ] {
            let error = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains("`c` occurs twice"), "{error}");
        }
    }

    #[test]
    fn what_is_not_finite_is_null() {
        assert_eq!(
            vector(&[f64::NAN, f64::INFINITY, 1.0]).to_string(),
            "[null,null,1.0]"
        );
    }

    #[test]
    fn matrices_are_arrays_of_rows() {
        assert_eq!(matrix(1, &[2.0]).to_string(), "[[2.0]]");
        assert_eq!(
            matrix(2, &[1.0, 2.0, 3.0, 4.0]).to_string(),
            "[[1.0,2.0],[3.0,4.0]]"
        );
        assert_eq!(matrix(0, &[]).to_string(), "[]");
    }
}
