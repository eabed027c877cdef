//! Sliding along a surface between first-order modes: the motion comes back to it from the other side, and volumes
//! become 0.
//!
//! ```text
//! J = G+/G-      G-, G+: rates of the gap before and behind the surface; the motion slides where G- < 0 and G+ > 0
//! ```
//!
//! The quotient does not use the densities of the two sides: a density may be negative where the motion crosses.

use std::cmp::Ordering;

use dalembert_expr::{BallPoint, ExpansionPoint, ExprId, Pool, RealPoint};

use super::bounds::is_never_negative;
use super::collision::{AtImpact, evidence_at_impact};
use super::dynamics::Number;
use super::evidence::Wording;
use super::factor::closed_form;
use super::finding::Verdict;
use super::hybrid::Surroundings;
use super::passage::Passage;
use super::wall::Wall;
use crate::model::Model;

/// Reason for a claim to stay open if the motion may slide.
pub(super) const MAY_SLIDE: &str =
    "the motion may slide along it, and the rate of its gap is not known to be negative behind it";

/// True if the motion that comes to a wall may slide along it.
pub(super) fn may_slide(wall: &Wall) -> bool {
    wall.passage.as_ref().is_some_and(Passage::may_slide)
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
    match (found.verdict(true, wording, around.seed), verdict) {
        (refuted @ Verdict::Refuted(_), _) => refuted,
        (_, Verdict::Proved(_)) if !always_goes_on(model, wall) => {
            Verdict::Undecided(MAY_SLIDE.to_owned())
        }
        (_, verdict) => verdict,
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
