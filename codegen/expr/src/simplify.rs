//! Simplification for presentation: collects squares and products of sines and cosines in all subexpressions.
//!
//! The rules keep the domain: an angle may vanish from an expression only if it is known to be finite. Work is bounded:
//! larger expressions are returned unchanged.

use crate::function::Function;
use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::subst::Rebuilt;

/// Expressions with more distinct subexpressions are returned unchanged.
const MAX_NODES: usize = 20_000;
/// Sums with more terms are returned unchanged.
const MAX_TERMS: usize = 128;

/// A summand `coefficient * rest * function(argument)^2`.
struct Square {
    position: usize,
    rest: ExprId,
    function: Function,
    argument: ExprId,
}

/// A summand `coefficient * rest * functions[0](arguments[0]) * functions[1](arguments[1])`.
struct Cross {
    position: usize,
    rest: ExprId,
    functions: [Function; 2],
    arguments: [ExprId; 2],
}

impl Pool {
    /// An equal expression in which sines and cosines with equal cofactors are collected:
    /// - `a cos(u)^2 + a sin(u)^2 -> a`, `a - a cos(u)^2 -> a sin(u)^2`, `a - a sin(u)^2 -> a cos(u)^2`;
    /// - `a cos(u) cos(v) +- a sin(u) sin(v) -> a cos(u -+ v)`, `a sin(u) cos(v) +- a cos(u) sin(v) -> a sin(u +- v)`.
    pub fn simplify(&mut self, id: ExprId) -> ExprId {
        let order = self.reachable(&[id]);
        if order.len() > MAX_NODES {
            return id;
        }
        let mut results = Rebuilt::new(Some(&id));
        for part in order {
            let node = self.node(part).clone();
            let rebuilt = self.map_operands(node, |operand| results.get(operand));
            let collected = self.collect_circular(rebuilt);
            results.set(part, collected);
        }
        results.get(id)
    }

    /// Applies the rules to the terms of one sum until none matches; each application removes a term.
    fn collect_circular(&mut self, sum: ExprId) -> ExprId {
        let mut sum = sum;
        loop {
            let (constant, mut terms) = self.linear_form(sum);
            if terms.len() + usize::from(!constant.is_zero()) < 2 || terms.len() > MAX_TERMS {
                return sum;
            }
            let one = self.one();
            terms.push((constant, one));
            let collected = self
                .collect_square(&terms)
                .or_else(|| self.collect_cross(&terms));
            let Some(terms) = collected else {
                return sum;
            };
            sum = self.combine(&terms);
        }
    }

    /// The terms after one application of a rule for squares; `None` if none applies.
    fn collect_square(&mut self, terms: &[(Rational, ExprId)]) -> Option<Vec<(Rational, ExprId)>> {
        let squares = self.squares(terms);
        let mut terms = terms.to_vec();
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

    /// The terms after one application of a rule for two angles; `None` if none applies.
    fn collect_cross(&mut self, terms: &[(Rational, ExprId)]) -> Option<Vec<(Rational, ExprId)>> {
        let crosses = self.crosses(terms);
        for cross in &crosses {
            let coefficient = &terms[cross.position].0;
            let partner = crosses.iter().find(|other| {
                other.position > cross.position
                    && (other.rest, other.arguments) == (cross.rest, cross.arguments)
                    && other.functions == cross.functions.map(complement)
                    && terms[other.position].0.abs() == coefficient.abs()
            });
            if let Some(partner) = partner {
                let alike = terms[partner.position].0 == *coefficient;
                let (sign, wave) = self.wave_of_two_angles(cross, alike);
                let mut collected = terms.to_vec();
                let product = self.mul(cross.rest, wave);
                collected[cross.position] = (&sign * coefficient, product);
                collected.swap_remove(partner.position);
                return Some(collected);
            }
        }
        None
    }

    /// `f(u) g(v) +- f'(u) g'(v)` as a sign and one sine or cosine, where `f'` and `g'` are the complements of `f` and
    /// `g`. The sign between the products is plus if `alike`.
    fn wave_of_two_angles(&mut self, cross: &Cross, alike: bool) -> (Rational, ExprId) {
        let [u, v] = cross.arguments;
        let signed = |positive| {
            if positive {
                Rational::ONE
            } else {
                Rational::MINUS_ONE
            }
        };
        let (function, plus, sign) = match cross.functions {
            [Function::Cos, Function::Cos] => (Function::Cos, !alike, true),
            // `sin sin +- cos cos = +- (cos cos +- sin sin)`
            [Function::Sin, Function::Sin] => (Function::Cos, !alike, alike),
            [Function::Sin, _] => (Function::Sin, alike, true),
            // cos sin +- sin cos = +- (sin cos +- cos sin)
            _ => (Function::Sin, alike, alike),
        };
        let angle = self.combine(&[(Rational::ONE, u), (signed(plus), v)]);
        (signed(sign), self.call(function, angle))
    }

    /// All decompositions of the terms into two sines or cosines and the remaining factors.
    fn crosses(&mut self, terms: &[(Rational, ExprId)]) -> Vec<Cross> {
        let mut crosses = Vec::new();
        for (position, (_, term)) in terms.iter().enumerate() {
            let Node::Product(factors) = self.node(*term).clone() else {
                continue;
            };
            let waves: Vec<_> = (0..factors.len())
                .filter_map(|index| Some((index, self.wave(&factors[index], &Rational::ONE)?)))
                .collect();
            for (index, (first, (f, u))) in waves.iter().enumerate() {
                for (second, (g, v)) in &waves[index + 1..] {
                    let rest = self.without(&factors, &[*first, *second], &Rational::ONE);
                    // Sorted angles make decompositions comparable, whichever factor came first.
                    let (functions, arguments) = if u < v {
                        ([*f, *g], [*u, *v])
                    } else {
                        ([*g, *f], [*v, *u])
                    };
                    crosses.push(Cross {
                        position,
                        rest,
                        functions,
                        arguments,
                    });
                }
            }
        }
        crosses
    }

    /// Function and argument of a factor that is a sine or cosine to an integer power of at least `least`.
    fn wave(&self, factor: &(ExprId, Rational), least: &Rational) -> Option<(Function, ExprId)> {
        let (base, exponent) = factor;
        match *self.node(*base) {
            Node::Call(function @ (Function::Sin | Function::Cos), argument) => {
                (exponent.is_integer() && exponent >= least).then_some((function, argument))
            }
            _ => None,
        }
    }

    /// The product of powers with the exponents at `positions` lowered by `amount`.
    fn without(
        &mut self,
        factors: &[(ExprId, Rational)],
        positions: &[usize],
        amount: &Rational,
    ) -> ExprId {
        let mut rest = factors.to_vec();
        for position in positions {
            rest[*position].1 = &rest[*position].1 - amount;
        }
        rest.retain(|(_, exponent)| !exponent.is_zero());
        self.power_product(&rest)
    }

    /// All decompositions of the terms into the square of a sine or cosine and the remaining factors.
    fn squares(&mut self, terms: &[(Rational, ExprId)]) -> Vec<Square> {
        let two = Rational::from(2);
        let mut squares = Vec::new();
        for (position, (_, term)) in terms.iter().enumerate() {
            let Node::Product(factors) = self.node(*term).clone() else {
                continue;
            };
            for (index, factor) in factors.iter().enumerate() {
                let wave = self.wave(factor, &two);
                if let Some((function, argument)) = wave.filter(|(_, u)| self.is_finite(*u)) {
                    let rest = self.without(&factors, &[index], &two);
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
    fn products_of_two_angles_are_collected() {
        let mut fixture = Fixture::new();
        for (text, expected) in [
            ("m*l*cos(x)*cos(y) + m*l*sin(x)*sin(y)", "m*l*cos(x - y)"),
            ("cos(x)*cos(y) - sin(x)*sin(y)", "cos(x + y)"),
            ("sin(x)*sin(y) - cos(x)*cos(y) + z", "z - cos(x + y)"),
            ("sin(x)*cos(y) + cos(x)*sin(y)", "sin(x + y)"),
            ("cos(x)*sin(y) - sin(x)*cos(y)", "-sin(x - y)"),
            (
                "2*sin(1/x)*cos(y)*a - 2*a*cos(1/x)*sin(y)",
                "2*a*sin(1/x - y)",
            ),
            (
                "cos(x)*cos(y) + 2*sin(x)*sin(y)",
                "cos(x)*cos(y) + 2*sin(x)*sin(y)",
            ),
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
