//! Parses numbers of the command line: decimals and multiples of pi. Formats numbers for summaries.
//!
//! `scalar = ["+" | "-"] factor {("*" | "/") factor}`, `factor = decimal ["pi"] | "pi"`. Factors are evaluated from left
//! to right in `f64`. A single decimal gives the nearest `f64`.

use std::f64::consts::PI;

/// Description of the numbers that [`parse`] accepts, for messages.
pub const EXPECTED: &str = "a finite number such as -1.5, 2e-3, pi/2 or -3*pi/4";

/// Parses a number.
///
/// # Errors
/// [`EXPECTED`] for any other text, and for values that are infinite or NaN.
pub fn parse(text: &str) -> Result<f64, &'static str> {
    let text = text.trim();
    let (sign, mut rest) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let mut value = 1.0;
    let mut divide = false;
    loop {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let operand = factor(rest[..end].trim()).ok_or(EXPECTED)?;
        value = if divide {
            value / operand
        } else {
            value * operand
        };
        let Some(operator) = rest[end..].chars().next() else {
            break;
        };
        divide = operator == '/';
        rest = &rest[end + 1..];
    }
    let value = sign * value;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(EXPECTED)
    }
}

fn factor(text: &str) -> Option<f64> {
    match text.strip_suffix("pi") {
        Some("") => Some(PI),
        Some(multiple) => Some(decimal(multiple.trim_end())? * PI),
        None => decimal(text),
    }
}

/// Parses an unsigned decimal. It refuses signs, `inf` and `nan`, which the standard library accepts.
fn decimal(text: &str) -> Option<f64> {
    let starts_as_number = text.starts_with(|first: char| first.is_ascii_digit() || first == '.');
    starts_as_number.then(|| text.parse().ok()).flatten()
}

/// The shortest decimal that parses to this number. It has an exponent if its size is below 1e-4 or at least 1e16.
pub fn full(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e16).contains(&size) => format!("{number:e}"),
        _ => number.to_string(),
    }
}

/// A number rounded to nine significant digits. It has an exponent if its size is below 1e-4 or at least 1e9.
pub fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.8e}").parse().unwrap_or(number);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e9).contains(&size) => format!("{rounded:e}"),
        _ => rounded.to_string(),
    }
}

/// Parses a positive number.
///
/// # Errors
/// A description of the accepted numbers.
pub fn positive(text: &str) -> Result<f64, String> {
    within(text, |value| value > 0.0, "a positive number")
}

/// Parses a number that is not negative.
///
/// # Errors
/// A description of the accepted numbers.
pub fn nonnegative(text: &str) -> Result<f64, String> {
    within(text, |value| value >= 0.0, "a number that is not negative")
}

/// Parses the length of an animation in seconds. A page has a picture for each thirtieth of a second.
///
/// # Errors
/// A description of the accepted numbers.
pub fn seconds_shown(text: &str) -> Result<f64, String> {
    within(
        text,
        |value| value > 0.0 && value <= 600.0,
        "a positive number up to 600",
    )
}

/// Parses an error tolerance.
///
/// # Errors
/// A description of the accepted numbers.
pub fn tolerance(text: &str) -> Result<f64, String> {
    within(
        text,
        |value| (1e-15..=0.1).contains(&value),
        "a number from 1e-15 to 0.1",
    )
}

/// Parses a coefficient of restitution.
///
/// # Errors
/// A description of the accepted numbers.
pub fn coefficient(text: &str) -> Result<f64, String> {
    within(
        text,
        |value| (0.0..=1.0).contains(&value),
        "a number from 0 to 1",
    )
}

fn within(text: &str, accepts: impl Fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    match parse(text) {
        Ok(value) if accepts(value) => Ok(value),
        _ => Err(format!("expected {expected}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_have_exponents() {
        for (number, all, nine) in [
            (0.0, "0", "0"),
            (
                4.908_712_883_434_957e-14,
                "4.908712883434957e-14",
                "4.90871288e-14",
            ),
            (-0.000_1, "-0.0001", "-0.0001"),
            (
                -0.520_683_714_448_936_4,
                "-0.5206837144489364",
                "-0.520683714",
            ),
            (12_345_678_901.25, "12345678901.25", "1.23456789e10"),
        ] {
            assert_eq!((&*full(number), &*short(number)), (all, nine));
        }
    }

    #[test]
    fn decimals_are_the_nearest_numbers() {
        for text in [
            "0",
            "1.5",
            "2.225073858507201e-308",
            "0.1",
            "1e22",
            "5e-324",
            "+3",
            "-7.25",
        ] {
            assert_eq!(
                parse(text),
                text.trim_start_matches('+').parse().map_err(|_| EXPECTED),
                "{text}"
            );
        }
    }

    #[test]
    fn multiples_of_pi() {
        let cases = [
            ("pi", PI),
            ("-pi/2", -PI / 2.0),
            ("3*pi/4", 3.0 * PI / 4.0),
            ("2pi", 2.0 * PI),
            (" 1/4 ", 0.25),
            ("pi*2", 2.0 * PI),
        ];
        for (text, value) in cases {
            assert_eq!(parse(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "", "-", "--1", "nan", "inf", "-inf", "infinity", "1e999", "1/0", "pi pi", "1,5",
            "1+1", "*2", "2*", "πi", "0x10", "1_000", "pipi", "é", "1//2", "0/0",
        ] {
            assert_eq!(parse(text), Err(EXPECTED), "{text}");
        }
    }
}
