//! Certified signs of expressions, from rational bounds of polynomials in parameters with declared ranges, or from
//! enclosures.

use dalembert_expr::{ExprId, Node, Rational, SymbolId};

use super::regularity::domain;
use crate::model::{Assumption, Model};

/// Largest exponent of a power whose bounds are computed.
const LARGEST: i64 = 16;

/// True if a function is certified to be non-negative at all states: by its form, by bounds, or by an enclosure.
pub(super) fn is_never_negative(model: &Model, value: ExprId) -> bool {
    if model.pool.sign(value).is_nonnegative() {
        return true;
    }
    let is_above = bounds(model, value).is_some_and(|[low, _]| low >= Rational::ZERO);
    let ranges = || {
        let order = model.pool.reachable(&[value]);
        model.pool.enclose(&order, &domain(model, value))
    };
    is_above || ranges()[value.index()].is_some_and(|range| range.lo >= 0.0)
}

/// Lower and upper bound of the values. `None` if the expression is no polynomial in parameters with declared ranges,
/// or if it contains a power above [`LARGEST`].
fn bounds(model: &Model, id: ExprId) -> Option<[Rational; 2]> {
    match model.pool.node(id) {
        Node::Number(value) => Some([value.clone(), value.clone()]),
        Node::Symbol(symbol) => of_parameter(model, *symbol),
        Node::Sum { constant, terms } => {
            let mut sum = [constant.clone(), constant.clone()];
            for (factor, term) in terms {
                let [low, high] = bounds(model, *term)?.map(|end| &end * factor);
                let [low, high] = if low <= high {
                    [low, high]
                } else {
                    [high, low]
                };
                sum = [&sum[0] + &low, &sum[1] + &high];
            }
            Some(sum)
        }
        Node::Product(factors) => {
            let mut product = [Rational::ONE, Rational::ONE];
            for (base, exponent) in factors {
                let exponent = exponent
                    .to_i64()
                    .filter(|power| (1..=LARGEST).contains(power))?;
                product = times(&product, &power(&bounds(model, *base)?, exponent));
            }
            Some(product)
        }
        _ => None,
    }
}

fn of_parameter(model: &Model, symbol: SymbolId) -> Option<[Rational; 2]> {
    let found = model
        .parameters
        .iter()
        .find(|parameter| parameter.symbol == symbol)?;
    match &found.assumption {
        Assumption::Within { low, high } => Some([low.clone(), high.clone()]),
        _ => None,
    }
}

fn times(a: &[Rational; 2], b: &[Rational; 2]) -> [Rational; 2] {
    let products = a.iter().flat_map(|x| b.iter().map(move |y| x * y));
    let mut products: Vec<Rational> = products.collect();
    products.sort();
    [products[0].clone(), products[3].clone()]
}

fn power(base: &[Rational; 2], exponent: i64) -> [Rational; 2] {
    let [low, high] = base
        .clone()
        .map(|end| (0..exponent).fold(Rational::ONE, |product, _| &product * &end));
    let is_around_zero = base[0] < Rational::ZERO && base[1] > Rational::ZERO;
    match (exponent % 2, low <= high) {
        (0, true) if is_around_zero => [Rational::ZERO, high],
        (0, false) if is_around_zero => [Rational::ZERO, low],
        (_, true) => [low, high],
        (_, false) => [high, low],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_exact() {
        let declaration =
            "pub P { coordinates { x; } parameters { c in [0, 1]; k in [-2, 1]; m > 0; }
            lagrangian = dot(x)^2/2 - x*c*k*m; }";
        let (mut model, _) = crate::claims::derived(declaration);
        let symbols: Vec<SymbolId> = model
            .parameters
            .iter()
            .map(|parameter| parameter.symbol)
            .collect();
        let [c, k, m] = [0, 1, 2].map(|i| model.pool.variable(symbols[i]));
        let square = |model: &mut Model, id| model.pool.pow(id, Rational::from(2));
        let [c2, k2] = [c, k].map(|id| square(&mut model, id));
        let one = model.pool.one();
        let less = model.pool.sub(c2, one);
        let range = |low: i64, high: i64| Some([Rational::from(low), Rational::from(high)]);
        assert_eq!(bounds(&model, less), range(-1, 0));
        assert_eq!(bounds(&model, k2), range(0, 4));
        let product = model.pool.mul(c, k);
        assert_eq!(bounds(&model, product), range(-2, 1));
        assert_eq!(bounds(&model, m), None);
    }
}
