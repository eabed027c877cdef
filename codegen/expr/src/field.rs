//! Arithmetic modulo primes between 2^60 and 2^61.
//!
//! The primes of a pool are drawn from its seed. All are 23 modulo 24, so exactly one of `u` and `-u` is a square for
//! `u != 0`. The nonzero squares form a group of odd order `(p-1)/2`. In this group, roots of a degree coprime to the
//! order are unique and multiplicative. Squares therefore stand for positive numbers: `sqrt(a b) = sqrt(a) sqrt(b)`
//! holds for squares `a`, `b`.

use num_bigint::BigInt;

use crate::rational::Rational;

const BITS: u32 = 61;
const MASK: u64 = (1 << BITS) - 1;

/// Number of primes that are used in turn.
pub(crate) const PRIMES: usize = 9;

/// A prime `p` between 2^60 and 2^61; residues are `u64` below `p`.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct Modulus {
    prime: u64,
    /// `2^122 / p`, rounded down.
    reciprocal: u64,
}

impl Modulus {
    /// The Mersenne prime `2^61 - 1`.
    pub const MERSENNE: Self = Self::of(MASK);

    /// `modulus` is between 2^60 and 2^61.
    const fn of(modulus: u64) -> Self {
        Self {
            prime: modulus,
            reciprocal: ((1 << (2 * BITS)) / modulus as u128) as u64,
        }
    }

    /// Different primes that follow from a seed. 2, 3, 5, ..., 17 are squares, as positive numbers should be, and
    /// `(p-1)/2` is coprime to 2, 3, 5, 7 and 11, so that roots of these degrees exist.
    ///
    /// About 5e13 primes have these properties. They are drawn, and not the same for all declarations, because numbers
    /// of a declaration can be multiples of primes that are known beforehand.
    pub(crate) fn drawn(seed: u64) -> [Self; PRIMES] {
        let mut state = mix(seed);
        let mut found = [Self::MERSENNE; PRIMES];
        for k in 0..PRIMES {
            while found[k] == Self::MERSENNE || found[..k].contains(&found[k]) {
                state = mix(state);
                let candidate = (state & (MASK >> 1) | (1 << (BITS - 1))) / 24 * 24 + 23;
                if candidate <= MASK && has_roots(candidate) && is_prime(candidate) {
                    found[k] = Self::of(candidate);
                }
            }
        }
        found
    }

    /// `p`
    pub fn prime(self) -> u64 {
        self.prime
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

    /// The residue of a number below `p^2` (Barrett).
    fn reduce(self, wide: u128) -> u64 {
        let high = u128::from((wide >> (BITS - 1)) as u64);
        let quotient = ((high * u128::from(self.reciprocal)) >> (BITS + 1)) as u64;
        // The quotient is too small by 2 at most, so the rest is less than 3 p < 2^63.
        let rest = (wide as u64).wrapping_sub(quotient.wrapping_mul(self.prime));
        self.reduce_once(self.reduce_once(rest))
    }

    /// The residue of any number.
    pub(crate) fn reduce_wide(self, wide: u128) -> u64 {
        let [high, low] = [wide >> 64, wide & u128::from(u64::MAX)].map(|part| self.reduce(part));
        self.add(self.mul(high, self.reduce(1 << 64)), low)
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

/// True if 5, 7, 11, 13 and 17 are squares modulo the prime `p`, which is 23 modulo 24, and 5, 7 and 11 do not divide `p - 1`. By
/// the law of quadratic reciprocity, `p` is then a square modulo 5, 13 and 17, and no square modulo 7 and 11.
fn has_roots(p: u64) -> bool {
    let (of_5, of_7, of_11, of_13, of_17) = (p % 5, p % 7, p % 11, p % 13, p % 17);
    of_5 == 4
        && matches!(of_7, 3 | 5 | 6)
        && matches!(of_11, 2 | 6 | 7 | 8 | 10)
        && matches!(of_13, 1 | 3 | 4 | 9 | 10 | 12)
        && matches!(of_17, 1 | 2 | 4 | 8 | 9 | 13 | 15 | 16)
}

/// True for primes among the numbers between 2^60 and 2^61 that are 3 modulo 4. The test of Miller and Rabin for these
/// bases is exact below 3e24 (Sorenson, Webster).
fn is_prime(number: u64) -> bool {
    const BASES: [u64; 13] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41];
    let field = Modulus::of(number);
    BASES.iter().all(|base| {
        let power = field.pow(*base, (number - 1) / 2);
        power == 1 || power == number - 1
    })
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

    fn moduli() -> impl Iterator<Item = Modulus> {
        let drawn = [0, 1, u64::MAX].into_iter().flat_map(Modulus::drawn);
        drawn.chain([Modulus::MERSENNE])
    }

    #[test]
    fn the_primes_of_different_seeds_differ() {
        let primes: std::collections::BTreeSet<u64> = (0..200)
            .flat_map(Modulus::drawn)
            .map(Modulus::prime)
            .collect();
        assert_eq!(primes.len(), 200 * PRIMES);
        assert!(
            primes
                .iter()
                .all(|prime| (1 << 60..1 << 61).contains(prime))
        );
        assert!(is_prime(MASK));
        assert!(!is_prime(2_147_483_647 * 1_073_741_789));
    }

    #[test]
    fn products_agree_with_wide_division() {
        for modulus in moduli() {
            let p = modulus.prime();
            let mut samples = vec![0, 1, 2, p - 1, p - 2, p / 2];
            samples.extend((0..20).map(|k| draw(modulus, &[k])));
            for a in &samples {
                for b in &samples {
                    let expected = (u128::from(*a) * u128::from(*b) % u128::from(p)) as u64;
                    assert_eq!(modulus.mul(*a, *b), expected);
                    let wide = (u128::from(*a) << 67) + u128::from(*b);
                    let expected = (wide % u128::from(p)) as u64;
                    assert_eq!(modulus.reduce_wide(wide), expected);
                }
            }
        }
    }

    #[test]
    fn moduli_satisfy_fermat_for_many_bases() {
        for modulus in moduli() {
            for base in [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37] {
                assert_eq!(modulus.pow(base, modulus.prime() - 1), 1);
            }
            assert_eq!(modulus.prime() % 4, 3);
        }
    }

    #[test]
    fn small_numbers_are_squares_and_have_roots_for_the_positive_moduli() {
        for modulus in Modulus::drawn(1) {
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
        for modulus in moduli() {
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
        let [modulus, ..] = Modulus::drawn(1);
        let value = modulus.rational(&Rational::new(-3, 7)).unwrap();
        assert_eq!(modulus.mul(value, 7), modulus.integer(-3));
        let big = Rational::from_decimal("1e30").unwrap();
        assert_eq!(modulus.rational(&big), Some(modulus.pow(10, 30)));
    }
}
