//! Release of a motion from a surface in contact. The contact force can only push; the motion leaves the surface where
//! the force would have to pull.
//!
//! The force is a function of time along a step. Its fall through zero is located in the same way as that of a gap.

use core::cell::{Cell, RefCell};

use super::held::Held;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::error::Fault;
use crate::events::locate::{Line, Search, Start};
use crate::events::sampled::{NODES, SAMPLES, along, nodes};
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Rounding of a force, relative to its largest value in the step.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A fraction of a step, and the surface that the motion leaves there; `None` if the search stopped there.
pub(super) type Release = (f64, Option<usize>);

/// The first release in a step.
pub(super) fn first_release<Sys: Impacting, Step: Stepper<Sys>>(
    held: &Held<Sys::Gaps>,
    step: &mut StepView<'_, Sys, Step>,
) -> Result<Option<Release>, Outcome> {
    step.prepare()?;
    let mut samples = [step.system.zero_gaps(); SAMPLES];
    for (sample, node) in samples.iter_mut().zip(NODES) {
        *sample = sizes(held, step, node)?;
    }
    let mut first: Option<Release> = None;
    for surface in held.iter() {
        let until = first.map_or(1.0, |(part, _)| part);
        let whole = samples.map(|sizes| sizes.as_slice()[surface]);
        let found = first_fall(held, surface, step, &whole, until)?;
        if let Some((part, _)) = found
            && part < until
        {
            first = found;
        }
    }
    Ok(first)
}

fn sizes<Sys: Impacting, Step: Stepper<Sys>>(
    held: &Held<Sys::Gaps>,
    step: &mut StepView<'_, Sys, Step>,
    part: f64,
) -> Result<Sys::Gaps, Fault> {
    step.counters.rate_evaluations += 1;
    let sizes = held.sizes(step.system, step.time(part), &step.state(part))?;
    Ok(sizes.unwrap_or_else(|| step.system.zero_gaps()))
}

/// The first fall of the force of one surface.
fn first_fall<Sys: Impacting, Step: Stepper<Sys>>(
    held: &Held<Sys::Gaps>,
    surface: usize,
    step: &mut StepView<'_, Sys, Step>,
    whole: &[f64; SAMPLES],
    until: f64,
) -> Result<Option<Release>, Outcome> {
    let largest = whole
        .iter()
        .fold(0.0_f64, |most, size| most.max(size.abs()));
    let above = whole[0] >= -ROUNDING * largest;
    if !above && whole.iter().all(|&size| size < 0.0) {
        // It was left at the start of the step, as another surface on which its force depended.
        return Ok(Some((0.0, Some(surface))));
    }
    let fault = Cell::new(None);
    let step = RefCell::new(step);
    let force = |part: f64| match sizes(held, *step.borrow_mut(), part) {
        Ok(sizes) => sizes.as_slice()[surface],
        Err(found) => {
            fault.set(Some(found));
            f64::NAN
        }
    };
    let line = Line {
        gap: &mut { force },
        along: &mut |ends: [f64; 2]| match ends == [0.0, 1.0] {
            true => along(whole),
            false => along(&nodes(ends).map(force)),
        },
        whole: None,
        ends: [whole[0], whole[SAMPLES - 1]],
        rounding: &mut |_| ROUNDING * largest,
        start: Start {
            from: 0.0,
            above,
            slope: None,
            until,
        },
        known: None,
    };
    let found = line.first_fall();
    if let Some(fault) = fault.take() {
        return Err(fault.into());
    }
    Ok(match found {
        Search::Clear => None,
        Search::Falls(bracket) => Some((bracket.after, Some(surface))),
        Search::Sinks(part) | Search::Pole(_, part) => Some((part, Some(surface))),
        Search::Unfinished(part) => Some((part, None)),
    })
}
