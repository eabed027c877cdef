//! Values of a model at a state by independent numerics: matrices, projected velocities, small linear systems.

use dalembert_codegen::model::Model;
use dalembert_expr::{ExprId, SymbolId};

/// Components of a vector.
pub(super) type Row = Vec<f64>;

/// Value of an expression at a state. Parameters that the state does not contain have their declared defaults.
pub(super) fn value(model: &Model, id: ExprId, state: &[(SymbolId, f64)]) -> f64 {
    let known = |symbol: SymbolId| {
        let given = state.iter().find(|(key, _)| *key == symbol);
        let parameter = || {
            let mut parameters = model.parameters.iter();
            let default = parameters
                .find(|parameter| parameter.symbol == symbol)?
                .default?;
            Some(model.pool.eval(&[default], &|_| f64::NAN)[0])
        };
        given
            .map(|(_, value)| *value)
            .or_else(parameter)
            .unwrap_or(f64::NAN)
    };
    model.pool.eval(&[id], &known)[0]
}

/// Values of several expressions.
pub(super) fn values(model: &Model, ids: &[ExprId], state: &[(SymbolId, f64)]) -> Row {
    ids.iter().map(|id| value(model, *id, state)).collect()
}

/// The state with these positions.
pub(super) fn at(model: &Model, q: &[f64]) -> Vec<(SymbolId, f64)> {
    let symbols = model.coordinates.iter().map(|coordinate| coordinate.q);
    symbols.zip(q.iter().copied()).collect()
}

/// The state with these positions and velocities.
pub(super) fn moving(model: &Model, q: &[f64], velocity: &[f64]) -> Vec<(SymbolId, f64)> {
    let symbols = model.coordinates.iter().map(|coordinate| coordinate.qdot);
    let mut state = at(model, q);
    state.extend(symbols.zip(velocity.iter().copied()));
    state
}

/// Metric, coefficients of the terms of the Lagrangian that are linear in the velocities, constraint forms and their
/// affine parts, at a position.
pub(super) fn matrices(model: &Model, q: &[f64]) -> (Vec<Row>, Row, Vec<Row>, Row) {
    let at = at(model, q);
    let lagrangian = &model.lagrangian;
    let constraints = &model.constraints;
    (
        (lagrangian.metric.iter())
            .map(|row| values(model, row, &at))
            .collect(),
        values(model, &lagrangian.linear, &at),
        (constraints.iter())
            .map(|constraint| values(model, &constraint.form, &at))
            .collect(),
        (constraints.iter())
            .map(|constraint| value(model, constraint.affine, &at))
            .collect(),
    )
}

/// The velocity projected to D, orthogonally in the metric.
pub(super) fn projected(model: &Model, q: &[f64], mut v: Row) -> Row {
    let (metric, _, forms, affine) = matrices(model, q);
    let duals: Vec<Row> = forms.iter().map(|form| solved(&metric, form)).collect();
    let mass: Vec<Row> = (forms.iter())
        .map(|form| duals.iter().map(|dual| inner(form, dual)).collect())
        .collect();
    let lost: Row = (forms.iter().zip(&affine))
        .map(|(form, affine)| inner(form, &v) + affine)
        .collect();
    let factors = solved(&mass, &lost);
    for (factor, dual) in factors.iter().zip(&duals) {
        for (entry, by) in v.iter_mut().zip(dual) {
            *entry -= factor * by;
        }
    }
    v
}

/// Inner product.
pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `matrix^{-1} right`, for a positive definite matrix.
pub(super) fn solved(matrix: &[Row], right: &[f64]) -> Row {
    let n = right.len();
    let mut rows: Vec<Row> = (matrix.iter().zip(right))
        .map(|(row, b)| [&row[..], &[*b]].concat())
        .collect();
    for i in 0..n {
        let pivot: Row = rows[i].iter().map(|entry| entry / rows[i][i]).collect();
        for (j, row) in rows.iter_mut().enumerate() {
            let factor = if j == i { 0.0 } else { row[i] };
            for (entry, by) in row.iter_mut().zip(&pivot) {
                *entry -= factor * by;
            }
        }
        rows[i] = pivot;
    }
    rows.iter().map(|row| row[n]).collect()
}
