//! Simultaneous substitution of expressions for symbols.

use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;

impl Pool {
    /// Replaces every symbol of `replacements` in an expression, all simultaneously.
    ///
    /// If a symbol occurs twice in `replacements`, its first entry is used.
    pub fn substitute(&mut self, id: ExprId, replacements: &[(SymbolId, ExprId)]) -> ExprId {
        self.substitute_all(&[id], replacements)[0]
    }

    /// Same as [`Pool::substitute`] for several expressions. Shared subexpressions are processed once.
    pub fn substitute_all(
        &mut self,
        roots: &[ExprId],
        replacements: &[(SymbolId, ExprId)],
    ) -> Vec<ExprId> {
        let symbols: Vec<_> = replacements.iter().map(|(symbol, _)| *symbol).collect();
        let affected = self.reachable_where(roots, |id| self.depends_on_any(id, &symbols));
        let mut results = Rebuilt::new(affected.last());
        for id in affected {
            let node = self.node(id).clone();
            let result = self.rebuild(node, replacements, |operand| results.get(operand));
            results.set(id, result);
        }
        roots.iter().map(|root| results.get(*root)).collect()
    }

    /// Replaces whole expressions: wherever one of `replacements` occurs as an operand of `roots`, or as a root, the
    /// expression beside it stands instead. A sum that was merged into another sum is no operand of it.
    pub fn replace_all(
        &mut self,
        roots: &[ExprId],
        replacements: &[(ExprId, ExprId)],
    ) -> Vec<ExprId> {
        let reached = self.reachable(roots);
        let mut results = Rebuilt::new(reached.last());
        for id in reached {
            let result = match replacements.iter().find(|(from, _)| *from == id) {
                Some((_, to)) => *to,
                None => {
                    let mut is_affected = false;
                    let node = self.node(id).clone();
                    node.for_each_operand(|operand| is_affected |= results.get(operand) != operand);
                    match is_affected {
                        true => self.map_operands(node, |operand| results.get(operand)),
                        false => id,
                    }
                }
            };
            results.set(id, result);
        }
        roots.iter().map(|root| results.get(*root)).collect()
    }

    /// Copies expressions of the pool `from` into this pool. `replacements` maps symbols of `from` to expressions of
    /// this pool. `None` if it lacks a symbol that occurs in `roots`.
    pub fn import(
        &mut self,
        from: &Pool,
        roots: &[ExprId],
        replacements: &[(SymbolId, ExprId)],
    ) -> Option<Vec<ExprId>> {
        let order = from.reachable(roots);
        let mut results = Rebuilt::new(order.last());
        for id in order {
            let result = match from.node(id).clone() {
                Node::Symbol(symbol) => {
                    let found = replacements.iter().find(|(key, _)| *key == symbol);
                    found.map(|(_, replacement)| *replacement)?
                }
                other => self.map_operands(other, |operand| results.get(operand)),
            };
            results.set(id, result);
        }
        Some(roots.iter().map(|root| results.get(*root)).collect())
    }

    /// Rebuilds a node that depends on a replaced symbol, with its operands mapped by `map`.
    fn rebuild(
        &mut self,
        node: Node,
        replacements: &[(SymbolId, ExprId)],
        map: impl Fn(ExprId) -> ExprId,
    ) -> ExprId {
        match node {
            Node::Symbol(symbol) => match replacements.iter().find(|(key, _)| *key == symbol) {
                Some((_, replacement)) => *replacement,
                None => self.variable(symbol),
            },
            other => self.map_operands(other, map),
        }
    }

    /// Rebuilds a node from mapped operands, by the constructors of the pool.
    pub(crate) fn map_operands(&mut self, node: Node, map: impl Fn(ExprId) -> ExprId) -> ExprId {
        match node {
            Node::Number(value) => self.number(value),
            Node::Pi => self.pi(),
            Node::Symbol(symbol) => self.variable(symbol),
            Node::Sum { constant, terms } => {
                let constant = self.number(constant);
                let mut summands: Vec<_> = terms
                    .iter()
                    .map(|(c, term)| (c.clone(), map(*term)))
                    .collect();
                summands.push((crate::Rational::ONE, constant));
                self.combine(&summands)
            }
            Node::Product(factors) => {
                let powers: Vec<_> = factors
                    .iter()
                    .map(|(base, e)| (map(*base), e.clone()))
                    .collect();
                self.power_product(&powers)
            }
            Node::Call(function, argument) => self.call(function, map(argument)),
            Node::Atan2(y, x) => self.atan2(map(y), map(x)),
        }
    }
}

/// A map from expressions to rebuilt expressions. Entries that were not set map to themselves.
pub(crate) struct Rebuilt(Vec<u32>);

impl Rebuilt {
    /// The identity, for ids up to `last`.
    pub(crate) fn new(last: Option<&ExprId>) -> Self {
        Self(vec![0; last.map_or(0, |id| id.index() + 1)])
    }

    pub(crate) fn set(&mut self, id: ExprId, result: ExprId) {
        self.0[id.index()] = result.index() as u32 + 1;
    }

    pub(crate) fn get(&self, id: ExprId) -> ExprId {
        match self.0.get(id.index()) {
            None | Some(0) => id,
            Some(position) => ExprId::from_index(*position as usize - 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn substitution_is_simultaneous() {
        let mut fixture = Fixture::new();
        let [id, x, y, expected] = fixture.read_all(["x^2 + sin(y)", "x", "y", "y^2 + sin(x)"]);
        let swap = [(fixture.symbol("x"), y), (fixture.symbol("y"), x)];
        assert_eq!(fixture.pool.substitute(id, &swap), expected);
    }

    #[test]
    fn whole_expressions_are_replaced() {
        let mut fixture = Fixture::new();
        let [id, sum, by, expected] = fixture.read_all([
            "cos(x + y)*x + (x + y)^2 + 3*sin(x + y + m)",
            "x + y",
            "m",
            "cos(m)*x + m^2 + 3*sin(x + y + m)",
        ]);
        assert_eq!(
            fixture.pool.replace_all(&[id, sum], &[(sum, by)]),
            [expected, by]
        );
    }

    #[test]
    fn expressions_of_another_pool_are_built_anew() {
        let mut other = Fixture::new();
        let [_, id] = other.read_all(["x + 7*y", "x^2*cos(y)/3 + sin(x)"]);
        let symbols = ["x", "y"].map(|name| other.symbol(name));
        let mut fixture = Fixture::new();
        let [angle, y, expected] =
            fixture.read_all(["m + 2", "y", "(m + 2)^2*cos(y)/3 + sin(m + 2)"]);
        let replacements = [(symbols[0], angle), (symbols[1], y)];
        let found = fixture.pool.import(&other.pool, &[id], &replacements);
        assert_eq!(found, Some(vec![expected]));
        assert_eq!(
            fixture.pool.import(&other.pool, &[id], &replacements[..1]),
            None
        );
    }

    #[test]
    fn substitution_builds_with_the_constructors() {
        let mut fixture = Fixture::new();
        let [id, zero, one] = fixture.read_all(["cos(x)*y + x/m", "0", "1"]);
        let values = [(fixture.symbol("x"), zero), (fixture.symbol("y"), one)];
        assert_eq!(fixture.pool.substitute(id, &values), one);
    }
}
