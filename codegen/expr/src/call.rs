//! Constructors of function calls: exact values, parity, and the rewrites listed in `construct.rs`.

use crate::function::{Function, Parity};
use crate::node::{ExprId, Node};
use crate::pool::Pool;
use crate::rational::Rational;
use crate::sign::Sign;

impl Pool {
    /// `function(argument)`
    pub fn call(&mut self, function: Function, argument: ExprId) -> ExprId {
        if let Some(value) = self.exact_value(function, argument) {
            return value;
        }
        if let Some(value) = self.remove_quarter_turns(function, argument) {
            return value;
        }
        let (coefficient, term) = self.as_multiple(argument);
        match (function, self.node(argument)) {
            (Function::Ln, Node::Call(Function::Exp, exponent)) => return *exponent,
            (Function::Abs, _) => return self.absolute(&coefficient, term),
            _ => {}
        }
        let opposite = coefficient.is_negative();
        match function.parity() {
            Parity::Odd if opposite => {
                let positive = self.neg(argument);
                let value = self.intern(Node::Call(function, positive));
                self.neg(value)
            }
            Parity::Even if opposite => {
                let positive = self.neg(argument);
                self.intern(Node::Call(function, positive))
            }
            Parity::Odd | Parity::Even | Parity::Neither => {
                self.intern(Node::Call(function, argument))
            }
        }
    }

    /// The angle of the point `(x, y)`, in `(-pi, pi]`.
    pub fn atan2(&mut self, y: ExprId, x: ExprId) -> ExprId {
        if self.is_syntactic_zero(y) && self.sign(x) == Sign::Positive && self.is_finite(x) {
            return self.zero();
        }
        self.intern(Node::Atan2(y, x))
    }

    /// `abs(coefficient * term)`
    fn absolute(&mut self, coefficient: &Rational, term: ExprId) -> ExprId {
        let sign = self.sign(term);
        let value = if sign.is_nonnegative() {
            term
        } else if sign.is_nonpositive() {
            self.neg(term)
        } else if matches!(self.node(term), Node::Call(Function::Abs, _)) {
            term
        } else {
            self.intern(Node::Call(Function::Abs, term))
        };
        self.scale(&coefficient.abs(), value)
    }

    fn exact_value(&mut self, function: Function, argument: ExprId) -> Option<ExprId> {
        if matches!(function, Function::Sin | Function::Cos | Function::Tan) {
            let turns = self.multiple_of_pi(argument)?;
            let value = value_at_turns(function, &turns)?;
            return Some(self.number(value));
        }
        if let Some(angle) = self.exact_angle(function, argument) {
            return Some(angle);
        }
        match (function, self.as_number(argument)?.to_i64()?) {
            (Function::Exp | Function::Cosh, 0) => Some(self.one()),
            (Function::Ln, 1) | (Function::Log1p, 0) => Some(self.zero()),
            (_, 0) if function.parity() == Parity::Odd => Some(self.zero()),
            _ => None,
        }
    }

    /// The rational `r`, if the expression is `r pi`.
    pub(crate) fn multiple_of_pi(&self, id: ExprId) -> Option<Rational> {
        match self.as_multiple(id) {
            (coefficient, term) if term == self.pi() => Some(coefficient),
            _ if self.is_syntactic_zero(id) => Some(Rational::ZERO),
            _ => None,
        }
    }

    /// sin or cos of `x + k pi/2` for an integer `k`, in terms of sin or cos of `x`.
    fn remove_quarter_turns(&mut self, function: Function, argument: ExprId) -> Option<ExprId> {
        if !matches!(function, Function::Sin | Function::Cos) || argument == self.pi() {
            return None;
        }
        let (_, terms) = self.linear_form(argument);
        let (coefficient, _) = terms.iter().find(|(_, term)| *term == self.pi())?;
        let quarters = (coefficient + coefficient)
            .to_i64()
            .filter(|_| terms.len() > 1)?;
        let shift = self.scale(coefficient, self.pi());
        let rest = self.sub(argument, shift);
        // cos x = sin(x + pi/2)
        let quarters = quarters.rem_euclid(4) + i64::from(function == Function::Cos);
        let (function, negative) = match quarters % 4 {
            0 => (Function::Sin, false),
            1 => (Function::Cos, false),
            2 => (Function::Sin, true),
            _ => (Function::Cos, true),
        };
        let value = self.call(function, rest);
        Some(if negative { self.neg(value) } else { value })
    }
}

/// sin, cos or tan of `turns * pi`, if the value is rational.
fn value_at_turns(function: Function, turns: &Rational) -> Option<Rational> {
    // The unit pi/12 divides pi/6 and pi/4.
    let units = (turns * &Rational::from(12)).to_i64()?.rem_euclid(24);
    match function {
        Function::Sin => sine_at(units),
        Function::Cos => sine_at((units + 6) % 24),
        _ => match units % 12 {
            0 => Some(Rational::ZERO),
            3 => Some(Rational::ONE),
            9 => Some(Rational::MINUS_ONE),
            _ => None,
        },
    }
}

/// `sin(units * pi/12)`, if the value is rational.
fn sine_at(units: i64) -> Option<Rational> {
    match units {
        0 | 12 => Some(Rational::ZERO),
        2 | 10 => Some(Rational::HALF),
        14 | 22 => Some(-Rational::HALF),
        6 => Some(Rational::ONE),
        18 => Some(Rational::MINUS_ONE),
        _ => None,
    }
}
