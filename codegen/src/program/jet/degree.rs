//! Orders after which series end by structure.

use super::super::{Function, Input, Op};

/// Largest degree of a series that is distinguished from an endless one.
const LONGEST: u32 = 4;

/// The order after which all coefficients vanish, for all states and parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Degree {
    /// All coefficients above this order vanish.
    AtMost(u32),
    /// No such order is known.
    Endless,
}

impl Degree {
    /// A degree; endless if it is too high to be of use.
    fn limited(degree: u32) -> Self {
        match degree {
            0..=LONGEST => Self::AtMost(degree),
            _ => Self::Endless,
        }
    }

    fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::AtMost(a), Self::AtMost(b)) => Self::limited(a + b),
            _ => Self::Endless,
        }
    }
}

/// The degree of an operation whose operands have these degrees.
pub(super) fn of(
    op: &Op,
    degrees: &[Degree],
    component: impl Fn(Input) -> Option<Degree>,
) -> Degree {
    const CONSTANT: Degree = Degree::AtMost(0);
    let at = |value: &super::Value| degrees[value.index()];
    match op {
        Op::Input(Input::Time) => Degree::AtMost(1),
        Op::Input(input) => component(*input).unwrap_or(CONSTANT),
        Op::Number(_) | Op::Pi | Op::Guard(_) => CONSTANT,
        Op::Neg(a) | Op::Call(dalembert_expr::Function::Abs, a) => at(a),
        Op::Add(a, b) | Op::Sub(a, b) => at(a).max(at(b)),
        Op::Mul(a, b) => at(a).plus(at(b)),
        Op::Div(a, b) if at(b) == CONSTANT => at(a),
        other => match other.operands().iter().all(|value| at(value) == CONSTANT) {
            true => CONSTANT,
            false => Degree::Endless,
        },
    }
}

/// The degrees of the components of a state: the least degrees that are consistent with the function of their
/// derivatives. Coefficients above them vanish order after order, because each follows from lower ones.
pub fn of_components(rate: &Function, component: impl Fn(Input) -> Option<usize>) -> Vec<Degree> {
    let mut components = vec![Degree::AtMost(0); rate.outputs.len()];
    loop {
        let mut degrees: Vec<Degree> = Vec::with_capacity(rate.ops.len());
        for op in &rate.ops {
            let degree = of(op, &degrees, |input| {
                component(input).map(|i| components[i])
            });
            degrees.push(degree);
        }
        let integrated = rate.outputs.iter().map(|output| {
            let is_zero = matches!(&rate.ops[output.index()], Op::Number(n) if n.is_zero());
            match is_zero {
                true => Degree::AtMost(0),
                false => degrees[output.index()].plus(Degree::AtMost(1)),
            }
        });
        let next: Vec<Degree> = integrated.collect();
        if next == components {
            return components;
        }
        components = next;
    }
}
