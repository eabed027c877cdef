//! Simpler forms of constants: angles whose sines or tangents are square roots, and square roots of `a + b sqrt(r)`.

use crate::function::Function;
use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;

/// Squares of sines and of tangents, each with its angle in twelfths of `pi`.
const SINES: [((i64, i64), i64); 5] = [
    ((0, 1), 0),
    ((1, 4), 2),
    ((1, 2), 3),
    ((3, 4), 4),
    ((1, 1), 6),
];
const TANGENTS: [((i64, i64), i64); 4] = [((0, 1), 0), ((1, 3), 2), ((1, 1), 3), ((3, 1), 4)];

impl Pool {
    /// The angle `function(argument)` as a multiple of `pi`, if the tables contain it. `function` is `asin`, `acos` or
    /// `atan`; for others `None`.
    pub(crate) fn exact_angle(&mut self, function: Function, argument: ExprId) -> Option<ExprId> {
        let table: &[_] = match function {
            Function::Asin | Function::Acos => &SINES,
            Function::Atan => &TANGENTS,
            _ => return None,
        };
        let (square, is_negative) = self.signed_square(argument)?;
        let is_found = |row: &&((i64, i64), i64)| Rational::new(row.0.0, row.0.1) == square;
        let (_, angle) = table.iter().find(is_found)?;
        let angle = if is_negative { -angle } else { *angle };
        let twelfths = match function {
            Function::Acos => 6 - angle,
            _ => angle,
        };
        Some(self.scale(&Rational::new(twelfths, 12), self.pi()))
    }

    /// The square of an expression that is a number or a root of one, and true if the expression is negative.
    fn signed_square(&self, id: ExprId) -> Option<(Rational, bool)> {
        if let Some(number) = self.as_number(id) {
            return Some((number * number, number.is_negative()));
        }
        let (coefficient, term) = self.as_multiple(id);
        let Node::Product(factors) = self.node(term) else {
            return None;
        };
        let mut square = &coefficient * &coefficient;
        for (base, exponent) in factors.iter() {
            let power = (exponent + exponent).to_i64()?;
            square = &square * &self.as_number(*base)?.pow_i(i32::try_from(power).ok()?)?;
        }
        Some((square, coefficient.is_negative()))
    }

    /// The root of `a + b sqrt(r)` as `sqrt((a + c)/2) + sqrt((a - c)/2)`, with a minus for negative `b`, if
    /// `c = sqrt(a^2 - b^2 r)` is rational.
    pub(crate) fn denested_root(&mut self, radicand: ExprId) -> Option<ExprId> {
        if !matches!(self.node(radicand), Node::Sum { .. }) {
            return None;
        }
        let (a, terms) = self.linear_form(radicand);
        let [(coefficient, root)] = terms.as_slice() else {
            return None;
        };
        let (square, is_negative) = self.signed_square(*root)?;
        let square = &square * &(coefficient * coefficient);
        if !a.is_positive() {
            return None;
        }
        let c = (&(&a * &a) - &square).exact_root(2)?;
        let [larger, smaller] = [&a + &c, &a - &c].map(|sum| &sum * &Rational::HALF);
        let [larger, smaller] = [larger, smaller].map(|half| self.number(half));
        let (larger, smaller) = (self.sqrt(larger), self.sqrt(smaller));
        Some(match is_negative != coefficient.is_negative() {
            true => self.sub(larger, smaller),
            false => self.add(larger, smaller),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::fixture::Fixture;
    use crate::zero::Verdict;

    #[test]
    fn angles_of_square_roots_are_fractions_of_pi() {
        let mut fixture = Fixture::new();
        for text in [
            "asin(1/2) - pi/6",
            "asin(-1/2) + pi/6",
            "acos(1/2) - pi/3",
            "acos(-1/2) - 2*pi/3",
            "asin(sqrt(2)/2) - pi/4",
            "asin(1/sqrt(2)) - pi/4",
            "acos(-sqrt(3)/2) - 5*pi/6",
            "atan(sqrt(3)) - pi/3",
            "atan(-1/sqrt(3)) + pi/6",
            "atan(1) + asin(1) + acos(-1) - 7*pi/4",
        ] {
            let id = fixture.read(text);
            assert_eq!(fixture.pool.zero_test(id), Verdict::Proved, "{text}");
        }
        for text in [
            "asin(1/2) - pi/6 - 1/1000000000000000000000",
            "asin(1/3) - pi/9",
        ] {
            let id = fixture.read(text);
            assert_ne!(fixture.pool.zero_test(id), Verdict::Proved, "{text}");
        }
    }

    #[test]
    fn roots_of_sums_with_a_root_are_sums_of_roots() {
        let mut fixture = Fixture::new();
        for text in [
            "sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)",
            "sqrt(3 - 2*sqrt(2)) + 1 - sqrt(2)",
            "sqrt(5 + 2*sqrt(6)) - sqrt(2) - sqrt(3)",
            "sqrt(8 - 4*sqrt(3)) - sqrt(6) + sqrt(2)",
            "1/sqrt(3 + 2*sqrt(2)) + 1 - sqrt(2)",
            "sqrt(7/4 + sqrt(3)) - 1 - sqrt(3)/2",
        ] {
            let id = fixture.read(text);
            assert_eq!(fixture.pool.zero_test(id), Verdict::Proved, "{text}");
        }
        for text in [
            "sqrt(3 + 2*sqrt(2)) + 1 - sqrt(2)",
            "sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2) - 1/1000000000",
        ] {
            let id = fixture.read(text);
            assert_ne!(fixture.pool.zero_test(id), Verdict::Proved, "{text}");
        }
    }
}
