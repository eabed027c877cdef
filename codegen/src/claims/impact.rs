//! `conserved under SURFACE: e`: is a quantity the same before and after an impact?

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, ModularPoint, RealPoint};

use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording};
use super::finding::Verdict;
use super::sample::Sample;
use super::wall::{AtImpact, Place, Wall, evidence_at_impact};
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
    let mut jump = Jump {
        wall: Wall::of(model, derivation, surface),
        dynamics,
        slopes: model
            .coordinates
            .iter()
            .map(|own| model.pool.diff(value, own.qdot))
            .collect(),
        value,
        written,
        place: Place::Anywhere,
    };
    let wording = Wording {
        vanishes: format!("`{written}` is the same before and after an impact at `{name}`"),
        differs: format!("`{written}` changes in an impact at `{name}`"),
        help: [
            format!("write `not conserved under {name}: {written};`"),
            format!("write `conserved under {name}: {written};`"),
        ],
    };
    let found = evidence_at_impact(model, &mut jump, seed);
    let is_seen = jump.wall.is_solved() || !found.is_real;
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
    wall: Wall,
    dynamics: &'j Dynamics,
    value: ExprId,
    /// Its derivatives by the velocities.
    slopes: Vec<ExprId>,
    written: &'j str,
    place: Place,
}

impl Jump<'_> {
    fn slope_by_velocity(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let values = point.values(&model.pool, &model.pool.reachable(&self.slopes))?;
        Some(
            self.slopes
                .iter()
                .map(|slope| values[slope.index()].abs())
                .sum(),
        )
    }

    fn values<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        velocities: &[Number<P>],
    ) -> Option<Number<P>> {
        for (coordinate, velocity) in model.coordinates.iter().zip(velocities) {
            point.set_symbol(coordinate.qdot, *velocity);
        }
        let values = point.values(&model.pool, &model.pool.reachable(&[self.value]))?;
        Some(values[self.value.index()])
    }
}

impl AtImpact for Jump<'_> {
    fn place(&mut self) -> &mut Place {
        &mut self.place
    }
}

impl Vanishing for Jump<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(&self.wall.roots);
        roots.extend([self.wall.gap, self.wall.gap_rate, self.value]);
        roots
    }

    fn settle(&self, model: &Model, point: &mut ModularPoint) -> Option<()> {
        self.wall.settle(model, point, self.place)?;
        self.dynamics.motion(&model.pool, point, None).map(|_| ())
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        self.wall
            .incoming(model, self.dynamics, attempt, self.roots())
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let before: Vec<_> = model
            .coordinates
            .iter()
            .map(|own| point.symbol(&model.pool, own.qdot))
            .collect();
        let after = self.wall.after(model, point)?;
        let new = self.values(model, point, &after)?;
        let old = self.values(model, point, &before)?;
        Some(vec![new, point.field().neg(old)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let after = self.wall.after(model, point)?;
        let largest = after.iter().fold(0.0, |size: f64, own| size.max(own.abs()));
        let by_velocity = self.slope_by_velocity(model, point)? * largest;
        let before = magnitude(model, point, self.value);
        self.values(model, point, &after)?;
        Some(before + magnitude(model, point, self.value) + by_velocity)
    }

    fn shown(&self, _: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        let names = [
            format!("{} after", self.written),
            format!("{} before", self.written),
        ];
        names.into_iter().zip([terms[0], -terms[1]]).collect()
    }
}
