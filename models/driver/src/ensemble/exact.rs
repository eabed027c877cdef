//! Exact sums of numbers and of their squares. They do not depend on the order or on the grouping of the terms.
//!
//! A finite `f64` is an integer multiple of `2^-1074`, and its square an integer multiple of `2^-2148`. The sums of
//! these integers are stored in digits of 32 bits with room for carries.

use num_bigint::{BigInt, BigUint, Sign};

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

    /// The mean, correctly rounded; NaN without terms.
    pub fn mean(&self) -> f64 {
        let sum = BigInt::from_signed_bytes_le(&self.sum());
        quotient(&sum, &(BigUint::from(self.count) << UNIT))
    }

    /// The sample standard deviation (divisor `count - 1`): the square root of the correctly rounded variance. NaN for
    /// fewer than two terms.
    pub fn deviation(&self) -> f64 {
        let sum = BigInt::from_signed_bytes_le(&self.sum());
        let squares = BigInt::from_signed_bytes_le(&self.squares());
        let spread = squares * self.count - &sum * &sum;
        let pairs = u128::from(self.count) * u128::from(self.count.saturating_sub(1));
        quotient(&spread, &(BigUint::from(pairs) << (2 * UNIT))).sqrt()
    }
}

/// The quotient, correctly rounded, ties to even; NaN for a denominator of 0.
fn quotient(numerator: &BigInt, denominator: &BigUint) -> f64 {
    let (sign, size) = (numerator.sign(), numerator.magnitude());
    if *denominator == BigUint::ZERO {
        return f64::NAN;
    }
    if sign == Sign::NoSign {
        return 0.0;
    }
    // The whole part of the quotient in units of 2^exponent has 63 or 64 bits, or fewer if the quotient is below
    // 2^-1012. At least two bits are rounded off.
    let lowest = -i64::from(UNIT);
    let exponent = (size.bits() as i64 - denominator.bits() as i64 - 63).max(lowest - 2);
    let shift = exponent.unsigned_abs();
    let (numerator, denominator) = match exponent > 0 {
        true => (size.clone(), denominator << shift),
        false => (size << shift, denominator.clone()),
    };
    let whole = &numerator / &denominator;
    let is_exact = &whole * &denominator == numerator;
    let whole = u64::try_from(whole).unwrap_or(u64::MAX);
    let bits = i64::from(u64::BITS - whole.leading_zeros());
    let dropped = (bits - 53).max(lowest - exponent);
    let (kept, rest) = (whole >> dropped, whole & ((1 << dropped) - 1));
    let half = 1 << (dropped - 1);
    let is_up = rest > half || (rest == half && (!is_exact || kept % 2 == 1));
    let mantissa = kept + u64::from(is_up);
    // The mantissa keeps its leading bit. Added to the exponent field, that bit raises the field by one; a subnormal
    // number has none.
    let field = (exponent + dropped - lowest) as u64;
    let magnitude = match field + (mantissa >> 52) < 0x7ff {
        true => f64::from_bits((field << 52) + mantissa),
        false => f64::INFINITY,
    };
    if sign == Sign::Minus {
        -magnitude
    } else {
        magnitude
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

    /// Both operands are exact in doubles, so the quotient of the processor is correctly rounded.
    #[test]
    fn quotients_are_rounded_as_the_processor_rounds() {
        let mut state = 1_u64;
        let mut next = |bits: u32| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) >> (53 - bits)
        };
        for bits in (1..=53).chain(1..=53).chain(1..=53) {
            let (numerator, denominator) = (next(bits), next(54 - bits).max(1));
            let [over, under] = [numerator, denominator].map(|it| it as f64);
            let of = |numerator: u64, unit: u32| {
                let numerator = -BigInt::from(numerator);
                quotient(&numerator, &(BigUint::from(denominator) << unit))
            };
            assert_eq!(-of(numerator, 0), over / under, "{numerator}/{denominator}");
            // The numerator as a subnormal number.
            let smallest = f64::from_bits(numerator);
            assert_eq!(
                -of(numerator, UNIT),
                smallest / under,
                "{smallest:e}/{denominator}"
            );
        }
        let huge = BigInt::from(1) << 1024;
        assert_eq!(quotient(&huge, &BigUint::from(1_u8)), f64::INFINITY);
        assert_eq!(quotient(&(huge - 1), &BigUint::from(2_u8)), 2f64.powi(1023));
    }

    #[test]
    fn means_and_deviations_lose_nothing() {
        let of = |terms: &[f64]| {
            let mut sum = ExactSum::default();
            terms.iter().for_each(|term| sum.add(*term));
            [sum.mean(), sum.deviation()]
        };
        assert_eq!(
            of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]),
            [5.0, (32.0f64 / 7.0).sqrt()]
        );
        assert_eq!(of(&[1e16, 1.0, -1e16]), [1.0 / 3.0, 1e16]);
        assert_eq!(of(&[1e16 + 2.0, 1e16 + 4.0]), [1e16 + 3.0, 2f64.sqrt()]);
        assert_eq!(of(&[0.1])[0], 0.1);
        assert!(of(&[0.1])[1].is_nan() && of(&[])[0].is_nan());
        assert_eq!(of(&[f64::MAX, -f64::MAX])[1], f64::INFINITY);
    }
}
