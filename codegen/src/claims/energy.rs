//! `energy under s: not increasing`: the energy after an impact is at most the energy before it (Carnot).
//!
//! ```text
//! walls that stand still, linear constraints   H+ - H- = -(2 - c) c G^2/(2 dh(pi_D grad h)),  G+ = (1 - c) G
//! ```
//!
//! G is the gap rate, and c depends on the law. The change is not positive for c between 0 and 2. A projection onto
//! linear constraints does not increase the energy, and a refraction keeps it. All this except for elastic impacts and
//! refractions needs a metric that is certified to be positive definite ([`super::definite`]). Otherwise, the two
//! energies are compared as functions of the state. The claim is proved if they are equal, or if their difference is a function of
//! the positions plus a diagonal quadratic form of the velocities and neither is positive anywhere. It is refuted by a
//! state at which the energy grows.
//! J. Cortes and A. M. Vinogradov (2006), Theorem 5.7.

use dalembert_expr::{ExprId, Pool, Sign, SymbolId, Verdict as Zero};

use super::bounds::is_never_negative;
use super::definite::{has_kinetic_energy_of_squares, is_positive_definite};
use super::evidence::Wording;
use super::examine::explicit;
use super::finding::{Certificate, Verdict};
use super::hybrid::Surroundings;
use super::impact::{Wanted, changes_at};
use super::passage::Passage;
use super::wall::Wall;
use crate::model::{Law, Model};

/// The verdict on `energy under s: not increasing`.
pub(super) fn check_not_increasing(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    let wall = Wall::of(model, around.derivation, surface, around.others);
    let known = known(model, around, surface, &wall);
    if let Some(Known { reason, .. }) = known.filter(|known| known.is_certain) {
        return proved(&name, reason);
    }
    let energy = model.pool.variable(model.derived.energy);
    if let Some(passage) = &wall.passage
        && is_never_positive_gain(model, around, surface, passage, &wall)
    {
        return proved(
            &name,
            "its change is a quadratic form of velocities without positive terms",
        );
    }
    let mut looked_for = |wanted| {
        let changes = changes_at(model, around, surface, (energy, "energy"), wanted)?;
        Ok(changes.together(true))
    };
    let found = looked_for(Wanted::Any).and_then(|found| match found.shows_that_it_vanishes() {
        true => Ok(found),
        false => looked_for(Wanted::Growth),
    });
    let found = match found {
        Ok(found) => found,
        Err(reason) => return Verdict::Undecided(reason),
    };
    let wording = Wording {
        vanishes: format!("the energy is the same before and after an impact at `{name}`"),
        differs: format!("the energy grows in an impact at `{name}`"),
        help: ["leave it out".to_owned(), String::new()],
    };
    match found.verdict(true, wording, around.seed) {
        // The energy grows only where the metric is not positive definite. The equations of motion do not exist there.
        Verdict::Undecided(_) | Verdict::Refuted(_) if known.is_some() => {
            Verdict::Undecided(format!(
                "the law of `{name}` adds no energy if the metric is positive definite, which is not known at all \
                 states; give ranges of parameters and coordinates, such as `m > 0`"
            ))
        }
        Verdict::Undecided(_) => Verdict::Undecided(format!(
            "no state was found at which the energy grows at `{name}`, and no proof that there is none"
        )),
        verdict => verdict,
    }
}

/// Reason for which laws without energy gain have none.
const CONTRACTED: &str = "the gap rate is multiplied by a number between -1 and 1";

fn proved(name: &str, reason: &str) -> Verdict {
    Verdict::Proved(Certificate::without_chance(
        format!("the energy does not grow in an impact at `{name}`: {reason}"),
        0,
    ))
}

/// Reason for which a law does not increase the energy.
#[derive(Debug, Clone, Copy)]
struct Known {
    reason: &'static str,
    /// False if the reason needs a positive definite metric, and the metric is not certified to be one.
    is_certain: bool,
}

/// Reason for which the energy does not grow, if the law implies it. Projections reduce the energy, and gaps have a
/// positive inertia, only if the metric is positive definite.
fn known(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    wall: &Wall,
) -> Option<Known> {
    let is_zero = |id: &ExprId| model.pool.is_syntactic_zero(*id);
    let declared = &model.surfaces[surface];
    let stands = is_zero(&around.derivation.surfaces[surface].rate);
    let mut constraints = model.constraints.iter().chain(&declared.instantaneous);
    if !stands || !constraints.all(|constraint| is_zero(&constraint.affine)) {
        return None;
    }
    let certain = |reason| {
        Some(Known {
            reason,
            is_certain: true,
        })
    };
    let reason = match declared.law {
        Law::Elastic if declared.instantaneous.is_empty() => {
            return certain("an elastic impact keeps it");
        }
        Law::Elastic => "an elastic impact keeps it, and a projection reduces it",
        // No state is made with a coefficient outside [0, 1].
        Law::Restitution(_) | Law::Newton(_) => CONTRACTED,
        Law::NonholonomicPlastic | Law::ImpactPlastic | Law::TotallyPlastic => CONTRACTED,
        Law::Transition => {
            let passage = wall.passage.as_ref()?;
            let mut affine = passage.after.forms.iter().filter_map(|row| row.last());
            let is_linear = affine.all(is_zero);
            if !passage.computes_velocities() || !is_linear {
                return None;
            }
            if passage.after.forms.is_empty() {
                return certain("a refraction keeps it, and so do equal momenta");
            }
            "a refraction keeps it, and the nearest velocity that linear constraints allow has less"
        }
        Law::Reset | Law::Stop => return None,
    };
    let metric = match &wall.passage {
        Some(passage) => passage.after.metric.clone(),
        None => model.lagrangian.metric.clone(),
    };
    let keeps_lagrangian = match &model.surfaces[surface].transition {
        Some(transition) => transition.keeps_lagrangian,
        None => true,
    };
    let is_certain = keeps_lagrangian && has_kinetic_energy_of_squares(model)
        || is_positive_definite(model, &metric);
    Some(Known { reason, is_certain })
}

/// True if the change of the energy is a function of the positions plus a diagonal quadratic form of the velocities, and
/// neither is positive anywhere.
fn is_never_positive_gain(
    model: &mut Model,
    around: &Surroundings<'_>,
    surface: usize,
    passage: &Passage,
    wall: &Wall,
) -> bool {
    if passage.computes_velocities() || !passage.before.forms.is_empty() {
        return false;
    }
    let enters = model.surfaces[surface]
        .transition
        .as_ref()
        .map(|transition| transition.enters);
    let entered = enters.and_then(|enters| around.others.get(enters)).copied();
    let quantity = model.pool.variable(model.derived.energy);
    let before = explicit(model, quantity);
    let Some(after) = passage.quantity_after(model, entered, quantity) else {
        return false;
    };
    let gain = model.pool.sub(after, before);
    let gain = match wall.solution() {
        Some(solution) => model.pool.substitute(gain, &[solution]),
        None => gain,
    };
    let gain = model.pool.simplify(gain);
    let velocities: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    let Some(parts) = diagonal(&mut model.pool, gain, &velocities) else {
        return false;
    };
    let constant = parts.first().copied();
    let metric: Vec<ExprId> = (0..velocities.len())
        .map(|i| passage.before.metric[i][i])
        .collect();
    let slopes = parts.into_iter().skip(1).zip(metric);
    let mut ratios: Vec<ExprId> = constant.into_iter().collect();
    for (part, mass) in slopes {
        // The quotient by a positive mass has the same sign and may be simpler.
        let ratio = model.pool.div(part, mass);
        let ratio = model.pool.multiply_out(ratio);
        let is_heavy = model.pool.sign(mass) == Sign::Positive;
        ratios.push(if is_heavy { ratio } else { part });
    }
    ratios.into_iter().all(|ratio| {
        let loss = model.pool.neg(ratio);
        is_never_negative(model, loss)
    })
}

/// The value at rest, and the second derivative with respect to each velocity, of a function that depends on velocities
/// only through multiples of their squares; `None` for other functions.
fn diagonal(pool: &mut Pool, gain: ExprId, velocities: &[SymbolId]) -> Option<Vec<ExprId>> {
    let zero = pool.zero();
    let at_rest: Vec<_> = velocities
        .iter()
        .map(|velocity| (*velocity, zero))
        .collect();
    let mut parts = vec![pool.substitute(gain, &at_rest)];
    for (i, by) in velocities.iter().enumerate() {
        let slope = pool.diff(gain, *by);
        let linear = pool.substitute(slope, &at_rest);
        if pool.zero_test(linear) != Zero::Proved {
            return None;
        }
        for (j, other) in velocities.iter().enumerate() {
            let second = pool.diff(slope, *other);
            if i == j {
                let second = pool.simplify(second);
                if pool.depends_on_any(second, velocities) {
                    return None;
                }
                parts.push(second);
            } else if pool.zero_test(second) != Zero::Proved {
                return None;
            }
        }
    }
    Some(parts)
}
