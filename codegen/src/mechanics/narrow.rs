//! Detection of rates with narrow features, which a step may pass over: bumps, needles and walls of functions that are
//! flat elsewhere. Sums, products, sines and cosines of steadily changing quantities change steadily themselves.
//! Exponentials, quotients and high powers need not.

use std::collections::HashMap;

use dalembert_expr::{ExprId, Function, Node, Pool, SymbolId};

/// Highest power of a quantity that changes about as steadily as the quantity. The 16th power of a sine is a bump a tenth
/// as long as its period.
const MOST_POWER: i64 = 8;

/// True unless the expressions consist of polynomials of low degree, sines and cosines of the varying symbols.
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
    let mut reachable = pool.reachable(expressions);
    reachable.reverse();
    reachable.iter().any(is_narrow) || has_high_power(pool, &reachable, varying)
}

/// True if a varying quantity is raised to a high power, in one step or in several. The expressions come after their operands.
fn has_high_power(pool: &Pool, expressions: &[ExprId], varying: &[SymbolId]) -> bool {
    let mut powers: HashMap<ExprId, i64> = HashMap::new();
    expressions.iter().any(|&id| {
        let of = |operand: ExprId| powers.get(&operand).copied().unwrap_or(0);
        let power = match pool.node(id) {
            Node::Number(_) | Node::Pi => 0,
            Node::Symbol(symbol) => i64::from(varying.contains(symbol)),
            Node::Product(factors) => {
                let raised = factors.iter().map(|(base, exponent)| {
                    of(*base).saturating_mul(exponent.to_i64().unwrap_or(1))
                });
                raised.max().unwrap_or(0)
            }
            Node::Call(..) | Node::Atan2(..) => {
                let mut varies = false;
                pool.node(id)
                    .for_each_operand(|operand| varies |= of(operand) > 0);
                i64::from(varies)
            }
            Node::Sum { .. } => {
                let mut highest = 0;
                pool.node(id)
                    .for_each_operand(|operand| highest = highest.max(of(operand)));
                highest
            }
        };
        powers.insert(id, power);
        power > MOST_POWER
    })
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
        let wall = pool.pow(along, Rational::from(9));
        let one = pool.number(Rational::ONE);
        let raised = pool.add(one, sine);
        let third = pool.pow(raised, Rational::from(3));
        let sum = pool.add(one, third);
        let ninth = pool.pow(sum, Rational::from(3));
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
            (ninth, true),
            (of_constant, false),
        ] {
            assert_eq!(can_be_narrow(&pool, &[id], &[x]), expected);
        }
    }
}
