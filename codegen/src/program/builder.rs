//! Builds a function: value numbering, exact folding of constants, structural zeros.
//!
//! The rewrites are arithmetic on exact zeros and ones (`0 + a`, `1 * a`, `0 * a`), signs, and commutativity. Such
//! zeros belong to the sparsity pattern; they are no rounded values. Nothing is reassociated.

use std::collections::HashMap;

use dalembert_expr::{Function as Elementary, Rational, WordHash};

use super::{Cost, Function, Guard, Input, Op, Value, schedule};

/// A function under construction.
#[derive(Debug, Default)]
pub struct Builder {
    ops: Vec<Op>,
    names: Vec<Option<String>>,
    numbered: HashMap<Op, Value, WordHash>,
}

impl Builder {
    /// An empty function.
    pub fn new() -> Self {
        Self::default()
    }

    /// The operation that defines a value.
    pub fn op(&self, value: Value) -> &Op {
        &self.ops[value.index()]
    }

    /// Number of operations so far.
    pub fn len(&self) -> usize {
        self.ops.len()
    }

    /// True if there is no operation yet.
    pub fn is_empty(&self) -> bool {
        self.ops.is_empty()
    }

    fn push(&mut self, op: Op) -> Value {
        if let Some(&value) = self.numbered.get(&op) {
            return value;
        }
        let value = Value::new(self.ops.len());
        self.numbered.insert(op.clone(), value);
        self.ops.push(op);
        self.names.push(None);
        value
    }

    /// An argument.
    pub fn input(&mut self, input: Input) -> Value {
        self.push(Op::Input(input))
    }

    /// An exact number.
    pub fn number(&mut self, number: Rational) -> Value {
        self.push(Op::Number(number))
    }

    /// An integer.
    pub fn integer(&mut self, integer: i64) -> Value {
        self.number(Rational::from(integer))
    }

    /// The structural zero.
    pub fn zero(&mut self) -> Value {
        self.integer(0)
    }

    /// The number pi.
    pub fn pi(&mut self) -> Value {
        self.push(Op::Pi)
    }

    /// The exact number of a value; `None` if the value is no constant.
    pub fn as_number(&self, value: Value) -> Option<&Rational> {
        match self.op(value) {
            Op::Number(number) => Some(number),
            _ => None,
        }
    }

    /// True if a value is the structural zero.
    pub fn is_zero(&self, value: Value) -> bool {
        self.as_number(value).is_some_and(Rational::is_zero)
    }

    fn is_one(&self, value: Value) -> bool {
        self.as_number(value).is_some_and(Rational::is_one)
    }

    fn both_numbers(&self, a: Value, b: Value) -> Option<(Rational, Rational)> {
        Some((self.as_number(a)?.clone(), self.as_number(b)?.clone()))
    }

    /// `-a`
    pub fn neg(&mut self, a: Value) -> Value {
        match self.op(a).clone() {
            Op::Number(number) => self.number(-number),
            Op::Neg(inner) => inner,
            Op::Sub(x, y) => self.sub(y, x),
            Op::Mul(x, y) => match (self.existing_opposite(x), self.existing_opposite(y)) {
                (Some(x), _) => self.mul(x, y),
                (None, Some(y)) => self.mul(x, y),
                (None, None) => self.push(Op::Neg(a)),
            },
            _ => self.push(Op::Neg(a)),
        }
    }

    /// `y - x`, if the value is `x - y` and `y - x` was computed before.
    fn existing_opposite(&self, value: Value) -> Option<Value> {
        match *self.op(value) {
            Op::Sub(x, y) => self.numbered.get(&Op::Sub(y, x)).copied(),
            _ => None,
        }
    }

    /// `a + b`
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        if self.is_zero(a) {
            return b;
        }
        if self.is_zero(b) {
            return a;
        }
        if let Some((x, y)) = self.both_numbers(a, b) {
            return self.number(x + y);
        }
        if let Op::Neg(inner) = *self.op(b) {
            return self.sub(a, inner);
        }
        if let Op::Neg(inner) = *self.op(a) {
            return self.sub(b, inner);
        }
        self.push(Op::Add(a.min(b), a.max(b)))
    }

    /// `a - b`
    pub fn sub(&mut self, a: Value, b: Value) -> Value {
        if a == b {
            return self.zero();
        }
        if self.is_zero(b) {
            return a;
        }
        if self.is_zero(a) {
            return self.neg(b);
        }
        if let Some((x, y)) = self.both_numbers(a, b) {
            return self.number(x - y);
        }
        if let Op::Neg(inner) = *self.op(b) {
            return self.add(a, inner);
        }
        self.push(Op::Sub(a, b))
    }

    /// `a * b`
    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        if let Some((x, y)) = self.both_numbers(a, b) {
            return self.number(x * y);
        }
        for (x, y) in [(a, b), (b, a)] {
            match self.as_number(x) {
                Some(number) if number.is_zero() => return self.zero(),
                Some(number) if number.is_one() => return y,
                Some(number) if *number == Rational::from(-1) => return self.neg(y),
                _ => {}
            }
        }
        match (self.op(a).clone(), self.op(b).clone()) {
            (Op::Neg(x), Op::Neg(y)) => self.mul(x, y),
            (Op::Neg(x), _) => self.negated_product(x, b),
            (_, Op::Neg(y)) => self.negated_product(a, y),
            _ => self.push(Op::Mul(a.min(b), a.max(b))),
        }
    }

    fn negated_product(&mut self, a: Value, b: Value) -> Value {
        let product = self.mul(a, b);
        self.neg(product)
    }

    /// `a / b`
    pub fn div(&mut self, a: Value, b: Value) -> Value {
        if self.is_zero(a) && self.as_number(b).is_none_or(|number| !number.is_zero()) {
            return a;
        }
        if self.is_one(b) {
            return a;
        }
        if let Some((x, y)) = self.both_numbers(a, b)
            && let Some(quotient) = x.checked_div(&y)
        {
            return self.number(quotient);
        }
        if let Op::Neg(inner) = *self.op(a) {
            let quotient = self.div(inner, b);
            return self.neg(quotient);
        }
        self.push(Op::Div(a, b))
    }

    /// `a / b`, if it was computed before.
    pub fn existing_quotient(&self, a: Value, b: Value) -> Option<Value> {
        self.numbered.get(&Op::Div(a, b)).copied()
    }

    /// `1 / a`
    pub fn reciprocal(&mut self, a: Value) -> Value {
        let one = self.integer(1);
        self.div(one, a)
    }

    /// `a + b * c`
    pub fn add_product(&mut self, a: Value, b: Value, c: Value) -> Value {
        let product = self.mul(b, c);
        self.add(a, product)
    }

    /// `a - b * c`
    pub fn sub_product(&mut self, a: Value, b: Value, c: Value) -> Value {
        let product = self.mul(b, c);
        self.sub(a, product)
    }

    /// Square root.
    pub fn sqrt(&mut self, a: Value) -> Value {
        self.push(Op::Sqrt(a))
    }

    /// A constant power whose exponent is no multiple of 1/2.
    pub fn power(&mut self, a: Value, exponent: Rational) -> Value {
        self.push(Op::Power(a, exponent))
    }

    /// An elementary function.
    pub fn call(&mut self, function: Elementary, a: Value) -> Value {
        self.push(Op::Call(function, a))
    }

    /// `atan2(y, x)`
    pub fn atan2(&mut self, y: Value, x: Value) -> Value {
        self.push(Op::Atan2(y, x))
    }

    /// Makes the function return an error unless the guard holds.
    pub fn guard(&mut self, guard: Guard) {
        self.push(Op::Guard(guard));
    }

    /// Gives a value a name, unless it is an argument, a number or a negation, or has a name already.
    pub fn name(&mut self, value: Value, name: impl Into<String>) {
        let nameless = self.names[value.index()].is_none();
        if nameless && !self.ops[value.index()].is_leaf() && !matches!(self.op(value), Op::Neg(_)) {
            self.names[value.index()] = Some(name.into());
        }
    }

    /// Adds an operation of a finished function. `values` has the values in this builder of that function's operations.
    pub fn replay_one(&mut self, op: &Op, values: &[Value]) -> Value {
        self.push(op.clone().with_operands(|value| values[value.index()]))
    }

    /// Adds the operations of a finished function, except those that exist already. Returns its results.
    pub fn replay(&mut self, function: &Function) -> Vec<Value> {
        let mut values: Vec<Value> = Vec::with_capacity(function.ops.len());
        for (op, name) in function.ops.iter().zip(&function.names) {
            let value = self.replay_one(op, &values);
            let existing = &mut self.names[value.index()];
            if existing.is_none() {
                existing.clone_from(name);
            }
            values.push(value);
        }
        let outputs = function.outputs.iter();
        outputs.map(|output| values[output.index()]).collect()
    }

    /// The finished function with all operations, whether used or not.
    pub fn finish_whole(self, outputs: Vec<Value>) -> Function {
        let cost = Cost::of(&self.ops);
        Function {
            ops: self.ops,
            names: self.names,
            outputs,
            cost,
        }
    }

    /// The finished function without operations that neither outputs nor guards use.
    pub fn finish(self, outputs: Vec<Value>) -> Function {
        let (ops, names, outputs) = schedule::prune(self.ops, self.names, outputs);
        let cost = Cost::of(&ops);
        Function {
            ops,
            names,
            outputs,
            cost,
        }
    }
}
