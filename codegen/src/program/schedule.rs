//! Dead code elimination: keeps the operations that outputs and guards need, in the order of construction.
//!
//! The order of construction follows the derivation (position, velocity, factors, solve), which reads well. In this
//! order every operand precedes the operations that use it.

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
            kept.push(op.with_operands(|value| renumbered[value.index()]));
            kept_names.push(name);
        }
    }
    let outputs = outputs
        .into_iter()
        .map(|value| renumbered[value.index()])
        .collect();
    (kept, kept_names, outputs)
}

impl Op {
    /// The operation with mapped operands. Operands of sums and products are sorted.
    pub(super) fn with_operands(self, map: impl Fn(Value) -> Value) -> Self {
        match self {
            Self::Input(_) | Self::Number(_) | Self::Pi => self,
            Self::Neg(a) => Self::Neg(map(a)),
            Self::Add(a, b) => {
                let (a, b) = (map(a), map(b));
                Self::Add(a.min(b), a.max(b))
            }
            Self::Sub(a, b) => Self::Sub(map(a), map(b)),
            Self::Mul(a, b) => {
                let (a, b) = (map(a), map(b));
                Self::Mul(a.min(b), a.max(b))
            }
            Self::Div(a, b) => Self::Div(map(a), map(b)),
            Self::Sqrt(a) => Self::Sqrt(map(a)),
            Self::Power(a, exponent) => Self::Power(map(a), exponent),
            Self::Call(function, a) => Self::Call(function, map(a)),
            Self::Atan2(y, x) => Self::Atan2(map(y), map(x)),
            Self::Guard(guard) => Self::Guard(map_guard(guard, map)),
        }
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
        Guard::Surface {
            surface,
            squared,
            reference,
        } => Guard::Surface {
            surface,
            squared: map(squared),
            reference: reference.map(map),
        },
    }
}
