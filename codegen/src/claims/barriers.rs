//! Zeros of a denominator that no motion passes, or only motions that are limits of others.
//!
//! *Codimension 2.* Let `B` be a sum of terms without negative values, two of which depend on different coordinates or
//! velocities, such as `x^2 + y^2`. Its zeros have codimension 2 in the states, so that the states whose motions meet
//! them form a set of codimension 1, and other motions are dense. A quantity with the rate 0 is constant along those. If
//! the motion depends continuously on its start, it is constant along all. That needs equations that are regular
//! everywhere: all motions of `dot(x) = x^2/(x^2 + y^2)`, `dot(y) = x*y/(x^2 + y^2)` pass the origin, and so do those
//! of `dot(x) = x/t`, `dot(y) = y/t`. Constraints may tie coordinates and velocities to each other:
//! `x*dot(y) = y*dot(x)` leads all motions to the origin. They exclude this case.
//!
//! *Infinite potentials.* Where the potential becomes infinite, the conservation of the energy makes the kinetic energy
//! infinite, and the velocity too if the metric is finite. No motion passes.
//!
//! *Ends of the domain.* If the equations contain the logarithm or a root of `B`, and `B` is strictly monotonic in a
//! coordinate, they have no real values on one side of its zeros. No motion passes to that side.

use std::collections::BTreeSet;

use dalembert_expr::{
    ExprId, Function, Node, Pool, Rational, Sign, Singularity, SymbolId, Verdict as Zero,
};

use super::continuity::has_gaps;
use super::definite::is_regular;
use crate::model::Model;

/// True if no motion passes the zeros of `denominator`, or only motions that are limits of others.
pub(super) fn is_barrier(model: &mut Model, equations: &[ExprId], denominator: ExprId) -> bool {
    let variables = state_variables(model);
    ends_domain(model, equations, denominator)
        || has_infinite_potential(model, denominator)
        || is_thin(model, denominator, &variables)
            && !has_gaps(model, denominator)
            && has_continuous_flow(model, equations)
}

/// True if almost all motions avoid the zeros of a function: they have codimension 2 in the states.
pub(super) fn is_avoided(model: &mut Model, denominator: ExprId) -> bool {
    let variables = state_variables(model);
    is_thin(model, denominator, &variables) && !has_gaps(model, denominator)
}

/// True if the equations of motion are certain to be locally Lipschitz at all states.
pub(super) fn has_continuous_flow(model: &mut Model, equations: &[ExprId]) -> bool {
    let parts = model.pool.reachable(equations);
    let is_smooth = |part: &ExprId| match model.pool.node(*part) {
        Node::Product(factors) => factors.iter().all(|(base, power)| {
            let sign = model.pool.sign(*base);
            match power.is_integer() {
                true => !power.is_negative() || sign.is_nonzero() && !has_gaps(model, *base),
                false => sign == Sign::Positive,
            }
        }),
        Node::Call(function, argument) => match function.singularity() {
            Singularity::None | Singularity::Kink => true,
            Singularity::Logarithm { .. } => model.pool.sign(*argument) == Sign::Positive,
            Singularity::Poles | Singularity::Ends => false,
        },
        Node::Atan2(..) => false,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => true,
    };
    let metric = model.lagrangian.metric.clone();
    parts.iter().all(is_smooth) && (model.is_first_order() || is_regular(model, &metric))
}

/// True if no motion stays where a root with the argument `radicand` has no rate: the potential or the force is
/// infinite there.
pub(super) fn cannot_stay(model: &mut Model, radicand: ExprId) -> bool {
    has_infinite_potential(model, radicand) || has_infinite_force(model, radicand)
}

/// True if the potential is a root of `radicand`, whose slope is infinite where it is 0, plus terms without roots.
fn has_infinite_force(model: &mut Model, radicand: ExprId) -> bool {
    let is_driven = model.is_first_order()
        || !model.forces.is_empty()
        || model.inputs().next().is_some()
        || !model.constraints.is_empty();
    let coordinates: Vec<SymbolId> = model.coordinates.iter().map(|it| it.q).collect();
    let is_monotonic = coordinates.iter().any(|by| {
        let slope = model.pool.diff(radicand, *by);
        is_strict(model, slope)
    });
    if is_driven || !is_monotonic {
        return false;
    }
    let pool = &model.pool;
    let is_root = |(base, power): &(ExprId, Rational)| {
        *base == radicand && !power.is_negative() && *power < Rational::ONE
    };
    let is_plain = |term: ExprId| {
        let has_roots = |part: &ExprId| match pool.node(*part) {
            Node::Product(factors) => factors.iter().any(|(_, power)| !power.is_integer()),
            Node::Call(function, _) => function.singularity() != Singularity::None,
            Node::Atan2(..) => true,
            Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => false,
        };
        pool.is_finite(term) && !pool.reachable(&[term]).iter().any(has_roots)
    };
    let metric = model.lagrangian.metric.iter().flatten();
    let mut others = metric.chain(&model.lagrangian.linear);
    if !others.all(|entry| is_plain(*entry)) {
        return false;
    }
    let (_, terms) = pool.linear_form(model.lagrangian.potential);
    let others: Vec<ExprId> = (terms.into_iter().map(|(_, term)| term))
        .filter(|term| !is_plain(*term))
        .collect();
    let [term] = others[..] else {
        return false;
    };
    let Node::Product(factors) = pool.node(term) else {
        return false;
    };
    let is_constant =
        |base: ExprId| pool.sign(base).is_nonzero() && !pool.depends_on_any(base, &coordinates);
    factors.iter().any(is_root)
        && factors
            .iter()
            .all(|factor| is_root(factor) || is_constant(factor.0))
}

/// True if the potential is infinite where `denominator` is 0, the energy is conserved and the metric is finite. All
/// terms of the potential that may be infinite have the same sign, unless there is only one.
fn has_infinite_potential(model: &Model, denominator: ExprId) -> bool {
    let pool = &model.pool;
    let is_driven = model.is_first_order()
        || !model.forces.is_empty()
        || model.inputs().next().is_some()
        || pool.depends_on(model.lagrangian.whole, model.time)
        || (model.constraints.iter()).any(|constraint| {
            constraint.nonlinear.is_some() || !pool.is_syntactic_zero(constraint.affine)
        });
    let mut entries = model.lagrangian.metric.iter().flatten();
    if is_driven || !entries.all(|entry| pool.is_finite(*entry)) {
        return false;
    }
    let (_, terms) = pool.linear_form(model.lagrangian.potential);
    // A total derivative such as `dot(x)/x` leaves `0/x` in the potential.
    let infinite: Vec<_> = (terms.into_iter())
        .filter(|(factor, term)| !factor.is_zero() && !pool.is_finite(*term))
        .collect();
    let signs = infinite.iter().map(|(factor, term)| {
        let sign = pool.sign(*term);
        match factor.is_negative() {
            true => (sign.is_nonpositive(), sign.is_nonnegative()),
            false => (sign.is_nonnegative(), sign.is_nonpositive()),
        }
    });
    let signs: Vec<(bool, bool)> = signs.collect();
    let is_uniform = infinite.len() == 1
        || signs.iter().all(|(above, _)| *above)
        || signs.iter().all(|(_, below)| *below);
    is_uniform
        && infinite
            .iter()
            .any(|(_, term)| is_infinite_at(model, *term, denominator))
}

/// True if a term goes to plus or minus infinity where `denominator` goes to 0.
fn is_infinite_at(model: &Model, term: ExprId, denominator: ExprId) -> bool {
    let pool = &model.pool;
    let coordinates: Vec<SymbolId> = model.coordinates.iter().map(|it| it.q).collect();
    let is_logarithm = |id: ExprId| matches!(pool.node(id), Node::Call(Function::Ln, argument) if *argument == denominator);
    let factors = match pool.node(term) {
        Node::Product(factors) => factors.to_vec(),
        _ => return is_logarithm(term),
    };
    let mut count = 0;
    let others_are_constant = factors.iter().all(|(base, power)| {
        let is_pole = *base == denominator && power.is_negative();
        let is_it = is_pole || is_logarithm(*base) && !power.is_negative();
        count += usize::from(is_it);
        is_it || pool.sign(*base).is_nonzero() && !pool.depends_on_any(*base, &coordinates)
    });
    count == 1 && others_are_constant
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

/// The parts of expressions, without those that cancel. `sqrt(x) - sqrt(x)` leaves `0*sqrt(x)`, and so does the total
/// derivative `dot(x)*sqrt(x)` in a Lagrangian; motion passes where such a part has no value.
fn occurring(pool: &Pool, roots: &[ExprId]) -> Vec<ExprId> {
    let mut found = BTreeSet::new();
    let mut pending = roots.to_vec();
    while let Some(id) = pending.pop() {
        if !found.insert(id) {
            continue;
        }
        match pool.node(id) {
            Node::Sum { terms, .. } => pending.extend(
                (terms.iter())
                    .filter(|(factor, _)| !factor.is_zero())
                    .map(|(_, term)| *term),
            ),
            Node::Product(factors) => pending.extend(
                (factors.iter())
                    .filter(|(_, power)| !power.is_zero())
                    .map(|(base, _)| *base),
            ),
            Node::Call(_, argument) => pending.push(*argument),
            Node::Atan2(y, x) => pending.extend([*y, *x]),
            Node::Number(_) | Node::Pi | Node::Symbol(_) => {}
        }
    }
    found.into_iter().collect()
}

/// True if the equations have no real values on one side of the zeros of an expression.
fn ends_domain(model: &mut Model, equations: &[ExprId], id: ExprId) -> bool {
    let parts = occurring(&model.pool, equations);
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
