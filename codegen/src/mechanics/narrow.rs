//! Detection of rates with narrow features, which a step may pass over: bumps, needles and walls of functions that are
//! flat elsewhere. Sums, products, sines and cosines of steadily changing quantities change steadily themselves.
//! Exponentials, quotients and powers need not.

use dalembert_expr::{ExprId, Function, Node, Pool, SymbolId};

/// True unless the expressions consist of polynomials, sines and cosines of the varying symbols.
pub(super) fn can_be_narrow(pool: &Pool, expressions: &[ExprId], varying: &[SymbolId]) -> bool {
    let varies = |id: ExprId| pool.depends_on_any(id, varying);
    let is_narrow = |id: &ExprId| match pool.node(*id) {
        Node::Call(Function::Sin | Function::Cos, _) => false,
        Node::Call(_, argument) => varies(*argument),
        Node::Atan2(y, x) => varies(*y) || varies(*x),
        Node::Product(factors) => factors.iter().any(|(base, exponent)| {
            (exponent.is_negative() || exponent.to_i64().is_none()) && varies(*base)
        }),
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => false,
    };
    pool.reachable(expressions).iter().any(is_narrow)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert_expr::{Assumption, Rational};

    #[test]
    fn functions_that_are_flat_elsewhere_are_told_from_others() {
        let mut pool = Pool::new();
        let [x, k] = ["x", "k"].map(|name| pool.symbol(name, name, Assumption::None));
        let [along, constant] = [x, k].map(|symbol| pool.variable(symbol));
        let square = pool.pow(along, Rational::from(2));
        let sine = pool.call(Function::Sin, along);
        let bump = pool.call(Function::Exp, square);
        let fixed = pool.call(Function::Exp, constant);
        let quotient = pool.div(constant, along);
        let root = pool.pow(square, Rational::HALF);
        for (id, expected) in [
            (square, false),
            (sine, false),
            (fixed, false),
            (bump, true),
            (quotient, true),
            (root, true),
        ] {
            assert_eq!(can_be_narrow(&pool, &[id], &[x]), expected);
        }
    }
}
