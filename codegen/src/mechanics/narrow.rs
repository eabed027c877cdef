//! Detection of rates with narrow features, which a step may pass over: bumps, needles and walls of functions that are
//! flat elsewhere. Sums, products, sines and cosines of steadily changing quantities change steadily themselves.
//! Exponentials, quotients and long products need not.

use dalembert_expr::{ExprId, Function, Node, Pool, SymbolId};

/// Highest degree of a product that changes about as steadily as its factors. The 16th power of a sine has bumps that
/// are a tenth as long as the period of the sine.
const MOST_FACTORS: i64 = 12;

/// True unless the expressions consist of sums, products of low degree, sines and cosines of the varying symbols.
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
    let reachable = pool.reachable(expressions);
    reachable.iter().any(is_narrow) || has_long_product(pool, &reachable, varying)
}

/// True if some product has many varying factors, powers counted. The expressions come after their operands.
fn has_long_product(pool: &Pool, expressions: &[ExprId], varying: &[SymbolId]) -> bool {
    let most = expressions.iter().map(|id| id.index()).max();
    let mut degrees = vec![0_i64; most.map_or(0, |most| most + 1)];
    expressions.iter().any(|&id| {
        let of = |operand: ExprId| degrees[operand.index()];
        let mut highest = 0;
        let node = pool.node(id);
        node.for_each_operand(|operand| highest = highest.max(of(operand)));
        let degree = match node {
            Node::Number(_) | Node::Pi => 0,
            Node::Symbol(symbol) => i64::from(varying.contains(symbol)),
            Node::Product(factors) => factors.iter().fold(0, |degree: i64, (base, exponent)| {
                let factor = of(*base).saturating_mul(exponent.to_i64().unwrap_or(1));
                degree.saturating_add(factor)
            }),
            Node::Call(..) | Node::Atan2(..) => highest.min(1),
            Node::Sum { .. } => highest,
        };
        degrees[id.index()] = degree;
        degree > MOST_FACTORS
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert_expr::{Assumption, Rational};

    #[test]
    fn functions_that_are_flat_elsewhere_are_recognised() {
        let mut pool = Pool::new();
        let [x, k] = ["x", "k"].map(|name| pool.symbol(name, name, Assumption::None));
        let [along, constant] = [x, k].map(|symbol| pool.variable(symbol));
        let square = pool.pow(along, Rational::from(2));
        let sine = pool.call(Function::Sin, along);
        let bump = pool.call(Function::Exp, square);
        let fixed = pool.call(Function::Exp, constant);
        let quotient = pool.div(constant, along);
        let root = pool.pow(square, Rational::HALF);
        let wall = pool.pow(along, Rational::from(13));
        let one = pool.number(Rational::ONE);
        let raised = pool.add(one, sine);
        let third = pool.pow(raised, Rational::from(3));
        let sum = pool.add(one, third);
        let nested = pool.pow(sum, Rational::from(5));
        let seventh = pool.pow(raised, Rational::from(7));
        let other = pool.pow(sum, Rational::from(2));
        let product = pool.mul(seventh, other);
        let of_constant = pool.pow(constant, Rational::from(40));
        for (id, expected) in [
            (square, false),
            (sine, false),
            (fixed, false),
            (bump, true),
            (quotient, true),
            (root, true),
            (wall, true),
            (third, false),
            (nested, true),
            (seventh, false),
            (product, true),
            (of_constant, false),
        ] {
            let found = can_be_narrow(&pool, &[id], &[x]);
            assert_eq!(found, expected, "{:?}", pool.node(id));
        }
    }
}
