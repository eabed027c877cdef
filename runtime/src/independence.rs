//! Times inside a step at which constraint forms become linearly dependent. Pieces of the step on which an enclosure
//! proves independence are skipped. The others are bisected, and examined pointwise when they are short.

use crate::contract::{RankDrop, System};
use crate::effects::StepView;
use crate::events::first::{Walk, walk};
use crate::events::path::Path;
use crate::integrate::Stepper;

/// Maximum number of halvings, after which a piece is examined pointwise.
const HALVINGS: u32 = 20;
/// Maximum number of pieces, after which the rest of the step is examined as one piece.
const STRETCHES: u32 = 1024;

/// Fraction of the step at which independence is tested in addition to both ends.
const MIDDLE: f64 = 0.375;

/// The first loss of rank between the start of a step with dense output and the fraction `reach` of it.
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
    // At the start the state is that of the preceding step, so that no loss of rank is missed between two steps.
    let motion = |theta: f64| match theta {
        0.0 => (step.t_start(), *step.start()),
        _ => (step.time(theta), step.state(theta)),
    };
    let shortest = reach / (1_u64 << HALVINGS) as f64;
    // NOTE: the examination takes its reference sizes just before the piece, because the forms may be dependent at the
    // start of the piece.
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
        // The forms are nearly dependent at all three fractions, or have no enclosure. The whole step is examined
        // pointwise.
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
        // All pieces passed, but independence at the end of the step is not proved. The whole step is examined with the
        // reference sizes of its start.
        Walk::Passed => looked_at([0.0, reach]),
        Walk::Stopped(at) => looked_at([at, reach]),
    }
}
