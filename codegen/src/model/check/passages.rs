//! Notes on resets after which the motion continues through the surface.

use dalembert_expr::{ExprId, Pool};

use super::super::Surface;
use super::super::resolve::Resolver;

/// Remarks on resets that set a value but neither move the state off their surface nor change the gap rate. The motion
/// continues through the surface, so such a reset happens once in every passage and is not an impact. A reset that sets
/// nothing marks an event on purpose; it gets no remark.
pub(super) fn notes(
    resolver: &Resolver<'_>,
    surfaces: &[Surface],
    field: Option<&[ExprId]>,
) -> Vec<String> {
    let mut pool = resolver.pool.clone();
    let surfaces = surfaces
        .iter()
        .filter(|surface| surface.transition.is_none());
    surfaces
        .filter(|surface| passes(&mut pool, resolver, surface, field))
        .map(|surface| {
            let name = &surface.name.display;
            format!(
                "the reset of `{name}` leaves its gap and the gap rate as they are: the motion goes on through the surface, and is reset once each time it comes from above"
            )
        })
        .collect()
}

fn passes(
    pool: &mut Pool,
    resolver: &Resolver<'_>,
    surface: &Surface,
    field: Option<&[ExprId]>,
) -> bool {
    let coordinates = &resolver.symbols.coordinates;
    let Some(reset) = &surface.reset else {
        return false;
    };
    let replacements = reset.replacements(coordinates);
    if replacements.is_empty() {
        return false;
    }
    let mut terms = vec![pool.diff(surface.gap, resolver.symbols.time)];
    for (i, coordinate) in coordinates.iter().enumerate() {
        let speed = match field {
            Some(field) => field[i],
            None => pool.variable(coordinate.qdot),
        };
        let slope = pool.diff(surface.gap, coordinate.q);
        terms.push(pool.mul(slope, speed));
    }
    let rate = pool.sum(&terms);
    [surface.gap, rate].into_iter().all(|value| {
        let after = pool.substitute(value, &replacements);
        let change = pool.sub(after, value);
        let change = pool.simplify(change);
        pool.is_syntactic_zero(change)
    })
}
