//! Consequences of an invariant volume, with their hypotheses, and of a volume that is not invariant.
//!
//! If the volume is smooth and each impulse vanishes with the gap rate, impacts accumulate for almost no start (W.
//! Clark, thesis, Theorem VII.17). Velocities that become infinite are excluded: every motion between two walls that close
//! has infinitely many impacts before they meet, and so have motions in a wedge that fall to the centre of `-1/r^2`. If moreover the energy is conserved and its levels are compact, almost every motion
//! comes back arbitrarily near to its start (Theorem VII.21). The levels are compact where surfaces bound all
//! coordinates that are not angles, the metric is positive and the potential finite, all of them everywhere. A Lagrangian
//! that may be infinite somewhere, such as `dot(x)^2/(x - 1/2)^2`, has no such consequence: its levels and their volumes may
//! be infinite. A surface with a condition has none: where the condition begins to hold, motion may be behind the surface,
//! and ends. A metric that may vanish, such as `(1 + cos(x))*dot(x)^2`, has none either: all motions may end there.

use dalembert_expr::{ExprId, Node, Pool, Sign, Singularity, SymbolId, Verdict as Zero};

use super::conserved::check_conserved;
use super::continuity::has_gaps;
use super::definite::is_regular;
use super::examine::explicit;
use super::finding::Verdict;
use super::hybrid::{Density, Effect, Surroundings};
use super::impact::{Wanted, changes_at};
use crate::model::{Beside, Law, Model, Topology};

/// The consequences as text, given that the volume of a density is kept.
pub(super) fn corollaries(
    model: &mut Model,
    around: &Surroundings<'_>,
    density: &Density,
) -> Vec<String> {
    if model.is_first_order() || !is_smooth(model, density) || !impulses_vanish(model) {
        return Vec::new();
    }
    let mut found = Vec::new();
    if !model.surfaces.is_empty() {
        found.push(
            "impacts accumulate for almost no start, unless states become unbounded: the volume is smooth, and impulses vanish with the gap rate; grazing motion is assumed to go on"
                .to_owned(),
        );
    }
    let Some(bounds) = bounded(model) else {
        return found;
    };
    let metric = model.lagrangian.metric.clone();
    let is_conditional = model.surfaces.iter().any(|it| !it.conditions.is_empty());
    if !is_conditional
        && model.pool.is_finite(model.lagrangian.whole)
        && exists_everywhere(model, around)
        && is_regular(model, &metric)
        && is_autonomous(model, around)
        && keeps_energy(model, around)
    {
        let bounds = match bounds.is_empty() {
            true => "all coordinates are angles".to_owned(),
            false => format!(
                "coordinates that are not angles are bounded by {}",
                bounds.join(", ")
            ),
        };
        found.push(format!(
            "almost every start comes back arbitrarily near: the energy is kept, and {bounds}, so that energy levels are compact"
        ));
    }
    found
}

/// Consequence of a volume that impacts do not keep.
const OPEN: &str = "accumulation of impacts is not excluded";

/// The sentence beside a proved factor that is not 1.
pub(super) fn of_factor(model: &mut Model, verdict: &Verdict, factor: ExprId) -> Vec<String> {
    let one = model.pool.one();
    let excess = model.pool.sub(factor, one);
    // An undecided factor says nothing: it may be 1.
    let differs = model.pool.zero_test(excess) == Zero::Refuted;
    let says = matches!(verdict, Verdict::Proved(_)) && differs;
    says.then(|| format!("{OPEN}: the surface does not keep the volume"))
        .into_iter()
        .collect()
}

/// The sentence beside the effects of surfaces on a volume.
pub(super) fn of_effects(model: &Model, effects: &[Effect]) -> Option<String> {
    let changed = effects
        .iter()
        .filter(|effect| matches!(effect.verdict, Verdict::Refuted(_)));
    let names: Vec<&str> = changed
        .map(|effect| model.surfaces[effect.surface].name.display.as_str())
        .collect();
    (!names.is_empty()).then(|| format!("{OPEN}: the volume is not kept at {}", names.join(", ")))
}

/// True if a density is positive and smooth everywhere.
fn is_smooth(model: &Model, density: &Density) -> bool {
    let pool = &model.pool;
    let is_regular = |value: ExprId| {
        let parts = pool.reachable(&[value]);
        pool.sign(value) == Sign::Positive
            && pool.is_finite(value)
            && parts
                .into_iter()
                .all(|part| has_all_derivatives(pool, part))
    };
    // A density that was found is regular: its existence on all of Q was proved.
    density.is_found || density.value.is_some_and(is_regular)
}

/// True if the outermost operation of an expression has all derivatives wherever its value is finite.
fn has_all_derivatives(pool: &Pool, id: ExprId) -> bool {
    match pool.node(id) {
        Node::Product(factors) => factors
            .iter()
            .all(|(base, exponent)| exponent.is_integer() || pool.sign(*base) == Sign::Positive),
        Node::Call(function, _) => match function.singularity() {
            Singularity::None | Singularity::Logarithm { .. } | Singularity::Poles => true,
            Singularity::Ends | Singularity::Kink => false,
        },
        Node::Atan2(..) => false,
        Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => true,
    }
}

/// True if the law of every surface has an impulse proportional to the gap rate, which is 0 in a grazing impact.
fn impulses_vanish(model: &Model) -> bool {
    let is_linear = |model: &Model| {
        let mut affine = model.constraints.iter().map(|constraint| constraint.affine);
        affine.all(|affine| model.pool.is_syntactic_zero(affine))
    };
    model.surfaces.iter().all(|surface| match surface.law {
        Law::Elastic | Law::Restitution(_) => is_linear(model),
        Law::Newton(_) => true,
        _ => false,
    })
}

/// True if the equations of motion are certain to have real values at all states.
fn exists_everywhere(model: &Model, around: &Surroundings<'_>) -> bool {
    let roots = around.dynamics.roots();
    roots
        .into_iter()
        .all(|root| model.pool.is_finite(root) && !has_gaps(model, root))
}

/// True if neither the motion nor a gap depends on time.
fn is_autonomous(model: &Model, around: &Surroundings<'_>) -> bool {
    let gaps = model.surfaces.iter().map(|surface| surface.gap);
    let mut roots = around.dynamics.roots();
    roots.extend(gaps);
    roots
        .iter()
        .all(|id| !model.pool.depends_on(*id, model.time))
}

/// True if motion and impacts are proved to keep the energy.
fn keeps_energy(model: &mut Model, around: &Surroundings<'_>) -> bool {
    let quantity = (model.pool.variable(model.derived.energy), "energy");
    let energy = (explicit(model, quantity.0), "energy");
    let parts = std::slice::from_ref(around.dynamics);
    let along = check_conserved(model, parts, energy, true, around.seed);
    let keeps = |model: &mut Model, surface: usize| {
        let changes = changes_at(model, around, surface, quantity, Wanted::Any);
        changes.is_ok_and(|changes| changes.together(true).shows_that_it_vanishes())
    };
    matches!(along, Verdict::Proved(_))
        && (0..model.surfaces.len()).all(|surface| keeps(model, surface))
}

/// The surfaces that bound the coordinates that are not angles; `None` if one of these coordinates may be unbounded.
fn bounded(model: &mut Model) -> Option<Vec<String>> {
    let coordinates = model.coordinates.clone();
    let is_open = |coordinate: &&crate::model::Coordinate| {
        matches!(coordinate.topology, Topology::Interval { .. })
    };
    if coordinates.iter().any(|coordinate| is_open(&coordinate)) {
        return None;
    }
    let lines = coordinates
        .iter()
        .filter(|coordinate| coordinate.topology == Topology::Line);
    let lines: Vec<SymbolId> = lines.map(|coordinate| coordinate.q).collect();
    let mut ends = vec![[false; 2]; lines.len()];
    let mut names = Vec::new();
    for surface in model.surfaces.clone() {
        let is_free = surface.conditions.is_empty() && surface.beside == Beside::Independent;
        let found = match is_free {
            true => confined(&mut model.pool, surface.gap, &lines),
            false => Vec::new(),
        };
        for (place, is_low, is_high) in &found {
            ends[*place][0] |= is_low;
            ends[*place][1] |= is_high;
        }
        if !found.is_empty() {
            names.push(surface.name.display.clone());
        }
    }
    ends.iter()
        .all(|[low, high]| *low && *high)
        .then_some(names)
}

/// The coordinates that `gap >= 0` bounds, each with flags for a lower and an upper bound. None are found unless the gap
/// is quadratic in the coordinates, with negative coefficients and without mixed terms, or linear in a single one.
fn confined(pool: &mut Pool, gap: ExprId, lines: &[SymbolId]) -> Vec<(usize, bool, bool)> {
    let used = (0..lines.len()).filter(|i| pool.depends_on(gap, lines[*i]));
    let used: Vec<usize> = used.collect();
    let slopes: Vec<ExprId> = used.iter().map(|i| pool.diff(gap, lines[*i])).collect();
    // NOTE: `x - 1/sin(phi)` bounds nothing from below.
    if !slopes.iter().chain([&gap]).all(|id| pool.is_finite(*id)) {
        return Vec::new();
    }
    if let ([line], [slope]) = (used.as_slice(), slopes.as_slice())
        && !pool.depends_on_any(*slope, lines)
        && is_parameter(pool, *slope)
    {
        return match pool.sign(*slope) {
            Sign::Positive => vec![(*line, true, false)],
            Sign::Negative => vec![(*line, false, true)],
            _ => Vec::new(),
        };
    }
    for (i, slope) in used.iter().zip(&slopes) {
        for j in &used {
            let second = pool.diff(*slope, lines[*j]);
            let second = pool.simplify(second);
            let is_right = match i == j {
                true => is_parameter(pool, second) && pool.sign(second) == Sign::Negative,
                false => pool.is_syntactic_zero(second),
            };
            if !is_right {
                return Vec::new();
            }
        }
    }
    used.into_iter().map(|i| (i, true, true)).collect()
}

/// True if all symbols of an expression have an assumption. Such symbols are parameters.
fn is_parameter(pool: &Pool, id: ExprId) -> bool {
    let assumed =
        |symbol: &SymbolId| pool.symbol_assumption(*symbol) != dalembert_expr::Assumption::None;
    pool.symbols(id).iter().all(assumed)
}
