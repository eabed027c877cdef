//! `conserved under SURFACE: e`: is a quantity the same before and after an impact?

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint, SymbolId};

use super::collision::{
    AtImpact, after_and_before, evidence_at_impact, value_with, with_difference,
};
use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::Wording;
use super::finding::Verdict;
use super::wall::Wall;
use crate::mechanics::Derivation;
use crate::model::Model;

/// The verdict on `conserved under SURFACE: value` or `not conserved under SURFACE: value`.
pub(super) fn check_conserved_under(
    model: &mut Model,
    derivation: &Derivation,
    dynamics: &Dynamics,
    surface: usize,
    (value, written): (ExprId, &str),
    holds: bool,
    seed: u64,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    if !model.surfaces[surface].instantaneous.is_empty() {
        return Verdict::Undecided(format!(
            "what impacts at `{name}` with their instantaneous constraints do to a quantity is not examined"
        ));
    }
    let wall = Wall::of(model, derivation, surface);
    let after = model.surfaces[surface].reset.clone().map(|reset| {
        let replacements = reset.replacements(&model.coordinates);
        model.pool.substitute(value, &replacements)
    });
    // On the surface, where one of its coordinates follows from the others.
    let solution = wall.solution();
    let mut on_surface = |id| match solution {
        Some(solution) => model.pool.substitute(id, &[solution]),
        None => id,
    };
    let (value, after) = (on_surface(value), after.map(on_surface));
    let jump = Jump {
        slopes: model
            .coordinates
            .iter()
            .map(|own| model.pool.diff(value, own.qdot))
            .collect(),
        by_position: model
            .coordinates
            .iter()
            .map(|own| (own.q, model.pool.diff(value, own.q)))
            .collect(),
        after,
        value,
        written,
    };
    let wording = Wording {
        vanishes: format!("`{written}` is the same before and after an impact at `{name}`"),
        differs: format!("`{written}` changes in an impact at `{name}`"),
        help: [
            format!("write `not conserved under {name}: {written};`"),
            format!("write `conserved under {name}: {written};`"),
        ],
    };
    let found = evidence_at_impact(model, &wall, dynamics, &jump, seed);
    let is_seen = wall.is_solved() || !found.is_real;
    match found.verdict(holds, wording, seed) {
        Verdict::Undecided(_) if !is_seen => Verdict::Undecided(format!(
            "parts of `{name}` may be out of sight: its gap is in no coordinate a polynomial of degree 1 or 2 whose \
             leading coefficient is never 0"
        )),
        verdict => verdict,
    }
}

/// The change of a quantity in an impact.
struct Jump<'j> {
    value: ExprId,
    /// Its value after a reset.
    after: Option<ExprId>,
    /// Its derivatives by the velocities.
    slopes: Vec<ExprId>,
    /// The same by the coordinates.
    by_position: Vec<(SymbolId, ExprId)>,
    written: &'j str,
}

impl Jump<'_> {
    /// How much the value changes per part of the position, which solves an equation up to rounding.
    fn slope_by_position(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let slopes: Vec<ExprId> = self.by_position.iter().map(|(_, slope)| *slope).collect();
        let values = point.values(&model.pool, &model.pool.reachable(&slopes))?;
        let terms = self.by_position.iter().map(|(symbol, slope)| {
            values[slope.index()].abs() * (1.0 + point.value(*symbol).abs())
        });
        Some(terms.sum())
    }
}

impl AtImpact for Jump<'_> {
    fn roots(&self) -> Vec<ExprId> {
        self.after.iter().copied().chain([self.value]).collect()
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let [new, old] = match self.after {
            Some(reset) => {
                let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
                [reset, self.value].map(|id| values[id.index()])
            }
            None => after_and_before(model, point, after, self.value)?,
        };
        Some(vec![new, point.field().neg(old)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        let largest = after.iter().fold(0.0, |size: f64, own| size.max(own.abs()));
        let values = point.values(&model.pool, &model.pool.reachable(&self.slopes))?;
        let slopes = self.slopes.iter().map(|own| values[own.index()].abs());
        let by_velocity = slopes.sum::<f64>() * largest;
        let before = magnitude(model, point, self.value) + self.slope_by_position(model, point)?;
        let new = match self.after {
            Some(reset) => magnitude(model, point, reset),
            None => {
                value_with(model, point, after, self.value)?;
                magnitude(model, point, self.value) + self.slope_by_position(model, point)?
            }
        };
        Some(before + new + by_velocity)
    }

    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        let names = ["after", "before"].map(|when| format!("{} {when}", self.written));
        with_difference(names, [terms[0], -terms[1]], sum)
    }
}
