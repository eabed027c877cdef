//! Factors that several expressions have in common.

use dalembert_expr::{ExprId, Node, Pool, Rational};

/// A sum as the product of the common factor of its terms and the rest.
pub(super) fn factored(pool: &mut Pool, sum: ExprId) -> ExprId {
    let (constant, terms) = pool.linear_form(sum);
    if !constant.is_zero() || terms.len() < 2 {
        return sum;
    }
    let expressions: Vec<ExprId> = terms.iter().map(|(_, term)| *term).collect();
    let (common, rest) = without_common_factor(pool, &expressions);
    let coefficients = terms.into_iter().map(|(coefficient, _)| coefficient);
    let rest: Vec<(Rational, ExprId)> = coefficients.zip(rest).collect();
    let rest = pool.combine(&rest);
    pool.mul(common, rest)
}

/// The product of the positive integer powers that divide all nonzero entries, and the entries divided by it.
pub(super) fn without_common_factor(pool: &mut Pool, vector: &[ExprId]) -> (ExprId, Vec<ExprId>) {
    let mut common: Option<Factors> = None;
    for &entry in vector
        .iter()
        .filter(|&&entry| !pool.is_syntactic_zero(entry))
    {
        let (_, powers) = factors(pool, entry);
        common = Some(match common {
            None => whole_powers(powers),
            Some(known) => shared(&known, &powers),
        });
    }
    let common = common.unwrap_or_default();
    let rest = vector
        .iter()
        .map(|&entry| divided(pool, entry, &common))
        .collect();
    (pool.power_product(&common), rest)
}

/// The entries divided by those of their common factors that are never zero. If the coefficients of all nonzero entries
/// have the same absolute value, the entries are also divided by the first of these coefficients.
pub(super) fn without_regular_factor(pool: &mut Pool, vector: &[ExprId]) -> Vec<ExprId> {
    let (common, entries) = without_common_factor(pool, vector);
    let singular = match pool.node(common) {
        Node::Product(factors) => factors.to_vec(),
        _ => vec![(common, Rational::ONE)],
    };
    let singular: Factors = singular
        .into_iter()
        .filter(|(base, _)| !pool.sign(*base).is_nonzero())
        .collect();
    let kept = pool.power_product(&singular);
    let first = entries
        .iter()
        .find(|&&entry| !pool.is_syntactic_zero(entry));
    let number = first.map_or(Rational::ONE, |&entry| factors(pool, entry).0);
    let alike = |&entry: &ExprId| {
        pool.is_syntactic_zero(entry) || factors(pool, entry).0.abs() == number.abs()
    };
    let scale = match entries.iter().all(alike) {
        true => number.recip().unwrap_or(Rational::ONE),
        false => Rational::ONE,
    };
    entries
        .into_iter()
        .map(|entry| {
            let entry = pool.mul(kept, entry);
            pool.scale(&scale, entry)
        })
        .collect()
}

/// Bases with their exponents.
type Factors = Vec<(ExprId, Rational)>;

/// Coefficient and factors.
fn factors(pool: &Pool, entry: ExprId) -> (Rational, Factors) {
    if let Some(number) = pool.as_number(entry) {
        return (number.clone(), Vec::new());
    }
    let (coefficient, term) = pool.as_multiple(entry);
    let factors = match pool.node(term) {
        Node::Product(factors) => factors.to_vec(),
        _ => vec![(term, Rational::ONE)],
    };
    (coefficient, factors)
}

fn whole_powers(mut factors: Factors) -> Factors {
    factors.retain(|(_, exponent)| exponent.is_integer() && exponent.is_positive());
    factors
}

fn shared(known: &Factors, entry: &Factors) -> Factors {
    let in_both = known.iter().filter_map(|(base, exponent)| {
        let has_it =
            |(other, exponent): &&(ExprId, Rational)| other == base && exponent.is_positive();
        let (_, other) = entry.iter().find(has_it)?;
        Some((*base, exponent.clone().min(other.clone())))
    });
    whole_powers(in_both.collect())
}

/// An entry divided by some of its factors.
fn divided(pool: &mut Pool, entry: ExprId, common: &Factors) -> ExprId {
    if pool.is_syntactic_zero(entry) {
        return entry;
    }
    let (coefficient, mut powers) = factors(pool, entry);
    for (base, exponent) in common {
        let has_it = |(other, left): &&mut (ExprId, Rational)| other == base && left.is_positive();
        if let Some((_, left)) = powers.iter_mut().find(has_it) {
            *left = left.clone() - exponent.clone();
        }
    }
    powers.retain(|(_, exponent)| !exponent.is_zero());
    let rest = pool.power_product(&powers);
    pool.scale(&coefficient, rest)
}

#[cfg(test)]
mod tests {
    use dalembert_expr::Assumption;

    use super::*;

    #[test]
    fn common_powers_are_taken_out_and_put_back_exactly() {
        let mut pool = Pool::new();
        let [r, x, y] = ["r", "x", "y"].map(|name| {
            let assumption = match name {
                "r" => Assumption::Positive,
                _ => Assumption::None,
            };
            let symbol = pool.symbol(name, name, assumption);
            pool.variable(symbol)
        });
        let two = pool.int(-2);
        let vector = [
            pool.product(&[two, r, r, x, x]),
            pool.zero(),
            pool.product(&[two, r, x, y]),
        ];
        let (common, rest) = without_common_factor(&mut pool, &vector);
        assert_eq!(pool.text(common), "r*x");
        for (&rest, entry) in rest.iter().zip(vector) {
            assert_eq!(pool.mul(common, rest), entry);
        }
        // `x` may be 0: a vector without it would not vanish there.
        let regular = without_regular_factor(&mut pool, &vector);
        let texts: Vec<String> = regular.iter().map(|&entry| pool.text(entry)).collect();
        assert_eq!(texts, ["r*x^2", "0", "x*y"]);
        // A number has no factor in common with `y/2`.
        let (minus, half) = (pool.int(-1), pool.scale(&Rational::HALF, y));
        assert_eq!(
            without_common_factor(&mut pool, &[minus, half]).1,
            [minus, half]
        );
        assert_eq!(
            without_regular_factor(&mut pool, &[minus, half]),
            [minus, half]
        );
        let (first, second) = (pool.mul(r, x), pool.mul(r, y));
        let sum = pool.add(first, second);
        let product = factored(&mut pool, sum);
        assert_eq!(pool.text(product), "r*(x + y)");
    }
}
