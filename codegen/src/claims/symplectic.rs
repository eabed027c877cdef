//! `symplectic`: do the motion and all that happens at surfaces keep `dp_i dq^i`?
//!
//! ```text
//! motion        L_X (dp_i dq^i) = d(F_i dq^i) + d(lambda_a eta^a)
//! surfaces      the same on vectors that the motion through h = 0 carries along, see `invariant.rs`
//! ```
//!
//! Without constraints the motion keeps the form iff `F_i dq^i` is closed. With them the form on D is not kept where
//! `lambda_a deta^a(X, Y)` differs from 0 for two fields of D: `deta^a(X, Y)` is the value of `d(lambda_a eta^a)` on their lifts, as
//! both are annihilated by `eta^a`. Where that is 0 the form on all states of D decides, as `invariant` does; where D has leaves it can prove the
//! claim alone. An impulse along `dh` keeps the form iff it keeps the volume.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Pool, RealPoint, SymbolId};

use super::conserved::magnitude;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::exactness::decide_local;
use super::expansion::Tangents;
use super::finding::{Certificate, Verdict, Witness};
use super::hybrid::{Density, Surroundings, effects};
use super::invariant::{check_invariant, kept_at_surface};
use super::passage::{Passage, Velocities};
use super::problem::Problem;
use super::side::Side;
use super::undecided::Undecided;
use super::wall::Wall;
use crate::model::{ExteriorForm, Model};

const KEPT: &str = "the motion of a Lagrangian without constraints keeps the symplectic form";
const LEAVES: &str =
    "the form on D may be kept on the leaves of integrable constraints, which are not examined";

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
                Verdict::Refuted(witness) => Verdict::Refuted(Witness {
                    reason: format!(
                        "`{name}` does not keep the symplectic form, as volumes are not kept: it {}",
                        effect.text
                    ),
                    help: "leave it out".to_owned(),
                    ..witness
                }),
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

/// The verdict on constraints: that on two fields of D, else that on all states of D.
fn on_constraints(model: &mut Model, around: &Surroundings<'_>) -> Verdict {
    if let Some(refuted) = changed_on_fields(model, around) {
        return refuted;
    }
    let (form, written) = symplectic_form(model);
    match check_invariant(model, around, &form, &written) {
        // A vector off the leaves of integrable constraints says nothing of them.
        Verdict::Refuted(_) if !connects(model, around) => Verdict::Undecided(LEAVES.to_owned()),
        decided => decided,
    }
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
    let (form, written) = symplectic_form(model);
    kept_at_surface(model, around, &tangents, (&form, &written), surface)
}

/// `dp_i ^ dq^i`, and its text.
fn symplectic_form(model: &mut Model) -> (ExteriorForm, String) {
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
