//! Upper bounds in double precision, and a lower bound of differences. Operands are nonnegative and may be infinite.

/// Upper bound of `a + b`; exact if a summand is 0.
pub(super) fn sum(a: f64, b: f64) -> f64 {
    match (a == 0.0, b == 0.0) {
        (true, _) => b,
        (_, true) => a,
        _ => (a + b).next_up(),
    }
}

/// Upper bound of `a b`; 0 if a factor is 0.
pub(super) fn product(a: f64, b: f64) -> f64 {
    match a == 0.0 || b == 0.0 {
        true => 0.0,
        false => (a * b).next_up(),
    }
}

/// Upper bound of `a/b`; infinite if `b` is 0 or `a` is infinite, and 0 if only `a` is 0.
pub(super) fn quotient(a: f64, b: f64) -> f64 {
    match (a == 0.0, b > 0.0 && a.is_finite()) {
        (_, false) => f64::INFINITY,
        (true, true) => 0.0,
        (false, true) => (a / b).next_up(),
    }
}

/// Lower bound of `a - b`, at least 0.
pub(super) fn difference(a: f64, b: f64) -> f64 {
    match a > b {
        true if b == 0.0 => a,
        true => (a - b).next_down().max(0.0),
        false => 0.0,
    }
}

/// Upper bound of `2^exponent`; exact if the power is a normal double.
pub(super) fn power_of_two(exponent: i32) -> f64 {
    match exponent {
        1024.. => f64::INFINITY,
        -1022..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        _ => f64::MIN_POSITIVE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_never_too_small() {
        assert!(sum(1.0, 1e-20) > 1.0);
        assert!(product(1e-200, 1e-200) > 0.0);
        assert!(quotient(1.0, 3.0) * 3.0 >= 1.0);
        assert_eq!(quotient(0.0, 0.0), f64::INFINITY);
        assert_eq!(product(f64::INFINITY, 0.0), 0.0);
        assert!(difference(1.0, 1e-20) < 1.0);
        assert_eq!(difference(1.0, f64::INFINITY), 0.0);
        assert_eq!(power_of_two(-3), 0.125);
        assert!(power_of_two(-2000) > 0.0 && power_of_two(1024) == f64::INFINITY);
    }
}
