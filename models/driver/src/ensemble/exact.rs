//! Exact sums of numbers and of their squares. They do not depend on the order or on the grouping of the terms.
//!
//! A finite `f64` is an integer multiple of `2^-1074`, and its square an integer multiple of `2^-2148`. The sums of
//! these integers are stored in digits of 32 bits with room for carries.

/// Terms of a sum are integer multiples of `2^-UNIT`.
pub const UNIT: u32 = 1074;

/// Number of digits of a sum: 2098 bits of a term, and room for `2^60` terms.
const DIGITS: usize = 69;

/// Number of digits of a sum of squares.
const SQUARES: usize = 135;

/// Maximum number of terms between two passes of carries. A term adds less than `2^32` to a digit.
const LOOSE: u32 = 1 << 30;

/// The exact sum of finite numbers, and of their squares.
#[derive(Debug, Clone)]
pub struct ExactSum {
    /// Number of finite terms.
    pub count: u64,
    /// The least term; infinity without terms.
    pub least: f64,
    /// The greatest term; negative infinity without terms.
    pub greatest: f64,
    sum: [i64; DIGITS],
    squares: [i64; SQUARES],
    loose: u32,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self {
            count: 0,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            sum: [0; DIGITS],
            squares: [0; SQUARES],
            loose: 0,
        }
    }
}

impl ExactSum {
    /// Adds a term. A term that is not finite is ignored.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.count += 1;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        let bits = value.to_bits();
        let fraction = bits & ((1 << 52) - 1);
        // The mantissa, and its exponent above -1074.
        let (mantissa, shift) = match (bits >> 52) & 0x7ff {
            0 => (fraction, 0),
            exponent => (fraction | (1 << 52), exponent as usize - 1),
        };
        let sign = if value.is_sign_negative() { -1 } else { 1 };
        spread(&mut self.sum, u128::from(mantissa), shift, sign);
        spread(
            &mut self.squares,
            u128::from(mantissa) * u128::from(mantissa),
            2 * shift,
            1,
        );
        self.loose += 1;
        if self.loose == LOOSE {
            carry(&mut self.sum);
            carry(&mut self.squares);
            self.loose = 0;
        }
    }

    /// The sum in units of `2^-1074`: an integer in two's complement, lowest byte first.
    pub fn sum(&self) -> Vec<u8> {
        bytes(self.sum)
    }

    /// The sum of the squares in units of `2^-2148`, in the same format.
    pub fn squares(&self) -> Vec<u8> {
        bytes(self.squares)
    }
}

/// Adds `sign*mantissa*2^shift` to a sum; the mantissa has at most 106 bits.
fn spread(digits: &mut [i64], mantissa: u128, shift: usize, sign: i64) {
    let (first, offset) = (shift / 32, shift % 32);
    let low = (mantissa & u128::from(u64::MAX)) << offset;
    let high = (mantissa >> 64) << offset;
    for (place, part) in [(first, low), (first + 2, high)] {
        let mut rest = part;
        let mut place = place;
        while rest != 0 {
            digits[place] += sign * i64::from(rest as u32);
            rest >>= 32;
            place += 1;
        }
    }
}

/// Carries, so that all digits but the last are in the range from 0 to `2^32 - 1`.
fn carry(digits: &mut [i64]) {
    let mut over = 0;
    let (last, lower) = digits.split_last_mut().expect("a sum has digits");
    for digit in lower {
        let sum = *digit + over;
        over = sum >> 32;
        *digit = sum & i64::from(u32::MAX);
    }
    *last += over;
}

fn bytes<const N: usize>(mut digits: [i64; N]) -> Vec<u8> {
    carry(&mut digits);
    let (last, lower) = digits.split_last().expect("a sum has digits");
    let lower = lower.iter().flat_map(|digit| (*digit as u32).to_le_bytes());
    lower.chain(last.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of a sum of size about 1, for which the lowest bits do not matter.
    fn value(bytes: &[u8], unit: i32) -> f64 {
        let negative = bytes.last().is_some_and(|byte| *byte >= 128);
        let mut magnitude: Vec<u8> = bytes.to_vec();
        if negative {
            let mut over = 1_u16;
            for byte in &mut magnitude {
                let sum = u16::from(!*byte) + over;
                *byte = sum as u8;
                over = sum >> 8;
            }
        }
        let digits = magnitude.iter().enumerate().filter(|(_, byte)| **byte != 0);
        let terms = digits.map(|(place, byte)| {
            // Two factors avoid overflow and underflow.
            let exponent = 8 * place as i32 - unit;
            f64::from(*byte) * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2)
        });
        let sum: f64 = terms.sum();
        if negative { -sum } else { sum }
    }

    #[test]
    fn sums_keep_what_rounding_loses() {
        let mut sum = ExactSum::default();
        for term in [1e300, 1.0, -1e300, 2f64.powi(-60), f64::NAN, f64::INFINITY] {
            sum.add(term);
        }
        assert_eq!(sum.count, 4);
        assert_eq!(value(&sum.sum(), UNIT as i32), 1.0 + 2f64.powi(-60));
        assert_eq!([sum.least, sum.greatest], [-1e300, 1e300]);
    }

    #[test]
    fn sums_do_not_depend_on_the_order_and_end_at_both_ends_of_the_range() {
        let terms = [
            f64::MAX,
            5e-324,
            -f64::MAX,
            -0.1,
            0.1,
            3.0,
            -f64::MIN_POSITIVE,
        ];
        let of = |terms: &mut dyn Iterator<Item = f64>| {
            let mut sum = ExactSum::default();
            terms.for_each(|term| sum.add(term));
            (sum.sum(), sum.squares())
        };
        assert_eq!(
            of(&mut terms.iter().copied()),
            of(&mut terms.iter().rev().copied())
        );
        let small = of(&mut [-5e-324, -5e-324].into_iter());
        assert!(small.0[1..].iter().all(|byte| *byte == 255) && small.0[0] == 254);
        assert!(small.1[1..].iter().all(|byte| *byte == 0) && small.1[0] == 2);
        let squares = of(&mut [3.0, -4.0].into_iter()).1;
        assert_eq!(value(&squares, 2 * UNIT as i32), 25.0);
    }
}
