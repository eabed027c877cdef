//! States that a run can have. At these the Lagrangian has a value, the metric is positive definite, and the coefficients
//! of impact laws lie in [0, 1]; the simulator refuses any other state.

use core::cmp::Ordering;

use dalembert_expr::{Ball, BallPoint, ExpansionPoint, ExprId, RangePoint};

use super::sample::{self, Sample};
use crate::model::Model;

/// Number of sets of values for the symbols that a sample lacks.
const COMPLETIONS: usize = 12;

/// True if a sample, with some values of the symbols that it lacks, is certified to belong to a state.
pub(super) fn is_admissible(model: &Model, sample: &Sample) -> bool {
    is_completed(model, sample, &mut BallPoint::of(&sample.point()))
}

/// Same as [`is_admissible`] for a point with the values of the sample.
pub(super) fn is_completed(model: &Model, sample: &Sample, point: &mut BallPoint) -> bool {
    (0..COMPLETIONS).any(|attempt| {
        let others = sample::sample(model, attempt, |symbol| sample.value(symbol).is_none());
        let exact = BallPoint::of(&others.point());
        for (symbol, value) in others.point_values() {
            // An exact default value lies within rounding of its double.
            let range = exact.symbol(&model.pool, symbol);
            point.set_symbol(symbol, range.widened(f64::EPSILON * value.abs()));
        }
        is_accepted(model, point)
    })
}

fn is_accepted(model: &Model, point: &mut BallPoint) -> bool {
    let laws = model.surfaces.iter().map(|surface| surface.law);
    let coefficients: Vec<ExprId> = laws.filter_map(|law| law.coefficient()).collect();
    let metric = &model.lagrangian.metric;
    let mut roots = vec![model.lagrangian.whole];
    roots.extend(&coefficients);
    roots.extend(metric.iter().flatten());
    let Some(values) = point.values(&model.pool, &model.pool.reachable(&roots)) else {
        return false;
    };
    let value = |id: &ExprId| values[id.index()];
    let is_negative = |ball: Ball| ball.sign() == Some(Ordering::Less);
    let is_outside = |coefficient: &ExprId| {
        let coefficient = value(coefficient);
        is_negative(coefficient) || is_negative(Ball::integer(1) - coefficient)
    };
    let rows = metric.iter().map(|row| row.iter().map(value).collect());
    !coefficients.iter().any(is_outside) && is_positive_definite(rows.collect())
}

/// True if all pivots of a symmetric matrix are certified to be positive.
fn is_positive_definite(mut matrix: Vec<Vec<Ball>>) -> bool {
    for pivot in 0..matrix.len() {
        let (above, below) = matrix.split_at_mut(pivot + 1);
        let first = &above[pivot];
        let is_positive = first[pivot].sign() == Some(Ordering::Greater);
        let Some(inverse) = first[pivot].inverse().filter(|_| is_positive) else {
            return false;
        };
        for row in below {
            let factor = row[pivot] * inverse;
            for (entry, other) in row.iter_mut().zip(first).skip(pivot) {
                *entry = *entry - factor * *other;
            }
        }
    }
    true
}
