//! Reference values: JSON files in `tests/reference` with numbers as decimal strings.

use serde_json::Value;

/// Reads `tests/reference/NAME.json`.
///
/// # Panics
/// If there is no such file.
pub fn read(name: &str) -> Value {
    let path = format!("{}/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A number, a decimal string or a fraction such as `1/400`.
///
/// # Panics
/// If the value is none of these.
pub fn number(value: &Value) -> f64 {
    let text = match value {
        Value::Number(number) => return number.as_f64().unwrap_or(f64::NAN),
        Value::String(text) => text,
        other => panic!("not a number: {other}"),
    };
    match text.split_once('/') {
        Some((numerator, denominator)) => parse(numerator) / parse(denominator),
        None => parse(text),
    }
}

fn parse(text: &str) -> f64 {
    text.parse()
        .unwrap_or_else(|_| panic!("not a number: {text}"))
}

/// The numbers of an array.
///
/// # Panics
/// If the value is not an array of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap_or_else(|| panic!("not an array: {value}"))
        .iter()
        .map(number)
        .collect()
}

/// Pairs of found numbers and the numbers of an array.
///
/// # Panics
/// If the value is not an array of as many numbers.
#[track_caller]
pub fn paired(found: &[f64], stored: &Value) -> Vec<(f64, f64)> {
    let stored = numbers(stored);
    assert_eq!(found.len(), stored.len(), "{found:?} for {stored:?}");
    found.iter().copied().zip(stored).collect()
}

/// Compares nested arrays of numbers component by component: relative error at most `tolerance`, absolute where the
/// expected value is 0.
///
/// # Errors
/// Describes the first component that differs, or the difference of shape.
pub fn compare(path: &str, actual: &Value, expected: &Value, tolerance: f64) -> Result<(), String> {
    if let (Some(actual), Some(expected)) = (actual.as_array(), expected.as_array()) {
        if actual.len() != expected.len() {
            return Err(format!(
                "{path}: {} entries for {}",
                actual.len(),
                expected.len()
            ));
        }
        let pairs = actual.iter().zip(expected).enumerate();
        return pairs
            .into_iter()
            .try_for_each(|(i, (a, e))| compare(&format!("{path}[{i}]"), a, e, tolerance));
    }
    if actual.is_null() {
        return Err(format!("{path}: nothing for {expected}"));
    }
    let (actual, expected) = (number(actual), number(expected));
    let size = if expected == 0.0 { 1.0 } else { expected.abs() };
    let error = (actual - expected).abs() / size;
    if error <= tolerance {
        Ok(())
    } else {
        Err(format!(
            "{path}: {actual:e} for {expected:e}, error {error:.2e}"
        ))
    }
}
