//! Expansion of products of sums, for presentation. [`Pool::simplify`] then collects and cancels terms.

use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::subst::Rebuilt;

/// Largest number of terms of an expanded product. Products with more terms are not expanded.
const MAX_TERMS: usize = 256;

impl Pool {
    /// Expands products and positive integer powers of sums, also inside functions and divisors. Products that would
    /// have too many terms are not expanded.
    pub fn multiply_out(&mut self, id: ExprId) -> ExprId {
        let mut results = Rebuilt::new(Some(&id));
        for part in self.reachable(&[id]) {
            let node = self.node(part).clone();
            let rebuilt = self.map_operands(node, |operand| results.get(operand));
            let expanded = self.distribute(rebuilt);
            results.set(part, expanded);
        }
        results.get(id)
    }

    /// Expands one product. Its operands are already expanded.
    fn distribute(&mut self, id: ExprId) -> ExprId {
        let (coefficient, product) = self.as_multiple(id);
        let Node::Product(factors) = self.node(product).clone() else {
            return id;
        };
        let mut rest = Vec::new();
        let mut terms = vec![(coefficient, self.one())];
        for (base, exponent) in factors.iter() {
            match (self.node(*base), exponent.to_small()) {
                (Node::Sum { .. }, Some((power @ 1.., 1))) => {
                    for _ in 0..power {
                        let Some(product) = self.multiplied(&terms, *base) else {
                            return id;
                        };
                        terms = product;
                    }
                }
                _ => rest.push((*base, exponent.clone())),
            }
        }
        let rest = self.power_product(&rest);
        for (_, term) in &mut terms {
            *term = self.mul(*term, rest);
        }
        self.combine(&terms)
    }

    /// Products of `terms` with the terms of a sum; `None` if there are too many.
    fn multiplied(
        &mut self,
        terms: &[(Rational, ExprId)],
        sum: ExprId,
    ) -> Option<Vec<(Rational, ExprId)>> {
        let (constant, mut summands) = self.linear_form(sum);
        if !constant.is_zero() {
            summands.push((constant, self.one()));
        }
        if terms.len() * summands.len() > MAX_TERMS {
            return None;
        }
        let mut product = Vec::new();
        for (c, term) in terms {
            for (d, summand) in &summands {
                product.push((c * d, self.mul(*term, *summand)));
            }
        }
        Some(product)
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn sums_are_multiplied_out() {
        let mut fixture = Fixture::new();
        for (written, expected) in [
            ("(x + y)*(x - y)", "x^2 - y^2"),
            ("2*(x + 1)^2*m", "2*m*x^2 + 4*m*x + 2*m"),
            ("sin((x + y)*m)", "sin(m*x + m*y)"),
            ("1/((x + y)*m)", "1/((x + y)*m)"),
        ] {
            let [id, expected] = fixture.read_all([written, expected]);
            assert_eq!(fixture.pool.multiply_out(id), expected, "{written}");
        }
    }

    #[test]
    fn what_cancels_after_expansion_is_gone() {
        let mut fixture = Fixture::new();
        let [id, expected] =
            fixture.read_all(["m*(y + m*y^2) - m^2*y^2*cos(x)^2 - m^2*y^2*sin(x)^2", "m*y"]);
        let expanded = fixture.pool.multiply_out(id);
        assert_eq!(fixture.pool.simplify(expanded), expected);
    }

    #[test]
    fn large_products_are_kept() {
        let mut fixture = Fixture::new();
        let [id] = fixture.read_all(["(x + y + m + 1)^9"]);
        assert_eq!(fixture.pool.multiply_out(id), id);
    }
}
