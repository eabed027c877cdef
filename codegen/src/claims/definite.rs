//! Metrics that are certified to be positive definite wherever they are regular.
//!
//! By Sylvester's criterion a matrix is positive definite if its leading minors are positive. A minor that is never
//! negative and not 0 everywhere is positive on a dense set, if it is analytic. If all minors are such, the metric has
//! no negative eigenvalue anywhere, and is positive definite where it is regular. `diag(m, m*r^2)` with `m > 0` is an
//! example. The same holds if the kinetic energy is written as a sum of squares with positive coefficients.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, Sign, SymbolId, Verdict as Zero};

use super::bounds::is_never_negative;
use crate::mechanics::inverse::{determinant, tidy};
use crate::model::Model;

/// Largest number of rows of a block whose minors are written out.
const LARGEST: usize = 4;

/// True if a metric is certified to be positive definite at all states at which it is regular.
pub(super) fn is_positive_definite(model: &mut Model, metric: &[Vec<ExprId>]) -> bool {
    blocks(&model.pool, metric).into_iter().all(|block| {
        let size = block.len();
        size <= LARGEST
            && (1..=size).all(|count| {
                let places = &block[..count];
                let row = |i: &usize| places.iter().map(|j| metric[*i][*j]).collect();
                let rows: Vec<Vec<ExprId>> = places.iter().map(row).collect();
                let columns: Vec<usize> = (0..count).collect();
                let minor = determinant(&mut model.pool, &rows, &columns);
                is_positive_almost_everywhere(model, minor)
            })
    })
}

/// True if a metric is certified to be regular at all states.
pub(super) fn is_regular(model: &mut Model, metric: &[Vec<ExprId>]) -> bool {
    blocks(&model.pool, metric).into_iter().all(|block| {
        let row = |i: &usize| block.iter().map(|j| metric[*i][*j]).collect();
        let rows: Vec<Vec<ExprId>> = block.iter().map(row).collect();
        let columns: Vec<usize> = (0..block.len()).collect();
        block.len() <= LARGEST && {
            let determinant = determinant(&mut model.pool, &rows, &columns);
            let determinant = tidy(&mut model.pool, determinant);
            model.pool.sign(determinant).is_nonzero()
        }
    })
}

/// True if the terms of the Lagrangian that are quadratic in velocities are never negative.
pub(super) fn has_kinetic_energy_of_squares(model: &mut Model) -> bool {
    let velocities: Vec<SymbolId> = model.coordinates.iter().map(|it| it.qdot).collect();
    let (_, terms) = model.pool.linear_form(model.lagrangian.whole);
    terms.into_iter().all(|(coefficient, term)| {
        let pool = &mut model.pool;
        let is_square = !coefficient.is_negative() && pool.sign(term).is_nonnegative();
        is_square
            || velocities.iter().all(|by| {
                let slope = pool.diff(term, *by);
                velocities.iter().all(|other| {
                    let second = pool.diff(slope, *other);
                    pool.zero_test(second) == Zero::Proved
                })
            })
    })
}

/// Sets of coordinates between which a metric has no entries.
fn blocks(pool: &Pool, metric: &[Vec<ExprId>]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for i in 0..metric.len() {
        let is_tied = |block: &Vec<usize>| {
            let mut entries = block.iter().map(|j| metric[i][*j]);
            entries.any(|entry| !pool.is_syntactic_zero(entry))
        };
        let (tied, others): (Vec<_>, Vec<_>) = blocks.into_iter().partition(is_tied);
        blocks = others;
        blocks.push(tied.into_iter().flatten().chain([i]).collect());
    }
    blocks
}

/// True if a function is certified to be positive, or to be analytic, never negative, and not 0 everywhere.
fn is_positive_almost_everywhere(model: &mut Model, id: ExprId) -> bool {
    if model.pool.sign(id) == Sign::Positive {
        return true;
    }
    let parts = model.pool.reachable(&[id]);
    let is_analytic = parts.iter().all(|part| match model.pool.node(*part) {
        Node::Product(factors) => factors.iter().all(|(_, power)| power.is_integer()),
        Node::Call(function, _) => !function.chooses_branch(),
        Node::Atan2(..) => false,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => true,
    });
    is_analytic
        && model.pool.zero_test(id) == Zero::Refuted
        && (is_never_negative(model, id) || has_no_negative_group(model, id))
}

/// True if the terms of a function with the same positive factor have a sum that is certainly not negative, for each
/// such factor: `m1*m2 + m2^2*(1 - cos(a)^2)`.
fn has_no_negative_group(model: &mut Model, id: ExprId) -> bool {
    let pool = &mut model.pool;
    let flat = tidy(pool, id);
    let flat = pool.multiply_out(flat);
    let (constant, terms) = pool.linear_form(flat);
    let mut sums = vec![(pool.one(), constant)];
    for (coefficient, term) in terms {
        let (key, [low, high]) = split(pool, term);
        let bound = match coefficient.is_negative() {
            false => low,
            true => high,
        };
        let Some(bound) = bound else {
            return false;
        };
        let part = &coefficient * &bound;
        match sums.iter_mut().find(|(known, _)| *known == key) {
            Some((_, sum)) => *sum = &*sum + &part,
            None => sums.push((key, part)),
        }
    }
    sums.iter().all(|(_, sum)| !sum.is_negative())
}

/// The positive factor of a product, and the lower and upper bounds of the other factors, where they are known.
fn split(pool: &mut Pool, term: ExprId) -> (ExprId, [Option<Rational>; 2]) {
    let factors = match pool.node(term) {
        Node::Product(factors) => factors.to_vec(),
        _ => vec![(term, Rational::ONE)],
    };
    let (mut positive, mut others) = (Vec::new(), Vec::new());
    for (base, exponent) in factors {
        let is_positive = pool.sign(base).is_nonnegative() && pool.sign(base).is_nonzero();
        let kind = if is_positive {
            &mut positive
        } else {
            &mut others
        };
        kind.push((base, exponent));
    }
    let powers: Vec<ExprId> = positive
        .into_iter()
        .map(|(base, exponent)| pool.pow(base, exponent))
        .collect();
    let key = pool.product(&powers);
    let is_even = |exponent: &Rational| exponent.to_i64().is_some_and(|power| power % 2 == 0);
    let is_wave = |base: &ExprId| {
        matches!(
            pool.node(*base),
            Node::Call(Function::Sin | Function::Cos, _)
        )
    };
    let all_even = others.iter().all(|(_, exponent)| is_even(exponent));
    let all_waves = others
        .iter()
        .all(|(base, exponent)| is_wave(base) && exponent.is_integer() && !exponent.is_negative());
    let low = match (all_even, all_waves) {
        _ if others.is_empty() => Some(Rational::ONE),
        (true, _) => Some(Rational::ZERO),
        (false, true) => Some(-&Rational::ONE),
        (false, false) => None,
    };
    (key, [low, all_waves.then_some(Rational::ONE)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn is_positive(lagrangian: &str) -> bool {
        let declaration = format!(
            "pub P {{ coordinates {{ x; y; a: angle; b: angle; }}
            parameters {{ m1 > 0; m2 > 0; c; }} lagrangian = {lagrangian}; }}"
        );
        let (mut model, _) = crate::claims::derived(&declaration);
        let metric = model.lagrangian.metric.clone();
        is_positive_definite(&mut model, &metric)
    }

    #[test]
    fn kinetic_energies_are_positive() {
        for kinetic in [
            "dot(x)^2 + dot(y)^2 + dot(a)^2 + dot(b)^2",
            "m1*(dot(x)^2 + x^2*dot(a)^2) + m2*dot(y)^2 + (m1 + c^2*m2)*dot(b)^2",
            "dot(x)^2 + dot(y)^2 + m1*dot(a)^2 + m2*(dot(a)^2 + dot(b)^2 + 2*cos(a - b)*dot(a)*dot(b))",
            "dot(x)^2 + dot(x)*dot(y) + dot(y)^2 + dot(a)^2 + dot(b)^2",
            "dot(a)^2 + dot(b)^2 + (dot(x)*cos(a) + dot(y)*sin(a))^2 + m1*(dot(x)^2 + dot(y)^2)",
        ] {
            assert!(is_positive(kinetic), "{kinetic}");
        }
    }

    #[test]
    fn metrics_that_are_indefinite_somewhere_are_not_positive() {
        for kinetic in [
            "dot(x)^2 + 4*dot(x)*dot(y) + dot(y)^2 + dot(a)^2 + dot(b)^2",
            "dot(x)^2 + 2*x*dot(x)*dot(y) + dot(y)^2 + dot(a)^2 + dot(b)^2",
            "dot(x)^2 + dot(y)^2 + (1 + 2*cos(a))*dot(a)^2 + dot(b)^2",
            "dot(x)^2 + dot(y)^2 + c*dot(a)^2 + dot(b)^2",
            "m1*dot(x)^2 + m2*dot(y)^2 + 2*m1*dot(x)*dot(y) + dot(a)^2 + dot(b)^2",
        ] {
            assert!(!is_positive(kinetic), "{kinetic}");
        }
    }
}
