//! Check that resets keep the constraints. The state after an impact must be in D at its new position, and on the same
//! level of every integrable constraint: positions are brought back to that level after every step.
//!
//! A reset is refused if evaluations modulo primes and at real points refute it. Constraints on velocities may stay
//! undecided, because every run checks them at every impact. Levels must be proved to be kept, because no run checks
//! them.

use dalembert_expr::{ExprId, SymbolId};

use super::collision::{Vanished, evidence_at_impact};
use super::dynamics::Dynamics;
use super::evidence::Wording;
use super::finding::Verdict;
use super::wall::Wall;
use crate::mechanics::Derivation;
use crate::model::{Model, Reset, Surface};
use crate::spec::ItemId;

/// Errors in resets: item, message and advice.
pub fn check_landings(model: &mut Model, derivation: &Derivation) -> Vec<(ItemId, String, String)> {
    let surfaces = model.surfaces.iter();
    if derivation.constraints.is_empty() || surfaces.clone().all(|surface| surface.reset.is_none())
    {
        return Vec::new();
    }
    if model.is_nonlinear() {
        return unexamined(model);
    }
    let dynamics = Dynamics::of(model, derivation);
    let mut mistakes = Vec::new();
    for surface in 0..model.surfaces.len() {
        let Some(reset) = model.surfaces[surface].reset.clone() else {
            continue;
        };
        let wall = Wall::of(model, derivation, surface, &[]);
        let landing = Landings {
            name: model.surfaces[surface].name.display.clone(),
            reset: &reset,
            wall: &wall,
            dynamics: &dynamics,
        };
        for constraint in 0..derivation.constraints.len() {
            let found = landing.check_velocity(model, constraint);
            let found = found.or_else(|| landing.check_level(model, constraint));
            mistakes.extend(found.map(|(text, help)| (reset.item, text, help)));
        }
    }
    mistakes
}

/// Errors for models with constraints that are not linear in the velocities. Every run checks velocities after a reset.
/// Levels are not examined, so resets that move positions are refused.
fn unexamined(model: &Model) -> Vec<(ItemId, String, String)> {
    let levels = model.constraints.iter();
    let Some(level) = levels.clone().find(|constraint| constraint.level.is_some()) else {
        return Vec::new();
    };
    let moving = (model.surfaces.iter())
        .filter_map(|surface| Some((surface, surface.reset.as_ref()?)))
        .filter(|(_, reset)| reset.moves());
    let mistake = |(surface, reset): (&Surface, &Reset)| {
        let (name, level) = (&surface.name.display, &level.name.display);
        let text = format!("the reset of `{name}` is not known to keep the level of `{level}`");
        let help = "write `dot(..)` of the level in the constraint, or leave the positions";
        (reset.item, text, help.to_owned())
    };
    moving.map(mistake).collect()
}

/// The reset of a surface.
struct Landings<'l> {
    name: String,
    reset: &'l Reset,
    wall: &'l Wall,
    dynamics: &'l Dynamics,
}

impl Landings<'_> {
    /// Violation of a constraint by the velocities after the reset, with advice; `None` if it is not refuted.
    fn check_velocity(&self, model: &mut Model, a: usize) -> Option<(String, String)> {
        let (name, constraint) = (&self.name, model.constraints[a].name.display.clone());
        let residual = residual(model, a);
        let question = Vanished {
            change: self.after(model, residual),
            shown: format!("residual of {constraint} after"),
        };
        let help = "velocities after a reset satisfy the constraints at the position after it";
        let wording = Wording {
            differs: format!("the reset of `{name}` leaves the constraint `{constraint}`"),
            help: [help.to_owned(), String::new()],
            ..Wording::default()
        };
        let seed = model.pool.seed();
        let found = evidence_at_impact(model, self.wall, self.dynamics, &question, seed);
        match found.verdict(true, wording, seed) {
            Verdict::Refuted(witness) => Some((witness.to_string(), witness.help)),
            _ => None,
        }
    }

    /// Change of the level of an integrable constraint, with advice; `None` if the level is proved to be kept.
    fn check_level(&self, model: &mut Model, a: usize) -> Option<(String, String)> {
        let level = model.constraints[a].level.filter(|_| self.reset.moves())?;
        let (name, constraint) = (&self.name, model.constraints[a].name.display.clone());
        let after = self.after(model, level);
        let question = Vanished {
            change: model.pool.sub(after, level),
            shown: format!("change of the level of {constraint}"),
        };
        let seed = model.pool.seed();
        let found = evidence_at_impact(model, self.wall, self.dynamics, &question, seed);
        (!found.shows_that_it_vanishes()).then(|| {
            let text =
                format!("the reset of `{name}` is not known to keep the level of `{constraint}`");
            let help = "a position stays on the level of an integrable constraint";
            (text, help.to_owned())
        })
    }

    /// An expression at the state after the reset, in terms of the state before it.
    fn after(&self, model: &mut Model, value: ExprId) -> ExprId {
        let replacements = self.reset.replacements(&model.coordinates);
        model.pool.substitute(value, &replacements)
    }
}

/// `eta(qdot) + eta_0` of a constraint.
fn residual(model: &mut Model, constraint: usize) -> ExprId {
    let velocities: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    let declared = &model.constraints[constraint];
    let (form, mut terms) = (declared.form.clone(), vec![declared.affine]);
    for (entry, symbol) in form.into_iter().zip(velocities) {
        let velocity = model.pool.variable(symbol);
        terms.push(model.pool.mul(entry, velocity));
    }
    model.pool.sum(&terms)
}
