//! Bounds of the coordinate velocities at unit quasi-velocities: the natural units of the coordinates.

use dalembert_expr::{ExprId, Pool};

use super::{Block, QuasiVelocity, Row, Solve};
use crate::mechanics::ConstraintForm;
use crate::mechanics::constraint::amplitude;
use crate::model::Model;

/// Bounds of `sum_i |X_i|` by coordinate, with sines and cosines counted as 1; 1 where the bound depends on the
/// configuration, or is not known.
pub(super) fn position_units(
    model: &mut Model,
    quasi: &[QuasiVelocity],
    constraints: &[ConstraintForm],
    blocks: &[Block],
) -> Vec<ExprId> {
    let one = model.pool.one();
    let mut bounds: Vec<Option<ExprId>> = vec![Some(model.pool.zero()); model.coordinates.len()];
    for block in blocks {
        let found = match (&block.solve, block.rows[0]) {
            (Solve::Entry, Row::Quasi(i)) => {
                let unit = model.pool.one();
                entry(model, &quasi[i].form, unit, block.columns[0], &bounds)
            }
            (Solve::Entry, Row::Constraint(a)) => {
                let nothing = model.pool.zero();
                entry(
                    model,
                    &constraints[a].form,
                    nothing,
                    block.columns[0],
                    &bounds,
                )
            }
            _ => None,
        };
        for &column in &block.columns {
            bounds[column] = found;
        }
    }
    bounds
        .into_iter()
        .map(|bound| bound.unwrap_or(one))
        .collect()
}

/// `(right + sum |entry| bound) / |pivot|` of a row, if this quotient is a positive function of the parameters.
fn entry(
    model: &mut Model,
    form: &[ExprId],
    right: ExprId,
    column: usize,
    bounds: &[Option<ExprId>],
) -> Option<ExprId> {
    let pool = &mut model.pool;
    let mut terms = vec![right];
    for (k, &component) in form.iter().enumerate() {
        if k != column && !pool.is_syntactic_zero(component) {
            let size = amplitude(pool, component);
            terms.push(pool.mul(size, bounds[k]?));
        }
    }
    let total = pool.sum(&terms);
    let pivot = magnitude(pool, form[column])?;
    let bound = pool.div(total, pivot);
    let is_parametric = !model
        .coordinates
        .iter()
        .any(|coordinate| model.pool.depends_on(bound, coordinate.q))
        && !model.pool.depends_on(bound, model.time);
    (is_parametric && model.pool.sign(bound).is_nonzero()).then_some(bound)
}

/// `|e|`; `None` unless `e` is known to vanish nowhere.
fn magnitude(pool: &mut Pool, e: ExprId) -> Option<ExprId> {
    let size = pool.call(dalembert_expr::Function::Abs, e);
    pool.sign(e).is_nonzero().then_some(size)
}
