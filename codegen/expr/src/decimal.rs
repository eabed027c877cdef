//! Conversion of decimal text to rational numbers, which is exact, and of rational numbers to doubles, which rounds
//! once.

use num_bigint::{BigInt, Sign};
use num_rational::BigRational;

use crate::rational::{MAX_BITS, Rational};

impl Rational {
    /// Reads a decimal number exactly: `12`, `0.1`, `1.25e-7`, `1e5`, `1_000`.
    ///
    /// `None` if the text is not a decimal number, or if numerator or denominator would exceed [`MAX_BITS`] bits.
    pub fn from_decimal(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, parse_exponent(exponent)?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = decimal_digits(whole, fraction)?;
        let places = fraction.bytes().filter(u8::is_ascii_digit).count();
        let scale = exponent - i64::try_from(places).ok()?;
        let power = BigInt::from(10u32).pow(u32::try_from(scale.unsigned_abs()).ok()?);
        let value = if scale < 0 {
            BigRational::new(digits, power)
        } else {
            BigRational::from_integer(digits * power)
        };
        Some(Self::from_big(value)).filter(|value| value.bits() <= MAX_BITS)
    }

    /// The nearest double, with ties to even; infinite if the number is beyond the range of doubles.
    pub fn to_f64(&self) -> f64 {
        const EXACT: u64 = 1 << 53;
        match self.to_small() {
            // One division of two exact doubles rounds once.
            Some((n, d)) if n.unsigned_abs() <= EXACT && d.unsigned_abs() <= EXACT => {
                n as f64 / d as f64
            }
            _ => nearest_double(&self.numer(), &self.denom()),
        }
    }

    /// Four doubles whose sum approximates the number. Each is the double nearest to the remainder after the previous
    /// ones. If the number is a double or beyond the range of doubles, all but the first are 0.
    pub fn to_parts(&self) -> [f64; 4] {
        let mut left = self.clone();
        core::array::from_fn(|_| {
            let part = left.to_f64();
            left = match BigRational::from_float(part) {
                Some(exact) => left.clone() - Self::from_big(exact),
                None => Self::ZERO,
            };
            part
        })
    }
}

/// The exponent of a decimal number. `None` if it is not a number of at most four digits. Larger exponents lead to
/// numbers that exceed [`MAX_BITS`].
fn parse_exponent(text: &str) -> Option<i64> {
    let digits = text
        .strip_prefix(['+', '-'])
        .unwrap_or(text)
        .replace('_', "");
    if digits.is_empty() || digits.len() > 4 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let value: i64 = digits.parse().ok()?;
    Some(if text.starts_with('-') { -value } else { value })
}

/// The digits of `whole.fraction` as one integer.
fn decimal_digits(whole: &str, fraction: &str) -> Option<BigInt> {
    let digits: String = [whole, fraction].concat().replace('_', "");
    let well_formed = whole.starts_with(|c: char| c.is_ascii_digit())
        && (fraction.is_empty() || fraction.starts_with(|c: char| c.is_ascii_digit()))
        && digits.bytes().all(|b| b.is_ascii_digit());
    // log2(10) > 3, so an integer of more than `MAX_BITS / 3` digits has more than `MAX_BITS` bits.
    if !well_formed || digits.len() as u64 > MAX_BITS / 3 {
        return None;
    }
    digits.parse().ok()
}

/// `numer / denom`, rounded once to the nearest double, with ties to even. The result may be subnormal.
///
/// The quotient has at least 56 bits and a sticky bit. It is then rounded to the precision of the result: 53 bits, or
/// fewer below the normal range.
fn nearest_double(numer: &BigInt, denom: &BigInt) -> f64 {
    let negative = numer.sign() == Sign::Minus;
    let (numer, denom) = (numer.magnitude(), denom.magnitude());
    // Sizes are far below 2^60 bits.
    let shift = 56 + denom.bits() as i64 - numer.bits() as i64;
    let (scaled, divisor) = if shift >= 0 {
        (numer << shift as u64, denom.clone())
    } else {
        (numer.clone(), denom << shift.unsigned_abs())
    };
    let quotient = &scaled / &divisor;
    let sticky = u64::from(&quotient * &divisor != scaled);
    let Ok(quotient) = u64::try_from(&quotient) else {
        return f64::NAN;
    };
    let magnitude = round_scaled(quotient << 1 | sticky, -shift - 1);
    if negative { -magnitude } else { magnitude }
}

/// `significand * 2^exponent`, rounded to nearest even.
fn round_scaled(significand: u64, exponent: i64) -> f64 {
    const LOWEST: i64 = -1074;
    let bits = i64::from(64 - significand.leading_zeros());
    let drop = (bits - 53).max(LOWEST - exponent).max(0);
    if drop > bits {
        return 0.0;
    }
    let kept = significand >> drop;
    let rest = significand - (kept << drop);
    let half = 1u64 << (drop - 1).max(0);
    let up = drop > 0 && (rest > half || (rest == half && kept % 2 == 1));
    (kept + u64::from(up)) as f64 * power_of_two(exponent + drop)
}

/// `2^exponent` for exponents from -1074; infinite beyond the range.
fn power_of_two(exponent: i64) -> f64 {
    match exponent {
        ..-1022 => f64::from_bits(1 << (exponent + 1074)),
        -1022..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decimal(text: &str) -> Rational {
        Rational::from_decimal(text).unwrap()
    }

    #[test]
    fn decimals_are_read_exactly() {
        assert_eq!(decimal("0.1"), Rational::new(1, 10));
        assert_eq!(decimal("1.25e-7"), Rational::new(1, 8_000_000));
        assert_eq!(decimal("1e5"), Rational::from(100_000));
        assert_eq!(decimal("1_000"), Rational::from(1000));
        assert_eq!(decimal("1."), Rational::ONE);
        assert_eq!(decimal("2E+3"), Rational::from(2000));
        for text in [
            "", ".", ".5", "1e", "1e+", "-1", "1.2.3", "1e99999", "0x1", "1e2000", "_1",
        ] {
            assert_eq!(Rational::from_decimal(text), None, "{text}");
        }
    }

    #[test]
    fn parts_are_what_rounding_leaves() {
        let exact = |part: f64| Rational::from_big(BigRational::from_float(part).unwrap());
        for (number, bits) in [
            (Rational::new(1, 3), 212),
            (-decimal("0.1"), 212),
            (decimal("123456789012345678901234567890"), 400),
        ] {
            let parts = number.to_parts();
            assert_eq!(parts[0], number.to_f64());
            let sum = parts
                .map(exact)
                .into_iter()
                .fold(Rational::ZERO, |a, b| a + b);
            let error = (number.clone() - sum).abs().to_f64();
            assert!(
                error <= number.abs().to_f64() * 0.5_f64.powi(bits),
                "{number:?}: {parts:?}"
            );
        }
        assert_eq!(decimal("0.375").to_parts(), [0.375, 0.0, 0.0, 0.0]);
        assert_eq!(decimal("1e-400").to_parts(), [0.0; 4]);
        assert_eq!(decimal("1e400").to_parts(), [f64::INFINITY, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn conversion_to_double_rounds_like_the_standard_parser() {
        let texts = [
            "0.1",
            "9.81",
            "1e400",
            "1e-400",
            "4.9e-324",
            "2.4e-324",
            "2.5e-324",
            "1.7976931348623157e308",
            "1.7976931348623159e308",
            "2.2250738585072011e-308",
            "9007199254740993",
            "9007199254740995",
            "0.30000000000000004",
            "123456789012345678901234567890",
            "5e-320",
            "1e-310",
            "1e22",
            "1e23",
            "3.14159265358979323846264338327950288419716939937510582",
        ];
        for text in texts {
            let expected: f64 = text.parse().unwrap();
            assert_eq!(decimal(text).to_f64(), expected, "{text}");
            assert_eq!((-decimal(text)).to_f64(), -expected, "{text}");
        }
        assert_eq!(Rational::new(1, 3).to_f64(), 1.0 / 3.0);
        assert_eq!(Rational::new(i64::MAX, i64::MAX - 1).to_f64(), 1.0);
    }
}
