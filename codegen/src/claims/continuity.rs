//! Jumps of a quantity whose rate is 0 wherever it exists: `abs(x)/x` at `x = 0`, `atan2(sin(x), cos(x))` at `x = pi`.
//!
//! Along a motion, which is analytic, a quantity made of sums, products, quotients, sines, cosines and exponentials is
//! meromorphic, so that a rate of 0 makes it constant. Roots, absolute values, logarithms and inverse functions choose
//! a branch; without poles they are continuous, so that a rate of 0 still makes them constant. Together with a pole, or
//! in the cut of `atan2`, a branch may change. No jump occurs where the equations of motion do not exist. None occurs
//! if the argument that would have to vanish is constant or has one sign.

use dalembert_expr::{ExprId, Function, Node, Pool, Singularity};

use crate::model::Model;

/// A place where `value` may jump, as text; `None` if it cannot jump. `is_constant` is true for expressions that are
/// constant along every motion. The motion has no equations where one of `singular` is 0.
pub(super) fn possible_jump(
    model: &mut Model,
    value: ExprId,
    singular: &[ExprId],
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> Option<String> {
    let parts = model.pool.reachable(&[value]);
    if !parts.iter().any(|id| chooses_branch(&model.pool, *id)) {
        return None;
    }
    for id in &parts {
        if let Node::Atan2(y, x) = model.pool.node(*id) {
            let (y, x) = (*y, *x);
            let sign = model.pool.sign(x);
            // The cut is the half-line `y = 0`, `x <= 0`.
            let is_clear = sign.is_nonnegative() && sign.is_nonzero();
            if !(is_clear || is_constant(model, y) && is_constant(model, x)) {
                return Some(format!("in the cut of `{}`", model.pool.text(*id)));
            }
        }
    }
    for id in poles(&mut model.pool, &parts) {
        let is_harmless = singular.contains(&id) || model.pool.sign(id).is_nonzero();
        if !is_harmless && !is_constant(model, id) {
            let text = model.pool.text(id);
            return Some(match model.pool.node(id) {
                Node::Call(Function::Tan, _) => format!("at the poles of `{text}`"),
                _ => format!("where `{text}` is 0"),
            });
        }
    }
    None
}

fn chooses_branch(pool: &Pool, id: ExprId) -> bool {
    match pool.node(id) {
        Node::Product(factors) => factors.iter().any(|(_, exponent)| !exponent.is_integer()),
        Node::Call(function, _) => function.chooses_branch(),
        Node::Atan2(..) => true,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => false,
    }
}

/// Denominators, arguments of logarithms, and tangents.
pub(super) fn poles(pool: &mut Pool, parts: &[ExprId]) -> Vec<ExprId> {
    let mut poles = Vec::new();
    for id in parts {
        match pool.node(*id) {
            Node::Product(factors) => {
                let below = factors
                    .iter()
                    .filter(|(_, exponent)| exponent.is_negative());
                poles.extend(below.map(|(base, _)| *base));
            }
            Node::Call(function, argument) => match (function.singularity(), *argument) {
                (Singularity::None | Singularity::Ends | Singularity::Kink, _) => {}
                (Singularity::Logarithm { shift }, argument) => {
                    poles.push(pool.shifted(argument, shift));
                }
                (Singularity::Poles, _) => poles.push(*id),
            },
            Node::Atan2(..) | Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => {}
        }
    }
    poles
}
