//! Well-formedness of a function: every operation and every guard reads only values that are defined before it, and
//! every result is a value.

use super::{Function, Op, Value};

/// A rule that a function breaks. This is a defect of the lowering, never of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Malformed {
    /// The operation of this number reads a value that is not defined before it, or a guard.
    Operand(usize),
    /// This result is not a value.
    Output(usize),
}

/// Checks a function.
///
/// # Errors
/// The first rule broken, in order.
pub fn verify(function: &Function) -> Result<(), Malformed> {
    let is_value = |value: Value, end: usize| {
        value.index() < end && !matches!(function.ops[value.index()], Op::Guard(_))
    };
    for (index, op) in function.ops.iter().enumerate() {
        if !op
            .operands()
            .into_iter()
            .all(|operand| is_value(operand, index))
        {
            return Err(Malformed::Operand(index));
        }
    }
    match function
        .outputs
        .iter()
        .position(|&output| !is_value(output, function.ops.len()))
    {
        Some(output) => Err(Malformed::Output(output)),
        None => Ok(()),
    }
}
