//! Constraint forms, and the terms of `d/dt (eta(qdot) + eta_0)` that do not contain accelerations.
//!
//! The one-form of a constraint `phi(t, q, qdot) = 0` that is nonlinear in the velocities is `eta = dphi/dqdot`
//! (Chetaev's rule). Virtual displacements are the changes of velocity that leave `phi` unchanged to first order, and
//! the constraint force is `lambda eta`. The time derivative of `phi` is `eta(qddot) + curvature`, as for the other
//! constraints. Here `curvature` stands for the terms without accelerations, which are the derivative of `phi` along
//! the motion at constant velocity. It is not the curvature of the constraint distribution.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, Sign};

use super::{Coordinates, Entry, gradient};
use crate::model::Model;

/// A constraint with its derivatives.
#[derive(Debug)]
pub struct ConstraintForm {
    /// `eta_j`, N entries.
    pub form: Vec<ExprId>,
    /// `eta_0`
    pub affine: ExprId,
    /// `eta(qdot) + eta_0`, or `phi` if the constraint is nonlinear.
    pub residual: ExprId,
    /// Scale of `residual`: the sum of the absolute values of its terms, with sines and cosines counted as 1. With the
    /// sines themselves, a term like `cos(pi/2) v`, which is 0 up to rounding, would have to vanish to the last digit.
    pub scale: ExprId,
    /// `(d_i eta_j) qdot^i qdot^j + (d_i eta_0) qdot^i + (d_t eta_j) qdot^j + d_t eta_0`, or `d_i phi qdot^i + d_t phi`
    /// if the constraint is nonlinear.
    pub curvature: ExprId,
    /// `eta_j` and `curvature`, divided by the numerical factor that all components have in common. The motion does not
    /// depend on it.
    pub primitive: (Vec<ExprId>, ExprId),
    /// Non-zero `d_k eta_j`, index `[j, k]`.
    pub form_gradient: Vec<Entry<2>>,
    /// Non-zero `d_k eta_0`, index `[k]`.
    pub affine_gradient: Vec<Entry<1>>,
    /// Non-zero `d_t eta_j`, index `[j]`.
    pub form_rate: Vec<Entry<1>>,
    /// The function `f(t, q)` that the motion conserves, if the form is exact with a known integral.
    pub level: Option<ExprId>,
    /// Scale of `level`, in analogy to `scale`, for a position-level constraint `level = 0`.
    pub level_scale: Option<ExprId>,
}

/// Derives the form of every constraint, in the order of declaration.
pub(super) fn derive_constraints(
    model: &mut Model,
    coordinates: &Coordinates,
) -> Vec<ConstraintForm> {
    let motion = coordinates.motion(model);
    (0..model.constraints.len())
        .map(|a| {
            let form = model.constraints[a].form.clone();
            let affine = model.constraints[a].affine;
            let residual = match model.constraints[a].nonlinear {
                Some(phi) => phi,
                None => derive_residual(model, coordinates, &form, affine),
            };
            let curvature = model.pool.derivative_along(residual, &motion);
            ConstraintForm {
                scale: amplitude(&mut model.pool, residual),
                primitive: primitive(&mut model.pool, &form, curvature),
                curvature,
                form_gradient: derive_form_gradient(model, coordinates, &form),
                affine_gradient: gradient(model, affine, &coordinates.q),
                form_rate: derive_form_rate(model, coordinates, &form),
                level: model.constraints[a].level,
                level_scale: level_scale(model, a),
                residual,
                form,
                affine,
            }
        })
        .collect()
}

fn level_scale(model: &mut Model, a: usize) -> Option<ExprId> {
    let constraint = &model.constraints[a];
    let level = constraint.level.filter(|_| constraint.is_of_positions)?;
    Some(amplitude(&mut model.pool, level))
}

fn primitive(pool: &mut Pool, form: &[ExprId], curvature: ExprId) -> (Vec<ExprId>, ExprId) {
    let entries = form.iter().filter(|&&entry| !pool.is_syntactic_zero(entry));
    let size = |&entry: &ExprId| match pool.as_number(entry) {
        Some(number) => number.abs(),
        None => pool.as_multiple(entry).0.abs(),
    };
    let mut sizes = entries.map(size);
    let common = sizes
        .next()
        .filter(|first| sizes.all(|size| size == *first));
    let scale = common
        .and_then(|size| size.recip())
        .unwrap_or(Rational::ONE);
    let form = form
        .iter()
        .map(|&entry| pool.scale(&scale, entry))
        .collect();
    (form, pool.scale(&scale, curvature))
}

/// `eta(qdot) + eta_0`
pub(super) fn derive_residual(
    model: &mut Model,
    coordinates: &Coordinates,
    form: &[ExprId],
    affine: ExprId,
) -> ExprId {
    let mut terms = vec![affine];
    for (&component, &qdot) in form.iter().zip(&coordinates.qdot) {
        let velocity = model.pool.variable(qdot);
        terms.push(model.pool.mul(component, velocity));
    }
    model.pool.sum(&terms)
}

fn derive_form_gradient(
    model: &mut Model,
    coordinates: &Coordinates,
    form: &[ExprId],
) -> Vec<Entry<2>> {
    let mut entries = Vec::new();
    for (j, &component) in form.iter().enumerate() {
        for Entry { index: [k], value } in gradient(model, component, &coordinates.q) {
            entries.push(Entry {
                index: [j, k],
                value,
            });
        }
    }
    entries
}

fn derive_form_rate(
    model: &mut Model,
    coordinates: &Coordinates,
    form: &[ExprId],
) -> Vec<Entry<1>> {
    let mut entries = Vec::new();
    for (j, &component) in form.iter().enumerate() {
        for Entry { value, .. } in gradient(model, component, &[coordinates.time]) {
            entries.push(Entry { index: [j], value });
        }
    }
    entries
}

/// A bound of `|expression|` without cancellation: all terms have their absolute values, sines and cosines are replaced
/// by 1.
pub(super) fn amplitude(pool: &mut Pool, expression: ExprId) -> ExprId {
    match pool.node(expression).clone() {
        Node::Number(number) => pool.number(number.abs()),
        Node::Call(Function::Sin | Function::Cos, _) => pool.one(),
        Node::Sum { constant, terms } => {
            let mut bounds = vec![pool.number(constant.abs())];
            for (coefficient, term) in terms.iter() {
                let (size, bound) = (pool.number(coefficient.abs()), amplitude(pool, *term));
                bounds.push(pool.mul(size, bound));
            }
            pool.sum(&bounds)
        }
        Node::Product(factors) => {
            let mut bounds = Vec::with_capacity(factors.len());
            for (base, exponent) in factors.iter() {
                // Only numerators are replaced by their bounds, because a denominator may be small.
                let bound = if exponent.is_positive() {
                    amplitude(pool, *base)
                } else {
                    pool.call(Function::Abs, *base)
                };
                bounds.push(pool.pow(bound, exponent.clone()));
            }
            pool.product(&bounds)
        }
        Node::Pi | Node::Symbol(_) | Node::Call(..) | Node::Atan2(..) => {
            pool.call(Function::Abs, expression)
        }
    }
}

/// One coordinate per constraint, such that the velocities of these coordinates are functions of the others at every
/// state. Returns pairs of constraint and coordinate, in an order in which the velocities can be solved for one by one;
/// the diagonal entries are never zero. `None` if no order of rows and columns makes such a minor triangular.
pub(crate) fn regular_minor(
    pool: &Pool,
    constraints: &[ConstraintForm],
) -> Option<Vec<(usize, usize)>> {
    let mut rows: Vec<usize> = (0..constraints.len()).collect();
    let columns = constraints
        .first()
        .map_or(0, |constraint| constraint.form.len());
    let mut pairs = Vec::with_capacity(rows.len());
    while !rows.is_empty() {
        let removable = |&a: &usize| {
            let alone = |j: usize| {
                rows.iter()
                    .all(|&b| b == a || pool.is_syntactic_zero(constraints[b].form[j]))
            };
            let column =
                (0..columns).find(|&j| alone(j) && never_zero(pool, constraints[a].form[j]))?;
            Some((a, column))
        };
        let pair = rows.iter().find_map(removable)?;
        rows.retain(|&row| row != pair.0);
        pairs.push(pair);
    }
    // A row removed early may contain columns of later rows, but not conversely.
    pairs.reverse();
    Some(pairs)
}

pub(super) fn never_zero(pool: &Pool, expression: ExprId) -> bool {
    matches!(
        pool.sign(expression),
        Sign::Positive | Sign::Negative | Sign::NonZero
    )
}
