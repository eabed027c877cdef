//! Exact evaluation of expressions modulo a prime, including transcendental functions.
//!
//! Symbols, pi and the following atoms are independent random residues. If two expressions agree at such a point, they
//! are identical, except with a small probability that the residues are a zero of their difference (Schwartz, Zippel):
//! - sin, cos, tan of a rational combination `sum of c_i x_i`: each `x_i / N` is an angle with the random half-angle
//!   tangent `t`, so that `sin = 2t/(1+t^2)` and `cos = (1-t^2)/(1+t^2)`. Multiples follow by angle addition. `N` is
//!   the common denominator. Multiples of `pi/12` are exact;
//! - exp, sinh, cosh, tanh: each `exp(x_i / N)` is a random square, and `exp(ln x) = x`;
//! - `x^(a/b)` is the root among the squares. `x` must be a square; otherwise the point is refused. `abs(x)` is `x` or
//!   `-x`, whichever is a square;
//! - ln, asin, acos, atan, asinh, atan2: one atom for each value of the argument. `log1p(x)` is `ln(1 + x)`.

use crate::function::Function;
use crate::node::{ExprId, Node};
use crate::point::{
    Atom, ModularFailure, ModularPoint, add_angles, multiple_angle, twelfths_of_pi,
};
use crate::pool::Pool;
use crate::rational::Rational;

impl Pool {
    /// The residues of `roots` at a point, in order.
    ///
    /// # Errors
    /// If an expression has no value at this point. It may have one at another point.
    pub fn modular_eval(
        &self,
        roots: &[ExprId],
        point: &mut ModularPoint,
    ) -> Result<Vec<u64>, ModularFailure> {
        self.modular_eval_ordered(&self.reachable(roots), roots, point)
    }

    /// Same as [`Pool::modular_eval`], where `order` is the result of [`Pool::reachable`] for the roots.
    pub(crate) fn modular_eval_ordered(
        &self,
        order: &[ExprId],
        roots: &[ExprId],
        point: &mut ModularPoint,
    ) -> Result<Vec<u64>, ModularFailure> {
        let values = self.residues(order, point)?;
        Ok(roots.iter().map(|root| values[root.index()]).collect())
    }

    /// The residues of all expressions in `order`, by id.
    pub(crate) fn residues(
        &self,
        order: &[ExprId],
        point: &mut ModularPoint,
    ) -> Result<Vec<u64>, ModularFailure> {
        let mut values = vec![0; order.last().map_or(0, |id| id.index() + 1)];
        for id in order {
            values[id.index()] = self.residue(*id, &values, point)?;
        }
        Ok(values)
    }

    fn residue(
        &self,
        id: ExprId,
        values: &[u64],
        point: &mut ModularPoint,
    ) -> Result<u64, ModularFailure> {
        let field = point.modulus();
        let number = |value| field.rational(value).ok_or(ModularFailure::DivisionByZero);
        match self.node(id) {
            Node::Number(value) => number(value),
            Node::Pi => Ok(point.draw(Atom::Pi, 0, 0)),
            Node::Symbol(symbol) => Ok(point.value(*symbol, self.symbol_assumption(*symbol))),
            Node::Sum { constant, terms } => {
                let mut sum = number(constant)?;
                for (coefficient, term) in terms {
                    let value = values[term.index()];
                    sum = field.add(sum, field.mul(number(coefficient)?, value));
                }
                Ok(sum)
            }
            Node::Product(factors) => {
                let mut product = 1;
                for (base, exponent) in factors {
                    product = field.mul(product, point.power(values[base.index()], exponent)?);
                }
                Ok(product)
            }
            Node::Call(function, argument) => {
                self.call_residue(*function, *argument, values, point)
            }
            Node::Atan2(y, x) => Ok(point.draw(Atom::Atan2, values[y.index()], values[x.index()])),
        }
    }

    fn call_residue(
        &self,
        function: Function,
        argument: ExprId,
        values: &[u64],
        point: &mut ModularPoint,
    ) -> Result<u64, ModularFailure> {
        let field = point.modulus();
        let x = values[argument.index()];
        let half = || field.inv(2).ok_or(ModularFailure::DivisionByZero);
        let divide = |a, b| match field.inv(b) {
            Some(inverse) => Ok(field.mul(a, inverse)),
            None => Err(ModularFailure::DivisionByZero),
        };
        match function {
            Function::Sin => Ok(self.sine_cosine(argument, values, point)?.0),
            Function::Cos => Ok(self.sine_cosine(argument, values, point)?.1),
            Function::Tan => {
                let (sine, cosine) = self.sine_cosine(argument, values, point)?;
                divide(sine, cosine)
            }
            Function::Exp => Ok(self.exponentials(argument, values, point)?.0),
            Function::Sinh => Ok(self.hyperbolic(argument, values, point)?.0),
            Function::Cosh => Ok(self.hyperbolic(argument, values, point)?.1),
            Function::Tanh => {
                let (up, down) = self.exponentials(argument, values, point)?;
                divide(field.sub(up, down), field.add(up, down))
            }
            Function::Asin | Function::Atan | Function::Asinh => Ok(point.odd_atom(function, x)),
            // acos x = pi/2 - asin x
            Function::Acos => {
                let quarter = field.mul(point.draw(Atom::Pi, 0, 0), half()?);
                Ok(field.sub(quarter, point.odd_atom(Function::Asin, x)))
            }
            Function::Ln => logarithm(x, point),
            Function::Log1p => logarithm(field.add(1, x), point),
            Function::Abs if x == 0 || field.is_square(x) => Ok(x),
            Function::Abs => Ok(field.neg(x)),
        }
    }

    /// `(sinh, cosh)` of a rational combination of exponents.
    pub(crate) fn hyperbolic(
        &self,
        argument: ExprId,
        values: &[u64],
        point: &mut ModularPoint,
    ) -> Result<(u64, u64), ModularFailure> {
        let field = point.modulus();
        let half = field.inv(2).ok_or(ModularFailure::DivisionByZero)?;
        let (up, down) = self.exponentials(argument, values, point)?;
        let (sine, cosine) = (field.sub(up, down), field.add(up, down));
        Ok((field.mul(sine, half), field.mul(cosine, half)))
    }

    /// `(sin, cos)` of a rational combination of angles.
    pub(crate) fn sine_cosine(
        &self,
        argument: ExprId,
        values: &[u64],
        point: &mut ModularPoint,
    ) -> Result<(u64, u64), ModularFailure> {
        let field = point.modulus();
        let (constant, terms) = self.linear_form(argument);
        let mut angle = multiple_angle(field, point.circle(1)?, point.multiple(&constant)?);
        for (coefficient, term) in terms {
            let turn = match (&coefficient * &Rational::from(12)).to_i64() {
                Some(units) if term == self.pi() => twelfths_of_pi(field, units)?,
                _ => {
                    let base = point.circle(values[term.index()])?;
                    multiple_angle(field, base, point.multiple(&coefficient)?)
                }
            };
            angle = add_angles(field, angle, turn);
        }
        Ok(angle)
    }

    /// `(exp, exp^-1)` of a rational combination of exponents.
    fn exponentials(
        &self,
        argument: ExprId,
        values: &[u64],
        point: &mut ModularPoint,
    ) -> Result<(u64, u64), ModularFailure> {
        let field = point.modulus();
        let (constant, mut terms) = self.linear_form(argument);
        terms.push((constant, self.one()));
        let mut result = (1, 1);
        for (coefficient, term) in terms.iter().filter(|(c, _)| !c.is_zero()) {
            let factor = match self.node(*term) {
                Node::Call(Function::Ln, x) => point.power(values[x.index()], coefficient)?,
                Node::Call(Function::Log1p, x) => {
                    point.power(field.add(1, values[x.index()]), coefficient)?
                }
                _ => {
                    // NOTE: for the constant, the term is the number 1. `values` may have no entry for it.
                    let x = if *term == self.one() {
                        1
                    } else {
                        values[term.index()]
                    };
                    let (up, down) = point.exponential(x)?;
                    let steps = point.multiple(coefficient)?;
                    field.pow(if steps < 0 { down } else { up }, steps.unsigned_abs())
                }
            };
            let inverse = field.inv(factor).ok_or(ModularFailure::DivisionByZero)?;
            result = (field.mul(result.0, factor), field.mul(result.1, inverse));
        }
        Ok(result)
    }
}

/// The atom of the logarithm of a square.
fn logarithm(x: u64, point: &ModularPoint) -> Result<u64, ModularFailure> {
    match x {
        0 => Err(ModularFailure::DivisionByZero),
        _ if !point.modulus().is_square(x) => Err(ModularFailure::NotASquare),
        _ => Ok(point.draw(Atom::Call(Function::Ln), x, 0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Modulus;
    use crate::fixture::Fixture;

    #[test]
    fn symbols_take_the_values_that_were_set() {
        let mut fixture = Fixture::new();
        let id = fixture.read("x^2 + y/2");
        let mut point = ModularPoint::new(Modulus::MERSENNE, 1);
        point.set(fixture.symbol("x"), 3);
        point.set(fixture.symbol("y"), 8);
        assert_eq!(fixture.pool.modular_eval(&[id], &mut point), Ok(vec![13]));
    }

    #[test]
    fn values_at_a_point_agree_between_calls() {
        let mut fixture = Fixture::new();
        let [product, sine, cosine] =
            fixture.read_all(["sin(x/2)*cos(x/2)", "sin(x/2)", "cos(x/2)"]);
        let mut point = ModularPoint::new(Modulus::drawn(0)[0], 5);
        let pool = &fixture.pool;
        let whole = pool.modular_eval(&[product], &mut point).unwrap()[0];
        let s = pool.modular_eval(&[sine], &mut point).unwrap()[0];
        let c = pool.modular_eval(&[cosine], &mut point).unwrap()[0];
        assert_eq!(point.modulus().mul(s, c), whole);
    }

    #[test]
    fn failures_say_what_is_missing() {
        let mut fixture = Fixture::new();
        let [pole, angle] = fixture.read_all(["1/x", "sin(x/7)"]);
        let mut point = ModularPoint::new(Modulus::MERSENNE, 1);
        point.set(fixture.symbol("x"), 0);
        let failure = |id, point: &mut ModularPoint| fixture.pool.modular_eval(&[id], point);
        assert_eq!(
            failure(pole, &mut point),
            Err(ModularFailure::DivisionByZero)
        );
        assert_eq!(failure(angle, &mut point), Err(ModularFailure::Denominator));
        let mut finer = ModularPoint::with_denominator(Modulus::MERSENNE, 1, 7);
        assert!(failure(angle, &mut finer).is_ok());
    }
}
