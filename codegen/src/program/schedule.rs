//! Order and dead code: keeps what outputs and guards need, in the order it was built.
//!
//! The order of construction is kept because it follows the derivation (position, velocity, factors, solve),
//! which reads well, and because operands come first in it by construction.

use super::{Guard, Op, Value};

/// Drops unneeded operations and renumbers the rest.
pub(super) fn prune(
    ops: Vec<Op>,
    names: Vec<Option<String>>,
    outputs: Vec<Value>,
) -> (Vec<Op>, Vec<Option<String>>, Vec<Value>) {
    let mut needed: Vec<bool> = ops.iter().map(|op| matches!(op, Op::Guard(_))).collect();
    for output in &outputs {
        needed[output.index()] = true;
    }
    for index in (0..ops.len()).rev() {
        if needed[index] {
            for operand in ops[index].operands() {
                needed[operand.index()] = true;
            }
        }
    }
    let mut renumbered = vec![Value::new(0); ops.len()];
    let (mut kept, mut kept_names) = (Vec::new(), Vec::new());
    for (index, (op, name)) in ops.into_iter().zip(names).enumerate() {
        if needed[index] {
            renumbered[index] = Value::new(kept.len());
            kept.push(map_operands(op, |value| renumbered[value.index()]));
            kept_names.push(name);
        }
    }
    let outputs = outputs
        .into_iter()
        .map(|value| renumbered[value.index()])
        .collect();
    (kept, kept_names, outputs)
}

fn map_operands(op: Op, map: impl Fn(Value) -> Value) -> Op {
    match op {
        Op::Input(_) | Op::Number(_) | Op::Pi => op,
        Op::Neg(a) => Op::Neg(map(a)),
        Op::Add(a, b) => Op::Add(map(a), map(b)),
        Op::Sub(a, b) => Op::Sub(map(a), map(b)),
        Op::Mul(a, b) => Op::Mul(map(a), map(b)),
        Op::Div(a, b) => Op::Div(map(a), map(b)),
        Op::Sqrt(a) => Op::Sqrt(map(a)),
        Op::Power(a, exponent) => Op::Power(map(a), exponent),
        Op::Call(function, a) => Op::Call(function, map(a)),
        Op::Atan2(y, x) => Op::Atan2(map(y), map(x)),
        Op::Guard(guard) => Op::Guard(map_guard(guard, map)),
    }
}

fn map_guard(guard: Guard, map: impl Fn(Value) -> Value) -> Guard {
    match guard {
        Guard::Pivot { pivot, value } => Guard::Pivot {
            pivot,
            value: map(value),
        },
        Guard::Constraint {
            constraint,
            squared,
            reference,
        } => Guard::Constraint {
            constraint,
            squared: map(squared),
            reference: reference.map(map),
        },
        Guard::Frame {
            quasi,
            squared,
            reference,
        } => Guard::Frame {
            quasi,
            squared: map(squared),
            reference: reference.map(map),
        },
        Guard::Mass {
            constraint,
            pivot,
            diagonal,
        } => Guard::Mass {
            constraint,
            pivot: map(pivot),
            diagonal: map(diagonal),
        },
        Guard::Surface { surface, squared } => Guard::Surface {
            surface,
            squared: map(squared),
        },
    }
}
