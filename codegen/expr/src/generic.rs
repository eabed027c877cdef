//! Expressions without what only keeps their domain: `0*x`, and `x^2*x^-1` for `x`.
//!
//! The result has the value of the expression wherever that has one, and may have one elsewhere: formulas for a reader, of almost all
//! states. Nothing that is emitted is made of it.

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
                    self.combine(&summands)
                }
                Node::Product(factors) => {
                    let mut powers: Vec<(ExprId, Rational)> = Vec::new();
                    for (base, exponent) in &factors {
                        let base = results.get(*base);
                        let merged = powers.iter_mut().find(|(known, power)| {
                            *known == base && power.is_integer() && exponent.is_integer()
                        });
                        match merged {
                            Some((_, power)) => *power = &*power + exponent,
                            None => powers.push((base, exponent.clone())),
                        }
                    }
                    powers.retain(|(_, exponent)| !exponent.is_zero());
                    self.power_product(&powers)
                }
                other => self.map_operands(other, |operand| results.get(operand)),
            };
            results.set(part, result);
        }
        results.get(id)
    }
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
