//! Polynomials modulo a prime: interpolation of rational functions, greatest common divisors, roots.
//!
//! A polynomial is the list of its coefficients from the constant on. The last one is not 0; the polynomial 0 is empty.

use dalembert_expr::Modulus;

/// Coefficients from the constant on.
pub(super) type Polynomial = Vec<u64>;

fn trim(mut a: Polynomial) -> Polynomial {
    while a.last() == Some(&0) {
        a.pop();
    }
    a
}

fn sub(field: Modulus, a: &[u64], b: &[u64]) -> Polynomial {
    let at = |c: &[u64], i: usize| c.get(i).copied().unwrap_or(0);
    let length = a.len().max(b.len());
    trim((0..length).map(|i| field.sub(at(a, i), at(b, i))).collect())
}

fn mul(field: Modulus, a: &[u64], b: &[u64]) -> Polynomial {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let mut product = vec![0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] = field.add(product[i + j], field.mul(*a, *b));
        }
    }
    trim(product)
}

/// Quotient and remainder; `None` for the divisor 0.
fn divide(field: Modulus, a: &[u64], b: &[u64]) -> Option<(Polynomial, Polynomial)> {
    let (lead, degree) = (field.inv(*b.last()?)?, b.len() - 1);
    let mut rest = a.to_vec();
    let mut quotient = vec![0; a.len().saturating_sub(degree)];
    for shift in (0..quotient.len()).rev() {
        let factor = field.mul(lead, rest[shift + degree]);
        quotient[shift] = factor;
        for (i, b) in b.iter().enumerate() {
            rest[shift + i] = field.sub(rest[shift + i], field.mul(factor, *b));
        }
    }
    Some((trim(quotient), trim(rest)))
}

/// A greatest common divisor.
pub(super) fn common_divisor(field: Modulus, a: &[u64], b: &[u64]) -> Polynomial {
    let (mut a, mut b) = (a.to_vec(), b.to_vec());
    while let Some((_, rest)) = divide(field, &a, &b) {
        (a, b) = (b, rest);
    }
    a
}

/// Numerator and denominator of the rational function with these values at distinct points; `None` unless its degrees
/// leave `surplus` values as a check (Cauchy interpolation by Euclid's algorithm).
pub(super) fn rational_function(
    field: Modulus,
    values: &[(u64, u64)],
    surplus: usize,
) -> Option<(Polynomial, Polynomial)> {
    let mut whole = vec![1];
    let mut interpolant: Polynomial = Vec::new();
    for (x, y) in values {
        // The next coefficient of Newton's form.
        let missing = field.sub(*y, value(field, &interpolant, *x));
        let factor = field.mul(missing, field.inv(value(field, &whole, *x))?);
        let minus: Vec<u64> = whole
            .iter()
            .map(|coefficient| field.neg(field.mul(factor, *coefficient)))
            .collect();
        interpolant = sub(field, &interpolant, &minus);
        whole = mul(field, &whole, &[field.neg(*x), 1]);
    }
    // Remainders r with cofactors t: r = t * interpolant modulo `whole`.
    let (mut old, mut new) = ((whole, Vec::new()), (interpolant, vec![1]));
    loop {
        let unknowns = new.0.len() + new.1.len();
        if unknowns + surplus <= values.len() {
            return Some(new);
        }
        let (quotient, rest) = divide(field, &old.0, &new.0)?;
        let cofactor = sub(field, &old.1, &mul(field, &quotient, &new.1));
        (old, new) = (new, (rest, cofactor));
    }
}

/// The value of a polynomial.
pub(super) fn value(field: Modulus, a: &[u64], x: u64) -> u64 {
    a.iter().rev().fold(0, |sum, coefficient| {
        field.add(field.mul(sum, x), *coefficient)
    })
}

/// The distinct roots in the field, in increasing order.
pub(super) fn roots(field: Modulus, a: &[u64]) -> Vec<u64> {
    let mut roots = Vec::new();
    if a.len() > 1 {
        // x^p - x is the product of x - r over all elements r of the field.
        let power = power_modulo(field, &[0, 1], field.prime(), a);
        let difference = sub(field, &power, &[0, 1]);
        let split = match difference.is_empty() {
            true => a.to_vec(),
            false => common_divisor(field, a, &difference),
        };
        split_roots(field, &split, 0, &mut roots);
    }
    roots.sort_unstable();
    roots
}

/// The roots of a product of distinct linear factors. For about half of the shifts `c`, `x + c` is a square at some
/// roots and a non-square at others (Cantor and Zassenhaus).
fn split_roots(field: Modulus, a: &[u64], shift: u64, roots: &mut Vec<u64>) {
    match a {
        [] | [_] => {}
        [constant, slope] => {
            let inverse = field.inv(*slope);
            roots.extend(inverse.map(|inverse| field.neg(field.mul(inverse, *constant))));
        }
        _ => {
            let half = (field.prime() - 1) / 2;
            let power = power_modulo(field, &[shift, 1], half, a);
            let squares = common_divisor(field, a, &sub(field, &power, &[1]));
            match divide(field, a, &squares) {
                Some((rest, _)) if squares.len() > 1 && rest.len() > 1 => {
                    split_roots(field, &squares, shift + 1, roots);
                    split_roots(field, &rest, shift + 1, roots);
                }
                _ => split_roots(field, a, shift + 1, roots),
            }
        }
    }
}

/// `base^exponent` modulo a polynomial of positive degree.
fn power_modulo(field: Modulus, base: &[u64], mut exponent: u64, modulus: &[u64]) -> Polynomial {
    let reduce = |a: &[u64]| divide(field, a, modulus).map_or(Vec::new(), |(_, rest)| rest);
    let (mut square, mut result) = (reduce(base), vec![1]);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = reduce(&mul(field, &result, &square));
        }
        square = reduce(&mul(field, &square, &square));
        exponent >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: Modulus = Modulus::MERSENNE;

    /// The product of `x - root`.
    fn product(roots: &[i64]) -> Polynomial {
        roots.iter().fold(vec![1], |product, root| {
            mul(FIELD, &product, &[FIELD.integer(-root), 1])
        })
    }

    #[test]
    fn roots_are_found_each_once() {
        for expected in [vec![], vec![7], vec![0, 3], vec![1, 2, 3, 4, 5, 60]] {
            let found = roots(FIELD, &product(&expected));
            let expected: Vec<u64> = expected
                .iter()
                .map(|integer| FIELD.integer(*integer))
                .collect();
            assert_eq!(found, expected);
        }
        assert_eq!(roots(FIELD, &product(&[2, 2, 5])), [2, 5]);
        // -1 is no square.
        assert_eq!(roots(FIELD, &[1, 0, 1]), []);
        assert_eq!(roots(FIELD, &mul(FIELD, &[1, 0, 1], &product(&[9]))), [9]);
    }

    #[test]
    fn rational_functions_are_known_from_enough_values() {
        let (above, below) = (product(&[2, 5]), product(&[-1, 3, 8]));
        let values: Vec<(u64, u64)> = (10..30)
            .map(|x| {
                let inverse = FIELD.inv(value(FIELD, &below, x)).expect("no pole");
                (x, FIELD.mul(value(FIELD, &above, x), inverse))
            })
            .collect();
        // The numerator has three coefficients, the denominator four, and two values serve as a check.
        assert_eq!(rational_function(FIELD, &values[..8], 2), None);
        let (n, d) = rational_function(FIELD, &values[..9], 2).expect("a function");
        assert_eq!(roots(FIELD, &n), roots(FIELD, &above));
        assert_eq!(roots(FIELD, &d), roots(FIELD, &below));
        let zeros: Vec<_> = (1..6).map(|x| (x, 0)).collect();
        assert_eq!(rational_function(FIELD, &zeros, 2), Some((vec![], vec![1])));
    }

    #[test]
    fn common_divisors_have_the_common_roots() {
        let common = common_divisor(FIELD, &product(&[1, 4, 9]), &product(&[4, 9, 16]));
        assert_eq!(roots(FIELD, &common), [4, 9]);
        assert_eq!(
            common_divisor(FIELD, &product(&[1]), &product(&[2])).len(),
            1
        );
    }
}
