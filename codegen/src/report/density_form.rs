//! The density form as explicit expressions, for small models.

use dalembert_expr::{ExprId, Verdict};

use crate::mechanics::inverse::{Matrix, dot, inverse, tidy};
use crate::mechanics::{Derivation, Entry};
use crate::model::Model;

/// `theta_k = m_ab [ W^{a,j} d_j eta^b_k + W^{b,j} d_k eta^a_j - W^b.(d_k g) W^a ]`, N components; `None` for a model
/// that is too large to be written out, and for constraints that are not linear in the velocities.
pub fn density_form(model: &mut Model, derivation: &Derivation) -> Option<Vec<ExprId>> {
    if model.is_nonlinear() {
        return None;
    }
    let metric = model.lagrangian.metric.clone();
    let pool = &mut model.pool;
    let cometric = inverse(pool, &metric)?;
    let forms: Matrix = derivation
        .constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    let duals: Matrix = forms
        .iter()
        .map(|form| cometric.iter().map(|row| dot(pool, row, form)).collect())
        .collect();
    let mass: Matrix = forms
        .iter()
        .map(|form| duals.iter().map(|dual| dot(pool, form, dual)).collect())
        .collect();
    let inverse_mass = inverse(pool, &mass)?;
    let columns: Matrix = (0..metric.len())
        .map(|j| duals.iter().map(|dual| dual[j]).collect())
        .collect();
    // m_ab W^b
    let inverse_duals: Matrix = inverse_mass
        .iter()
        .map(|row| {
            columns
                .iter()
                .map(|column| dot(pool, row, column))
                .collect()
        })
        .collect();
    let mut terms = vec![Vec::new(); metric.len()];
    for (a, field) in inverse_duals.iter().enumerate() {
        for &Entry {
            index: [j, k],
            value,
        } in &derivation.constraints[a].form_gradient
        {
            terms[j].push(pool.mul(field[k], value));
            terms[k].push(pool.mul(field[j], value));
        }
        for &Entry {
            index: [i, j, k],
            value,
        } in &derivation.density.metric.by_coordinate
        {
            let first = pool.product(&[duals[a][i], field[j], value]);
            let second = pool.product(&[duals[a][j], field[i], value]);
            terms[k].push(pool.neg(first));
            if i != j {
                terms[k].push(pool.neg(second));
            }
        }
    }
    let sums: Vec<_> = terms.iter().map(|term| pool.sum(term)).collect();
    let written = |expr: ExprId| match pool.zero_test(expr) {
        Verdict::Proved => pool.zero(),
        Verdict::Refuted | Verdict::Undecided => tidy(pool, expr),
    };
    Some(sums.into_iter().map(written).collect())
}
