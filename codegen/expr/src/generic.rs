//! Simplification that drops parts which only restrict the domain: the term `0*x` is left out, and `x^2*x^-1` becomes
//! `x`.
//!
//! The result equals the expression wherever the expression has a value, and may have a value elsewhere. It serves
//! printed formulas, which hold at almost all states. Emitted code never uses it.

use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::subst::Rebuilt;

impl Pool {
    /// The expression with terms times 0 left out and integer powers of one base merged.
    pub fn generic(&mut self, id: ExprId) -> ExprId {
        let parts = self.reachable(&[id]);
        let mut results = Rebuilt::new(parts.last());
        for part in parts {
            let result = match self.node(part).clone() {
                Node::Sum { constant, terms } => {
                    let kept = terms
                        .iter()
                        .filter(|(coefficient, _)| !coefficient.is_zero());
                    let mut summands: Vec<_> = kept
                        .map(|(coefficient, term)| (coefficient.clone(), results.get(*term)))
                        .collect();
                    summands.push((Rational::ONE, self.number(constant)));
                    self.over_denominators(&summands)
                }
                Node::Product(factors) => {
                    let factors = factors.iter();
                    let powers: Vec<(ExprId, Rational)> = factors
                        .map(|(base, exponent)| (results.get(*base), exponent.clone()))
                        .collect();
                    let product = self.power_product(&merged(&powers));
                    self.without_guards(product)
                }
                other => self.map_operands(other, |operand| results.get(operand)),
            };
            results.set(part, result);
        }
        results.get(id)
    }

    /// The sum of `summands`. If terms over one denominator add up to a multiple of one of its factors, that factor is
    /// cancelled.
    fn over_denominators(&mut self, summands: &[(Rational, ExprId)]) -> ExprId {
        let mut terms = Vec::new();
        let mut groups: Vec<(Factors, Vec<(Rational, ExprId)>)> = Vec::new();
        for (coefficient, term) in summands {
            let (below, above) = match self.node(*term) {
                Node::Product(factors) => (factors.iter().cloned())
                    .partition(|(_, exponent)| exponent.is_negative() && exponent.is_integer()),
                _ => (Vec::new(), vec![(*term, Rational::ONE)]),
            };
            if below.is_empty() {
                terms.push((coefficient.clone(), *term));
                continue;
            }
            let above = (coefficient.clone(), self.power_product(&above));
            match groups.iter_mut().find(|(known, _)| *known == below) {
                Some((_, numerator)) => numerator.push(above),
                None => groups.push((below, vec![above])),
            }
        }
        for (below, numerator) in groups {
            let whole = self.combine(&numerator);
            let (coefficient, factor) = self.as_multiple(whole);
            match below.iter().any(|(base, _)| *base == factor) {
                true => {
                    let factors = [&*below, &[(factor, Rational::ONE)]].concat();
                    terms.push((coefficient, self.power_product(&merged(&factors))));
                }
                false => {
                    let below = self.power_product(&below);
                    for (coefficient, above) in numerator {
                        terms.push((coefficient, self.mul(above, below)));
                    }
                }
            }
        }
        self.combine(&terms)
    }

    /// The expression with factors of one base merged. Its factors may have been products that share bases.
    fn without_guards(&mut self, mut id: ExprId) -> ExprId {
        loop {
            let (coefficient, term) = self.as_multiple(id);
            let Node::Product(factors) = self.node(term) else {
                return id;
            };
            let powers = merged(factors);
            if powers.len() == factors.len() {
                return id;
            }
            let product = self.power_product(&powers);
            id = self.scale(&coefficient, product);
        }
    }
}

/// Bases and exponents.
type Factors = Vec<(ExprId, Rational)>;

/// The factors with integer powers of one base merged.
fn merged(factors: &[(ExprId, Rational)]) -> Factors {
    let mut powers = Factors::new();
    for (base, exponent) in factors {
        let known = powers
            .iter_mut()
            .find(|(known, power)| known == base && power.is_integer() && exponent.is_integer());
        match known {
            Some((_, power)) => *power = &*power + exponent,
            None => powers.push((*base, exponent.clone())),
        }
    }
    powers.retain(|(_, exponent)| !exponent.is_zero());
    powers
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn what_keeps_the_domain_is_left_out() {
        let mut fixture = Fixture::new();
        let cases = [
            ("x/x", "1"),
            ("y + 1/x - 1/x", "y"),
            ("x^2*sin(y)/sin(y)/x", "x"),
            ("cos(y*x/x)^2/cos(y)", "cos(y)"),
            ("2*x*(x + y)/(x*(x + y))^1", "2"),
            ("x/(x + 2*y) + 2*y/(x + 2*y) + 1/x", "1 + 1/x"),
            (
                "3*x^2/(x + 2*y)^2 + 6*x*y/(x + 2*y)^2",
                "3*x^2/(x + 2*y)^2 + 6*x*y/(x + 2*y)^2",
            ),
            ("1/x + 1/y", "1/x + 1/y"),
        ];
        for (written, expected) in cases {
            let [id, expected] = fixture.read_all([written, expected]);
            assert_eq!(fixture.pool.generic(id), expected, "{written}");
        }
        let [kept, plain] = fixture.read_all(["x/x", "1"]);
        assert_ne!(kept, plain, "the constructors keep the domain");
    }
}
