//! Surfaces with the same gap: resolves `otherwise`, and marks transitions whose conditions may leave a motion without
//! a transition.

use dalembert_expr::Pool;

use super::super::resolve::Resolver;
use super::super::{Beside, Condition, Surface};
use super::surfaces::have_same_gap;
use crate::spec::Spec;

/// Finds the surfaces with the same gap, for `otherwise` and for the last of several transitions.
pub(super) fn resolve(resolver: &mut Resolver<'_>, surfaces: &mut [Surface]) {
    let spec = resolver.spec;
    let otherwise: Vec<bool> = surfaces
        .iter()
        .map(|surface| is_otherwise(spec, surface))
        .collect();
    for index in 0..surfaces.len() {
        let is_transition = surfaces[index].transition.is_some();
        if !otherwise[index] && !is_transition {
            continue;
        }
        let same: Vec<usize> = (0..surfaces.len())
            .filter(|&other| other != index)
            .filter(|&other| have_same_gap(resolver, &surfaces[other], &surfaces[index]))
            .collect();
        let others = || -> Vec<Vec<Condition>> {
            let others = same.iter().map(|&other| surfaces[other].conditions.clone());
            others.collect()
        };
        if otherwise[index] {
            check_otherwise(resolver, surfaces, index, &same, &otherwise);
            surfaces[index].beside = Beside::Otherwise(others());
            continue;
        }
        let is_last = same
            .iter()
            .all(|&other| surfaces[other].transition.is_none() || other < index);
        let passes = |surface: &Surface| {
            surface
                .transition
                .as_ref()
                .is_some_and(|transition| transition.has_no_side)
        };
        let is_open = !passes(&surfaces[index])
            && !same.iter().any(|&other| otherwise[other])
            && !surfaces[index].conditions.is_empty()
            && !others().iter().any(Vec::is_empty);
        if is_last && is_open && !same.is_empty() {
            surfaces[index].beside = Beside::Last(others());
        }
    }
}

/// Notes on pairs of surfaces with the same gap whose opposite strict conditions both exclude the edge between their
/// regions.
pub(super) fn notes(resolver: &Resolver<'_>, surfaces: &[Surface]) -> Vec<String> {
    let mut pool = resolver.pool.clone();
    let mut notes = Vec::new();
    for (index, second) in surfaces.iter().enumerate() {
        for first in &surfaces[..index] {
            let Some(between) = left_out(&mut pool, first, second) else {
                continue;
            };
            if first.gap != second.gap || !second.beside.others().is_empty() {
                continue;
            }
            let (first, second) = (&first.name.display, &second.name.display);
            notes.push(format!(
                "a motion that meets the surface of `{first}` and `{second}` where {between} = 0 passes: neither counts there; \
                 write `>=` or `<=` in one of the two conditions, or `otherwise`"
            ));
        }
    }
    notes
}

/// Margin whose sign decides which of two surfaces counts, as text; `None` unless their strict conditions are opposite.
fn left_out(pool: &mut Pool, first: &Surface, second: &Surface) -> Option<String> {
    let ([one], [other]) = (&*first.conditions, &*second.conditions) else {
        return None;
    };
    let sum = pool.add(one.margin, other.margin);
    let are_opposite = !one.is_closed && !other.is_closed && pool.is_syntactic_zero(sum);
    are_opposite.then(|| pool.text(other.margin))
}

fn is_otherwise(spec: &Spec, surface: &Surface) -> bool {
    let mut declared = spec.surfaces.iter();
    declared.any(|other| other.item == surface.item && other.is_otherwise)
}

/// Refuses `otherwise` without another surface, with no case left, or twice.
fn check_otherwise(
    resolver: &mut Resolver<'_>,
    surfaces: &[Surface],
    index: usize,
    same: &[usize],
    otherwise: &[bool],
) {
    let at = resolver.spec.location(surfaces[index].item);
    let name = &surfaces[index].name.display;
    let every = same
        .iter()
        .find(|&&other| !otherwise[other] && surfaces[other].conditions.is_empty());
    if let Some(twin) = same.iter().find(|&&other| otherwise[other]) {
        let twin = &surfaces[*twin].name.display;
        let text = format!("`{name}` and `{twin}` are both `otherwise` of one gap");
        resolver.refuse::<()>(at, text, "write the conditions of one of them");
    } else if let Some(every) = every {
        let every = &surfaces[*every].name.display;
        let text = format!("`{every}` has no condition: nothing is left for `{name}`");
        resolver.refuse::<()>(at, text, "write `when ..` there");
    } else if same.is_empty() {
        let text = format!("no other surface has the gap of `{name}`");
        let help = "leave `otherwise` out, or write the same comparison as in the others";
        resolver.refuse::<()>(at, text, help);
    }
}
