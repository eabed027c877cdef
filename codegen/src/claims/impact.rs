//! Claims `conserved under SURFACE: e`: comparison of a quantity before and after an impact.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint, SymbolId};

use super::collision::{
    AtImpact, after_and_before, evidence_at_impact, value_with, with_difference,
};
use super::conserved::magnitude;
use super::dynamics::Number;
use super::evidence::{Evidence, Wording};
use super::examine::explicit;
use super::finding::Verdict;
use super::focusing::{TURNED, leaves_gap_rate};
use super::hybrid::Surroundings;
use super::passage::Passage;
use super::wall::Wall;
use crate::model::Model;

/// The verdict on `conserved under SURFACE: value` or `not conserved under SURFACE: value`.
pub(super) fn check_conserved_under(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    stated: (ExprId, &str),
    holds: bool,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    let written = stated.1;
    let wording = Wording {
        vanishes: format!("`{written}` is the same before and after an impact at `{name}`"),
        differs: format!("`{written}` changes in an impact at `{name}`"),
        help: [
            match written {
                "energy" => format!(
                    "write `not conserved under {name}: energy;`, or `energy under {name}: not increasing;` for an \
                     impact that only takes energy"
                ),
                _ => format!("write `not conserved under {name}: {written};`"),
            },
            format!("write `conserved under {name}: {written};`"),
        ],
    };
    let changes = match changes_at(model, around, surface, stated, Wanted::Any) {
        Ok(changes) => changes,
        Err(reason) => return Verdict::Undecided(reason),
    };
    let is_seen = changes.is_seen();
    match changes.together(holds).verdict(holds, wording, around.seed) {
        Verdict::Undecided(_) if !is_seen => Verdict::Undecided(format!(
            "parts of `{name}` may be missed: in no coordinate is its gap a polynomial of degree 1 or 2 whose \
             leading coefficient is never 0"
        )),
        verdict => verdict,
    }
}

/// Changes of a quantity that are sought at real states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Every change.
    Any,
    /// Increases of the quantity.
    Growth,
}

/// The evidence on the changes of a quantity at a surface.
pub(super) struct Changes {
    /// Evidence from the law, the reset or the transition.
    pub(super) found: Evidence,
    /// Evidence from a reflection, if a transition may be one.
    reflected: Option<Evidence>,
    is_solved: bool,
}

impl Changes {
    fn is_seen(&self) -> bool {
        self.is_solved || !self.found.is_real
    }

    /// Evidence on all changes. A change by a reflection at a state refutes nothing, because the reflection may not
    /// occur there.
    pub(super) fn together(self, holds: bool) -> Evidence {
        match self.reflected {
            Some(reflected) if holds => {
                let reflected = Evidence {
                    witness: None,
                    is_suspect: reflected.is_suspect || reflected.witness.is_some(),
                    ..reflected
                };
                self.found.and(reflected)
            }
            _ => self.found,
        }
    }
}

/// The evidence on whether a quantity, which may name `energy` and momenta, is the same before and after an impact.
///
/// # Errors
/// The reason for which the change is unknown.
pub(super) fn changes_at(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    (quantity, written): (ExprId, &str),
    wanted: Wanted,
) -> Result<Changes, String> {
    let declared = &model.surfaces[surface];
    let name = declared.name.display.clone();
    let enters = declared
        .transition
        .as_ref()
        .map(|transition| transition.enters);
    let wall = Wall::of(model, around.derivation, surface, around.others);
    if !leaves_gap_rate(model, around, surface, &wall) {
        return Err(format!("of impacts at `{name}`: {TURNED}"));
    }
    let entered = enters.and_then(|enters| around.others.get(enters)).copied();
    let value = explicit(model, quantity);
    let after = match &wall.passage {
        Some(passage) => {
            let after = passage.quantity_after(model, entered, quantity);
            after.ok_or_else(|| format!("`{written}` is not known after `{name}`"))?
        }
        None if enters.is_some() => {
            return Err(format!(
                "the mode that `{name}` leads to is not examined here"
            ));
        }
        None => value,
    };
    let is_computed = wall
        .passage
        .as_ref()
        .is_none_or(Passage::computes_velocities);
    let is_refracted = wall.passage.as_ref().is_some_and(Passage::is_refracted);
    let jump = Jump::of(model, &wall, (value, after, written), is_computed, wanted);
    let found = evidence_at_impact(model, &wall, around.dynamics, &jump, around.seed);
    let reflected = is_refracted.then(|| {
        let wall = Wall::reflecting(model, around.derivation, surface);
        let jump = Jump::of(model, &wall, (value, value, written), true, wanted);
        evidence_at_impact(model, &wall, around.dynamics, &jump, around.seed)
    });
    Ok(Changes {
        found,
        reflected,
        is_solved: wall.locus().is_solved(),
    })
}

/// The change of a quantity in an impact.
struct Jump<'j> {
    value: ExprId,
    /// Value after the impact.
    after: ExprId,
    /// True if `after` is written in the velocities after the impact instead of those before it.
    is_computed: bool,
    /// Derivatives with respect to the velocities.
    slopes: Vec<ExprId>,
    /// Derivatives with respect to the coordinates.
    by_position: Vec<(SymbolId, ExprId)>,
    written: &'j str,
    wanted: Wanted,
}

impl<'j> Jump<'j> {
    /// The change on the surface, with a coordinate eliminated if the surface can be solved for it.
    fn of(
        model: &mut Model,
        wall: &Wall,
        (value, after, written): (ExprId, ExprId, &'j str),
        is_computed: bool,
        wanted: Wanted,
    ) -> Self {
        let solution = wall.solution();
        let mut on_surface = |id| match solution {
            Some(solution) => model.pool.substitute(id, &[solution]),
            None => id,
        };
        let [value, after] = [value, after].map(&mut on_surface);
        let coordinates = model.coordinates.clone();
        let mut by = |symbol| model.pool.diff(value, symbol);
        Self {
            slopes: coordinates
                .iter()
                .map(|coordinate| by(coordinate.qdot))
                .collect(),
            by_position: coordinates
                .iter()
                .map(|coordinate| (coordinate.q, by(coordinate.q)))
                .collect(),
            after,
            is_computed,
            value,
            written,
            wanted,
        }
    }
}

impl Jump<'_> {
    /// Sensitivity of the value to the position, which satisfies the equation of the surface only up to rounding.
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
        vec![self.after, self.value]
    }

    fn wants(&self, terms: &[f64]) -> bool {
        self.wanted == Wanted::Any || terms.iter().sum::<f64>() > 0.0
    }

    fn terms<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        after: &[Number<P>],
    ) -> Option<Vec<Number<P>>> {
        let [new, old] = match self.is_computed {
            false => {
                let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
                [self.after, self.value].map(|id| values[id.index()])
            }
            true => after_and_before(model, point, after, (self.after, self.value))?,
        };
        Some(vec![new, point.field().neg(old)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint, after: &[f64]) -> Option<f64> {
        let largest = after
            .iter()
            .fold(0.0, |size: f64, component| size.max(component.abs()));
        let values = point.values(&model.pool, &model.pool.reachable(&self.slopes))?;
        let slopes = self.slopes.iter().map(|slope| values[slope.index()].abs());
        let by_velocity = slopes.sum::<f64>() * largest;
        let before = magnitude(model, point, self.value) + self.slope_by_position(model, point)?;
        let new = match self.is_computed {
            false => magnitude(model, point, self.after),
            true => {
                value_with(model, point, after, self.after)?;
                magnitude(model, point, self.after) + self.slope_by_position(model, point)?
            }
        };
        Some(before + new + by_velocity)
    }

    fn shown(&self, terms: &[f64], sum: f64) -> Vec<(String, f64)> {
        let names = ["after", "before"].map(|when| format!("{} {when}", self.written));
        with_difference(names, [terms[0], -terms[1]], sum)
    }
}
