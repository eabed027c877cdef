//! Simplification for presentation: `a cos(u)^2 + a sin(u)^2 -> a` and its two other readings, everywhere below a
//! root.
//!
//! The rules keep the domain: `u` must be known finite. Work is bounded: larger expressions are returned unchanged.

use crate::node::{ExprId, Function, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::subst::Rebuilt;

/// Expressions with more distinct parts are left alone.
const MAX_NODES: usize = 20_000;
/// Sums with more terms are left alone.
const MAX_TERMS: usize = 128;

/// A summand `coefficient * rest * function(argument)^2`.
struct Square {
    position: usize,
    rest: ExprId,
    function: Function,
    argument: ExprId,
}

impl Pool {
    /// An equal expression in which squares of sine and cosine with equal cofactors are collected:
    /// `a cos^2 + a sin^2 -> a`, `a - a cos^2 -> a sin^2`, `a - a sin^2 -> a cos^2`.
    pub fn simplify(&mut self, id: ExprId) -> ExprId {
        let order = self.reachable(&[id]);
        if order.len() > MAX_NODES {
            return id;
        }
        let mut results = Rebuilt::new(Some(&id));
        for part in order {
            let node = self.node(part).clone();
            let rebuilt = self.map_operands(node, |operand| results.get(operand));
            let collected = self.collect_squares(rebuilt);
            results.set(part, collected);
        }
        results.get(id)
    }

    /// Applies the rules to the terms of one sum until none matches; each application removes a term.
    fn collect_squares(&mut self, sum: ExprId) -> ExprId {
        let mut sum = sum;
        loop {
            let (constant, mut terms) = self.linear_form(sum);
            if terms.len() + usize::from(!constant.is_zero()) < 2 || terms.len() > MAX_TERMS {
                return sum;
            }
            let one = self.one();
            terms.push((constant, one));
            let Some(terms) = self.collect_pair(terms) else {
                return sum;
            };
            sum = self.combine(&terms);
        }
    }

    /// The terms after one application of a rule; `None` if none applies.
    fn collect_pair(
        &mut self,
        mut terms: Vec<(Rational, ExprId)>,
    ) -> Option<Vec<(Rational, ExprId)>> {
        let squares = self.squares(&terms);
        for square in &squares {
            let coefficient = terms[square.position].0.clone();
            let partner = squares.iter().find(|other| {
                other.function != square.function
                    && (other.argument, other.rest) == (square.argument, square.rest)
                    && terms[other.position].0 == coefficient
            });
            if let Some(partner) = partner {
                terms[square.position].1 = square.rest;
                terms.swap_remove(partner.position);
                return Some(terms);
            }
            let opposite = -&coefficient;
            let whole = |(c, term): &(Rational, ExprId)| *c == opposite && *term == square.rest;
            if let Some(position) = terms.iter().position(whole) {
                let other = self.call(complement(square.function), square.argument);
                let two = Rational::from(2);
                let power = self.power_product(&[(square.rest, Rational::ONE), (other, two)]);
                terms[position].1 = power;
                terms.swap_remove(square.position);
                return Some(terms);
            }
        }
        None
    }

    /// All ways to read the terms as a square of a sine or cosine times a rest.
    fn squares(&mut self, terms: &[(Rational, ExprId)]) -> Vec<Square> {
        let mut squares = Vec::new();
        for (position, (_, term)) in terms.iter().enumerate() {
            let Node::Product(factors) = self.node(*term).clone() else {
                continue;
            };
            for (index, (base, exponent)) in factors.iter().enumerate() {
                let Node::Call(function @ (Function::Sin | Function::Cos), argument) =
                    *self.node(*base)
                else {
                    continue;
                };
                let lowered = exponent - &Rational::from(2);
                let divisible = exponent.is_integer() && !lowered.is_negative();
                if divisible && self.is_finite(argument) {
                    let mut rest = factors.to_vec();
                    rest[index].1 = lowered;
                    rest.retain(|(_, exponent)| !exponent.is_zero());
                    let rest = self.power_product(&rest);
                    squares.push(Square {
                        position,
                        rest,
                        function,
                        argument,
                    });
                }
            }
        }
        squares
    }
}

fn complement(function: Function) -> Function {
    if function == Function::Sin {
        Function::Cos
    } else {
        Function::Sin
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;

    #[test]
    fn squares_of_sine_and_cosine_are_collected() {
        let mut fixture = Fixture::new();
        for (text, expected) in [
            ("m*l^2*cos(theta)^2 + m*l^2*sin(theta)^2", "m*l^2"),
            ("x + cos(theta)^2 + sin(theta)^2", "x + 1"),
            ("m - m*cos(theta)^2", "m*sin(theta)^2"),
            ("1 - sin(x)^2", "cos(x)^2"),
            (
                "sqrt(l^2*cos(x)^2*cos(y)^2 + l^2*cos(x)^2*sin(y)^2 + l^2*sin(x)^2)",
                "l",
            ),
            ("2*cos(x)^2 + 3*sin(x)^2", "2*cos(x)^2 + 3*sin(x)^2"),
            ("cos(1/x)^2 + sin(1/x)^2", "cos(1/x)^2 + sin(1/x)^2"),
            ("cos(x)^3*sin(y) + cos(x)*sin(x)^2*sin(y)", "cos(x)*sin(y)"),
        ] {
            let ids = fixture.read_all([text, expected]);
            let simple = fixture.pool.simplify(ids[0]);
            assert_eq!(
                simple,
                ids[1],
                "{text} became {}",
                fixture.pool.text(simple)
            );
        }
    }
}
