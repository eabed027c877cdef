//! The velocities after a transition between modes of different Lagrangians, before they are focused on the constraints of
//! the mode that is entered.
//!
//! ```text
//! p+ = p + c d                     v = g+^{-1}(p - A+),   k = d(g+^{-1} d),   b = d(v) + d_t h
//! H+(p+) = H-(p) - c d_t h         c^2 k/2 + c b + E = 0,   E = H+(p) - H-(p),   b + k c = -sqrt(b^2 - 2 k E)
//! ```
//!
//! `d = dh - eta^a m_ab dh(W^b)`, with `W = g^{-1} eta` and `m^ab = eta^a(W^b)`, is the part of `dh` that acts within the
//! constraints of the mode that is left. Where the root is not real the motion is reflected by the elastic law. J. Cortes and
//! A. M. Vinogradov (2006), Definition 4.14.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Jets, Rational, Series};

use super::linear::{dot, solve};
use super::side::Side;

/// The velocities after a refraction as series, given the series of expressions and of the velocities before it. `None`
/// where there is no refraction.
pub(super) fn refracted<P: ExpansionPoint>(
    jets: &Jets<'_, P::Field>,
    point: &P,
    series: &dyn Fn(ExprId) -> Series<P::Field>,
    (before, after): (&Side, &Side),
    (slope, rate): &(Vec<ExprId>, ExprId),
    velocity: &[Series<P::Field>],
) -> Option<Vec<Series<P::Field>>> {
    let field = jets.field;
    let all = |row: &[ExprId]| row.iter().map(|id| series(*id)).collect::<Vec<_>>();
    let lowered = |side: &Side, velocity: &[Series<P::Field>]| -> Vec<Series<P::Field>> {
        let row = |row: &Vec<ExprId>| dot(jets, &all(row), velocity);
        side.metric.iter().map(row).collect()
    };
    let half = field.rational(&Rational::HALF)?;
    let energy = |side: &Side, velocity: &[Series<P::Field>]| {
        let kinetic = jets.scale(half, &dot(jets, &lowered(side, velocity), velocity));
        jets.add(&kinetic, &series(side.potential))
    };
    let slope = within(jets, series, before, all(slope))?;
    // The momenta before minus the linear terms after, and d. The metric after raises the indices of both.
    let shifts = before.linear.iter().zip(&after.linear);
    let shifts = shifts.map(|(before, after)| jets.sub(&series(*before), &series(*after)));
    let momenta = lowered(before, velocity).into_iter().zip(shifts);
    let right = momenta
        .zip(&slope)
        .map(|((momentum, shift), slope)| vec![jets.add(&momentum, &shift), slope.clone()]);
    let metric = after.metric.iter().map(|row| all(row)).collect();
    let raised = solve(jets, metric, right.collect())?.unknowns;
    let column = |j: usize| -> Vec<_> { raised.iter().map(|row| row[j].clone()).collect() };
    let (start, along) = (column(0), column(1));
    let compliance = dot(jets, &slope, &along);
    let b = jets.add(&dot(jets, &slope, &start), &series(*rate));
    let excess = jets.sub(&energy(after, &start), &energy(before, velocity));
    let twice = jets.scale(field.integer(2), &jets.mul(&compliance, &excess));
    let under = jets.sub(&jets.mul(&b, &b), &twice);
    let root = point.power(jets.value(&under), &Rational::HALF)?;
    let root = jets.root(&under, root)?;
    // NOTE: this `c` is minus the c of the equations above.
    let c = jets.mul(&jets.add(&root, &b), &jets.inverse(&compliance)?);
    let shifted = |(start, along): (&Series<P::Field>, &Series<P::Field>)| {
        jets.sub(start, &jets.mul(&c, along))
    };
    Some(start.iter().zip(&along).map(shifted).collect())
}

/// The part of a one-form that acts within the constraints of a mode.
fn within<A: Arithmetic>(
    jets: &Jets<'_, A>,
    series: &dyn Fn(ExprId) -> Series<A>,
    side: &Side,
    form: Vec<Series<A>>,
) -> Option<Vec<Series<A>>> {
    if side.forms.is_empty() {
        return Some(form);
    }
    let projection = side.projection(jets, series)?;
    let column =
        |j: usize| -> Vec<Series<A>> { projection.iter().map(|(row, _)| row[j].clone()).collect() };
    Some(
        (0..form.len())
            .map(|j| dot(jets, &form, &column(j)))
            .collect(),
    )
}
