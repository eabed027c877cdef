//! Error-free sums and products of doubles, and their rounding to a given number of parts.
//!
//! References: D. E. Knuth, *The Art of Computer Programming* 2 (1997), 4.2.2, theorem B; T. J. Dekker, *A
//! Floating-Point Technique for Extending the Available Precision*, Numerische Mathematik 18 (1971); D. M. Priest,
//! *Algorithms for Arbitrary Precision Floating Point Arithmetic* (1991).

/// Maximum number of parts of a sum, plus one level for the rest.
const LEVELS: usize = 7;

/// The rounded sum `a + b` and its rounding error.
#[inline(always)]
pub(super) fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let moved = sum - a;
    [sum, (a - (sum - moved)) + (b - moved)]
}

/// The rounded product `a b` and its rounding error, which is exact unless it underflows.
#[inline(always)]
fn two_product(a: f64, b: f64) -> [f64; 2] {
    let product = a * b;
    #[cfg(all(target_feature = "fma", feature = "std"))]
    {
        [product, a.mul_add(b, -product)]
    }
    #[cfg(not(all(target_feature = "fma", feature = "std")))]
    {
        [product, product_error(a, b, product)]
    }
}

/// Rounding error of a product. The factors are split into halves of 26 bits (Veltkamp, Dekker).
#[cfg(not(all(target_feature = "fma", feature = "std")))]
#[inline(always)]
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    /// Bounds of the factors (`2^996`) and of the product (`2^-968`). Beyond them, halves overflow, or the least digits
    /// of the product underflow.
    const HUGE: f64 = f64::from_bits((1023 + 996) << 52);
    const TINY: f64 = f64::from_bits((1023 - 968) << 52);
    let is_inside = a.abs() < HUGE && b.abs() < HUGE && product.abs() > TINY;
    if !is_inside {
        return libm::fma(a, b, -product);
    }
    let halves = |x: f64| {
        let high = 134_217_729.0 * x;
        let high = high - (high - x);
        [high, x - high]
    };
    let ([a, c], [b, d]) = (halves(a), halves(b));
    ((a * b - product) + a * d + c * b) + c * d
}

/// Accumulator of a sum: `PARTS` parts and a rest.
pub(super) struct Sum<const PARTS: usize> {
    levels: [f64; LEVELS],
}

impl<const PARTS: usize> Sum<PARTS> {
    const IS_IN_RANGE: () = assert!(PARTS >= 1 && PARTS < LEVELS);

    #[inline(always)]
    pub(super) fn of(parts: &[f64; PARTS]) -> Self {
        let () = Self::IS_IN_RANGE;
        let mut levels = [0.0; LEVELS];
        levels[..PARTS].copy_from_slice(parts);
        Self { levels }
    }

    /// Adds a number that is smaller than the sum by about `level` times 53 bits, the length of a part.
    #[inline(always)]
    pub(super) fn add(&mut self, mut number: f64, level: usize) {
        for level in &mut self.levels[level..PARTS] {
            [*level, number] = two_sum(*level, number);
        }
        self.levels[PARTS] += number;
    }

    /// Adds the product of two numbers. It is smaller than the sum by about `level` times 53 bits.
    #[inline(always)]
    pub(super) fn add_product(&mut self, a: f64, b: f64, level: usize) {
        if level < PARTS {
            let [product, error] = two_product(a, b);
            self.add(product, level);
            self.add(error, level + 1);
        } else {
            self.levels[PARTS] += a * b;
        }
    }

    /// The sum in parts that do not overlap. Each part is the rounded difference between the sum and the parts before
    /// it.
    #[inline(always)]
    pub(super) fn parts(self) -> [f64; PARTS] {
        let mut levels = self.levels;
        // NOTE: one pass leaves overlapping parts where leading digits cancel.
        for _ in 0..2 {
            for i in (0..PARTS).rev() {
                [levels[i], levels[i + 1]] = two_sum(levels[i], levels[i + 1]);
            }
        }
        let mut parts = [0.0; PARTS];
        let (mut place, mut part) = (0, levels[0]);
        for &level in &levels[1..=PARTS] {
            let [sum, rest] = two_sum(part, level);
            part = sum;
            if rest != 0.0 {
                parts[place] = sum;
                place += 1;
                part = rest;
                if place == PARTS {
                    break;
                }
            }
        }
        if place < PARTS {
            parts[place] = part;
        }
        for i in 1..PARTS {
            [parts[i - 1], parts[i]] = two_sum(parts[i - 1], parts[i]);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg_attr(
        miri,
        ignore = "near the ends of the range a function of libm is used, which contains assembly"
    )]
    fn products_have_the_error_of_a_fused_one() {
        let mut x = 1.0e-290;
        while x < 1.0e300 {
            for y in [1.0 / 3.0, -7.0e-17, 3.0e8, 1.7e305] {
                let [product, error] = two_product(x, y);
                let exact = f64::mul_add(x, y, -(x * y));
                assert_eq!([product, error], [x * y, exact], "{x} {y}");
            }
            x *= 10.0 / 7.0;
            if x > 1.0e3 {
                x *= 1.0e5;
            }
        }
    }

    #[test]
    fn what_cancels_leaves_what_is_behind_it() {
        let mut sum = Sum::<3>::of(&[1.0, 2e-17, 3e-40]);
        sum.add(-1.0, 0);
        sum.add(-2e-17, 1);
        assert_eq!(sum.parts(), [3e-40, 0.0, 0.0]);
        let mut sum = Sum::<2>::of(&[1e300, 1.0]);
        sum.add(1e-300, 1);
        assert_eq!(sum.parts(), [1e300, 1.0]);
    }
}
