//! Logarithms and powers of two to two or three digits, from the bits of a number. They are accurate enough to choose a
//! step, and the same on every machine.

/// Bits of the exponent.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;

/// Exponent bias of doubles.
const BIAS: u64 = 1023;
const PLACE: u32 = 52;

/// The largest power of two not above a positive number, which must not be subnormal.
pub(crate) fn power_of_two(x: f64) -> f64 {
    f64::from_bits(normal(x).to_bits() & EXPONENT)
}

/// The binary logarithm of a positive number, to 0.01.
#[inline(always)]
pub(super) fn log2(x: f64) -> f64 {
    let bits = normal(x).to_bits();
    let exponent = (bits >> PLACE) as f64 - BIAS as f64;
    let part = f64::from_bits((bits & !EXPONENT) | 1.0_f64.to_bits()) - 1.0;
    // The parabola that is exact at both ends and in the middle.
    exponent + part * (1.339_850_002_884_624_7 - 0.339_850_002_884_624_7 * part)
}

/// `2^x` to 1 part in 300, for exponents in the range of doubles.
#[inline(always)]
pub(super) fn exp2(x: f64) -> f64 {
    let x = x.clamp(-1022.0, 1023.0);
    // NOTE: the conversion drops the fraction of a positive number.
    let shifted = (x + BIAS as f64) as u64;
    let part = x - (shifted as f64 - BIAS as f64);
    let mantissa = 1.0 + part * (0.656_854_249_492_380_2 + 0.343_145_750_507_619_8 * part);
    f64::from_bits(shifted << PLACE) * mantissa
}

fn normal(x: f64) -> f64 {
    x.clamp(f64::MIN_POSITIVE, f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_and_powers_are_as_good_as_they_say() {
        let mut x = 1e-300;
        while x < 1e300 {
            assert!((log2(x) - f64::log2(x)).abs() < 0.01, "{x}");
            let exponent = f64::log2(x);
            assert!((exp2(exponent) / x - 1.0).abs() < 4e-3, "{x}");
            assert!(power_of_two(x) <= x && 2.0 * power_of_two(x) > x, "{x}");
            x *= 1.37;
        }
        assert_eq!([log2(1.0), log2(0.5)], [0.0, -1.0]);
        assert_eq!([exp2(0.0), exp2(-3.0)], [1.0, 0.125]);
        assert_eq!(
            [exp2(f64::INFINITY), exp2(-1e9)],
            [exp2(1023.0), exp2(-1022.0)]
        );
    }
}
