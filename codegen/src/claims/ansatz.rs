//! Candidates for a density factor that depends on velocities: functions of the configuration times velocities and
//! kinetic momenta.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, SymbolId};

use super::dynamics::Dynamics;
use super::problem::Problem;
use crate::model::{Model, Topology};

/// Largest number of distinct arguments of the sines and cosines used as functions of the configuration.
const ARGUMENTS: usize = 4;
/// Largest number of coordinates, angles excluded, whose monomials are used.
const LINES: usize = 4;
/// Largest number of terms of one stage. The work of elimination grows with its cube.
const TERMS: usize = 120;
/// Largest degree of monomials of parameters.
const DEGREE: usize = 3;
/// Largest number of monomials of parameters.
const MONOMIALS: usize = 48;

/// Terms of a factor in stages. Each stage contains the one before it.
pub(super) fn stages(
    model: &mut Model,
    problem: &Problem,
    dynamics: &Dynamics,
) -> Vec<Vec<ExprId>> {
    let roots = dynamics.roots();
    let pool = &mut model.pool;
    let mut bases: Vec<ExprId> = Vec::new();
    for coordinate in &model.coordinates {
        bases.push(pool.variable(coordinate.qdot));
    }
    for (coordinate, linear) in model.coordinates.iter().zip(&model.lagrangian.linear) {
        let momentum = pool.diff(model.lagrangian.whole, coordinate.qdot);
        bases.push(pool.sub(momentum, *linear));
    }
    // The constant is needed only with a drift, a linear term or a potential. Without these, the terms of each degree in
    // the velocities solve the equation separately.
    let linear = &model.lagrangian.linear;
    if problem.has_drift(pool)
        || linear.iter().any(|entry| !pool.is_syntactic_zero(*entry))
        || pool.depends_on_any(model.lagrangian.potential, &problem.symbols)
    {
        bases.push(pool.one());
    }
    let circular = circular_functions(pool, &roots, &problem.symbols);
    let lines: Vec<SymbolId> = model
        .coordinates
        .iter()
        .filter(|coordinate| !matches!(coordinate.topology, Topology::Angle))
        .map(|coordinate| coordinate.q)
        .filter(|coordinate| roots.iter().any(|root| pool.depends_on(*root, *coordinate)))
        .take(LINES)
        .collect();
    let polynomials = monomials(pool, &lines, 2);
    let mut functions = vec![pool.one()];
    let mut stages = vec![products(pool, &functions, &bases)];
    for more in [circular, polynomials[1..].to_vec()] {
        if !more.is_empty() {
            functions.extend(more);
            stages.push(products(pool, &functions, &bases));
        }
    }
    stages
}

/// Products of every function with every base, in the order of the functions.
fn products(pool: &mut Pool, functions: &[ExprId], bases: &[ExprId]) -> Vec<ExprId> {
    let mut terms = Vec::new();
    for function in functions {
        for base in bases {
            let term = pool.mul(*function, *base);
            if terms.len() < TERMS && !terms.contains(&term) && !pool.is_syntactic_zero(term) {
                terms.push(term);
            }
        }
    }
    terms
}

/// Sines and cosines of those arguments of circular functions in `roots` that depend on coordinates.
fn circular_functions(pool: &mut Pool, roots: &[ExprId], symbols: &[SymbolId]) -> Vec<ExprId> {
    let mut arguments = Vec::new();
    for id in pool.reachable(roots) {
        if let Node::Call(Function::Sin | Function::Cos | Function::Tan, argument) = pool.node(id)
            && pool.depends_on_any(*argument, symbols)
            && !arguments.contains(argument)
        {
            arguments.push(*argument);
        }
    }
    let mut functions = Vec::new();
    for argument in arguments.into_iter().take(ARGUMENTS) {
        functions.push(pool.call(Function::Sin, argument));
        functions.push(pool.call(Function::Cos, argument));
    }
    functions
}

/// Monomials of the parameters, ordered by degree.
pub(super) fn parameter_monomials(pool: &mut Pool, parameters: &[SymbolId]) -> Vec<ExprId> {
    let mut monomials = monomials(pool, parameters, DEGREE);
    monomials.truncate(MONOMIALS);
    monomials
}

/// Monomials of some symbols up to a degree, ordered by degree: 1, the symbols, their products, and so on.
pub(super) fn monomials(pool: &mut Pool, symbols: &[SymbolId], degree: usize) -> Vec<ExprId> {
    let mut all = vec![pool.one()];
    // The monomials of one degree, each with the index of its last symbol. It is multiplied only by this symbol and
    // later ones, so that no monomial appears twice.
    let mut last = vec![(pool.one(), 0)];
    for _ in 0..degree {
        let mut next = Vec::new();
        for (monomial, first) in last {
            for (position, symbol) in symbols.iter().enumerate().skip(first) {
                let symbol = pool.variable(*symbol);
                next.push((pool.mul(monomial, symbol), position));
            }
        }
        all.extend(next.iter().map(|(monomial, _)| *monomial));
        last = next;
    }
    all
}

/// `sum of coefficient * monomial * term`, scaled to coprime integer coefficients, the first of them positive.
pub(super) fn combination(pool: &mut Pool, parts: &[(Rational, ExprId, ExprId)]) -> ExprId {
    let Some((first, ..)) = parts.first() else {
        return pool.zero();
    };
    let scaled = |(coefficient, ..): &(Rational, ExprId, ExprId)| coefficient.checked_div(first);
    let coefficients: Vec<Rational> = parts.iter().filter_map(scaled).collect();
    // Denominators are kept if their common multiple would be too large.
    let clear = coefficients.iter().fold(1, |common, coefficient| {
        let denominator = coefficient.to_small().map(|(_, d)| d);
        let both = denominator.and_then(|d| least_common_multiple(common, d));
        both.unwrap_or(common)
    });
    // The monomials of each term, in order of first appearance of the terms.
    let mut collected: Vec<(ExprId, Vec<(Rational, ExprId)>)> = Vec::new();
    for (coefficient, (_, monomial, term)) in coefficients.into_iter().zip(parts) {
        let position = match collected.iter().position(|(known, _)| known == term) {
            Some(position) => position,
            None => {
                collected.push((*term, Vec::new()));
                collected.len() - 1
            }
        };
        let coefficient = &coefficient * &Rational::from(clear);
        collected[position].1.push((coefficient, *monomial));
    }
    let mut summands = Vec::new();
    for (term, monomials) in collected {
        let coefficient = pool.combine(&monomials);
        summands.push(pool.mul(coefficient, term));
    }
    pool.sum(&summands)
}

/// The least common multiple of two positive numbers; `None` if it exceeds the range.
fn least_common_multiple(a: i64, b: i64) -> Option<i64> {
    let (mut common, mut rest) = (a, b);
    while rest != 0 {
        (common, rest) = (rest, common % rest);
    }
    (a / common).checked_mul(b)
}
