//! Conversion of extended numbers from and to decimal text.

use core::f64::consts;
use core::fmt;
use core::str::FromStr;

use super::functions::Wide;
use super::number::Extended;
use crate::math;

/// Decimal digits of a number with this many parts: 15.9 per part, minus one.
const fn digits(parts: usize) -> usize {
    (159 * parts - 10) / 10
}

/// Number of decimal digits that a number with 6 parts always represents exactly.
const EXACT: u32 = 95;

/// Largest absolute value of an exponent in a text.
const EXPONENTS: i32 = 400;

/// Error for a text that is not a decimal number such as `-12`, `0.1` or `1.25e-7`, or whose exponent exceeds 400 in
/// absolute value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotDecimal;

impl fmt::Display for NotDecimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected a decimal number, such as 0.1 or 1.25e-7")
    }
}

impl core::error::Error for NotDecimal {}

/// A number times a power of ten.
fn shifted(mut number: Wide, exponent: i32) -> Wide {
    let ten = Wide::plain(10.0);
    let mut left = exponent.unsigned_abs();
    // Several factors, each of them within the range of doubles.
    while left > 0 {
        let mut power = Wide::plain(1.0);
        let now = left.min(200);
        for _ in 0..now {
            power = power * ten;
        }
        number = match exponent < 0 {
            true => number / power,
            false => number * power,
        };
        left -= now;
    }
    number
}

impl<const PARTS: usize> FromStr for Extended<PARTS> {
    type Err = NotDecimal;

    /// Reads a decimal number to the full precision of the parts.
    fn from_str(text: &str) -> Result<Self, NotDecimal> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse().map_err(|_| NotDecimal)?),
            None => (text, 0_i32),
        };
        let (is_negative, unsigned) = match mantissa.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, mantissa),
        };
        let (whole, fraction) = unsigned.split_once('.').unwrap_or((unsigned, ""));
        if whole.len() + fraction.len() == 0 || exponent.unsigned_abs() > EXPONENTS as u32 {
            return Err(NotDecimal);
        }
        let (mut number, mut seen, mut scale) = (Wide::plain(0.0), 0, exponent);
        for (place, digit) in whole.bytes().chain(fraction.bytes()).enumerate() {
            if !digit.is_ascii_digit() {
                return Err(NotDecimal);
            }
            if seen < EXACT {
                number = number.fused(Wide::plain(10.0), Wide::plain(f64::from(digit - b'0')));
                seen += u32::from(number.nearest() != 0.0);
                scale -= i32::from(place >= whole.len());
            } else {
                scale += i32::from(place < whole.len());
            }
        }
        let size = shifted(number, scale);
        Ok(if is_negative { -size } else { size }.converted())
    }
}

impl<const PARTS: usize> fmt::Display for Extended<PARTS> {
    /// Writes scientific notation. The number of digits after the decimal point is the precision (`{:.20}`), by default
    /// about the number of significant digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let leading = self.nearest();
        if leading == 0.0 || !leading.is_finite() {
            return fmt::LowerExp::fmt(&leading, f);
        }
        let size: Wide = match leading < 0.0 {
            true => (-*self).converted(),
            false => self.converted(),
        };
        let places = f
            .precision()
            .unwrap_or(digits(PARTS))
            .min(EXACT as usize - 5);
        let [one, ten] = [1.0, 10.0].map(Wide::plain);
        let mut exponent = math::floor(math::ln(size.nearest()) * consts::LOG10_E) as i32;
        // The estimate may be wrong by one near powers of ten.
        let mut left = shifted(size, -exponent);
        if left >= ten || left < one {
            exponent += if left < one { -1 } else { 1 };
            left = shifted(size, -exponent);
        }
        left = left + shifted(Wide::plain(0.5), -(places as i32));
        if left >= ten {
            exponent += 1;
            left = left / ten;
        }
        if leading < 0.0 {
            f.write_str("-")?;
        }
        for place in 0..=places {
            let digit = (0..9)
                .take_while(|d| left >= Wide::plain(f64::from(d + 1)))
                .count();
            write!(f, "{digit}")?;
            if place == 0 && places > 0 {
                f.write_str(".")?;
            }
            left = (left - Wide::plain(digit as f64)) * ten;
        }
        write!(f, "e{exponent}")
    }
}
