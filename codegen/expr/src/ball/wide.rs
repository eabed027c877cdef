//! Floating-point numbers with a mantissa of 256 bits. Operations truncate, and return a bound of the error.

use std::cmp::Ordering;

use num_bigint::{BigInt, BigUint, Sign};

use super::bound::power_of_two;

/// Words of a mantissa.
const WORDS: usize = 4;
/// Bits of a mantissa.
pub(super) const BITS: i32 = 64 * WORDS as i32;

/// `mantissa * 2^exponent`, negated if `is_negative`. The lowest word of the mantissa comes first.
///
/// NOTE: the highest bit of the mantissa is 1 unless the number is 0. The number 0 has exponent 0 and is not negative.
#[derive(Copy, Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Wide {
    pub(super) is_negative: bool,
    mantissa: [u64; WORDS],
    exponent: i32,
}

impl Wide {
    /// The number 0.
    pub(super) const ZERO: Self = Self {
        is_negative: false,
        mantissa: [0; WORDS],
        exponent: 0,
    };

    /// An integer.
    pub(super) fn integer(value: i64) -> Self {
        let mantissa = [value.unsigned_abs(), 0, 0, 0];
        normalised(value < 0, mantissa, 0)
    }

    /// A finite double.
    pub(super) fn double(value: f64) -> Self {
        let bits = value.to_bits();
        let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52 & 0x7ff) as i32);
        let (fraction, exponent) = match exponent {
            0 => (fraction, 1),
            _ => (fraction | 1 << 52, exponent),
        };
        normalised(value < 0.0, [fraction, 0, 0, 0], exponent - 1075)
    }

    /// `value * 2^exponent`, with a bound of the error.
    pub(super) fn scaled(value: &BigInt, exponent: i32) -> (Self, f64) {
        let excess = value.bits() as i32 - BITS;
        let kept: BigUint = match excess > 0 {
            true => value.magnitude() >> excess,
            false => value.magnitude().clone(),
        };
        let mut mantissa = [0; WORDS];
        for (word, digit) in mantissa.iter_mut().zip(kept.iter_u64_digits()) {
            *word = digit;
        }
        let exponent = exponent + excess.max(0);
        let is_cut = value
            .trailing_zeros()
            .is_some_and(|zeros| (zeros as i32) < excess);
        let error = match is_cut {
            true => power_of_two(exponent),
            false => 0.0,
        };
        let is_negative = value.sign() == Sign::Minus;
        (normalised(is_negative, mantissa, exponent), error)
    }

    /// The integer with these words, highest first, times `2^exponent`.
    pub(super) fn of_words(words: [u64; WORDS], exponent: i32) -> Self {
        let [a, b, c, d] = words;
        normalised(false, [d, c, b, a], exponent)
    }

    pub(super) fn is_zero(&self) -> bool {
        self.mantissa[WORDS - 1] == 0
    }

    pub(super) fn neg(self) -> Self {
        Self {
            is_negative: !self.is_negative && !self.is_zero(),
            ..self
        }
    }

    /// The exponent `e` with `2^(e-1) <= |self| < 2^e`, for a number that is not 0.
    pub(super) fn order(&self) -> i32 {
        self.exponent + BITS
    }

    /// `self * 2^shift`
    pub(super) fn shifted(self, shift: i32) -> Self {
        match self.is_zero() {
            true => self,
            false => Self {
                exponent: self.exponent + shift,
                ..self
            },
        }
    }

    /// Upper bound of the absolute value.
    pub(super) fn at_most(&self) -> f64 {
        // A number below the range of `leading` is less than 2^53 times 2^-1023.
        self.leading(1, f64::INFINITY, power_of_two(-970))
    }

    /// Lower bound of the absolute value.
    pub(super) fn at_least(&self) -> f64 {
        self.leading(0, power_of_two(1023), 0.0)
    }

    /// The first 53 bits plus `added` in the last place, as a double. Beyond the range of doubles it is `above` or
    /// `below`.
    fn leading(&self, added: u64, above: f64, below: f64) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        let bits = (self.mantissa[WORDS - 1] >> 11) + added;
        match self.exponent + BITS - 53 {
            971.. => above,
            // The product of integer and power of two is exact.
            exponent @ -1022..=970 => bits as f64 * power_of_two(exponent),
            _ => below,
        }
    }

    /// A double near the number.
    pub(super) fn nearest(&self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        // A sticky bit stands for all bits below the highest 64, so the conversion rounds once.
        let rest = self.mantissa[..WORDS - 1].iter().any(|word| *word != 0);
        let bits = self.mantissa[WORDS - 1] | u64::from(rest);
        let exponent = self.exponent + BITS - 64;
        let half = exponent.div_euclid(2);
        let size = libm::scalbn(libm::scalbn(bits as f64, half), exponent - half);
        if self.is_negative { -size } else { size }
    }

    /// `self + other`, with a bound of the error.
    pub(super) fn add(self, other: Self) -> (Self, f64) {
        if self.is_zero() {
            return (other, 0.0);
        }
        if other.is_zero() {
            return (self, 0.0);
        }
        let (large, small) = match self.exponent >= other.exponent {
            true => (self, other),
            false => (other, self),
        };
        let shift = large.exponent - small.exponent;
        let (low, mut is_cut) = shifted_right(&small.mantissa, shift);
        let sum = if large.is_negative == small.is_negative {
            let (mut mantissa, carry) = added(&large.mantissa, &low);
            if carry {
                is_cut |= mantissa[0] & 1 == 1;
                mantissa = shifted_right(&mantissa, 1).0;
                mantissa[WORDS - 1] |= 1 << 63;
            }
            Self {
                is_negative: large.is_negative,
                mantissa,
                exponent: large.exponent + i32::from(carry),
            }
        } else {
            match compared(&large.mantissa, &low) {
                Ordering::Less => normalised(
                    small.is_negative,
                    subtracted(&low, &large.mantissa),
                    large.exponent,
                ),
                _ => normalised(
                    large.is_negative,
                    subtracted(&large.mantissa, &low),
                    large.exponent,
                ),
            }
        };
        // The shift of the smaller operand cuts off less than one unit in the last place of the larger, a carry at most
        // one.
        let error = match is_cut {
            true => power_of_two(large.exponent + 1),
            false => 0.0,
        };
        (sum, error)
    }

    /// `self * other`, with a bound of the error.
    pub(super) fn mul(self, other: Self) -> (Self, f64) {
        if self.is_zero() || other.is_zero() {
            return (Self::ZERO, 0.0);
        }
        let mut words = [0u64; 2 * WORDS];
        // NOTE: these loops use indices, because a user's build compiles the generator without optimisation, where
        // iterators are slow.
        let mut i = 0;
        while i < WORDS {
            let factor = u128::from(self.mantissa[i]);
            let mut carry = 0u64;
            let mut j = 0;
            while factor != 0 && j < WORDS {
                // At most (2^64 - 1)^2 + 2 (2^64 - 1) = 2^128 - 1.
                let sum = factor * other.mantissa[j] as u128 + words[i + j] as u128 + carry as u128;
                words[i + j] = sum as u64;
                carry = (sum >> 64) as u64;
                j += 1;
            }
            words[i + WORDS] = carry;
            i += 1;
        }
        let mut exponent = self.exponent + other.exponent + BITS;
        if words[2 * WORDS - 1] >> 63 == 0 {
            let mut k = 2 * WORDS - 1;
            while k > 0 {
                words[k] = words[k] << 1 | words[k - 1] >> 63;
                k -= 1;
            }
            words[0] <<= 1;
            exponent -= 1;
        }
        let is_cut = words[0] | words[1] | words[2] | words[3] != 0;
        let product = Self {
            is_negative: self.is_negative != other.is_negative,
            mantissa: [words[4], words[5], words[6], words[7]],
            exponent,
        };
        let error = match is_cut {
            true => power_of_two(exponent),
            false => 0.0,
        };
        (product, error)
    }

    /// `self / divisor`, with a bound of the error.
    pub(super) fn divided(self, divisor: u64) -> (Self, f64) {
        let mut mantissa = self.mantissa;
        let mut rest = 0u128;
        let mut k = WORDS;
        while k > 0 {
            k -= 1;
            let part = rest << 64 | mantissa[k] as u128;
            mantissa[k] = (part / divisor as u128) as u64;
            rest = part % divisor as u128;
        }
        let error = match rest {
            0 => 0.0,
            _ => power_of_two(self.exponent),
        };
        (normalised(self.is_negative, mantissa, self.exponent), error)
    }
}

/// The normalised number with this mantissa, whose highest bits may be 0.
fn normalised(is_negative: bool, mut mantissa: [u64; WORDS], mut exponent: i32) -> Wide {
    if mantissa == [0; WORDS] {
        return Wide::ZERO;
    }
    while mantissa[WORDS - 1] == 0 {
        let mut k = WORDS - 1;
        while k > 0 {
            mantissa[k] = mantissa[k - 1];
            k -= 1;
        }
        mantissa[0] = 0;
        exponent -= 64;
    }
    let shift = mantissa[WORDS - 1].leading_zeros();
    if shift > 0 {
        let mut k = WORDS - 1;
        while k > 0 {
            mantissa[k] = mantissa[k] << shift | mantissa[k - 1] >> (64 - shift);
            k -= 1;
        }
        mantissa[0] <<= shift;
        exponent -= shift as i32;
    }
    Wide {
        is_negative,
        mantissa,
        exponent,
    }
}

/// The mantissa shifted to the right, and true if a bit that was 1 is lost.
fn shifted_right(mantissa: &[u64; WORDS], shift: i32) -> ([u64; WORDS], bool) {
    if shift >= BITS {
        return ([0; WORDS], *mantissa != [0; WORDS]);
    }
    let (words, bits) = (shift as usize / 64, shift as usize % 64);
    let mut is_cut = false;
    let mut k = 0;
    while k < words {
        is_cut |= mantissa[k] != 0;
        k += 1;
    }
    let mut result = [0; WORDS];
    let mut k = words;
    while k < WORDS {
        result[k - words] = mantissa[k] >> bits;
        if bits > 0 {
            let fallen = mantissa[k] << (64 - bits);
            match k == words {
                true => is_cut |= fallen != 0,
                false => result[k - words - 1] |= fallen,
            }
        }
        k += 1;
    }
    (result, is_cut)
}

/// The sum modulo `2^256`, and true if there is a carry.
fn added(a: &[u64; WORDS], b: &[u64; WORDS]) -> ([u64; WORDS], bool) {
    let mut sum = [0; WORDS];
    let mut carry = false;
    let mut k = 0;
    while k < WORDS {
        let (part, first) = a[k].overflowing_add(b[k]);
        let (part, second) = part.overflowing_add(carry as u64);
        sum[k] = part;
        carry = first || second;
        k += 1;
    }
    (sum, carry)
}

/// `a - b` for `a >= b`.
fn subtracted(a: &[u64; WORDS], b: &[u64; WORDS]) -> [u64; WORDS] {
    let mut difference = [0; WORDS];
    let mut borrow = false;
    let mut k = 0;
    while k < WORDS {
        let (part, first) = a[k].overflowing_sub(b[k]);
        let (part, second) = part.overflowing_sub(borrow as u64);
        difference[k] = part;
        borrow = first || second;
        k += 1;
    }
    difference
}

fn compared(a: &[u64; WORDS], b: &[u64; WORDS]) -> Ordering {
    let mut k = WORDS;
    while k > 0 {
        k -= 1;
        if a[k] != b[k] {
            return a[k].cmp(&b[k]);
        }
    }
    Ordering::Equal
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    /// The number as a fraction.
    fn exact(number: Wide) -> BigRational {
        let mut digits = BigInt::from(0);
        for word in number.mantissa.iter().rev() {
            digits = (digits << 64) + BigInt::from(*word);
        }
        let digits = if number.is_negative { -digits } else { digits };
        let power = BigInt::from(1) << number.exponent.unsigned_abs();
        match number.exponent < 0 {
            true => BigRational::new(digits, power),
            false => BigRational::from_integer(digits * power),
        }
    }

    /// Numbers with few and with many bits, of many sizes.
    fn numbers() -> Vec<Wide> {
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        let mut found = vec![Wide::ZERO, Wide::integer(1), Wide::integer(-3)];
        for k in 0..60 {
            let mut mantissa = [next(), next(), next(), next()];
            match k % 5 {
                0 => mantissa = [u64::MAX; 4],
                1 => mantissa[..2].fill(0),
                2 => mantissa[..3].fill(u64::MAX),
                _ => {}
            }
            let exponent = [-256, -255, -250, -192, -10, -512, 3][k % 7];
            found.push(normalised(k % 2 == 0, mantissa, exponent));
        }
        found
    }

    fn is_within(result: Wide, wanted: BigRational, error: f64, what: &str) {
        let difference = exact(result) - wanted;
        let bound = BigRational::from_float(error).unwrap();
        let is_small = difference <= bound && -difference <= bound;
        assert!(is_small, "{what} is off by more than {error:e}");
        let top = result.mantissa[WORDS - 1] >> 63;
        assert!(result == Wide::ZERO || top == 1, "{what} is not normalised");
    }

    #[test]
    fn errors_are_within_their_bounds() {
        let numbers = numbers();
        for a in &numbers {
            for b in &numbers {
                let (sum, error) = a.add(*b);
                is_within(sum, exact(*a) + exact(*b), error, "a sum");
                let (product, error) = a.mul(*b);
                is_within(product, exact(*a) * exact(*b), error, "a product");
            }
            for divisor in [1, 3, 1 << 40, u64::MAX] {
                let (quotient, error) = a.divided(divisor);
                let wanted = exact(*a) / BigInt::from(divisor);
                is_within(quotient, wanted, error, "a quotient");
            }
        }
    }

    #[test]
    fn bounds_by_doubles_enclose_the_number() {
        for number in numbers() {
            let size = exact(if number.is_negative {
                number.neg()
            } else {
                number
            });
            let [low, high] = [number.at_least(), number.at_most()]
                .map(|bound| BigRational::from_float(bound).unwrap());
            assert!(low <= size && size <= high);
            assert!(number.at_most() <= 1.000_000_1 * number.at_least());
            let near = number.nearest().abs();
            assert!(number.at_least() <= near && near <= number.at_most());
        }
    }

    #[test]
    fn bounds_hold_beyond_the_range_of_doubles() {
        let large = Wide::integer(1).shifted(1023);
        assert!(large.at_least() <= 2f64.powi(1023) && large.at_most() == f64::INFINITY);
        let small = Wide::integer(1).shifted(-1100);
        assert!(small.at_least() == 0.0 && small.at_most() > 0.0);
        for exponent in [-1080, -1074, -1022, -1000, -971, -970, -969, -900] {
            let number = Wide::integer(1).shifted(exponent);
            let size = 2f64.powi(exponent);
            assert!(
                number.at_least() <= size && size <= number.at_most(),
                "2^{exponent}"
            );
        }
        assert_eq!(large.shifted(-1100).nearest(), 2f64.powi(-77));
    }

    #[test]
    fn doubles_and_integers_are_exact() {
        for value in [
            0.0,
            -0.0,
            1.0,
            -0.1,
            1e300,
            5e-324,
            f64::MAX,
            f64::MIN_POSITIVE,
        ] {
            let number = Wide::double(value);
            assert_eq!(number.nearest(), value);
            assert_eq!(exact(number), BigRational::from_float(value).unwrap());
        }
        for value in [0, 1, -7, i64::MAX, i64::MIN] {
            let wanted = BigRational::from_integer(BigInt::from(value));
            assert_eq!(exact(Wide::integer(value)), wanted);
        }
    }
}
