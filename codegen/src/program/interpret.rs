//! Executes a function without a compiler, as a reference for emitted code.

use dalembert_expr::Function as Elementary;
use dalembert_numbers::Numbers;

use super::{Function, Guard, Input, Op, Value};

/// Executes `function`. `input` returns the value of each argument. The results are in the order of the outputs.
///
/// # Errors
/// The guard that did not hold.
pub fn interpret(function: &Function, input: &dyn Fn(Input) -> f64) -> Result<Vec<f64>, Guard> {
    let values = values(function, input)?;
    Ok(function
        .outputs
        .iter()
        .map(|output| values[output.index()])
        .collect())
}

/// Every value of `function`; NaN for guards that hold.
pub(super) fn values(function: &Function, input: &dyn Fn(Input) -> f64) -> Result<Vec<f64>, Guard> {
    let mut values: Vec<f64> = Vec::with_capacity(function.ops.len());
    for op in &function.ops {
        let value = execute(op, &values, input)?;
        values.push(value);
    }
    Ok(values)
}

fn execute(op: &Op, values: &[f64], input: &dyn Fn(Input) -> f64) -> Result<f64, Guard> {
    let at = |value: &Value| values[value.index()];
    Ok(match op {
        Op::Input(argument) => input(*argument),
        Op::Number(number) => number.to_f64(),
        Op::Pi => std::f64::consts::PI,
        Op::Neg(a) => -at(a),
        Op::Add(a, b) => at(a) + at(b),
        Op::Sub(a, b) => at(a) - at(b),
        Op::Mul(a, b) => at(a) * at(b),
        Op::Div(a, b) => at(a) / at(b),
        Op::Sqrt(a) => at(a).sqrt(),
        Op::Power(a, exponent) => at(a).powf(exponent.to_f64()),
        Op::Call(function, a) => elementary(*function, at(a)),
        // A zero of either sign counts as 0.
        Op::Atan2(y, x) => (at(y) + 0.0).atan2(at(x) + 0.0),
        Op::Guard(guard) if holds(guard, values) => f64::NAN,
        Op::Guard(guard) => return Err(guard.clone()),
    })
}

fn holds(guard: &Guard, values: &[f64]) -> bool {
    match *guard {
        Guard::Pivot { value, .. } => values[value.index()] > 0.0,
        Guard::Constraint {
            squared,
            reference: None,
            ..
        }
        | Guard::Frame {
            squared,
            reference: None,
            ..
        }
        | Guard::Surface {
            squared,
            reference: None,
            ..
        } => values[squared.index()] > 0.0,
        Guard::Constraint {
            squared,
            reference: Some(reference),
            ..
        }
        | Guard::Frame {
            squared,
            reference: Some(reference),
            ..
        }
        | Guard::Surface {
            squared,
            reference: Some(reference),
            ..
        } => values[squared.index()] > Guard::LEAST_SQUARED_RATIO * values[reference.index()],
        Guard::Mass {
            pivot, diagonal, ..
        } => values[pivot.index()] > Guard::LEAST_PIVOT_RATIO * values[diagonal.index()],
    }
}

/// The value of a function of the language, over any kind of number.
pub fn elementary<L: Numbers>(function: Elementary, x: L) -> L {
    macro_rules! by_name {
        ($($meaning:literal $variant:ident $name:ident)*) => {
            match function {
                $(Elementary::$variant => x.$name(),)*
            }
        };
    }
    dalembert_expr::with_functions!(by_name)
}
