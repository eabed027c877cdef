//! Exact rational numbers: machine words while they fit, big integers beyond.
//!
//! A value is always in lowest terms with a positive denominator, and it is stored small whenever both parts
//! fit an `i64`; equality and hashing can therefore compare the stored parts.

use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, BigUint, Sign};
use num_rational::BigRational;

/// Largest size in bits of a numerator or denominator that [`Rational::pow_i`] and
/// [`Rational::from_decimal`] produce.
pub const MAX_BITS: u64 = 4096;

/// An exact rational number.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Rational(Parts);

/// NOTE: `Big` only ever holds values that do not fit `Small`; the derived `Eq` and `Hash` rely on it.
#[derive(Clone, PartialEq, Eq, Hash)]
enum Parts {
    Small(i64, i64),
    Big(Box<BigRational>),
}

impl Rational {
    /// Zero.
    pub const ZERO: Self = Self(Parts::Small(0, 1));
    /// One.
    pub const ONE: Self = Self(Parts::Small(1, 1));
    /// Minus one.
    pub const MINUS_ONE: Self = Self(Parts::Small(-1, 1));
    /// One half.
    pub const HALF: Self = Self(Parts::Small(1, 2));

    /// `numer / denom` in lowest terms.
    ///
    /// # Panics
    /// If `denom` is 0.
    pub fn new(numer: i64, denom: i64) -> Self {
        assert!(
            denom != 0,
            "the denominator of a rational number must not be zero"
        );
        Self::from_i128(i128::from(numer), i128::from(denom))
    }

    /// True if it is 0.
    pub fn is_zero(&self) -> bool {
        matches!(self.0, Parts::Small(0, _))
    }

    /// True if it is 1.
    pub fn is_one(&self) -> bool {
        matches!(self.0, Parts::Small(1, 1))
    }

    /// True if it is less than 0.
    pub fn is_negative(&self) -> bool {
        match &self.0 {
            Parts::Small(n, _) => *n < 0,
            Parts::Big(value) => value.numer().sign() == Sign::Minus,
        }
    }

    /// True if it is greater than 0.
    pub fn is_positive(&self) -> bool {
        !self.is_zero() && !self.is_negative()
    }

    /// True if its denominator is 1.
    pub fn is_integer(&self) -> bool {
        match &self.0 {
            Parts::Small(_, d) => *d == 1,
            Parts::Big(value) => value.is_integer(),
        }
    }

    /// The value as an `i64`, if it is an integer that fits.
    pub fn to_i64(&self) -> Option<i64> {
        match self.0 {
            Parts::Small(n, 1) => Some(n),
            _ => None,
        }
    }

    /// Numerator and denominator, if both fit an `i64`.
    pub fn to_small(&self) -> Option<(i64, i64)> {
        match self.0 {
            Parts::Small(n, d) => Some((n, d)),
            Parts::Big(_) => None,
        }
    }

    /// The numerator in lowest terms; it carries the sign.
    pub fn numer(&self) -> BigInt {
        match &self.0 {
            Parts::Small(n, _) => BigInt::from(*n),
            Parts::Big(value) => value.numer().clone(),
        }
    }

    /// The denominator in lowest terms; positive.
    pub fn denom(&self) -> BigInt {
        match &self.0 {
            Parts::Small(_, d) => BigInt::from(*d),
            Parts::Big(value) => value.denom().clone(),
        }
    }

    /// The absolute value.
    pub fn abs(&self) -> Self {
        if self.is_negative() {
            -self
        } else {
            self.clone()
        }
    }

    /// `1 / self`; `None` for 0.
    pub fn recip(&self) -> Option<Self> {
        match &self.0 {
            Parts::Small(0, _) => None,
            Parts::Small(n, d) => Some(Self::from_i128(i128::from(*d), i128::from(*n))),
            Parts::Big(value) => Some(Self::from_big(value.recip())),
        }
    }

    /// `self / other`; `None` if `other` is 0.
    pub fn checked_div(&self, other: &Self) -> Option<Self> {
        other.recip().map(|inverse| self * &inverse)
    }

    /// `self^exponent`; `None` for a negative power of 0 and for results beyond [`MAX_BITS`] bits.
    pub fn pow_i(&self, exponent: i32) -> Option<Self> {
        if exponent < 0 {
            return self.recip()?.pow_i(exponent.checked_neg()?);
        }
        if self.is_zero() || self.abs().is_one() {
            let odd = exponent % 2 == 1;
            return Some(match exponent {
                0 => Self::ONE,
                _ if odd => self.clone(),
                _ => self.abs(),
            });
        }
        if (self.bits() - 1).saturating_mul(u64::from(exponent.unsigned_abs())) > MAX_BITS {
            return None;
        }
        // Powers of numbers without common factor have none.
        let (value, exponent) = (self.to_big(), exponent.unsigned_abs());
        let (numer, denom) = (value.numer().pow(exponent), value.denom().pow(exponent));
        Some(Self::from_big(BigRational::new_raw(numer, denom)))
            .filter(|power| power.bits() <= MAX_BITS)
    }

    /// The non-negative `degree`-th root of a non-negative value, if it is rational.
    pub fn exact_root(&self, degree: u32) -> Option<Self> {
        if self.is_negative() || degree == 0 {
            return None;
        }
        let root = |part: BigInt| {
            let part = part.magnitude().clone();
            let root = part.nth_root(degree);
            (root.pow(degree) == part).then(|| BigInt::from(root))
        };
        Some(Self::from_big(BigRational::new(
            root(self.numer())?,
            root(self.denom())?,
        )))
    }

    /// The largest integer not above it.
    pub fn floor(&self) -> Self {
        match &self.0 {
            Parts::Small(n, d) => Self::from(n.div_euclid(*d)),
            Parts::Big(value) => Self::from_big(value.floor()),
        }
    }

    /// Size in bits of the larger of numerator and denominator.
    pub fn bits(&self) -> u64 {
        match &self.0 {
            Parts::Small(n, d) => {
                u64::from(64 - n.unsigned_abs().leading_zeros().min(d.leading_zeros()))
            }
            Parts::Big(value) => value.numer().bits().max(value.denom().bits()),
        }
    }

    /// The binary logarithm of the absolute value, to within 1; 0 for 0.
    pub fn log2(&self) -> i64 {
        match &self.0 {
            Parts::Small(0, _) => 0,
            Parts::Small(n, d) => {
                i64::from(d.leading_zeros()) - i64::from(n.unsigned_abs().leading_zeros())
            }
            Parts::Big(value) => value.numer().bits() as i64 - value.denom().bits() as i64,
        }
    }

    /// The non-negative generator of the integer combinations of two numbers:
    /// `gcd(a/b, c/d) = gcd(a, c) / lcm(b, d)`; `None` if it does not fit machine words.
    pub(crate) fn small_gcd(&self, other: &Self) -> Option<Self> {
        let ((a, b), (c, d)) = (self.to_small()?, other.to_small()?);
        let numer = i64::try_from(gcd(a.unsigned_abs(), c.unsigned_abs())).ok()?;
        let common = i64::try_from(gcd(b.unsigned_abs(), d.unsigned_abs())).ok()?;
        let denom = (b / common).checked_mul(d)?;
        Some(Self(Parts::Small(numer, denom)))
    }

    fn from_i128(numer: i128, denom: i128) -> Self {
        let (n, d) = (numer.unsigned_abs(), denom.unsigned_abs());
        let common = gcd_wide(n, d);
        let (n, d) = (n / common, d / common);
        let negative = (numer < 0) != (denom < 0);
        match (i64::try_from(n), i64::try_from(d)) {
            (Ok(n), Ok(d)) => Self(Parts::Small(if negative { -n } else { n }, d)),
            _ => {
                let numer = BigInt::from_biguint(
                    if negative { Sign::Minus } else { Sign::Plus },
                    BigUint::from(n),
                );
                Self::from_big(BigRational::new_raw(numer, BigInt::from(d)))
            }
        }
    }

    pub(crate) fn from_big(value: BigRational) -> Self {
        match (i64::try_from(value.numer()), i64::try_from(value.denom())) {
            (Ok(n), Ok(d)) => Self(Parts::Small(n, d)),
            _ => Self(Parts::Big(Box::new(value))),
        }
    }

    fn to_big(&self) -> BigRational {
        match &self.0 {
            Parts::Small(n, d) => BigRational::new_raw(BigInt::from(*n), BigInt::from(*d)),
            Parts::Big(value) => (**value).clone(),
        }
    }
}

impl From<i64> for Rational {
    fn from(value: i64) -> Self {
        Self(Parts::Small(value, 1))
    }
}

impl Add for &Rational {
    type Output = Rational;

    fn add(self, other: Self) -> Rational {
        if let (Parts::Small(a, b), Parts::Small(c, d)) = (&self.0, &other.0) {
            if *b == 1
                && *d == 1
                && let Some(sum) = a.checked_add(*c)
            {
                return Rational::from(sum);
            }
            let [a, b, c, d] = [*a, *b, *c, *d].map(i128::from);
            return Rational::from_i128(a * d + c * b, b * d);
        }
        Rational::from_big(self.to_big() + other.to_big())
    }
}

impl Mul for &Rational {
    type Output = Rational;

    fn mul(self, other: Self) -> Rational {
        if let (Parts::Small(a, b), Parts::Small(c, d)) = (&self.0, &other.0) {
            if *b == 1
                && *d == 1
                && let Some(product) = a.checked_mul(*c)
            {
                return Rational::from(product);
            }
            let [a, b, c, d] = [*a, *b, *c, *d].map(i128::from);
            return Rational::from_i128(a * c, b * d);
        }
        Rational::from_big(self.to_big() * other.to_big())
    }
}

impl Neg for &Rational {
    type Output = Rational;

    fn neg(self) -> Rational {
        match &self.0 {
            Parts::Small(n, d) if *n != i64::MIN => Rational(Parts::Small(-n, *d)),
            _ => Rational::from_big(-self.to_big()),
        }
    }
}

impl Sub for &Rational {
    type Output = Rational;

    fn sub(self, other: Self) -> Rational {
        self + &-other
    }
}

impl Neg for Rational {
    type Output = Self;

    fn neg(self) -> Self {
        -&self
    }
}

macro_rules! by_value {
    ($($operation:ident $method:ident),*) => {$(
        impl $operation for Rational {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                (&self).$method(&other)
            }
        }
    )*};
}

by_value!(Add add, Sub sub, Mul mul);

impl Ord for Rational {
    fn cmp(&self, other: &Self) -> Ordering {
        match (&self.0, &other.0) {
            (Parts::Small(a, b), Parts::Small(c, d)) => {
                let [a, b, c, d] = [*a, *b, *c, *d].map(i128::from);
                (a * d).cmp(&(c * b))
            }
            _ => self.to_big().cmp(&other.to_big()),
        }
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for Rational {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Parts::Small(n, 1) => write!(out, "{n}"),
            Parts::Small(n, d) => write!(out, "{n}/{d}"),
            Parts::Big(value) => write!(out, "{value}"),
        }
    }
}

impl fmt::Debug for Rational {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn gcd_wide(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        if let (Ok(a), Ok(b)) = (u64::try_from(a), u64::try_from(b)) {
            return u128::from(gcd(a, b));
        }
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_kept_in_lowest_terms() {
        assert_eq!(Rational::new(6, -4).to_string(), "-3/2");
        assert_eq!(Rational::new(0, -7), Rational::ZERO);
        let third = Rational::new(1, 3);
        assert_eq!(&(&third + &third) + &third, Rational::ONE);
        assert_eq!(&Rational::new(2, 3) * &Rational::new(3, 2), Rational::ONE);
        assert_eq!(
            -Rational::new(1, 2) - Rational::new(1, 2),
            Rational::MINUS_ONE
        );
    }

    #[test]
    fn arithmetic_leaves_and_reenters_machine_words() {
        let big = Rational::from(i64::MAX) + Rational::ONE;
        assert_eq!(big.to_string(), "9223372036854775808");
        assert_eq!(big.to_small(), None);
        assert_eq!(&big - &Rational::ONE, Rational::from(i64::MAX));
        assert_eq!(-&big, Rational::from(i64::MIN));
        assert_eq!(-Rational::from(i64::MIN), big);
        assert_eq!(&big * &big.recip().unwrap(), Rational::ONE);
        assert!(Rational::new(1, i64::MAX) < Rational::new(1, i64::MAX - 1));
        assert!(big > Rational::from(i64::MAX));
    }

    #[test]
    fn logarithms_are_within_one() {
        let ratio = Rational::new(3, 7).pow_i(900).expect("a number");
        assert!((ratio.log2() as f64 - 900.0 * (3.0_f64 / 7.0).log2()).abs() <= 1.0);
        assert_eq!(Rational::from(-8).log2(), 3);
        assert_eq!(Rational::ZERO.log2(), 0);
    }

    #[test]
    fn powers_are_bounded_in_size() {
        assert_eq!(Rational::new(2, 3).pow_i(-3), Some(Rational::new(27, 8)));
        assert_eq!(Rational::ZERO.pow_i(-1), None);
        assert_eq!(Rational::ZERO.pow_i(0), Some(Rational::ONE));
        assert_eq!(Rational::from(2).pow_i(5000), None);
        assert_eq!(Rational::from(2).pow_i(4000).unwrap().bits(), 4001);
        assert_eq!(
            Rational::MINUS_ONE.pow_i(i32::MAX),
            Some(Rational::MINUS_ONE)
        );
    }

    #[test]
    fn roots_are_exact_or_absent() {
        assert_eq!(Rational::new(9, 4).exact_root(2), Some(Rational::new(3, 2)));
        assert_eq!(Rational::from(2).exact_root(2), None);
        assert_eq!(Rational::from(-8).exact_root(3), None);
        assert_eq!(Rational::from(27).exact_root(3), Some(Rational::from(3)));
    }
}
