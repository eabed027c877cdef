//! Arithmetic modulo a prime just below 2^61.
//!
//! All primes are `p = 2^61 - c` with small `c`, so that a product is reduced by two multiplications by `c`. All are
//! 3 modulo 4, so exactly one of `u` and `-u` is a square for `u != 0`. The nonzero squares form a group of odd order
//! `(p-1)/2`. In this group, roots of a degree coprime to the order are unique and multiplicative. Squares therefore
//! stand for positive numbers: `sqrt(a b) = sqrt(a) sqrt(b)` holds for squares `a`, `b`.

use num_bigint::BigInt;

use crate::rational::Rational;

const BITS: u32 = 61;
const MASK: u64 = (1 << BITS) - 1;

/// A prime `p = 2^61 - c`; residues are `u64` below `p`.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Modulus {
    deficit: u64,
}

impl Modulus {
    /// The Mersenne prime `2^61 - 1`.
    pub const MERSENNE: Self = Self { deficit: 1 };

    /// The Mersenne prime, then [`Modulus::POSITIVE`].
    pub const ALL: [Self; 9] = [
        Self::MERSENNE,
        Self::POSITIVE[0],
        Self::POSITIVE[1],
        Self::POSITIVE[2],
        Self::POSITIVE[3],
        Self::POSITIVE[4],
        Self::POSITIVE[5],
        Self::POSITIVE[6],
        Self::POSITIVE[7],
    ];

    /// The largest primes below 2^61 with two properties: 2, 3, 5, ..., 17 are squares, as positive numbers should be,
    /// and `(p-1)/2` is coprime to 2, 3, 5, 7 and 11, so that roots of these degrees exist (`p = 23 mod 24`).
    pub const POSITIVE: [Self; 8] = [
        Self { deficit: 11_913 },
        Self { deficit: 116_673 },
        Self { deficit: 132_033 },
        Self { deficit: 148_593 },
        Self { deficit: 150_993 },
        Self { deficit: 155_193 },
        Self { deficit: 204_033 },
        Self { deficit: 219_153 },
    ];

    /// `p`
    pub fn prime(self) -> u64 {
        (1 << BITS) - self.deficit
    }

    /// `a + b`
    pub fn add(self, a: u64, b: u64) -> u64 {
        self.reduce_once(a + b)
    }

    /// `a - b`
    pub fn sub(self, a: u64, b: u64) -> u64 {
        self.reduce_once(a + self.prime() - b)
    }

    /// `-a`
    pub fn neg(self, a: u64) -> u64 {
        self.sub(0, a)
    }

    /// `a b`
    pub fn mul(self, a: u64, b: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(b))
    }

    /// The residue of a 128-bit number.
    pub(crate) fn reduce(self, wide: u128) -> u64 {
        // 2^61 = c mod p, c < 2^18: the first fold leaves less than 2^86, the second less than 2^61 + 2^43 < 2 p.
        let fold = u128::from(wide as u64 & MASK) + (wide >> BITS) * u128::from(self.deficit);
        self.reduce_once((fold as u64 & MASK) + (fold >> BITS) as u64 * self.deficit)
    }

    /// `base^exponent`; 1 for exponent 0.
    pub fn pow(self, base: u64, mut exponent: u64) -> u64 {
        let (mut square, mut result) = (base, 1);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.mul(result, square);
            }
            square = self.mul(square, square);
            exponent >>= 1;
        }
        result
    }

    /// `1 / a`; `None` for 0.
    pub fn inv(self, a: u64) -> Option<u64> {
        // The extended Euclidean algorithm needs half the multiplications of a power, on machine words.
        let p = self.prime() as i64;
        let (mut old, mut new) = ((a as i64, 1i64), (p, 0i64));
        while new.0 != 0 {
            let quotient = old.0 / new.0;
            (old, new) = (new, (old.0 - quotient * new.0, old.1 - quotient * new.1));
        }
        (old.0 == 1).then(|| old.1.rem_euclid(p) as u64)
    }

    /// True if `a` is a square other than 0.
    pub fn is_square(self, a: u64) -> bool {
        self.pow(a, (self.prime() - 1) / 2) == 1
    }

    /// The square root that is itself a square; `None` if `a` is not a square.
    pub fn sqrt(self, a: u64) -> Option<u64> {
        let root = self.pow(a, self.prime().div_ceil(4));
        (self.mul(root, root) == a).then_some(root)
    }

    /// The exponent `e` for which `a^e` is the `degree`-th root of a square `a`, if `degree` is coprime to `(p-1)/2`.
    pub(crate) fn root_exponent(self, degree: u64) -> Option<u64> {
        let order = i128::from((self.prime() - 1) / 2);
        let (mut old, mut new) = ((i128::from(degree), 1i128), (order, 0i128));
        while new.0 != 0 {
            let quotient = old.0 / new.0;
            (old, new) = (new, (old.0 - quotient * new.0, old.1 - quotient * new.1));
        }
        (old.0 == 1).then(|| old.1.rem_euclid(order) as u64)
    }

    /// The residue of an integer.
    pub fn integer(self, value: i64) -> u64 {
        let prime = self.prime() as i64;
        match 0 <= value && value < prime {
            true => value as u64,
            false => value.rem_euclid(prime) as u64,
        }
    }

    /// The residue of a rational number; `None` if `p` divides its denominator.
    pub fn rational(self, value: &Rational) -> Option<u64> {
        match value.to_small() {
            Some((n, 1)) => Some(self.integer(n)),
            Some((n, d)) => Some(self.mul(self.integer(n), self.inv(self.integer(d))?)),
            None => {
                let numer = self.big_integer(&value.numer())?;
                Some(self.mul(numer, self.inv(self.big_integer(&value.denom())?)?))
            }
        }
    }

    fn big_integer(self, value: &BigInt) -> Option<u64> {
        let prime = BigInt::from(self.prime());
        let residue = (value % &prime + &prime) % &prime;
        u64::try_from(&residue).ok()
    }

    fn reduce_once(self, a: u64) -> u64 {
        let p = self.prime();
        if a >= p { a - p } else { a }
    }
}

/// A pseudorandom nonzero residue. It is a function of the modulus and the words only, so it is the same in every run.
pub(crate) fn draw(modulus: Modulus, words: &[u64]) -> u64 {
    let mut state = 0x243f_6a88_85a3_08d3; // the first digits of pi
    for word in words {
        state = mix(state ^ word);
    }
    let mut residue = 0;
    while residue == 0 || residue >= modulus.prime() {
        state = mix(state);
        residue = state & MASK;
    }
    residue
}

/// The output function of the splitmix64 generator.
pub(crate) fn mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_agree_with_wide_division() {
        for modulus in Modulus::ALL {
            let p = modulus.prime();
            let mut samples = vec![0, 1, 2, p - 1, p - 2, p / 2];
            samples.extend((0..20).map(|k| draw(modulus, &[k])));
            for a in &samples {
                for b in &samples {
                    let expected = (u128::from(*a) * u128::from(*b) % u128::from(p)) as u64;
                    assert_eq!(modulus.mul(*a, *b), expected);
                }
            }
        }
    }

    #[test]
    fn moduli_satisfy_fermat_for_many_bases() {
        for modulus in Modulus::ALL {
            for base in [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37] {
                assert_eq!(modulus.pow(base, modulus.prime() - 1), 1);
            }
            assert_eq!(modulus.prime() % 4, 3);
        }
    }

    #[test]
    fn small_numbers_are_squares_and_have_roots_for_the_positive_moduli() {
        for modulus in Modulus::POSITIVE {
            assert!(
                [2, 3, 5, 7, 11, 13, 17]
                    .iter()
                    .all(|number| modulus.is_square(*number))
            );
            for degree in [2, 3, 4, 5, 6, 7, 11] {
                let root = modulus.pow(
                    modulus.pow(6, modulus.root_exponent(degree).unwrap()),
                    degree,
                );
                assert_eq!(root, 6);
            }
        }
    }

    #[test]
    fn inverses_and_roots_undo_products() {
        for modulus in Modulus::ALL {
            assert_eq!(modulus.inv(0), None);
            for k in 0..20 {
                let a = draw(modulus, &[k, 7]);
                assert_eq!(modulus.mul(a, modulus.inv(a).unwrap()), 1);
                let square = modulus.mul(a, a);
                let root = modulus.sqrt(square).unwrap();
                assert!(root == a || root == modulus.neg(a));
                assert!(modulus.is_square(root));
                assert_ne!(modulus.is_square(a), modulus.is_square(modulus.neg(a)));
            }
        }
    }

    #[test]
    fn rational_numbers_have_residues() {
        let modulus = Modulus::ALL[1];
        let value = modulus.rational(&Rational::new(-3, 7)).unwrap();
        assert_eq!(modulus.mul(value, 7), modulus.integer(-3));
        let big = Rational::from_decimal("1e30").unwrap();
        assert_eq!(modulus.rational(&big), Some(modulus.pow(10, 30)));
    }
}
