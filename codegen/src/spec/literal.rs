//! Number literals, read exactly: `0.1` is one tenth.

use dalembert_expr::Rational;
use proc_macro2::Literal;

use super::ast::{Scalar, ScalarKind};
use super::cursor::{Cursor, Read};
use super::limits::{LITERAL_DIGITS, is_a_double};
use super::slips::NUMBERS;
use crate::diagnostics::Location;

/// The number types of Rust, which may be suffixes of a literal.
const TYPES: [&str; 16] = [
    "f16", "f32", "f64", "f128", "i8", "i16", "i32", "i64", "i128", "isize", "u8", "u16", "u32",
    "u64", "u128", "usize",
];

impl Cursor<'_> {
    /// The value of a literal that was just read.
    pub(super) fn literal(&mut self, literal: &Literal) -> Read<Scalar> {
        let text = literal.to_string();
        let at = Location::from(literal.span());
        let positive = text.strip_prefix('-').unwrap_or(&text);
        let value = Scalar {
            kind: ScalarKind::Number(self.number(positive, at)?, positive.to_owned()),
            at,
        };
        // Only a macro that builds literals itself can make a negative one.
        if positive.len() == text.len() {
            return Ok(value);
        }
        Ok(Scalar {
            kind: ScalarKind::Negative(Box::new(value)),
            at,
        })
    }

    fn number(&mut self, text: &str, at: Location) -> Read<Rational> {
        if !text.starts_with(|first: char| first.is_ascii_digit()) {
            return Err(self.refuse(at, "expected an expression, found a string", NUMBERS));
        }
        if text.starts_with("0x") || text.starts_with("0b") || text.starts_with("0o") {
            return Err(self.refuse(at, "numbers are decimal", "write `12`, `0.5`, `1.25e-7`"));
        }
        let (number, suffix) = text.split_at(number_length(text));
        let digits = number.chars().filter(char::is_ascii_digit).count();
        if digits > LITERAL_DIGITS {
            let text = format!("a number of {digits} digits; the limit is {LITERAL_DIGITS}");
            return Err(self.refuse(at, text, "write fewer digits"));
        }
        if !suffix.is_empty() {
            return Err(self.refuse_suffix(number, suffix, at));
        }
        let value = Rational::from_decimal(&number.to_ascii_lowercase());
        value.filter(is_a_double).ok_or_else(|| {
            let text = format!("`{number}` is out of the range of doubles");
            let help = "the absolute value of a number is 0 or lies between 2.3e-308 and 1.7e308";
            self.refuse(at, text, help)
        })
    }

    fn refuse_suffix(
        &mut self,
        number: &str,
        suffix: &str,
        at: Location,
    ) -> super::cursor::Refused {
        if TYPES.contains(&suffix) {
            return self.refuse(
                at,
                format!("numbers have no type: `{suffix}`"),
                &format!("write `{number}`"),
            );
        }
        let suffix: String = suffix.chars().take(24).collect();
        let text = format!("missing `*` between `{number}` and `{suffix}`");
        self.refuse(at, text, &format!("write `{number}*{suffix}`"))
    }
}

/// Length of the number in a literal; the rest is its suffix.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut end = digits_from(bytes, 0);
    if bytes.get(end) == Some(&b'.') {
        end = digits_from(bytes, end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits_from(bytes, end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

/// The end of the digits and underscores that begin at `start`.
fn digits_from(bytes: &[u8], start: usize) -> usize {
    let digits = bytes
        .iter()
        .skip(start)
        .take_while(|byte| byte.is_ascii_digit() || **byte == b'_');
    start + digits.count()
}
