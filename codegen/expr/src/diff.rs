//! Partial derivatives, cached per expression and symbol.

use crate::node::{ExprId, Node, SymbolId};
use crate::pool::Pool;
use crate::rational::Rational;

impl Pool {
    /// The partial derivative with respect to a symbol, all other symbols held fixed.
    ///
    /// `d abs(x) = x / abs(x)`.
    pub fn diff(&mut self, id: ExprId, symbol: SymbolId) -> ExprId {
        let pending = self.reachable_where(&[id], |part| {
            self.depends_on(part, symbol) && self.known_derivative(part, symbol).is_none()
        });
        for part in pending {
            let derivative = self.diff_node(part, symbol);
            let known = &mut self.derivatives[symbol.index()];
            if known.len() <= part.index() {
                known.resize(part.index() + 1, 0);
            }
            known[part.index()] = derivative.index() as u32 + 1;
        }
        self.derivative_of(id, symbol)
    }

    /// `sum over s of (d id / d s) * direction_s`. Directions that are the number 0 add nothing, although their products
    /// with derivatives that are not defined everywhere would be kept.
    pub fn derivative_along(&mut self, id: ExprId, directions: &[(SymbolId, ExprId)]) -> ExprId {
        let mut summands = Vec::new();
        for (symbol, direction) in directions {
            if !self.is_syntactic_zero(*direction) && self.depends_on(id, *symbol) {
                let partial = self.diff(id, *symbol);
                summands.push(self.mul(partial, *direction));
            }
        }
        self.sum(&summands)
    }

    fn known_derivative(&self, id: ExprId, symbol: SymbolId) -> Option<ExprId> {
        let position = *self.derivatives[symbol.index()].get(id.index())?;
        (position as usize).checked_sub(1).map(ExprId::from_index)
    }

    /// The derivative of an operand. Operands come before their users, so it is in the cache unless the operand does not
    /// depend on the symbol.
    fn derivative_of(&self, id: ExprId, symbol: SymbolId) -> ExprId {
        self.known_derivative(id, symbol).unwrap_or(self.zero())
    }

    fn diff_node(&mut self, id: ExprId, symbol: SymbolId) -> ExprId {
        match self.node(id).clone() {
            Node::Number(_) | Node::Pi => self.zero(),
            Node::Symbol(other) if other == symbol => self.one(),
            Node::Symbol(_) => self.zero(),
            Node::Sum { terms, .. } => self.diff_sum(&terms, symbol),
            Node::Product(factors) => self.diff_product(&factors, symbol),
            Node::Call(function, argument) => {
                let outer = function.derivative(self, argument, id);
                let inner = self.derivative_of(argument, symbol);
                self.mul(outer, inner)
            }
            Node::Atan2(y, x) => self.diff_atan2(y, x, symbol),
        }
    }

    fn diff_sum(&mut self, terms: &[(Rational, ExprId)], symbol: SymbolId) -> ExprId {
        let mut summands = Vec::with_capacity(terms.len());
        for (coefficient, term) in terms {
            summands.push((coefficient.clone(), self.derivative_of(*term, symbol)));
            if coefficient.is_zero() {
                // A term with coefficient 0 limits the domain. Keep it, so that it limits the domain of the derivative.
                summands.push((coefficient.clone(), *term));
            }
        }
        self.combine(&summands)
    }

    /// `sum over i of e_i x_i' x_i^(e_i - 1) product of the others`, without dividing by `x_i`.
    fn diff_product(&mut self, factors: &[(ExprId, Rational)], symbol: SymbolId) -> ExprId {
        let mut summands = Vec::new();
        for (position, (base, exponent)) in factors.iter().enumerate() {
            let inner = self.derivative_of(*base, symbol);
            if self.is_syntactic_zero(inner) {
                continue;
            }
            let mut powers = factors.to_vec();
            powers[position].1 = exponent - &Rational::ONE;
            powers.retain(|(_, exponent)| !exponent.is_zero());
            powers.push((inner, Rational::ONE));
            summands.push((exponent.clone(), self.power_product(&powers)));
        }
        self.combine(&summands)
    }

    /// `(x y' - y x') / (x^2 + y^2)`
    fn diff_atan2(&mut self, y: ExprId, x: ExprId, symbol: SymbolId) -> ExprId {
        let two = Rational::from(2);
        let (dy, dx) = (self.derivative_of(y, symbol), self.derivative_of(x, symbol));
        let (x_dy, y_dx) = (self.mul(x, dy), self.mul(y, dx));
        let numerator = self.sub(x_dy, y_dx);
        let (x2, y2) = (self.pow(x, two.clone()), self.pow(y, two));
        let denominator = self.add(x2, y2);
        self.div(numerator, denominator)
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;
    use crate::{Assumption, Function, Pool};

    #[test]
    fn derivatives_agree_with_central_differences() {
        let mut fixture = Fixture::new();
        let mut texts: Vec<String> = Function::ALL
            .iter()
            .map(|function| format!("{}(x*y/2 + x^2/9)", function.name()))
            .collect();
        texts.extend(
            [
                "sqrt(x*y)",
                "x^3*y/(x + y)^2",
                "atan2(x*y, x - 3)",
                "x^(5/3)*sqrt(1 + x^2)",
                "exp(-x^2/m)*cos(x)^2",
            ]
            .map(String::from),
        );
        let x = fixture.symbol("x");
        for text in texts {
            let id = fixture.read(&text);
            let derivative = fixture.pool.diff(id, x);
            let at = |shift: f64| {
                let value = move |s| if s == x { 0.7 + shift } else { 0.8 };
                fixture.pool.eval(&[id, derivative], &value)
            };
            let step = 1e-5;
            let difference = (at(step)[0] - at(-step)[0]) / (2.0 * step);
            let exact = at(0.0)[1];
            assert!(
                (difference - exact).abs() < 1e-8 * (1.0 + exact.abs()),
                "{text}: {difference} {exact}"
            );
        }
    }

    #[test]
    fn derivative_of_a_squared_sum_stays_compact() {
        let mut fixture = Fixture::new();
        let id = fixture.read("(x*a + y*b + z)^2");
        let x = fixture.symbol("x");
        let derivative = fixture.pool.diff(id, x);
        assert_eq!(fixture.pool.text(derivative), "2*a*(x*a + y*b + z)");
    }

    #[test]
    fn derivative_along_sums_the_directions() {
        let mut fixture = Fixture::new();
        let [id, u, v, expected] =
            fixture.read_all(["x^2*y", "dot(x)", "dot(y)", "2*x*y*dot(x) + x^2*dot(y)"]);
        let directions = [(fixture.symbol("x"), u), (fixture.symbol("y"), v)];
        assert_eq!(fixture.pool.derivative_along(id, &directions), expected);
    }

    #[test]
    fn a_hundred_thousand_levels_do_not_overflow_the_stack() {
        let mut pool = Pool::new();
        let symbol = pool.symbol("x", "x", Assumption::None);
        let x = pool.variable(symbol);
        let mut deep = x;
        for _ in 0..50_000 {
            let sine = pool.call(Function::Sin, deep);
            deep = pool.add(sine, x);
        }
        let derivative = pool.diff(deep, symbol);
        assert!(pool.eval(&[derivative], &|_| 0.5)[0].is_finite());
        let shifted = pool.substitute(deep, &[(symbol, deep)]);
        assert!(pool.depends_on(shifted, symbol));
        assert!(pool.text(deep).contains("..."));
        pool.latex(deep);
        pool.zero_test(deep);
        pool.simplify(deep);
    }
}
