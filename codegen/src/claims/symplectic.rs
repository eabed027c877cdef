//! `symplectic`: do the motion and all that happens at surfaces keep `dp_i dq^i`?
//!
//! ```text
//! motion        L_X (dp_i dq^i) = d(F_i dq^i) + d(lambda_a eta^a)
//! surfaces      the same on vectors that the motion through h = 0 carries along, see `invariant.rs`
//! ```
//!
//! Without constraints the motion keeps the form iff `F_i dq^i` is closed. With them the form on D is not kept where
//! `lambda_a deta^a(X, Y)` differs from 0 for two fields of D: `deta^a(X, Y)` is the value of `d(lambda_a eta^a)` on their lifts, as
//! both are annihilated by `eta^a`. Where that is 0 the form on all states of D decides, as `invariant` does. If it is not kept there and the
//! constraints are integrable, the form on their leaves decides, see `leaves.rs`. An impulse along `dh` keeps the form iff it keeps the volume.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Pool, RealPoint, SymbolId};

use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::exactness::decide_local;
use super::expansion::{Tangents, explicit_form};
use super::finding::{Certificate, Verdict, Witness};
use super::hybrid::{Density, Surroundings, effects};
use super::invariant::{Stated, check_on, kept_at_surface, kept_by_motion};
use super::leaves::{are_integrable, check_behind};
use super::passage::{Passage, Velocities};
use super::problem::Problem;
use super::side::Side;
use super::together::Together;
use super::undecided::Undecided;
use super::wall::Wall;
use crate::model::{ExteriorForm, Model};

const KEPT: &str = "the motion of a Lagrangian without constraints keeps the symplectic form";
const LEAVES: &str = "some constraints are integrable and some are not: the form on all states of D changes, and on the leaves of the integrable ones it is not examined";

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
        let surface = effect.surface;
        let name = model.surfaces[surface].name.display.clone();
        let wall = Wall::of(model, around.derivation, surface, around.others);
        let is_declared =
            |passage: &Passage| matches!(passage.velocities, Velocities::Declared(..));
        let verdict = match wall.passage.as_ref().is_some_and(is_declared) {
            // What changes volumes does not keep the form.
            true if effect.keeps() => map_keeps(model, around, surface),
            _ => match effect.verdict {
                Verdict::Refuted(witness) => changed_with_volumes(
                    model,
                    around,
                    surface,
                    Witness {
                        reason: format!(
                            "`{name}` does not keep the symplectic form, as volumes are not kept: it {}",
                            effect.text
                        ),
                        help: "leave it out".to_owned(),
                        ..witness
                    },
                ),
                other => other,
            },
        };
        match verdict {
            Verdict::Proved(part) => {
                all.rest_on(&part);
                all.shown += &format!("; `{name}` keeps it");
            }
            Verdict::Refuted(_) => return verdict,
            Verdict::Undecided(reason) => {
                open.get_or_insert(format!("what `{name}` does is not known: {reason}"));
            }
        }
    }
    match open {
        Some(reason) => Verdict::Undecided(reason),
        None => Verdict::Proved(all),
    }
}

/// The refutation at a surface that does not keep volumes; at a state where the form itself shows it, if volumes need none.
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

/// The verdict on a motion with forces: `F_i dq^i` is a closed form of the positions.
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

/// The verdict on an expression that must be 0 at all states.
fn vanishes(model: &Model, around: &Surroundings<'_>, value: ExprId, shown: String) -> Verdict {
    let question = AtStates::value(around.dynamics, value, shown);
    let wording = Wording {
        vanishes: KEPT.to_owned(),
        differs: "forces change the symplectic form".to_owned(),
        help: ["leave it out".to_owned(), String::new()],
    };
    evidence(model, &question, around.seed).verdict(true, wording, around.seed)
}

/// The verdict on constraints: that on two fields of D, that on all states of D, else that on the leaves of D.
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
    if matches!(on_d, Verdict::Proved(_)) {
        return with_behind(model, around, &tangents, form, on_d);
    }
    match are_integrable(model, around.dynamics, around.seed) {
        Some(integrable) => {
            let tangents = tangents.along_leaves();
            let mut verdict = check_on(model, around, &tangents, form);
            if let Verdict::Proved(all) = &mut verdict {
                all.rest_on(&integrable);
                all.shown = format!("{}, and {}", integrable.shown, all.shown);
            }
            with_behind(model, around, &tangents, form, verdict)
        }
        // A vector off the leaves of integrable constraints says nothing of them.
        None if matches!(on_d, Verdict::Refuted(_)) && !connects(model, around) => {
            Verdict::Undecided(LEAVES.to_owned())
        }
        None => on_d,
    }
}

/// The verdict with that on what surfaces carry vectors to.
fn with_behind(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    form: Stated<'_>,
    verdict: Verdict,
) -> Verdict {
    let Verdict::Proved(all) = verdict else {
        return verdict;
    };
    let explicit = explicit_form(model, form.form);
    let mut together = Together::of(all);
    for surface in 0..model.surfaces.len() {
        let forms = (&explicit, form);
        let keeps_all = |there: &mut Model, dynamics: &Dynamics| {
            let Some(tangents) = Tangents::of(there, dynamics) else {
                return false;
            };
            let around = Surroundings {
                dynamics,
                ..*around
            };
            let (form, written) = symplectic_form(there);
            let form = explicit_form(there, &form);
            let kept = kept_by_motion(there, &around, &tangents, (&form, &written));
            matches!(kept, Verdict::Proved(_))
        };
        let behind = check_behind(model, around, tangents, forms, surface, keeps_all);
        if let Some(refuted) = together.add(behind) {
            return refuted;
        }
    }
    together.verdict()
}

/// True if brackets of fields of D span all directions: there are no leaves.
fn connects(model: &mut Model, around: &Surroundings<'_>) -> bool {
    let problem = Problem::of(model, around.derivation);
    let found = decide_local(&model.pool, &problem, around.seed);
    found.is_ok_and(|local| local.rank == problem.components())
}

/// The refutation by two fields of D, between which constraint forces change the form.
fn changed_on_fields(model: &mut Model, around: &Surroundings<'_>) -> Option<Verdict> {
    let n = model.coordinates.len();
    let q: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    let mut curls = Vec::new();
    for constraint in model.constraints.clone() {
        let form = constraint.form;
        let entry = |i: usize, j: usize, pool: &mut Pool| {
            let [one, other] = [pool.diff(form[j], q[i]), pool.diff(form[i], q[j])];
            pool.sub(one, other)
        };
        let row = |i: usize, pool: &mut Pool| (0..n).map(|j| entry(i, j, pool)).collect();
        let rows: Vec<Vec<ExprId>> = (0..n).map(|i| row(i, &mut model.pool)).collect();
        curls.push(rows);
    }
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

/// The verdict on a declared map of velocities without constraints.
fn map_keeps(model: &mut Model, around: &Surroundings<'_>, surface: usize) -> Verdict {
    let Some(tangents) = Tangents::of(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    let (form, written) = &symplectic_form(model);
    kept_at_surface(model, around, &tangents, stated(form, written), surface)
}

/// The symplectic form as one that is stated.
pub(super) fn stated<'f>(form: &'f ExteriorForm, written: &'f str) -> Stated<'f> {
    Stated {
        form,
        written,
        is_symplectic: true,
    }
}

/// `dp_i ^ dq^i`, and its text.
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

/// Something that must be 0 at all states on D.
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
