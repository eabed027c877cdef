//! Takes constant factors out of products and multiplies them with each other first. `x (c y)` becomes `c (x y)` if the
//! product `x y` is computed anyway: that saves a sum in every order. `a (b x)` with constants `a` and `b` becomes
//! `(a b) x`: its coefficients do not wait for those of `b x`.

use std::collections::HashSet;

use super::super::builder::Builder;
use super::super::{Function, Input, Op, Value};
use super::degree::{self, Degree};

/// A function with the same results, along motions whose components have these degrees.
pub(super) fn take_out(
    function: &Function,
    component: impl Fn(Input) -> Option<Degree>,
) -> Function {
    let mut degrees = Vec::with_capacity(function.ops.len());
    for op in &function.ops {
        degrees.push(degree::of(op, &degrees, &component));
    }
    let known = Known::of(function, degrees);
    let mut builder = Builder::new();
    let mut values: Vec<Value> = Vec::with_capacity(function.ops.len());
    for (i, (op, name)) in function.ops.iter().zip(&function.names).enumerate() {
        let value = match known.split(Value::new(i)) {
            Some(groups) => {
                let groups = groups.iter().filter_map(|group| {
                    let group = group.iter().map(|value| values[value.index()]);
                    group.reduce(|a, b| builder.mul(a, b))
                });
                let groups: Vec<Value> = groups.collect();
                let product = groups.into_iter().reduce(|a, b| builder.mul(a, b));
                product.unwrap_or_else(|| builder.integer(1))
            }
            None => builder.replay_one(op, &values),
        };
        if let Some(name) = name {
            builder.name(value, name.clone());
        }
        values.push(value);
    }
    let outputs = function.outputs.iter();
    let outputs = outputs.map(|output| values[output.index()]).collect();
    builder.finish(outputs)
}

/// Properties of a function's values.
struct Known<'a> {
    function: &'a Function,
    degrees: Vec<Degree>,
    /// Number of times a value is an operand or a result.
    uses: Vec<usize>,
    /// All products that are computed, each with its operands in order.
    products: HashSet<[Value; 2]>,
}

impl<'a> Known<'a> {
    fn of(function: &'a Function, degrees: Vec<Degree>) -> Self {
        let mut uses = vec![0; function.ops.len()];
        let operands = function.ops.iter().flat_map(Op::operands);
        for value in operands.chain(function.outputs.iter().copied()) {
            uses[value.index()] += 1;
        }
        let products = function.ops.iter().filter_map(|op| match *op {
            Op::Mul(a, b) => Some([a.min(b), a.max(b)]),
            _ => None,
        });
        Self {
            function,
            degrees,
            uses,
            products: products.collect(),
        }
    }

    /// The factors of a product in two groups, the constant ones and the others. The factors within a group are
    /// multiplied first. `None` unless this saves operations.
    fn split(&self, value: Value) -> Option<[Vec<Value>; 2]> {
        let Op::Mul(a, b) = self.function.ops[value.index()] else {
            return None;
        };
        if let Some((factor, rest)) = self.scaled(value) {
            let (mut factors, rest) = self.peel(rest, |value| self.uses[value.index()] == 1);
            let is_nested = !factors.is_empty();
            factors.push(factor);
            return is_nested.then(|| [factors, vec![rest]]);
        }
        let ((mut factors, a), (more, b)) = (self.peel(a, |_| true), self.peel(b, |_| true));
        factors.extend(more);
        let is_taken = self.products.contains(&[a.min(b), a.max(b)]);
        (!factors.is_empty() && is_taken).then(|| [factors, vec![a, b]])
    }

    /// The constant factors of a value and the rest. `may` selects the values to take apart.
    fn peel(&self, mut value: Value, may: impl Fn(Value) -> bool) -> (Vec<Value>, Value) {
        let mut factors = Vec::new();
        while may(value)
            && let Some((factor, rest)) = self.scaled(value)
        {
            factors.push(factor);
            value = rest;
        }
        (factors, value)
    }

    /// A constant factor of a value that varies, and the rest.
    fn scaled(&self, value: Value) -> Option<(Value, Value)> {
        let Op::Mul(a, b) = self.function.ops[value.index()] else {
            return None;
        };
        match [a, b].map(|value| self.degrees[value.index()] == Degree::AtMost(0)) {
            [true, false] => Some((a, b)),
            [false, true] => Some((b, a)),
            _ => None,
        }
    }
}
