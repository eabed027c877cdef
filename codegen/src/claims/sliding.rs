//! Sliding along a surface between first-order modes: the motion comes back to it from the other side, and volumes
//! become 0.
//!
//! ```text
//! J = G+/G-      G-, G+: rates of the gap before and behind the surface; the motion slides where G- < 0 and G+ > 0
//! ```
//!
//! The quotient does not use the densities of the two sides: a density may be negative where the motion crosses.
//!
//! Sliding needs a transition of the mode that is entered, back through the same surface. Without one, the motion goes on
//! in that mode, on either side. If it is not known whether a transition leads back, verdicts are those that hold in
//! both cases.

use std::cmp::Ordering;

use dalembert_expr::{BallPoint, ExpansionPoint, ExprId, Pool, RealPoint};

use super::bounds::is_never_negative;
use super::collision::{AtImpact, evidence_at_impact};
use super::dynamics::Number;
use super::evidence::Wording;
use super::factor::closed_form;
use super::finding::Verdict;
use super::hybrid::Surroundings;
use super::locus;
use super::passage::{Passage, positions};
use super::regularity::is_never_zero;
use super::side::{imported, velocities_of};
use super::wall::Wall;
use crate::model::{Beside, Model, Surface};

/// Reason for a claim to stay open if the motion may slide.
pub(super) const MAY_SLIDE: &str =
    "the motion may slide along it, and the rate of its gap is not known to be negative behind it";

/// Whether the mode that a transition enters leads back to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Return {
    /// No transition of that mode acts where it is entered.
    Never,
    /// Not known.
    Perhaps,
    /// One transition acts there, everywhere and in the opposite direction.
    Always,
}

/// Whether the mode that a surface leads to leads back to it. [`Return::Never`] for surfaces at which no motion slides.
pub(super) fn returns(model: &mut Model, surface: usize, others: &[&Model]) -> Return {
    let crossed = &model.surfaces[surface];
    let gap = crossed.gap;
    let keeps_state = |surface: &Surface| {
        let transition = surface.transition.as_ref();
        transition.is_some_and(|transition| transition.map.is_none())
    };
    if !model.is_first_order() || !keeps_state(crossed) {
        return Return::Never;
    }
    let enters = crossed.transition.as_ref().map(|to| to.enters);
    let Some(entered) = enters.and_then(|enters| others.get(enters)) else {
        return Return::Perhaps;
    };
    let opposite = model.pool.neg(gap);
    let opposite = model.pool.text(opposite);
    let acting: Vec<&Surface> = (entered.surfaces.iter())
        .filter(|back| back.transition.is_some() && !is_elsewhere(model, gap, entered, back.gap))
        .collect();
    match acting[..] {
        [] => Return::Never,
        [back] => {
            let target = back
                .transition
                .as_ref()
                .and_then(|to| others.get(to.enters));
            let leads_back = target.is_some_and(|target| target.name == model.name);
            let is_opposite = entered.pool.text(back.gap) == opposite;
            let counts = back.conditions.is_empty() && back.beside == Beside::Independent;
            match leads_back && is_opposite && counts && keeps_state(back) {
                true => Return::Always,
                false => Return::Perhaps,
            }
        }
        _ => Return::Perhaps,
    }
}

/// True if the gap `other` of another mode is certain not to be 0 where `gap` is 0.
fn is_elsewhere(model: &mut Model, gap: ExprId, entered: &Model, other: ExprId) -> bool {
    let state = (positions(model), velocities_of(model));
    let Some(other) = imported(model, entered, (&state.0, &state.1), &[other]) else {
        return false;
    };
    let pool = &mut model.pool;
    let mut candidates = vec![pool.add(other[0], gap), pool.sub(other[0], gap)];
    if let Some(solution) = locus::solution(model, gap) {
        candidates.push(model.pool.substitute(other[0], &[solution]));
    }
    candidates.into_iter().any(|candidate| {
        let candidate = model.pool.simplify(candidate);
        is_never_zero(model, candidate)
    })
}

/// Whether the mode behind a wall leads back to it.
fn return_to(wall: &Wall) -> Return {
    wall.passage
        .as_ref()
        .map_or(Return::Never, Passage::returns)
}

/// True if the motion that comes to a wall may slide along it.
pub(super) fn may_slide(wall: &Wall) -> bool {
    return_to(wall) != Return::Never
}

/// True if the motion slides along a wall wherever the gap rate behind it is positive.
pub(super) fn slides_where_it_returns(wall: &Wall) -> bool {
    return_to(wall) == Return::Always
}

/// Adapts the verdict on the factor of a volume, which holds where the motion crosses the surface: where it slides, the
/// factor is 0. `claimed` holds the claimed factor and the density before.
pub(super) fn unless_it_slides(
    model: &mut Model,
    around: &Surroundings<'_>,
    (surface, wall): (usize, &Wall),
    claimed: Vec<ExprId>,
    verdict: Verdict,
) -> Verdict {
    if !may_slide(wall) || matches!(verdict, Verdict::Refuted(_)) {
        return verdict;
    }
    let unless_it_crosses = |model: &mut Model, verdict| match verdict {
        Verdict::Proved(_) if !always_goes_on(model, wall) => {
            Verdict::Undecided(MAY_SLIDE.to_owned())
        }
        verdict => verdict,
    };
    if !slides_where_it_returns(wall) {
        return unless_it_crosses(model, verdict);
    }
    let question = Slides { wall, claimed };
    let name = &model.surfaces[surface].name.display;
    let wording = Wording {
        differs: format!(
            "the motion slides along `{name}` where the Jacobian is negative, and volumes become 0 there"
        ),
        help: ["leave it out".to_owned(), String::new()],
        ..Wording::default()
    };
    let found = evidence_at_impact(model, wall, around.dynamics, &question, around.seed);
    match found.verdict(true, wording, around.seed) {
        refuted @ Verdict::Refuted(_) => refuted,
        _ => unless_it_crosses(model, verdict),
    }
}

/// True if the motion in the mode that is entered is certified not to come back to the surface: by its gap rate, by the
/// product with the gap rate before, or by their ratio.
pub(super) fn always_goes_on(model: &mut Model, wall: &Wall) -> bool {
    let Some(passage) = &wall.passage else {
        return true;
    };
    let (slopes, rate) = passage.gap_form();
    let solution = wall.solution();
    let along = |pool: &mut Pool, rates: &Option<Vec<ExprId>>| {
        let mut terms = vec![rate];
        for (slope, rate) in slopes.iter().zip(rates.iter().flatten()) {
            terms.push(pool.mul(*slope, *rate));
        }
        let sum = pool.sum(&terms);
        solution.map_or(sum, |solution| pool.substitute(sum, &[solution]))
    };
    let pool = &mut model.pool;
    let incoming = along(pool, &passage.before.rates);
    let outgoing = along(pool, &passage.after.rates);
    let (falling, product) = (pool.neg(outgoing), pool.mul(incoming, outgoing));
    [falling, product]
        .into_iter()
        .any(|rate| is_never_negative(model, rate))
        || closed_form(model, passage).is_some_and(|ratio| is_never_negative(model, ratio))
}

/// The question whether the motion slides at a state at which the claimed factor is not 0.
struct Slides<'s> {
    wall: &'s Wall,
    claimed: Vec<ExprId>,
}

impl AtImpact for Slides<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let passage = self.wall.passage.iter().flat_map(Passage::roots);
        self.claimed.iter().copied().chain(passage).collect()
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        Some(vec![self.wall.jacobian(model, point, after)?])
    }

    fn wants(&self, terms: &[f64]) -> bool {
        terms[0] < 0.0
    }

    fn is_certain(&self, model: &Model, point: &mut BallPoint) -> bool {
        let order = model.pool.reachable(&self.claimed);
        let Some(values) = point.values(&model.pool, &order) else {
            return false;
        };
        let claims = |id: &ExprId| values[id.index()].sign().is_some();
        let is_claimed = self.claimed.iter().all(claims);
        let jacobian = |point: &mut BallPoint| self.wall.jacobian(model, point, &[]);
        is_claimed && jacobian(point).is_some_and(|it| it.sign() == Some(Ordering::Less))
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        Some(self.wall.jacobian(model, point, after)?.abs())
    }

    fn shown(&self, terms: &[f64], _: f64) -> Vec<(String, f64)> {
        vec![("Jacobian".to_owned(), terms[0])]
    }
}
