//! Impact surfaces: functions of position with a regular zero set that allowed motion can reach.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::super::degree::is_zero;
use super::super::resolve::{Resolver, Scope};
use super::super::{Beside, Condition, Constraint, Law, Surface};
use super::names::Names;
use crate::diagnostics::listed;
use crate::spec::{self, Comparison, SURFACES};

/// All surfaces, families expanded.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Vec<Surface> {
    let spec = resolver.spec;
    let mut surfaces = Vec::new();
    let mut names = Names::new(resolver, "surface");
    for surface in &spec.surfaces {
        let members = resolver.members(&surface.declared);
        if surfaces.len() + members.len() > SURFACES {
            let text = format!("more than {SURFACES} surfaces");
            let help = "split the model";
            resolver.refuse::<()>(surface.declared.name.at, text, help);
            break;
        }
        for (name, mut scope) in members {
            names.add(resolver, &name, &surface.declared.name);
            let gap = resolver.gap(surface, &mut scope);
            let conditions: Vec<Option<Condition>> = surface
                .conditions
                .iter()
                .map(|condition| {
                    let margin = resolver.difference(condition, &mut scope, "conditions")?;
                    Some(Condition {
                        margin,
                        is_closed: condition.is_closed,
                    })
                })
                .collect();
            let (law, reset, transition) = match surface.enters {
                Some(_) => (
                    Some(Law::Transition),
                    Some(None),
                    resolver.transition(surface, &scope),
                ),
                None => (
                    resolver.law(surface.law.as_ref(), &mut scope),
                    resolver.reset(surface.law.as_ref(), &scope),
                    Some(None),
                ),
            };
            let instantaneous = resolver.instantaneous(surface, &scope);
            resolver.within_budget(surface.gap.at);
            let conditions: Option<Vec<Condition>> = conditions.into_iter().collect();
            let (Some(law), Some(reset), Some(transition), Some(instantaneous)) =
                (law, reset, transition, instantaneous)
            else {
                break;
            };
            let (Some(gap), Some(conditions)) = (gap, conditions) else {
                break;
            };
            surfaces.push(Surface {
                name,
                documentation: surface.documentation.clone(),
                gap,
                conditions,
                beside: Beside::Independent,
                law,
                reset,
                transition,
                instantaneous,
                item: surface.item,
            });
        }
    }
    names.check_families(resolver);
    surfaces
}

impl Resolver<'_> {
    /// The greater side minus the other side.
    pub(super) fn difference(
        &mut self,
        comparison: &Comparison,
        scope: &mut Scope,
        what: &str,
    ) -> Option<ExprId> {
        let greater = self.position_expression(&comparison.greater, scope, what);
        let less = self.position_expression(&comparison.less, scope, what);
        let difference = self.pool.sub(greater?, less?);
        self.check_periodic(&[&comparison.greater, &comparison.less], scope, difference);
        Some(difference)
    }

    fn gap(&mut self, surface: &spec::Surface, scope: &mut Scope) -> Option<ExprId> {
        let gap = self.difference(&surface.gap, scope, "impact surfaces")?;
        let at = surface.gap.at;
        let positions = self.symbols.positions();
        let moves = positions.iter().any(|position| {
            let slope = self.pool.diff(gap, *position);
            !is_zero(&self.pool, slope)
        });
        if !moves {
            return self.refuse(
                at,
                "surface has no zero set: it does not depend on position",
                "write `name: h >= 0;`",
            );
        }
        self.check_regular(at, gap)?;
        Some(gap)
    }
}

/// Refuses surfaces that no allowed motion reaches: `dh` in the annihilator of D.
pub(super) fn check_reachable(
    resolver: &mut Resolver<'_>,
    surfaces: &[Surface],
    constraints: &[Constraint],
) {
    if constraints.is_empty() {
        return;
    }
    let positions = resolver.symbols.positions();
    let forms: Vec<Vec<ExprId>> = constraints
        .iter()
        .map(|constraint| constraint.form.clone())
        .collect();
    for surface in surfaces {
        let gradient: Vec<ExprId> = positions
            .iter()
            .map(|position| resolver.pool.diff(surface.gap, *position))
            .collect();
        let mut rows = forms.clone();
        rows.push(gradient);
        let report = resolver.pool.rank(&rows);
        let Some((_, others)) = report
            .dependencies
            .iter()
            .find(|(row, _)| *row == forms.len())
        else {
            continue;
        };
        // A wall that moves, or an affine constraint, can still bring the two together.
        let moving = resolver.pool.depends_on(surface.gap, resolver.symbols.time)
            || others
                .iter()
                .any(|other| !resolver.pool.is_syntactic_zero(constraints[*other].affine));
        if moving {
            continue;
        }
        let names: Vec<&str> = others
            .iter()
            .map(|other| constraints[*other].name.display.as_str())
            .collect();
        let help = format!("its distance is kept constant by {}", listed(names));
        let text = format!(
            "no allowed motion can reach the surface `{}`",
            surface.name.display
        );
        let at = resolver.spec.location(surface.item);
        resolver.refuse::<()>(at, text, &help);
    }
}

/// Refuses surfaces that are equal up to a constant factor: two reflections in one wall would let every motion through.
pub(super) fn check_distinct(resolver: &mut Resolver<'_>, surfaces: &[Surface]) {
    for (index, second) in surfaces.iter().enumerate() {
        for first in &surfaces[..index] {
            if first.conditions != second.conditions
                || first.beside != second.beside
                || is_otherwise(first)
                || is_otherwise(second)
                || !is_proportional(resolver, first.gap, second.gap)
                || count_both_ways(&resolver.pool, first, second)
            {
                continue;
            }
            let text = format!("same surface as `{}`", first.name.display);
            let (at, other) = (
                resolver.spec.location(second.item),
                resolver.spec.location(first.item),
            );
            let error = resolver.diagnostics.error(at, text);
            error.help("leave one of them out").also(
                other,
                format!("`{}` is the same surface", second.name.display),
            );
        }
    }
}

/// True if a surface is declared with `otherwise`. Its relation to surfaces with the same gap is checked elsewhere.
fn is_otherwise(surface: &Surface) -> bool {
    matches!(surface.beside, Beside::Otherwise(_))
}

/// True if the gaps of two transitions have opposite signs, under the same conditions.
pub(super) fn are_opposite(resolver: &mut Resolver<'_>, first: &Surface, second: &Surface) -> bool {
    first.conditions == second.conditions
        && is_proportional(resolver, first.gap, second.gap)
        && count_both_ways(&resolver.pool, first, second)
}

/// True if two surfaces with resets or transitions, equal up to a constant factor, have opposite orientation: the first
/// acts where its gap falls, the second where the first gap rises.
fn count_both_ways(pool: &Pool, first: &Surface, second: &Surface) -> bool {
    let passes = |surface: &Surface| matches!(surface.law, Law::Reset | Law::Transition);
    let are_resets = passes(first) && passes(second);
    are_resets && product_sign(pool, first.gap, second.gap) < 0.0
}

/// True if two gaps are the same up to a positive factor.
pub(super) fn have_same_gap(
    resolver: &mut Resolver<'_>,
    first: &Surface,
    second: &Surface,
) -> bool {
    product_sign(&resolver.pool, first.gap, second.gap) > 0.0
        && is_proportional(resolver, first.gap, second.gap)
}

/// Relative difference that is no rounding error.
const IN_NUMBERS: f64 = 1e-9;

/// Number of points at which proportional gaps are evaluated.
const POINTS: u32 = 64;

/// The sign of the product of two proportional gaps, at the first of some points where neither is 0 or undefined; 0 if
/// there is no such point.
fn product_sign(pool: &Pool, first: ExprId, second: ExprId) -> f64 {
    if first == second {
        return 1.0;
    }
    let products = (0..POINTS).map(|seed| {
        let gaps = pool.eval(&[first, second], &|symbol| generic(symbol, seed));
        gaps[0].signum() * gaps[1].signum() * f64::from(gaps[0] != 0.0 && gaps[1] != 0.0)
    });
    let mut signs = products.filter(|sign| sign.is_finite() && *sign != 0.0);
    signs.next().unwrap_or(0.0)
}

/// Values of symbols at a generic point. Their sizes are about 1 for the first seeds and about 1000 for later ones,
/// with both signs.
fn generic(symbol: SymbolId, seed: u32) -> f64 {
    let steps = symbol.index() as f64 + 1.618_033_988_749_895 * f64::from(seed);
    let size = 0.3 + (steps * 0.618_033_988_749_894_9).fract();
    let scale = [1.0, 10.0, 100.0, 1000.0][(seed / 2 % 4) as usize];
    let sign = if (symbol.index() as u32 * seed) % 3 == 1 {
        -1.0
    } else {
        1.0
    };
    sign * scale * size
}

/// True if the quotients of two functions at two points differ by more than rounding.
///
/// NOTE: many surfaces have many pairs, and the exact test of a pair is slow.
fn differ_in_numbers(pool: &Pool, f: ExprId, g: ExprId) -> bool {
    let at = |seed: u32| [f, g].map(|id| pool.eval_magnitude(id, &|symbol| generic(symbol, seed)));
    let mut points = (0..POINTS).map(at).filter(|values| {
        let numbers = values.iter().flat_map(|(value, size)| [value, size]);
        numbers.copied().all(f64::is_finite)
    });
    let (Some([f, g]), Some([other_f, other_g])) = (points.next(), points.next()) else {
        return false;
    };
    let difference = f.0 * other_g.0 - other_f.0 * g.0;
    difference.abs() > IN_NUMBERS * (f.1 * other_g.1 + other_f.1 * g.1)
}

/// True if the quotient of two functions is constant: `f d(g) - g d(f) = 0`.
fn is_proportional(resolver: &mut Resolver<'_>, f: ExprId, g: ExprId) -> bool {
    let pool = &mut resolver.pool;
    let symbols = pool.symbols(f);
    if symbols != pool.symbols(g) || differ_in_numbers(pool, f, g) {
        return false;
    }
    symbols.into_iter().all(|symbol| {
        let (f_slope, g_slope) = (pool.diff(f, symbol), pool.diff(g, symbol));
        let (left, right) = (pool.mul(f, g_slope), pool.mul(g, f_slope));
        let difference = pool.sub(left, right);
        is_zero(pool, difference)
    })
}
