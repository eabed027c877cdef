//! Jumps of a quantity whose rate is 0 wherever it exists: `abs(x)/x` at `x = 0`, `atan2(sin(x), cos(x))` at `x = pi`.
//!
//! Along a motion, which is analytic, a quantity made of sums, products, quotients, sines, cosines and exponentials is
//! meromorphic, so that a rate of 0 makes it constant. Roots, absolute values, logarithms and inverse functions choose
//! a branch; without poles they are continuous, so that a rate of 0 still makes them constant. Together with a pole, or
//! in the cut of `atan2`, a branch may change.
//!
//! That the equations of motion have the same denominator does not exclude a jump: `sin(x)/x` has a value at `x = 0` in
//! the limit, and a motion passes there. The denominator `B` of a quantity excludes a jump in four cases.
//!
//! 1. `B` has a sign that excludes 0, and exists everywhere.
//! 2. `B` is constant along every motion.
//! 3. `B` is 0 only in a set of codimension 2 in the states: it is a sum of terms without negative values, two of which
//!    depend on different coordinates or velocities, such as `x^2 + y^2`. The states whose motions meet such a set form
//!    a set of codimension 1, so that other motions are dense, and along them the quantity is constant. Where the
//!    motion depends continuously on its start, it is therefore constant on all of them. Where it does not, as in a
//!    collision of two bodies, the equations determine no motion beyond the set. Constraints may tie the coordinates
//!    or velocities to each other: `x*dot(y) = y*dot(x)` leads all motions to the origin. They exclude this case.
//! 4. The equations contain the logarithm or a root of `B`, and `B` is strictly monotonic in a coordinate: the equations
//!    have no real values on one side of its zeros, so that no motion crosses them.

use dalembert_expr::{ExprId, Function, Node, Pool, Singularity, SymbolId, Verdict as Zero};

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
    let parts = model.pool.reachable(&[value]);
    if !parts.iter().any(|id| chooses_branch(&model.pool, *id)) {
        return None;
    }
    for id in &parts {
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
    for id in poles(&mut model.pool, &parts) {
        let is_harmless = model.pool.sign(id).is_nonzero() && !has_gaps(model, id)
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

/// True if no motion passes the zeros of `denominator`, or only motions that are limits of others.
fn is_barrier(model: &mut Model, equations: &[ExprId], denominator: ExprId) -> bool {
    let variables = state_variables(model);
    let is_thin = is_thin(model, denominator, &variables) && !has_gaps(model, denominator);
    is_thin || ends_domain(model, equations, denominator)
}

/// Coordinates and velocities that may be chosen freely; none in models with constraints, which may tie them.
fn state_variables(model: &Model) -> Vec<SymbolId> {
    if !model.constraints.is_empty() {
        return Vec::new();
    }
    let positions = model.coordinates.iter().map(|coordinate| coordinate.q);
    let velocities = model.coordinates.iter().map(|coordinate| coordinate.qdot);
    match model.is_first_order() {
        true => positions.collect(),
        false => positions.chain(velocities).collect(),
    }
}

/// True if the zeros of a function of the state are certain to have codimension 2 or more.
fn is_thin(model: &mut Model, id: ExprId, variables: &[SymbolId]) -> bool {
    match model.pool.node(id).clone() {
        Node::Product(factors) => factors.iter().all(|(base, exponent)| {
            exponent.is_negative()
                || model.pool.sign(*base).is_nonzero()
                || is_thin(model, *base, variables)
        }),
        Node::Call(Function::Abs, argument) => is_thin(model, argument, variables),
        Node::Sum { constant, terms } => {
            let is_sum_without_negative_values = !constant.is_negative()
                && terms.iter().all(|(factor, term)| {
                    !factor.is_negative() && model.pool.sign(*term).is_nonnegative()
                });
            if !is_sum_without_negative_values {
                return false;
            }
            let terms: Vec<ExprId> = (terms.iter().map(|(_, term)| *term))
                .filter(|term| has_no_open_set_of_zeros(model, *term, variables))
                .collect();
            let pool = &model.pool;
            let share = |one: ExprId, other: ExprId| {
                let both = |by: &SymbolId| pool.depends_on(one, *by) && pool.depends_on(other, *by);
                let every = model.coordinates.iter().flat_map(|it| [it.q, it.qdot]);
                every.into_iter().any(|symbol| both(&symbol))
            };
            (1..terms.len()).any(|i| terms[..i].iter().any(|term| !share(*term, terms[i])))
        }
        _ => false,
    }
}

/// True if a term is certain not to be 0 on an open set of states, for all values of parameters. Each of its factors is
/// strictly monotonic in a variable, or analytic, not constant and free of parameters.
fn has_no_open_set_of_zeros(model: &mut Model, term: ExprId, variables: &[SymbolId]) -> bool {
    let factors = match model.pool.node(term) {
        Node::Product(factors) => factors.iter().map(|(base, _)| *base).collect(),
        _ => vec![term],
    };
    let coordinates = model.coordinates.iter();
    let known: Vec<SymbolId> = coordinates.flat_map(|it| [it.q, it.qdot]).collect();
    factors.into_iter().all(|factor| {
        let is_free = (known.iter())
            .all(|symbol| variables.contains(symbol) || !model.pool.depends_on(factor, *symbol));
        if model.pool.sign(factor).is_nonzero() {
            return true;
        }
        is_free
            && variables.iter().any(|by| {
                let slope = model.pool.diff(factor, *by);
                is_strict(model, slope)
                    || is_analytic_in(model, factor, variables)
                        && model.pool.zero_test(slope) == Zero::Refuted
            })
    })
}

/// True if a slope exists everywhere and is not 0.
fn is_strict(model: &Model, slope: ExprId) -> bool {
    let parts = model.pool.reachable(&[slope]);
    model.pool.sign(slope).is_nonzero()
        && (parts.iter()).all(|part| {
            let node = model.pool.node(*part);
            matches!(node, Node::Number(_) | Node::Pi | Node::Symbol(_))
                || matches!(node, Node::Product(factors) if factors.iter().all(|(_, power)| power.is_integer() && !power.is_negative()))
        })
}

/// True if an expression is a polynomial in some symbols and their sines, cosines and exponentials.
fn is_analytic_in(model: &Model, id: ExprId, variables: &[SymbolId]) -> bool {
    let parts = model.pool.reachable(&[id]);
    parts.iter().all(|part| match model.pool.node(*part) {
        Node::Symbol(symbol) => variables.contains(symbol),
        Node::Product(factors) => factors
            .iter()
            .all(|(_, power)| power.is_integer() && !power.is_negative()),
        Node::Call(function, _) => {
            function.singularity() == Singularity::None && !function.chooses_branch()
        }
        Node::Atan2(..) => false,
        Node::Number(_) | Node::Pi | Node::Sum { .. } => true,
    })
}

/// True if the equations have no real values on one side of the zeros of an expression.
fn ends_domain(model: &mut Model, equations: &[ExprId], id: ExprId) -> bool {
    let parts = model.pool.reachable(equations);
    let needs_sign = parts.iter().any(|part| match model.pool.node(*part) {
        Node::Product(factors) => factors
            .iter()
            .any(|(base, power)| *base == id && !power.is_integer()),
        Node::Call(Function::Ln, argument) => *argument == id,
        _ => false,
    });
    let coordinates: Vec<SymbolId> = model.coordinates.iter().map(|it| it.q).collect();
    needs_sign
        && coordinates.into_iter().any(|by| {
            let slope = model.pool.diff(id, by);
            is_strict(model, slope)
        })
}

/// True if an expression may have no real value at some states: outside of the domain of a root or of an inverse
/// function. On two sides of such states its values may differ.
fn has_gaps(model: &Model, id: ExprId) -> bool {
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

fn chooses_branch(pool: &Pool, id: ExprId) -> bool {
    match pool.node(id) {
        Node::Product(factors) => factors.iter().any(|(_, exponent)| !exponent.is_integer()),
        Node::Call(function, _) => function.chooses_branch(),
        Node::Atan2(..) => true,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => false,
    }
}

/// Denominators, arguments of logarithms, and tangents.
fn poles(pool: &mut Pool, parts: &[ExprId]) -> Vec<ExprId> {
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
