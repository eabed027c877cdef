//! Jumps of a quantity whose rate is 0 wherever it exists: `abs(x)/x` at `x = 0`, `atan2(sin(x), cos(x))` at `x = pi`.
//!
//! Along a motion, which is analytic, a quantity made of sums, products, quotients, sines, cosines and exponentials is
//! meromorphic where the arguments of its functions are finite, so that a rate of 0 makes it constant. Roots,
//! absolute values, logarithms and inverse functions choose a branch; without poles they are continuous, so that a rate of
//! 0 still makes them constant. Together with a pole, or in the cut of `atan2`, a branch may change. So may a function of
//! an infinite argument, such as `tanh(1/x)`: it has different limits on both sides, where all its derivatives are 0.
//!
//! A root has no rate where its argument is 0, and a motion may stay there: `y = 0` is a motion of `dot(x) = 1`,
//! `dot(y) = sqrt(y)`, along which `x - 2*sqrt(y)` is not constant. This needs equations that are not regular, otherwise
//! motions off that set are near, and the quantity is constant along all. It also needs an infinite slope: the slope of
//! `sqrt(x^2 + y^2)` is bounded, so that its rate along neighbouring curves tends to 0.
//!
//! That the equations of motion have the same denominator does not exclude a jump: `sin(x)/x` has a value at `x = 0` in
//! the limit, and a motion passes there. The denominator `B` of a quantity excludes a jump in four cases.
//!
//! 1. `B` has a sign that excludes 0, and exists everywhere.
//! 2. `B` is constant along every motion.
//! 3. The equations are regular everywhere, and `B` is 0 only in a set of codimension 2.
//! 4. No motion passes the zeros of `B`. See [`super::barriers`] for this case and the case before it.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, Sign, Singularity, SymbolId};

use super::barriers::{cannot_stay, has_continuous_flow, is_barrier};
use super::regularity::domain;
use crate::model::Model;

/// A place where `value` may jump, as text; `None` if it cannot jump. `is_constant` is true for expressions that are
/// constant along every motion. `equations` are the expressions of the motion, `None` for a function that is not
/// followed along a motion.
pub(super) fn possible_jump(
    model: &mut Model,
    value: ExprId,
    equations: Option<&[ExprId]>,
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> Option<String> {
    let parts = branching(model, value)?;
    let poles = poles(&mut model.pool, &parts, WithLogarithms(true));
    if let Some(place) =
        cut(model, &parts, is_constant).or_else(|| infinite(model, poles, equations, is_constant))
    {
        return Some(place);
    }
    let equations = equations?;
    if has_continuous_flow(model, equations) {
        return None;
    }
    for id in infinite_slopes(&mut model.pool, &parts) {
        let is_harmless = model.pool.sign(id) == Sign::Positive
            || cannot_stay(model, id)
            || is_constant(model, id);
        if !is_harmless {
            return Some(format!("where `{}` is 0", model.pool.text(id)));
        }
    }
    None
}

/// The parts of an expression; `None` if none of them chooses a branch.
fn branching(model: &Model, value: ExprId) -> Option<Vec<ExprId>> {
    let parts = model.pool.reachable(&[value]);
    let branches = parts.iter().any(|id| chooses_branch(&model.pool, *id));
    branches.then_some(parts)
}

/// True if an expression may have kinks or jumps along a motion, apart from its poles.
pub(super) fn may_bend(
    model: &mut Model,
    value: ExprId,
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> bool {
    let parts = model.pool.reachable(&[value]);
    parts
        .into_iter()
        .any(|id| match model.pool.node(id).clone() {
            Node::Product(factors) => {
                let roots = factors.into_iter().filter(|(_, power)| !power.is_integer());
                let mut bases = roots.map(|(base, _)| base);
                bases.any(|base| {
                    model.pool.sign(base) != Sign::Positive && !is_constant(model, base)
                })
            }
            Node::Call(_, argument) => {
                chooses_branch(&model.pool, id) && !is_constant(model, argument)
            }
            _ => chooses_branch(&model.pool, id),
        })
}

/// True if an expression is analytic at all states.
pub(super) fn is_smooth(model: &mut Model, value: ExprId) -> bool {
    let parts = model.pool.reachable(&[value]);
    !may_bend(model, value, &mut |_, _| false)
        && (poles(&mut model.pool, &parts, WithLogarithms(true)).into_iter())
            .all(|id| model.pool.sign(id).is_nonzero() && !has_gaps(model, id))
}

/// A place where `value` jumps as a function of the state, as text; see [`possible_jump`].
pub(super) fn discontinuity(
    model: &mut Model,
    value: ExprId,
    equations: &[ExprId],
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> Option<String> {
    let parts = branching(model, value)?;
    // A logarithm has the same limit on both sides of its pole.
    let poles = poles(&mut model.pool, &parts, WithLogarithms(false));
    cut(model, &parts, is_constant).or_else(|| infinite(model, poles, Some(equations), is_constant))
}

/// A cut that a motion may cross, as text.
fn cut(
    model: &mut Model,
    parts: &[ExprId],
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> Option<String> {
    for id in parts {
        if let Node::Atan2(y, x) = model.pool.node(*id) {
            let (y, x) = (*y, *x);
            let sign = model.pool.sign(x);
            // The cut is the half-line `y = 0`, `x <= 0`.
            let is_clear = sign.is_nonnegative() && sign.is_nonzero() && !has_gaps(model, x);
            if !(is_clear || is_constant(model, y) && is_constant(model, x)) {
                return Some(format!("in the cut of `{}`", model.pool.text(*id)));
            }
        }
    }
    None
}

/// The first of these denominators, tangents or arguments of logarithms that a motion may pass while the function is
/// infinite, as text.
fn infinite(
    model: &mut Model,
    poles: Vec<ExprId>,
    equations: Option<&[ExprId]>,
    is_constant: &mut dyn FnMut(&mut Model, ExprId) -> bool,
) -> Option<String> {
    let coordinates = model.coordinates.iter();
    let mut varying: Vec<SymbolId> = coordinates.flat_map(|it| [it.q, it.qdot]).collect();
    varying.push(model.time);
    for id in poles {
        let is_harmless = !model.pool.depends_on_any(id, &varying)
            || model.pool.sign(id).is_nonzero() && !has_gaps(model, id)
            || equations.is_some_and(|equations| is_barrier(model, equations, id))
            || is_constant(model, id);
        if !is_harmless {
            let text = model.pool.text(id);
            return Some(match model.pool.node(id) {
                Node::Call(Function::Tan, _) => format!("at the poles of `{text}`"),
                _ => format!("where `{text}` is 0"),
            });
        }
    }
    None
}

/// True if an expression may have no real value at some states: outside of the domain of a root or of an inverse
/// function. On two sides of such states its values may differ.
pub(super) fn has_gaps(model: &Model, id: ExprId) -> bool {
    let parts = model.pool.reachable(&[id]);
    parts.iter().any(|part| match model.pool.node(*part) {
        Node::Product(factors) => factors
            .iter()
            .any(|(base, power)| !power.is_integer() && !model.pool.sign(*base).is_nonnegative()),
        Node::Call(function, argument) if function.singularity() == Singularity::Ends => {
            let order = model.pool.reachable(&[*argument]);
            let range = model.pool.enclose(&order, &domain(model, *argument));
            !range[argument.index()].is_some_and(|range| range.lo >= -1.0 && range.hi <= 1.0)
        }
        _ => false,
    })
}

/// True if an expression may have poles.
fn may_be_infinite(pool: &Pool, id: ExprId) -> bool {
    let parts = pool.reachable(&[id]);
    parts.iter().any(|part| match pool.node(*part) {
        Node::Product(factors) => (factors.iter())
            .any(|(base, power)| power.is_negative() && !pool.sign(*base).is_nonzero()),
        Node::Call(function, _) => matches!(
            function.singularity(),
            Singularity::Poles | Singularity::Logarithm { .. }
        ),
        _ => false,
    })
}

fn chooses_branch(pool: &Pool, id: ExprId) -> bool {
    match pool.node(id) {
        Node::Product(factors) => factors.iter().any(|(_, exponent)| !exponent.is_integer()),
        // With an infinite argument, these have no limit, or different limits on both sides: `tanh(1/x)`.
        Node::Call(function, argument) => {
            function.chooses_branch() || may_be_infinite(pool, *argument)
        }
        Node::Atan2(..) => true,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => false,
    }
}

/// Functions at whose zeros a root or an inverse function has an infinite slope.
pub(super) fn infinite_slopes(pool: &mut Pool, parts: &[ExprId]) -> Vec<ExprId> {
    let mut found = Vec::new();
    for id in parts {
        match pool.node(*id).clone() {
            Node::Product(factors) => {
                let roots = factors.iter().filter(|(_, power)| {
                    !power.is_integer() && !power.is_negative() && *power < Rational::ONE
                });
                let roots = roots.filter(|(base, power)| {
                    *power < Rational::HALF || !is_sum_of_squares(pool, *base)
                });
                found.extend(roots.map(|(base, _)| *base));
            }
            Node::Call(function, argument) if function.singularity() == Singularity::Ends => {
                let square = pool.pow(argument, Rational::from(2));
                let one = pool.one();
                found.push(pool.sub(one, square));
            }
            _ => {}
        }
    }
    found
}

/// True for a sum of squares with positive coefficients.
fn is_sum_of_squares(pool: &Pool, id: ExprId) -> bool {
    let (constant, terms) = pool.linear_form(id);
    let is_square = |term: ExprId| match pool.node(term) {
        Node::Product(factors) => factors
            .iter()
            .all(|(base, power)| *power == Rational::from(2) || pool.sign(*base) == Sign::Positive),
        _ => pool.sign(term) == Sign::Positive,
    };
    !constant.is_negative()
        && (terms.into_iter()).all(|(factor, term)| !factor.is_negative() && is_square(term))
}

/// True if arguments of logarithms count as denominators.
pub(super) struct WithLogarithms(pub(super) bool);

/// Denominators and tangents, and arguments of logarithms.
pub(super) fn poles(
    pool: &mut Pool,
    parts: &[ExprId],
    WithLogarithms(has_logarithms): WithLogarithms,
) -> Vec<ExprId> {
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
                (Singularity::Logarithm { shift }, argument) if has_logarithms => {
                    poles.push(pool.shifted(argument, shift));
                }
                (Singularity::Poles, _) => poles.push(*id),
                _ => {}
            },
            Node::Atan2(..) | Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => {}
        }
    }
    poles
}
