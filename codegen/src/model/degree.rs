//! The degree of an expression in some of its symbols, and the coefficients of linear expressions.

use dalembert_expr::{Assumption, ExprId, Node, Pool, Rational, SymbolId, Verdict};

/// An upper bound for the degree of `expr` as a polynomial in `symbols`, from its structure; `None` if it may not be a
/// polynomial. One pass over the shared nodes, operands first.
pub(super) fn degree_bound(pool: &Pool, expr: ExprId, symbols: &[SymbolId]) -> Option<u32> {
    let order = pool.reachable(&[expr]);
    let mut degrees: Vec<Option<u32>> = Vec::with_capacity(order.len());
    for id in &order {
        let degree = |operand: ExprId| {
            order
                .binary_search(&operand)
                .ok()
                .and_then(|index| degrees.get(index).copied().flatten())
        };
        let bound = node_degree(pool.node(*id), symbols, &degree);
        degrees.push(bound);
    }
    order
        .binary_search(&expr)
        .ok()
        .and_then(|index| degrees[index])
}

fn node_degree(
    node: &Node,
    symbols: &[SymbolId],
    degree: &dyn Fn(ExprId) -> Option<u32>,
) -> Option<u32> {
    match node {
        Node::Number(_) | Node::Pi => Some(0),
        Node::Symbol(symbol) => Some(u32::from(symbols.contains(symbol))),
        Node::Sum { terms, .. } => terms.iter().try_fold(0, |most, (_, term)| {
            degree(*term).map(|term| most.max(term))
        }),
        Node::Product(factors) => factors.iter().try_fold(0_u32, |sum, (base, exponent)| {
            let power = power_degree(degree(*base)?, exponent)?;
            sum.checked_add(power)
        }),
        Node::Call(_, argument) => degree(*argument).filter(|degree| *degree == 0),
        Node::Atan2(y, x) => degree(*y)
            .filter(|degree| *degree == 0)
            .and(degree(*x).filter(|degree| *degree == 0)),
    }
}

fn power_degree(base: u32, exponent: &Rational) -> Option<u32> {
    if base == 0 {
        return Some(0);
    }
    let exponent = exponent
        .to_i64()
        .and_then(|exponent| u32::try_from(exponent).ok())?;
    base.checked_mul(exponent)
}

/// True if `expr` is written as a polynomial in `symbols` and has at most this degree, by its structure or because its
/// derivative of order `degree + 1` along a general direction is zero. An expression that is not written as a
/// polynomial may have no value where the symbols are 0, and its coefficients cannot be computed there.
pub(super) fn has_degree(pool: &mut Pool, expr: ExprId, symbols: &[SymbolId], degree: u32) -> bool {
    match degree_bound(pool, expr, symbols) {
        None => return false,
        Some(bound) if bound <= degree => return true,
        Some(_) => {}
    }
    let mut directions = Vec::with_capacity(symbols.len());
    for symbol in symbols {
        let direction = pool.symbol("w", "w", Assumption::None);
        directions.push((*symbol, pool.variable(direction)));
    }
    let mut derivative = expr;
    for _ in 0..=degree {
        derivative = pool.derivative_along(derivative, &directions);
    }
    is_zero(pool, derivative)
}

/// True if an expression is proved to be zero.
pub(super) fn is_zero(pool: &Pool, expr: ExprId) -> bool {
    pool.is_syntactic_zero(expr) || pool.zero_test(expr) == Verdict::Proved
}

/// The number 0 for an expression that is proved to be zero and has a value everywhere, else the expression.
pub(super) fn without_hidden_zero(pool: &Pool, expr: ExprId) -> ExprId {
    if pool.is_finite(expr) && is_zero(pool, expr) {
        pool.zero()
    } else {
        expr
    }
}

/// True if an expression has a value wherever `others` have values: each of its subexpressions that may be undefined is
/// also a subexpression of `others`.
pub(super) fn is_defined_with(pool: &Pool, expr: ExprId, others: &[ExprId]) -> bool {
    let known = pool.reachable(others);
    let is_known = |id: &ExprId| known.binary_search(id).is_ok();
    let mut has_value: Vec<(ExprId, bool)> = Vec::new();
    for id in pool.reachable(&[expr]) {
        let of = |operand: &ExprId| {
            let position = has_value.binary_search_by_key(operand, |(id, _)| *id);
            position.is_ok_and(|position| has_value[position].1)
        };
        let is_sound = is_known(&id)
            || pool.is_finite(id)
            || match pool.node(id) {
                Node::Sum { terms, .. } => terms.iter().all(|(_, term)| of(term)),
                Node::Product(factors) => factors
                    .iter()
                    .all(|(base, power)| power.is_integer() && !power.is_negative() && of(base)),
                _ => false,
            };
        has_value.push((id, is_sound));
    }
    has_value.last().is_some_and(|(_, is_sound)| *is_sound)
}

/// `expr` with every one of `symbols` set to 0.
pub(super) fn at_zero(pool: &mut Pool, expr: ExprId, symbols: &[SymbolId]) -> ExprId {
    if !pool.depends_on_any(expr, symbols) {
        return expr;
    }
    let zero = pool.zero();
    let replacements: Vec<(SymbolId, ExprId)> =
        symbols.iter().map(|symbol| (*symbol, zero)).collect();
    pool.substitute(expr, &replacements)
}

/// The coefficients of `symbols` in an expression that is linear in them. Hidden zeros become the number 0.
pub(super) fn coefficients(pool: &mut Pool, expr: ExprId, symbols: &[SymbolId]) -> Vec<ExprId> {
    let derivatives: Vec<ExprId> = symbols
        .iter()
        .map(|symbol| pool.diff(expr, *symbol))
        .collect();
    derivatives
        .into_iter()
        .map(|coefficient| {
            let coefficient = at_zero(pool, coefficient, symbols);
            without_hidden_zero(pool, coefficient)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert_expr::Function;

    #[test]
    fn a_polynomial_in_disguise_is_recognised() {
        let mut pool = Pool::new();
        let symbol = pool.symbol("v", "v", Assumption::None);
        let v = pool.variable(symbol);
        let one = pool.one();
        let plus = pool.add(v, one);
        let cube = pool.pow(plus, Rational::from(3));
        let v_cubed = pool.pow(v, Rational::from(3));
        let quadratic = pool.sub(cube, v_cubed);
        assert_eq!(degree_bound(&pool, quadratic, &[symbol]), Some(3));
        assert!(has_degree(&mut pool, quadratic, &[symbol], 2));
        assert!(!has_degree(&mut pool, cube, &[symbol], 2));
    }

    #[test]
    fn a_quotient_is_no_polynomial() {
        let mut pool = Pool::new();
        let symbol = pool.symbol("v", "v", Assumption::None);
        let v = pool.variable(symbol);
        let v_cubed = pool.pow(v, Rational::from(3));
        let quotient = pool.div(v_cubed, v);
        assert_eq!(degree_bound(&pool, quotient, &[symbol]), None);
        assert!(!has_degree(&mut pool, quotient, &[symbol], 2));
    }

    #[test]
    fn a_hidden_zero_is_taken_for_the_number_where_it_has_a_value() {
        let mut pool = Pool::new();
        let symbol = pool.symbol("x", "x", Assumption::None);
        let x = pool.variable(symbol);
        let (sine, cosine) = (pool.call(Function::Sin, x), pool.call(Function::Cos, x));
        let two = Rational::from(2);
        let squares = [
            pool.pow(sine, two.clone()),
            pool.pow(cosine, two),
            pool.int(-1),
        ];
        let hidden = pool.sum(&squares);
        assert!(!pool.is_syntactic_zero(hidden));
        let zero = without_hidden_zero(&pool, hidden);
        assert!(pool.is_syntactic_zero(zero));
        let nowhere = pool.div(hidden, x);
        assert_eq!(without_hidden_zero(&pool, nowhere), nowhere);
        assert_eq!(without_hidden_zero(&pool, sine), sine);
    }
}
