//! Symmetries of motion, impacts, resets and transitions together: decides whether the flow of a vector field maps
//! motions to motions.
//!
//! ```text
//! Lagrangian   lift L = df/dt, D kept (symmetry.rs);  forces   lift F_i + F_j d_i xi^j = 0
//! first order  xi^j d_j X^i - X^j d_j xi^i = 0
//! surface      xi(h) = 0 and lift m = 0 of its conditions m and coefficients, where h = 0
//! reset        lift psi^i = xi^i(psi),   lift w^i = w^j (d_j xi^i)(psi),   q+ = psi, qdot+ = w, where h = 0
//! ```
//!
//! A transition is treated as a reset, with the field of the entered mode on the right-hand side. The flow maps an
//! impulse along `pi_D^* dh` to such an impulse if it preserves the metric, D with the instantaneous constraints, and
//! the surface. It maps a refraction without constraints to a refraction if it preserves both Lagrangians.

use dalembert_expr::{ExprId, SymbolId, Verdict as Zero};

use super::collision::{Vanished, evidence_at_impact};
use super::dynamics::Dynamics;
use super::evidence::Wording;
use super::finding::Verdict;
use super::gauge;
use super::hybrid::Surroundings;
use super::impact::{Wanted, changes_at};
use super::passage::{Passage, Velocities};
use super::side::imported;
use super::symmetry::{check_constraints, check_forces, check_symmetry, keeps_lagrangian, lifted};
use super::wall::Wall;
use crate::mechanics::{Derivation, derive};
use crate::model::{Law, Model};

/// A vector field on each mode of a model, in the order of the modes, or on a model without modes.
pub(crate) struct Fields<'f> {
    /// The modes; empty for a model without modes.
    pub(crate) others: &'f [&'f Model],
    /// The field on each mode, or on the model.
    pub(crate) fields: &'f [Vec<ExprId>],
}

/// Checks that the field is a symmetry of a mode, of its surfaces and of their maps. Returns true if its momentum is
/// proved to be conserved in the mode.
///
/// # Errors
/// The place where the check fails, and the reason.
pub(crate) fn check_equivariance(
    model: &mut Model,
    derivation: &Derivation,
    all: &Fields<'_>,
    mode: usize,
    seed: u64,
) -> Result<bool, String> {
    if model.is_nonlinear() {
        return Err("constraints that are not linear in velocities are not examined".to_owned());
    }
    let dynamics = Dynamics::of(model, derivation);
    let field = &all.fields[mode];
    let (verdict, _) = check_symmetry(model, &dynamics, field, seed);
    expect("the motion", verdict)?;
    expect("the motion", check_forces(model, &dynamics, field, seed))?;
    let around = Surroundings {
        derivation,
        dynamics: &dynamics,
        others: all.others,
        seed,
    };
    for surface in 0..model.surfaces.len() {
        check_surface(model, &around, all, mode, surface)?;
    }
    Ok(keeps_momentum(model, &around, field))
}

/// One sentence for each surface of a first-order system. For a model with modes, the one sentence that transitions are
/// not examined.
pub(super) fn symmetry_at_surfaces(
    model: &mut Model,
    around: &Surroundings<'_>,
    field: &[ExprId],
) -> Vec<String> {
    if !around.others.is_empty() {
        return vec!["what transitions do to it is not examined".to_owned()];
    }
    let all = Fields {
        others: &[],
        fields: &[field.to_vec()],
    };
    (model.acting_surfaces().into_iter())
        .map(|surface| {
            let name = model.surfaces[surface].name.display.clone();
            match check_surface(model, around, &all, 0, surface) {
                Ok(()) => format!("an impact at {name} keeps the symmetry"),
                Err(reason) => {
                    format!("an impact at {name} is not shown to keep the symmetry: {reason}")
                }
            }
        })
        .collect()
}

/// Fails with the reason, prefixed by the place, if the verdict is not a proof.
fn expect(place: &str, verdict: Verdict) -> Result<(), String> {
    match verdict {
        Verdict::Proved(_) => Ok(()),
        Verdict::Refuted(witness) => Err(format!("{place}: {witness}")),
        Verdict::Undecided(reason) => Err(format!("{place}: not shown; {reason}")),
    }
}

/// Checks that the flow preserves a surface and its law.
fn check_surface(
    model: &mut Model,
    around: &Surroundings<'_>,
    all: &Fields<'_>,
    mode: usize,
    surface: usize,
) -> Result<(), String> {
    let declared = &model.surfaces[surface];
    let place = format!("surface `{}`", declared.name.display);
    let coefficient = match declared.law {
        Law::Restitution(e) | Law::Newton(e) => Some(e),
        _ => None,
    };
    let field = &all.fields[mode];
    check_instantaneous(model, surface, field, around.seed)
        .map_err(|reason| format!("{place}: {reason}"))?;
    let directions = lifted(model, field);
    let wall = Wall::of(model, around.derivation, surface, around.others);
    let derived = &around.derivation.surfaces[surface];
    let mut changes = vec![("rate of the gap along its flow".to_owned(), {
        let gap = derived.gap;
        model.pool.derivative_along(gap, &directions)
    })];
    let margins = derived.margins.clone();
    if let Some(value) = coefficient {
        let change = model.pool.derivative_along(value, &directions);
        changes.push(("rate of a coefficient along its flow".to_owned(), change));
    }
    for margin in margins {
        let change = model.pool.derivative_along(margin, &directions);
        // The flow need not keep a condition `c > 0` where it does not change: `X(c) = f c` keeps its sign.
        if model.pool.zero_test(change) == Zero::Proved || is_multiple(model, change, margin) {
            continue;
        }
        // Otherwise only a change at `c = 0` shows something.
        if !model.pool.sign(change).is_nonzero() {
            return Err(format!(
                "{place}: not shown; its flow may change whether a condition holds"
            ));
        }
        changes.push(("rate of a condition along its flow".to_owned(), change));
    }
    if let Some(passage) = &wall.passage {
        changes.extend(of_passage(
            model,
            all,
            (mode, surface),
            passage,
            &directions,
            around.seed,
        )?);
    }
    for (name, change) in changes {
        let mut change = model.pool.simplify(change);
        if let Some(solution) = wall.solution() {
            change = model.pool.substitute(change, &[solution]);
        }
        if model.pool.zero_test(change) == Zero::Proved {
            continue;
        }
        let question = Vanished {
            change,
            shown: name,
        };
        let found = evidence_at_impact(model, &wall, around.dynamics, &question, around.seed);
        let wording = Wording {
            differs: "its flow changes what happens there".to_owned(),
            ..Wording::default()
        };
        expect(&place, found.verdict(true, wording, around.seed))?;
    }
    Ok(())
}

/// True if one expression is shown to be a finite multiple of another one: the ratio of their derivatives.
fn is_multiple(model: &mut Model, one: ExprId, other: ExprId) -> bool {
    let positions = model.coordinates.iter().map(|it| it.q);
    let symbols: Vec<SymbolId> = positions.chain([model.time]).collect();
    symbols.into_iter().any(|by| {
        let slopes = [one, other].map(|value| model.pool.diff(value, by));
        if model.pool.zero_test(slopes[1]) != Zero::Refuted {
            return false;
        }
        let ratio = model.pool.div(slopes[0], slopes[1]);
        let ratio = model.pool.simplify(ratio);
        let multiple = model.pool.mul(ratio, other);
        let difference = model.pool.sub(one, multiple);
        model.pool.is_finite(ratio) && model.pool.zero_test(difference) == Zero::Proved
    })
}

/// Checks that the flow preserves the constraints of the model together with the instantaneous ones of a surface, as in
/// a model that has both as constraints.
fn check_instantaneous(
    model: &Model,
    surface: usize,
    field: &[ExprId],
    seed: u64,
) -> Result<(), String> {
    let added = &model.surfaces[surface].instantaneous;
    if added.is_empty() {
        return Ok(());
    }
    let mut within = model.clone();
    within.constraints.extend(added.iter().cloned());
    within.surfaces.clear();
    within.frame.clear();
    let derivation = derive(&mut within);
    let dynamics = Dynamics::of(&mut within, &derivation);
    let verdict = check_constraints(&mut within, &dynamics, field, seed);
    expect("its instantaneous constraints", verdict)
}

/// Conditions of a reset or transition: differences between the image of the field and the field at the image, with
/// descriptions.
fn of_passage(
    model: &mut Model,
    all: &Fields<'_>,
    (mode, surface): (usize, usize),
    passage: &Passage,
    directions: &[(SymbolId, ExprId)],
    seed: u64,
) -> Result<Vec<(String, ExprId)>, String> {
    let place = model.surfaces[surface].name.display.clone();
    let unknown = format!("surface `{place}`: the field is not known in the mode that is entered");
    let velocities = match &passage.velocities {
        Velocities::Declared(values, _) => values.clone(),
        _ => Vec::new(),
    };
    let enters = model.surfaces[surface].transition.as_ref();
    let enters = enters.map_or(mode, |transition| transition.enters);
    let mut entered = match all.others.get(enters) {
        Some(entered) => (*entered).clone(),
        None => model.clone(),
    };
    if passage.is_refracted() {
        let fields = [&all.fields[mode], &all.fields[enters]];
        check_refraction(model, &mut entered, fields, seed)
            .map_err(|reason| format!("surface `{place}`: {reason}"))?;
    }
    let names: Vec<String> = (entered.coordinates.iter())
        .map(|coordinate| coordinate.name.display.clone())
        .collect();
    let mut after = Vec::new();
    for component in &all.fields[enters] {
        after.push(*component);
        for i in 0..entered.coordinates.len() {
            let q = entered.coordinates[i].q;
            after.push(entered.pool.diff(*component, q));
        }
    }
    let image = (passage.positions.as_slice(), velocities.as_slice());
    let after = imported(model, &entered, image, &after).ok_or(unknown)?;
    let mut changes = Vec::new();
    for (i, row) in after.chunks(names.len() + 1).enumerate() {
        let moved = model
            .pool
            .derivative_along(passage.positions[i], directions);
        let change = model.pool.sub(moved, row[0]);
        changes.push((format!("mismatch in {} behind it", names[i]), change));
        let Some(velocity) = velocities.get(i) else {
            continue;
        };
        let moved = model.pool.derivative_along(*velocity, directions);
        let terms = row[1..].iter().zip(&velocities);
        let terms: Vec<ExprId> = terms.map(|(a, b)| model.pool.mul(*a, *b)).collect();
        let there = model.pool.sum(&terms);
        let change = model.pool.sub(moved, there);
        changes.push((format!("mismatch in dot({}) behind it", names[i]), change));
    }
    Ok(changes)
}

/// Checks that the flow preserves a refraction. A refraction maps `p` to the momentum `p + c dh` at which the energies
/// before and after differ by `-c d_t h`, and which leads away from the surface into the entered mode.
fn check_refraction(
    model: &mut Model,
    entered: &mut Model,
    [field, behind]: [&Vec<ExprId>; 2],
    seed: u64,
) -> Result<(), String> {
    if !model.constraints.is_empty() || !entered.constraints.is_empty() {
        return Err("a refraction within constraints is not examined".to_owned());
    }
    match keeps_lagrangian(model, field, seed) && keeps_lagrangian(entered, behind, seed) {
        true => Ok(()),
        false => Err("a refraction is not shown to be kept: one of its Lagrangians changes along the flow, if only by a total derivative".to_owned()),
    }
}

/// The function whose total derivative the Lagrangian gains along the flow of a symmetry: 0, or a polynomial of the
/// positions. `None` if it is not found.
fn gained(model: &mut Model, field: &[ExprId], seed: u64) -> Option<ExprId> {
    if keeps_lagrangian(model, field, seed) {
        return Some(model.pool.zero());
    }
    let directions = lifted(model, field);
    let whole = model.lagrangian.whole;
    let rate = model.pool.derivative_along(whole, &directions);
    let gained = gauge::antiderivative(model, rate)?;
    (!model.pool.depends_on(gained, model.time)).then_some(gained)
}

/// True if the momentum of a symmetry, minus the function gained, is proved to be conserved by the motion and at all
/// surfaces.
fn keeps_momentum(model: &mut Model, around: &Surroundings<'_>, field: &[ExprId]) -> bool {
    if model.is_first_order() {
        return false;
    }
    let Some(lost) = gained(model, field, around.seed) else {
        return false;
    };
    let constraints = model.constraints.iter().map(|one| one.form.clone());
    let forces = model.forces.iter().map(|force| force.form.clone());
    let forms: Vec<Vec<ExprId>> = constraints.chain(forces).collect();
    for form in forms {
        let terms = form.iter().zip(field);
        let terms: Vec<ExprId> = terms.map(|(a, b)| model.pool.mul(*a, *b)).collect();
        let sum = model.pool.sum(&terms);
        if model.pool.zero_test(sum) != Zero::Proved {
            return false;
        }
    }
    let pairs = field.iter().zip(model.derived.momenta.clone());
    let mut terms = Vec::new();
    for (component, momentum) in pairs {
        let momentum = model.pool.variable(momentum);
        terms.push(model.pool.mul(*component, momentum));
    }
    let momentum = model.pool.sum(&terms);
    let momentum = model.pool.sub(momentum, lost);
    model.acting_surfaces().into_iter().all(|surface| {
        let found = changes_at(model, around, surface, (momentum, "momentum"), Wanted::Any);
        found.is_ok_and(|changes| changes.together(true).shows_that_it_vanishes())
    })
}
