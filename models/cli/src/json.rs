//! JSON as the command line writes it: keys in the order of the interface, one row per line, numbers that read
//! back to the same `f64`, `null` for what is infinite or not a number.

use std::io::{self, Write};

use serde_json::Value;

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
/// Whatever the stream says.
pub fn write_array(output: &mut dyn Write, rows: impl Iterator<Item = Value>) -> io::Result<()> {
    write_rows(output, rows)?;
    writeln!(output)
}

/// An object written key by key, one per line, so that long arrays need not be held as values.
pub struct Document<'a> {
    output: &'a mut dyn Write,
    empty: bool,
}

impl<'a> Document<'a> {
    /// Opens the object.
    ///
    /// # Errors
    /// Whatever the stream says; so for every method.
    pub fn begin(output: &'a mut dyn Write) -> io::Result<Self> {
        write!(output, "{{")?;
        Ok(Self {
            output,
            empty: true,
        })
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
