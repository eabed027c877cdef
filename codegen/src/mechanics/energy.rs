//! Energy of a state.

use dalembert_expr::{ExprId, Rational};

use crate::model::Model;

/// `1/2 g(qdot, qdot) + V`
pub(crate) fn total_energy(model: &mut Model) -> ExprId {
    let mut terms = vec![model.lagrangian.potential];
    for i in 0..model.coordinates.len() {
        for j in 0..=i {
            let factor = if i == j {
                Rational::new(1, 2)
            } else {
                Rational::from(1)
            };
            let [a, b] = [i, j].map(|k| model.pool.variable(model.coordinates[k].qdot));
            let product = model.pool.product(&[model.lagrangian.metric[i][j], a, b]);
            terms.push(model.pool.scale(&factor, product));
        }
    }
    model.pool.sum(&terms)
}
