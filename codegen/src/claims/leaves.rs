//! Leaves of integrable constraints: their existence, and surfaces that map vectors along leaves to such vectors.
//!
//! ```text
//! w^a = eta^a + eta^a_0 dt      dw^a(X, Y) = 0 for all fields X, Y of Q x R that all w^a annihilate (Frobenius)
//! ```
//!
//! The vectors along a leaf at one time have `eta^a(v) = 0`. The motion on a leaf is that of the Lagrangian restricted
//! to it, and keeps its symplectic form.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Pool, RealPoint, SymbolId};

use super::carried::Carried;
use super::collision::evidence_at_impact;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::expansion::{CHANCE, Tangents, weight};
use super::finding::{Certificate, Verdict};
use super::hybrid::Surroundings;
use super::invariant::Stated;
use super::side::Side;
use super::undecided::Undecided;
use super::wall::Wall;
use crate::mechanics::{Derivation, derive};
use crate::model::{ExteriorForm, Model};

/// The verdict on whether the constraints of a model are integrable together.
pub(super) fn are_integrable(model: &mut Model, dynamics: &Dynamics, seed: u64) -> Verdict {
    if model.is_nonlinear() {
        return Verdict::Undecided(Undecided::Nonlinear.to_string());
    }
    let mut variables: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.q)
        .collect();
    variables.push(model.time);
    let forms: Vec<Vec<ExprId>> = model
        .constraints
        .iter()
        .map(|constraint| constraint.expressions().collect())
        .collect();
    let curls: Vec<Vec<Vec<ExprId>>> = forms
        .iter()
        .map(|form| curl(&mut model.pool, form, &variables))
        .collect();
    let side = Side::of(model);
    let question = Involutive {
        dynamics,
        curls: &curls,
        side: &side,
        seed,
    };
    let wording = Wording {
        vanishes: "the constraints are integrable".to_owned(),
        ..Wording::default()
    };
    match evidence(model, &question, seed).verdict(true, wording, seed) {
        Verdict::Proved(proof) => Verdict::Proved(with_chance(proof)),
        other => other,
    }
}

/// A proof by random weights, with their chance of error.
fn with_chance(proof: Certificate) -> Certificate {
    Certificate {
        error: proof.error + CHANCE,
        ..proof
    }
}

/// `d_i w_j - d_j w_i`
pub(super) fn curl(pool: &mut Pool, form: &[ExprId], variables: &[SymbolId]) -> Vec<Vec<ExprId>> {
    let all = 0..form.len();
    let mut entry = |i: usize, j: usize| {
        let one = pool.diff(form[j], variables[i]);
        let other = pool.diff(form[i], variables[j]);
        pool.sub(one, other)
    };
    all.clone()
        .map(|i| all.clone().map(|j| entry(i, j)).collect())
        .collect()
}

/// The values of `dw^a` on pairs of fields that all `w^a` annihilate, summed with random weights.
struct Involutive<'i> {
    dynamics: &'i Dynamics,
    curls: &'i [Vec<Vec<ExprId>>],
    side: &'i Side,
    seed: u64,
}

impl Involutive<'_> {
    /// The values of each curl, on each pair of fields.
    fn values<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let motion = self.dynamics.motion(&model.pool, point, None)?;
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots()))?;
        let basis = self.side.chart(point, &values)?.basis;
        let free = basis.first().map_or(0, Vec::len);
        let mut fields: Vec<Vec<Number<P>>> = (0..free)
            .map(|k| basis.iter().map(|row| row[k]).collect())
            .collect();
        fields
            .iter_mut()
            .for_each(|vector| vector.push(field.integer(0)));
        let mut along = motion.qdot;
        along.push(field.integer(1));
        fields.push(along);
        let mut found = Vec::new();
        for curl in self.curls {
            for (place, x) in fields.iter().enumerate() {
                for y in &fields[..place] {
                    let mut sum = field.integer(0);
                    for (row, x) in curl.iter().zip(x) {
                        for (entry, y) in row.iter().zip(y) {
                            let product = field.mul(*x, *y);
                            sum = field.add(sum, field.mul(values[entry.index()], product));
                        }
                    }
                    found.push(sum);
                }
            }
        }
        Some(found)
    }
}

impl Vanishing for Involutive<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(self.curls.iter().flatten().flatten());
        roots.extend(self.side.roots());
        roots
    }

    fn dynamics(&self) -> Option<&Dynamics> {
        Some(self.dynamics)
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let field = point.field();
        let values = self.values(model, point)?;
        let weighted = values
            .into_iter()
            .enumerate()
            .map(|(index, value)| field.mul(field.integer(weight(self.seed, index as u64)), value));
        Some(vec![
            weighted.fold(field.integer(0), |sum, term| field.add(sum, term)),
        ])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let order = model.pool.reachable(&self.roots());
        let values = RealPoint::values(point, &model.pool, &order)?;
        let entries = self.curls.iter().flatten().flatten();
        let size: f64 = entries.map(|entry| values[entry.index()].abs()).sum();
        Some((1.0 + size) / CHANCE)
    }

    fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
        vec![("curls of the constraints".to_owned(), sum)]
    }
}

/// A mode that is entered, with its equations.
pub(super) struct Entered {
    /// Its index, unless it is the mode that is left.
    pub(super) index: Option<usize>,
    pub(super) model: Model,
    pub(super) derivation: Derivation,
    pub(super) dynamics: Dynamics,
}

impl Entered {
    fn of(index: Option<usize>, mut model: Model) -> Self {
        let derivation = derive(&mut model);
        let dynamics = Dynamics::of(&mut model, &derivation);
        Self {
            index,
            model,
            derivation,
            dynamics,
        }
    }
}

/// The verdict on whether the form is also kept behind a surface; `None` if that needs no proof. If the constraints of
/// the mode behind it are integrable, that mode may preserve the form only on vectors along its leaves. The surface
/// must then map vectors along leaves to such vectors, or the mode must preserve the form on all vectors (`keeps_all`).
pub(super) fn check_behind(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    forms: (&ExteriorForm, Stated<'_>),
    surface: usize,
    keeps_all: impl FnOnce(&mut Entered) -> Verdict,
) -> Option<Verdict> {
    let enters = model.surfaces[surface].transition.as_ref();
    let enters = enters.map(|transition| transition.enters);
    let entered = enters.and_then(|enters| around.others.get(enters)).copied();
    let is_needed = match entered {
        Some(mode) => !mode.constraints.is_empty(),
        None => tangents.is_along_leaves,
    };
    if !is_needed {
        return None;
    }
    let mut behind = Entered::of(enters, entered.unwrap_or(model).clone());
    let integrable = are_integrable(&mut behind.model, &behind.dynamics, around.seed);
    // Without leaves, the form of that mode is examined on all vectors.
    if matches!(integrable, Verdict::Refuted(_)) {
        return None;
    }
    if let landed @ Verdict::Proved(_) =
        lands_along(model, around, tangents, forms, surface, entered)
    {
        return Some(landed);
    }
    if entered.is_some()
        && let kept @ Verdict::Proved(_) = keeps_all(&mut behind)
    {
        return Some(kept);
    }
    let why = match integrable {
        Verdict::Proved(_) => "the motion there is known to keep the form along leaves only",
        _ => "it is not known whether these are integrable",
    };
    Some(Verdict::Undecided(format!(
        "it is not shown to carry vectors along a leaf to vectors along leaves of the constraints behind it, and {why}"
    )))
}

/// The verdict on whether a surface maps vectors to vectors along leaves of the constraints behind it.
fn lands_along(
    model: &mut Model,
    around: &Surroundings<'_>,
    tangents: &Tangents,
    forms: (&ExteriorForm, Stated<'_>),
    surface: usize,
    entered: Option<&Model>,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    let wall = Wall::of(model, around.derivation, surface, around.others);
    let tangents = &tangents.at_wall(model, around, &wall);
    let question = match Carried::of(model, around, forms, tangents, (&wall, entered)) {
        Ok(question) => question.across_leaves(around.seed),
        Err(reason) => return Verdict::Undecided(reason),
    };
    let wording = Wording {
        vanishes: format!("`{name}` carries vectors along leaves to such vectors"),
        ..Wording::default()
    };
    let found = evidence_at_impact(model, &wall, around.dynamics, &question, around.seed);
    match found.verdict(true, wording, around.seed) {
        Verdict::Proved(proof) => Verdict::Proved(with_chance(proof)),
        other => other,
    }
}
