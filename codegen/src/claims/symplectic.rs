//! `symplectic`: decides whether the motion and all events at surfaces preserve `dp_i ^ dq^i`.
//!
//! ```text
//! motion        L_X (dp_i ^ dq^i) = d(F_i dq^i) + d(lambda_a eta^a)
//! surfaces      the form has the same values on vectors before h = 0 and on their images behind it, see `carried.rs`
//! ```
//!
//! Without constraints the motion preserves the form iff `F_i dq^i` is closed. With constraints it does not preserve
//! the form on D where `lambda_a deta^a(X, Y)` is not 0 for two fields X, Y of D: `deta^a(X, Y)` is the value of
//! `d(lambda_a eta^a)` on their lifts, as `eta^a` annihilates both. If this value is 0, the form on all states of D
//! decides, as for the claim `invariant`. If that form is not preserved and the constraints are integrable, the form on
//! their leaves decides; see `leaves.rs`. An impulse along `dh` preserves the form iff it preserves the volume.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, RealPoint, SymbolId};

use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::exactness::decide_local;
use super::expansion::{Tangents, explicit_form};
use super::finding::{Certificate, Verdict, Witness};
use super::hybrid::{Density, Effect, Surroundings, effects};
use super::invariant::{Stated, check_on, kept_at_surface};
use super::leaves::{Entered, are_integrable, check_behind, curl};
use super::passage::{Open, Passage, Velocities};
use super::problem::Problem;
use super::side::Side;
use super::together::Together;
use super::undecided::Undecided;
use super::wall::Wall;
use crate::model::{ExteriorForm, Model};

const KEPT: &str = "the motion of a Lagrangian without constraints keeps the symplectic form";
const LEAVES: &str = "some constraints are integrable and some are not: the form on all states of D changes, and on the leaves of the integrable ones it is not examined";
const UNKNOWN: &str = "the form on all states of D changes, and it is not known whether the constraints are integrable: on their leaves it may be kept";

/// The verdict on `symplectic`.
pub(super) fn check_symplectic(model: &mut Model, around: &Surroundings<'_>) -> Verdict {
    if !model.constraints.is_empty() {
        return on_constraints(model, around);
    }
    let motion = forces_are_closed(model, around);
    let mut all = match motion {
        Verdict::Proved(certificate) => certificate,
        other => return other,
    };
    let one = Density {
        value: Some(model.pool.one()),
        written: None,
        is_found: false,
    };
    let effects = effects(model, around, &one);
    let mut open = None;
    for effect in effects {
        let name = model.surfaces[effect.surface].name.display.clone();
        match at_surface(model, around, effect) {
            Verdict::Proved(part) => {
                all.rest_on(&part);
                all.shown += &format!("; `{name}` keeps it");
            }
            Verdict::Undecided(reason) => {
                open.get_or_insert(format!("the effect of `{name}` is not known: {reason}"));
            }
            refuted @ Verdict::Refuted(_) => return refuted,
        }
    }
    match open {
        Some(reason) => Verdict::Undecided(reason),
        None => Verdict::Proved(all),
    }
}

/// Verdict on a surface of a mode without constraints, given the effect of the surface on volumes.
fn at_surface(model: &mut Model, around: &Surroundings<'_>, effect: Effect) -> Verdict {
    let surface = effect.surface;
    let wall = Wall::of(model, around.derivation, surface, around.others);
    let gains = |open: Option<Open>| matches!(open, Some(Open::Dimensions(before, after)) if before < after);
    let leads_to_more = model.surfaces[surface].instantaneous.is_empty()
        && wall
            .passage
            .as_ref()
            .is_some_and(|passage| gains(passage.open));
    let is_declared = |passage: &Passage| matches!(passage.velocities, Velocities::Declared(..));
    match effect.verdict {
        _ if leads_to_more => map_to_more_keeps(model, around, surface),
        // A map that changes volumes does not preserve the form.
        Verdict::Proved(_) if wall.passage.as_ref().is_some_and(is_declared) => {
            map_keeps(model, around, surface)
        }
        Verdict::Refuted(witness) => {
            let name = &model.surfaces[surface].name.display;
            let reason = format!(
                "`{name}` does not keep the symplectic form, as volumes are not kept: it {}",
                effect.text
            );
            let witness = Witness {
                reason,
                help: "leave it out".to_owned(),
                ..witness
            };
            changed_with_volumes(model, around, surface, witness)
        }
        other => other,
    }
}

/// The refutation at a surface that does not preserve volumes. If the change of volumes was proved without a state, a
/// state that refutes the form is shown.
fn changed_with_volumes(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    witness: Witness,
) -> Verdict {
    if witness.sample.is_none()
        && let Verdict::Refuted(mut shown) = map_keeps(model, around, surface)
    {
        shown.reason = format!("{}; {}", shown.reason, witness.reason);
        return Verdict::Refuted(shown);
    }
    Verdict::Refuted(witness)
}

/// Verdict on a motion with forces: `F_i dq^i` must be a closed form of the positions.
fn forces_are_closed(model: &mut Model, around: &Surroundings<'_>) -> Verdict {
    let n = model.coordinates.len();
    let mut force = vec![model.pool.zero(); n];
    for declared in model.forces.clone() {
        for (sum, entry) in force.iter_mut().zip(declared.form) {
            *sum = model.pool.add(*sum, entry);
        }
    }
    let coordinates = model.coordinates.clone();
    let mut certificate = Certificate::without_chance(KEPT.to_owned(), around.seed);
    for i in 0..n {
        for j in 0..n {
            let [a, b] = [i, j].map(|k| coordinates[k].name.display.clone());
            let slope = model.pool.diff(force[i], coordinates[j].qdot);
            let mut parts = vec![(slope, format!("derivative of the force on {a} by dot({b})"))];
            if i < j {
                let one = model.pool.diff(force[i], coordinates[j].q);
                let other = model.pool.diff(force[j], coordinates[i].q);
                let curl = model.pool.sub(one, other);
                parts.push((curl, format!("curl of the force in {a} and {b}")));
            }
            for (value, shown) in parts {
                if model.pool.is_syntactic_zero(value) {
                    continue;
                }
                match vanishes(model, around, value, shown) {
                    Verdict::Proved(part) => certificate.rest_on(&part),
                    other => return other,
                }
            }
        }
    }
    Verdict::Proved(certificate)
}

/// Verdict on an expression that must be 0 at all states.
fn vanishes(model: &Model, around: &Surroundings<'_>, value: ExprId, shown: String) -> Verdict {
    let question = AtStates::value(around.dynamics, value, shown);
    let wording = Wording {
        vanishes: KEPT.to_owned(),
        differs: "forces change the symplectic form".to_owned(),
        help: ["leave it out".to_owned(), String::new()],
    };
    evidence(model, &question, around.seed).verdict(true, wording, around.seed)
}

/// Verdict under constraints: first on two fields of D, then on all states of D, then on the leaves of D.
fn on_constraints(model: &mut Model, around: &Surroundings<'_>) -> Verdict {
    if let Some(refuted) = changed_on_fields(model, around) {
        return refuted;
    }
    let Some(tangents) = Tangents::of(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    let (form, written) = &symplectic_form(model);
    let form = stated(form, written);
    let on_d = check_on(model, around, &tangents, form);
    let on_d = with_behind(model, around, &tangents, form, (on_d, &[]));
    if matches!(on_d, Verdict::Proved(_)) {
        return on_d;
    }
    match are_integrable(model, around.dynamics, around.seed) {
        Verdict::Proved(integrable) => {
            let tangents = tangents.along_leaves();
            let mut verdict = check_on(model, around, &tangents, form);
            if let Verdict::Proved(all) = &mut verdict {
                all.rest_on(&integrable);
                all.shown = format!("{}, and {}", integrable.shown, all.shown);
            }
            with_behind(model, around, &tangents, form, (verdict, &[]))
        }
        // A vector across the leaves of integrable constraints is no refutation.
        found if matches!(on_d, Verdict::Refuted(_)) && !connects(model, around) => {
            let is_known = matches!(found, Verdict::Refuted(_));
            Verdict::Undecided(if is_known { LEAVES } else { UNKNOWN }.to_owned())
        }
        _ => on_d,
    }
}

/// The verdict, extended by the vectors that surfaces carry to other modes.
fn with_behind(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    form: Stated<'_>,
    (verdict, assumed): (Verdict, &[usize]),
) -> Verdict {
    let Verdict::Proved(all) = verdict else {
        return verdict;
    };
    let mut together = Together::of(all);
    for surface in model.acting_surfaces() {
        let behind = check_mode_behind(model, around, tangents, form, surface, assumed);
        let named = |verdict| match verdict {
            Verdict::Undecided(reason) => unknown(model, surface, &reason),
            decided => decided,
        };
        if let Some(refuted) = behind.and_then(|verdict| together.add(named(verdict))) {
            return refuted;
        }
    }
    together.verdict()
}

/// An open verdict with the name of a surface and the reason.
fn unknown(model: &Model, surface: usize, reason: &str) -> Verdict {
    let name = &model.surfaces[surface].name.display;
    Verdict::Undecided(format!("the effect of `{name}` is not known: {reason}"))
}

/// Verdict on the vectors that one surface carries to another mode.
fn check_mode_behind(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    form: Stated<'_>,
    surface: usize,
    assumed: &[usize],
) -> Option<Verdict> {
    let explicit = explicit_form(model, form.form);
    let forms = (&explicit, form);
    check_behind(model, around, tangents, forms, surface, |entered| {
        keeps_all(entered, around, assumed)
    })
}

/// Verdict on all states of an entered mode: its motion, its surfaces and the modes behind it must preserve the form.
/// Modes that are already under examination (`assumed`) are taken to preserve it.
fn keeps_all(entered: &mut Entered, around: &Surroundings<'_>, assumed: &[usize]) -> Verdict {
    let index = entered.index.unwrap_or(usize::MAX);
    if assumed.contains(&index) {
        let shown = "the form is kept on all states".to_owned();
        return Verdict::Proved(Certificate::without_chance(shown, around.seed));
    }
    if entered.model.is_nonlinear() {
        return Verdict::Undecided(Undecided::Nonlinear.to_string());
    }
    let model = &mut entered.model;
    let around = &Surroundings {
        derivation: &entered.derivation,
        dynamics: &entered.dynamics,
        ..*around
    };
    let Some(tangents) = Tangents::of(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    let (form, written) = &symplectic_form(model);
    let form = stated(form, written);
    let on_d = check_on(model, around, &tangents, form);
    let assumed = [assumed, &[index]].concat();
    with_behind(model, around, &tangents, form, (on_d, &assumed))
}

/// True if brackets of fields of D span all directions, so that there are no leaves.
fn connects(model: &mut Model, around: &Surroundings<'_>) -> bool {
    let problem = Problem::of(model, around.derivation);
    let found = decide_local(&model.pool, &problem, around.seed);
    found.is_ok_and(|local| local.rank == problem.components())
}

/// Refutation by two fields of D on which constraint forces change the form.
fn changed_on_fields(model: &mut Model, around: &Surroundings<'_>) -> Option<Verdict> {
    let n = model.coordinates.len();
    let q: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    let constraints = model.constraints.iter();
    let forms: Vec<Vec<ExprId>> = constraints
        .map(|constraint| constraint.form.clone())
        .collect();
    let curls: Vec<Vec<Vec<ExprId>>> = forms
        .iter()
        .map(|form| curl(&mut model.pool, form, &q))
        .collect();
    let side = Side::of(model);
    let free = n - model.constraints.len();
    for i in 0..free {
        for j in i + 1..free {
            let question = AtStates {
                dynamics: around.dynamics,
                part: Part::Curl {
                    curls: &curls,
                    side: &side,
                    pair: (i, j),
                },
                shown: "lambda_a deta^a(X, Y)".to_owned(),
            };
            let wording = Wording {
                vanishes: String::new(),
                differs: format!(
                    "constraint forces change the symplectic form on D: X and Y are the fields of D of its independent velocities {} and {}",
                    i + 1,
                    j + 1
                ),
                help: [
                    "leave it out; `volume: kept;` may hold".to_owned(),
                    String::new(),
                ],
            };
            let found = evidence(model, &question, around.seed);
            if let verdict @ Verdict::Refuted(_) = found.verdict(true, wording, around.seed) {
                return Some(verdict);
            }
        }
    }
    None
}

/// Verdict on a declared map of velocities, without constraints.
fn map_keeps(model: &mut Model, around: &Surroundings<'_>, surface: usize) -> Verdict {
    let Some(tangents) = Tangents::of(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    let (form, written) = &symplectic_form(model);
    kept_at_surface(model, around, &tangents, stated(form, written), surface)
}

/// Verdict on a map to states of higher dimension, where volumes cannot be compared. The form decides, on vectors along
/// the leaves of the constraints there.
fn map_to_more_keeps(model: &mut Model, around: &Surroundings<'_>, surface: usize) -> Verdict {
    let kept = map_keeps(model, around, surface);
    let (Verdict::Proved(all), Some(tangents)) = (&kept, Tangents::of(model, around.dynamics))
    else {
        return kept;
    };
    let mut together = Together::of(all.clone());
    let (form, written) = &symplectic_form(model);
    let form = stated(form, written);
    let behind = check_mode_behind(model, around, &tangents, form, surface, &[]);
    let refuted = behind.and_then(|verdict| together.add(verdict));
    refuted.unwrap_or_else(|| together.verdict())
}

/// The symplectic form in the shape of a stated form.
pub(super) fn stated<'f>(form: &'f ExteriorForm, written: &'f str) -> Stated<'f> {
    Stated {
        form,
        written,
        is_symplectic: true,
    }
}

/// `dp_i ^ dq^i`, with its text.
pub(super) fn symplectic_form(model: &mut Model) -> (ExteriorForm, String) {
    let mut form = ExteriorForm::zero(2);
    let mut texts = Vec::new();
    for i in 0..model.coordinates.len() {
        let (q, p) = (model.coordinates[i].q, model.derived.momenta[i]);
        let pool = &mut model.pool;
        let pair = [p, q].map(|symbol| pool.variable(symbol));
        let [dp, dq] = pair.map(|function| ExteriorForm::differential(pool, function));
        let area = dp.wedge(pool, &dq);
        form = form.plus(pool, area);
        let name = &model.coordinates[i].name.display;
        texts.push(format!("d(momentum({name}))^d({name})"));
    }
    (form, texts.join(" + "))
}

/// The claim that a quantity is 0 at all states on D.
pub(super) struct AtStates<'s> {
    dynamics: &'s Dynamics,
    part: Part<'s>,
    shown: String,
}

impl<'s> AtStates<'s> {
    /// An expression of positions, velocities and time.
    pub(super) fn value(dynamics: &'s Dynamics, value: ExprId, shown: String) -> Self {
        Self {
            dynamics,
            part: Part::Value(value),
            shown,
        }
    }
}

enum Part<'s> {
    Value(ExprId),
    /// `lambda_a deta^a(X_i, X_j)`
    Curl {
        curls: &'s [Vec<Vec<ExprId>>],
        side: &'s Side,
        pair: (usize, usize),
    },
}

impl Vanishing for AtStates<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        match &self.part {
            Part::Value(value) => roots.push(*value),
            Part::Curl { curls, side, .. } => {
                roots.extend(curls.iter().flatten().flatten());
                roots.extend(side.roots());
            }
        }
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let (curls, side, (i, j)) = match &self.part {
            Part::Value(value) => {
                let values = point.values(&model.pool, &model.pool.reachable(&[*value]))?;
                return Some(vec![values[value.index()]]);
            }
            Part::Curl { curls, side, pair } => (curls, side, *pair),
        };
        let field = point.field();
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
        let basis = side.chart(point, &values)?.basis;
        let mut terms = Vec::new();
        for (multiplier, curl) in motion.multipliers.iter().zip(curls.iter()) {
            let mut sum = field.integer(0);
            for (row, x) in curl.iter().zip(&basis) {
                for (entry, y) in row.iter().zip(&basis) {
                    let product = field.mul(x[i], y[j]);
                    sum = field.add(sum, field.mul(values[entry.index()], product));
                }
            }
            terms.push(field.mul(*multiplier, sum));
        }
        Some(terms)
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let terms = self.terms(model, point)?;
        let sum: f64 = terms.iter().map(|term| term.abs()).sum();
        Some(match &self.part {
            Part::Value(value) => magnitude(model, point, *value),
            Part::Curl { .. } => sum,
        })
    }

    fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
        vec![(self.shown.clone(), sum)]
    }
}
