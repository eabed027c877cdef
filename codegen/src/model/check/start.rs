//! The declared start lies in front of every wall.

use dalembert_expr::{ExprId, Pool, SymbolId};

use super::super::resolve::Resolver;
use super::super::{Initial, Law, Surface};
use crate::diagnostics::Location;
use crate::spec::InitialTarget;

/// Gaps smaller than this part of their terms may be rounding.
const MARGIN: f64 = 1e-9;

/// Refuses a start behind a wall, at the defaults of the parameters; walls whose gap names no declared position are left
/// to the caller, and so are parameters without defaults.
pub(super) fn check(resolver: &mut Resolver<'_>, initial: &Initial, surfaces: &[Surface]) {
    for surface in surfaces {
        if matches!(surface.law, Law::Reset | Law::Transition) {
            continue;
        }
        let Some(at) = declared_at(resolver, initial, surface.gap) else {
            continue;
        };
        let point = |symbol: SymbolId| start(resolver, initial, symbol);
        let pool = &resolver.pool;
        let counts = surface
            .conditions
            .iter()
            .all(|condition| clear_sign(pool, condition.margin, &point) == Some(1.0));
        if !counts || clear_sign(pool, surface.gap, &point) != Some(-1.0) {
            continue;
        }
        let gap = pool.eval(&[surface.gap], &point)[0];
        let name = &surface.name.display;
        let text = format!("the start lies behind the surface `{name}`: its gap is {gap}");
        resolver.refuse::<()>(at, text, "a motion starts where every gap is 0 or more");
    }
}

/// The last value in `initial` that the gap depends on.
fn declared_at(resolver: &Resolver<'_>, initial: &Initial, gap: ExprId) -> Option<Location> {
    let symbols = resolver.pool.symbols(gap);
    let coordinates = resolver.symbols.coordinates.iter().zip(&initial.q);
    let named: Vec<&str> = coordinates
        .filter(|(coordinate, value)| value.is_some() && symbols.contains(&coordinate.q))
        .map(|(coordinate, _)| coordinate.name.field.as_str())
        .collect();
    let mut entries = resolver.spec.initial.iter().rev();
    let entry = entries.find(|entry| {
        entry.target == InitialTarget::Position
            && named.contains(&entry.declared.name.text.as_str())
    })?;
    Some(entry.value.at)
}

/// The value of a symbol at the start; not a number where nothing declares it.
fn start(resolver: &Resolver<'_>, initial: &Initial, symbol: SymbolId) -> f64 {
    if let Some(index) = resolver.symbols.coordinate_of(symbol) {
        let Some(value) = initial.q[index] else {
            return 0.0;
        };
        let parameter = |symbol: SymbolId| default(resolver, symbol);
        return resolver.pool.eval(&[value], &parameter)[0];
    }
    if symbol == resolver.symbols.time {
        return 0.0;
    }
    default(resolver, symbol)
}

fn default(resolver: &Resolver<'_>, symbol: SymbolId) -> f64 {
    let mut parameters = resolver.symbols.parameters.iter();
    let found = parameters.find(|parameter| parameter.symbol == symbol);
    let value = found.and_then(|parameter| parameter.default);
    value.map_or(f64::NAN, |value| resolver.constant_value(value))
}

/// 1 or -1 where rounding leaves no doubt about the sign.
fn clear_sign(pool: &Pool, id: ExprId, point: &dyn Fn(SymbolId) -> f64) -> Option<f64> {
    let (value, magnitude) = pool.eval_magnitude(id, point);
    (value.abs() > MARGIN * magnitude).then(|| value.signum())
}
