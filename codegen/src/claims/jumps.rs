//! Effects of surfaces on a symmetry xi and on its momentum `J = xi^i dL/dqdot^i`. The flow of xi preserves an impact
//! law if it preserves the surface: `xi(h) = 0` where `h = 0`. An impulse `p+ = p + eps pi_D^* dh` changes the momentum
//! by `eps dh(pi_D xi)` (W. Clark, thesis, chapter VI), which is `eps dh(xi)` if xi lies in D.

use dalembert_expr::{ExprId, Verdict as Zero};

use super::collision::{Vanished, evidence_at_impact};
use super::evidence::Wording;
use super::finding::{Verdict, digits};
use super::hybrid::Surroundings;
use super::impact::{Wanted, changes_at};
use super::symmetry::{gain, lifted};
use super::wall::Wall;
use crate::model::{Law, Model};

/// One sentence for each surface, about the momentum less the gain of the Lagrangian, which is conserved between impacts.
pub(super) fn momentum_at_surfaces(
    model: &mut Model,
    around: &Surroundings<'_>,
    field: &[ExprId],
) -> Vec<String> {
    let gain = gain(model, field);
    let name = match gain {
        Some(_) => "its momentum less the gain",
        None => "its momentum",
    };
    let mut terms = Vec::new();
    for (component, momentum) in field.iter().zip(model.derived.momenta.clone()) {
        let momentum = model.pool.variable(momentum);
        terms.push(model.pool.mul(*component, momentum));
    }
    let mut momentum = model.pool.sum(&terms);
    if let Some(gain) = gain {
        momentum = model.pool.sub(momentum, gain);
    }
    (model.acting_surfaces().into_iter())
        .map(|surface| at_surface(model, around, surface, (momentum, name, field)))
        .collect()
}

fn at_surface(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    (momentum, name, field): (ExprId, &str, &[ExprId]),
) -> String {
    let declared = &model.surfaces[surface];
    let what = match declared.law {
        Law::Transition => format!("the transition {}", declared.name.display),
        _ => format!("an impact at {}", declared.name.display),
    };
    let found = changes_at(model, around, surface, (momentum, "momentum"), Wanted::Any);
    let found = match found {
        Ok(found) => found.together(true),
        Err(reason) => return format!("{what} may change {name}: {reason}"),
    };
    let what = what + surface_is_kept(model, around, surface, field);
    match found.verdict(true, Wording::default(), around.seed) {
        Verdict::Proved(_) => format!("{what} keeps {name}"),
        Verdict::Undecided(reason) => format!("{what} may change {name}: {reason}"),
        Verdict::Refuted(witness) => {
            let values = witness.values.iter();
            let values = values.map(|(name, value)| format!("{name} = {}", digits(*value)));
            let values = values.collect::<Vec<_>>().join(", ");
            let at = witness
                .sample
                .as_ref()
                .map_or(String::new(), |sample| sample.text());
            let jump = jump(model, around, surface, field);
            format!("{what} changes {name}{jump}: {values} at {at}")
        }
    }
}

/// True if the only effect of a surface is an impulse along `pi_D^* dh`.
fn is_impulse(model: &Model, surface: usize) -> bool {
    let declared = &model.surfaces[surface];
    declared.instantaneous.is_empty() && !matches!(declared.law, Law::Reset | Law::Transition)
}

/// Text of the verdict on the invariance of a surface and its law under the flow. Empty for maps that are not impulses.
fn surface_is_kept(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    field: &[ExprId],
) -> &'static str {
    if !is_impulse(model, surface) {
        return "";
    }
    let wall = Wall::of(model, around.derivation, surface, around.others);
    let mut change = along(model, &around.derivation.surfaces[surface].form, field);
    if let Some(solution) = wall.solution() {
        change = model.pool.substitute(change, &[solution]);
    }
    let question = Vanished {
        change,
        shown: "xi(h)".to_owned(),
    };
    let found = evidence_at_impact(model, &wall, around.dynamics, &question, around.seed);
    match found.verdict(true, Wording::default(), around.seed) {
        Verdict::Proved(_) if !keeps_conditions(model, around, surface, field) => "",
        Verdict::Proved(_) => " keeps the symmetry and",
        Verdict::Refuted(_) => " breaks the symmetry and",
        Verdict::Undecided(_) => "",
    }
}

/// True if the flow is known to keep the conditions under which a surface counts, and the coefficient of its law.
fn keeps_conditions(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    field: &[ExprId],
) -> bool {
    let directions = lifted(model, field);
    let coefficient = match model.surfaces[surface].law {
        Law::Restitution(e) | Law::Newton(e) => Some(e),
        _ => None,
    };
    let margins = around.derivation.surfaces[surface].margins.iter().copied();
    margins.chain(coefficient).all(|margin| {
        let rate = model.pool.derivative_along(margin, &directions);
        model.pool.zero_test(rate) == Zero::Proved
    })
}

/// The value of a one-form on the field.
fn along(model: &mut Model, form: &[ExprId], field: &[ExprId]) -> ExprId {
    let terms = form.iter().zip(field);
    let terms: Vec<ExprId> = terms.map(|(a, b)| model.pool.mul(*a, *b)).collect();
    let sum = model.pool.sum(&terms);
    model.pool.simplify(sum)
}

/// Text of the change of the momentum, for an impulse.
fn jump(model: &mut Model, around: &Surroundings<'_>, surface: usize, field: &[ExprId]) -> String {
    if !is_impulse(model, surface) {
        return String::new();
    }
    let forms: Vec<Vec<ExprId>> = model
        .constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    let is_horizontal = forms.iter().all(|form| {
        let value = along(model, form, field);
        model.pool.zero_test(value) == Zero::Proved
    });
    let slope = along(model, &around.derivation.surfaces[surface].form, field);
    match is_horizontal {
        true => format!(
            " by eps*({}), eps its impulse along dh",
            model.pool.text(slope)
        ),
        false => " by eps*dh(pi_D xi), eps its impulse along pi_D^* dh".to_owned(),
    }
}
