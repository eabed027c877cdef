//! The velocities after a transition between modes of different Lagrangians, without constraints.
//!
//! ```text
//! p+ = p + c dh                    v = g+^{-1}(p - A+),   k = dh(g+^{-1} dh),   b = dh(v) + d_t h
//! H+(p+) = H-(p) - c d_t h         c^2 k/2 + c b + E = 0,   E = H+(p) - H-(p),   b + k c = -sqrt(b^2 - 2 k E)
//! ```
//!
//! Where the root is not real the motion is reflected by the elastic law. J. Cortes and A. M. Vinogradov (2006), Definition 4.14.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, Rational};

use super::dynamics::Number;
use super::linear::solve;
use super::side::Side;

/// The velocities after a refraction of those before it; `None` where there is none.
pub(super) fn refracted<P: ExpansionPoint>(
    point: &P,
    values: &[Number<P>],
    (before, after): (&Side, &Side),
    (slope, rate): &(Vec<ExprId>, ExprId),
    velocity: &[Number<P>],
) -> Option<Vec<Number<P>>> {
    let field = point.field();
    let value = |id: &ExprId| values[id.index()];
    let space = JetSpace::new(0, 0, 1)?;
    let jets = Jets::new(field, &space);
    let product = |left: &[Number<P>], right: &[Number<P>]| {
        let terms = left.iter().zip(right);
        terms.fold(field.integer(0), |sum, (a, b)| {
            field.add(sum, field.mul(*a, *b))
        })
    };
    let numbers = |row: &[ExprId]| row.iter().map(value).collect::<Vec<_>>();
    let lowered = |side: &Side, velocity: &[Number<P>]| -> Vec<Number<P>> {
        let row = |row: &Vec<ExprId>| product(&numbers(row), velocity);
        side.metric.iter().map(row).collect()
    };
    let half = field.rational(&Rational::HALF)?;
    let energy = |side: &Side, velocity: &[Number<P>]| {
        let kinetic = field.mul(half, product(&lowered(side, velocity), velocity));
        field.add(kinetic, value(&side.potential))
    };
    let slope = numbers(slope);
    // The momenta before without the velocity-linear terms after, and dh, both raised by the metric after.
    let shifts = before.linear.iter().zip(&after.linear);
    let shifts = shifts.map(|(before, after)| field.sub(value(before), value(after)));
    let momenta = lowered(before, velocity).into_iter().zip(shifts);
    let right = momenta.zip(&slope).map(|((momentum, shift), slope)| {
        vec![
            jets.constant(field.add(momentum, shift)),
            jets.constant(*slope),
        ]
    });
    let metric = after.metric.iter().map(|row| {
        let entries = row.iter().map(|id| jets.constant(value(id)));
        entries.collect()
    });
    let raised = solve(&jets, metric.collect(), right.collect())?.unknowns;
    let column =
        |j: usize| -> Vec<Number<P>> { raised.iter().map(|row| jets.value(&row[j])).collect() };
    let (start, along) = (column(0), column(1));
    let compliance = product(&slope, &along);
    let b = field.add(product(&slope, &start), value(rate));
    let excess = field.sub(energy(after, &start), energy(before, velocity));
    let twice = field.mul(field.integer(2), field.mul(compliance, excess));
    let root = point.power(field.sub(field.mul(b, b), twice), &Rational::HALF)?;
    let c = field.neg(field.mul(field.add(root, b), field.inv(compliance)?));
    let shifted =
        |(start, along): (&Number<P>, &Number<P>)| field.add(*start, field.mul(c, *along));
    Some(start.iter().zip(&along).map(shifted).collect())
}
