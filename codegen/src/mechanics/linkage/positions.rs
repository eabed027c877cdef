//! Positions that belong to derived velocities: a sum of angles, whose rate is the sum of their rates.

use dalembert_expr::{Assumption, ExprId, Node, Pool, Rational, SymbolId};

use super::read::Form;

/// A sum of coordinates with constant coefficients, and the symbol that stands for it.
pub(super) struct Position {
    terms: Vec<(SymbolId, Rational)>,
    /// The symbol of its value.
    pub symbol: SymbolId,
}

impl Position {
    /// The position whose rate is a derived velocity; `None` if the coefficients of the velocity are not constant.
    pub fn of(pool: &mut Pool, q: &[SymbolId], velocity: &Form, number: usize) -> Option<Self> {
        let terms: Option<Vec<(SymbolId, Rational)>> = velocity
            .iter()
            .map(|(&i, &factor)| Some((q[i], pool.as_number(factor)?.clone())))
            .collect();
        let mut terms = terms?;
        terms.sort_by_key(|(symbol, _)| *symbol);
        let name = format!("position_{number}");
        let symbol = pool.symbol(&name, &name, Assumption::None);
        Some(Self { terms, symbol })
    }
}

/// The expressions with the symbols of positions in place of their sums.
pub(super) fn name_positions(
    pool: &mut Pool,
    q: &[SymbolId],
    positions: &[Position],
    expressions: &[ExprId],
) -> Vec<ExprId> {
    let mut replacements = Vec::new();
    for id in pool.reachable(expressions) {
        if let Some(named) = named_sum(pool, q, positions, id) {
            replacements.push((id, named));
        }
    }
    pool.replace_all(expressions, &replacements)
}

/// A sum with a position in place of its coordinates, if these are the terms of a position.
fn named_sum(
    pool: &mut Pool,
    q: &[SymbolId],
    positions: &[Position],
    id: ExprId,
) -> Option<ExprId> {
    let Node::Sum { constant, terms } = pool.node(id).clone() else {
        return None;
    };
    let mut coordinates = Vec::new();
    let mut others = vec![(Rational::ONE, pool.number(constant))];
    for (coefficient, term) in terms {
        match pool.node(term) {
            Node::Symbol(symbol) if q.contains(symbol) => coordinates.push((*symbol, coefficient)),
            _ => others.push((coefficient, term)),
        }
    }
    coordinates.sort_by_key(|(symbol, _)| *symbol);
    let position = positions
        .iter()
        .find(|position| position.terms == coordinates)?;
    others.push((Rational::ONE, pool.variable(position.symbol)));
    Some(pool.combine(&others))
}
