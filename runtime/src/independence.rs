//! Times inside a step at which constraint forms become dependent. Stretches on which an enclosure proves independence
//! are passed; the others are halved and examined.

use crate::contract::{RankDrop, System};
use crate::effects::StepView;
use crate::events::first::{Walk, walk};
use crate::events::path::Path;
use crate::integrate::Stepper;

/// Halvings of a step before a stretch is looked at closely, and stretches before all that is left is.
const HALVINGS: u32 = 20;
const STRETCHES: u32 = 1024;

/// Place, as a share of the step, at which independence is tried besides the ends. Not a place that halving comes to.
const MIDDLE: f64 = 0.375;

/// The first drop between the start of a step with dense output and `reach`.
pub(crate) fn drop<Sys: System, Step: Stepper<Sys>>(
    step: &StepView<'_, Sys, Step>,
    reach: f64,
) -> Option<RankDrop> {
    let system = step.system;
    let mut path = Path::new(step.start());
    path.follow_dense(step);
    let is_independent = |part: [f64; 2]| {
        let component = |i: usize| path.component(i, part);
        system.keeps_rank((path.time_model(part), &component))
    };
    // At the ends the states that this step has in common with its neighbours, so that nothing passes between two steps.
    let motion = |theta: f64| match theta {
        0.0 => (step.t_start(), *step.start()),
        _ => (step.time(theta), step.state(theta)),
    };
    let shortest = reach / (1_u64 << HALVINGS) as f64;
    // NOTE: sizes are taken beside the first place, which must not be where the forms are dependent: it lies before the stretch.
    let looked_at = |[from, to]: [f64; 2]| {
        let from = (from - shortest).max(0.0);
        let part = |theta: f64| match theta {
            1.0 => to,
            _ => from + theta * (to - from),
        };
        let found = system.rank_drop(|theta| motion(part(theta)), 1.0)?;
        Some(RankDrop {
            theta: part(found.theta),
            ..found
        })
    };
    let mut places = [0.0, MIDDLE * reach, reach - shortest].into_iter();
    if !places.any(|at| is_independent([at, at + shortest])) {
        // Forms that are nearly dependent everywhere, or that cannot be enclosed: places of the whole step have to tell.
        return looked_at([0.0, reach]);
    }
    match walk(
        [0.0, reach],
        [HALVINGS, STRETCHES],
        is_independent,
        looked_at,
    ) {
        Walk::Found(drop) => Some(drop),
        Walk::Passed if is_independent([reach - shortest, reach]) => None,
        // Forms that are dependent at the end within rounding, beside what they are at the start.
        Walk::Passed => looked_at([0.0, reach]),
        Walk::Stopped(at) => looked_at([at, reach]),
    }
}
