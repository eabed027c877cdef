//! Departure from a touched surface at the start of a step: the motion leaves it, presses into it, or goes along it.

use super::glance::Glance;
use super::search::{FLAT, gap_at};
use super::tangency::{crosses_at_rest, is_accelerated, sinks_by_its_second_rate};
use super::watch::Watch;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::locate::Start;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Fraction of a step at which the search for the departure of a touched gap begins. A gap that grows like the square of
/// time is there about a rounding error of what it is at the end.
const LEAST_DEPARTURE: f64 = 1.0 / (1 << 26) as f64;

/// Departure from a touched surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Departure {
    /// It leaves the surface, and may return within the step. At this fraction the gap is beyond its rounding error.
    Rises(f64),
    /// It goes into the surface: the outcome of a run that nothing holds.
    Pressed(Outcome),
    /// It goes along the surface within rounding errors.
    None,
}

/// The first change of a touched gap that exceeds its rounding error, and the fraction of the step where it does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Change {
    Rises(f64),
    Sinks(f64),
    None,
}

impl<Sys: Impacting> Watch<Sys> {
    /// Decides the departure from a surface that is touched at the start of the step, with a gap rate that is not positive.
    pub(super) fn departure<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<Departure, Outcome> {
        let change = self.first_change(surface, step);
        if let Change::Rises(part) = change {
            return Ok(Departure::Rises(part));
        }
        if self.is_pressed(surface, step, glance) {
            return pressed(surface, step);
        }
        match change {
            Change::Sinks(part) if self.sinks(surface, part, step, glance)? => {
                pressed(surface, step)
            }
            _ => Ok(Departure::None),
        }
    }

    /// Same as [`Watch::departure`], for a gap whose sign near the start of the step no enclosure tells, and for any gap
    /// rate. `None` if it remains open.
    pub(super) fn unclear_departure<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<Option<Departure>, Outcome> {
        let change = self.first_change(surface, step);
        let (until, is_above) = match change {
            Change::Rises(part) => (part, true),
            Change::Sinks(part) => (part, false),
            Change::None => (1.0, true),
        };
        if !self.keeps_side(surface, (until, is_above), step) {
            return Ok(None);
        }
        match change {
            Change::Rises(part) => Ok(Some(Departure::Rises(part))),
            Change::Sinks(part) if self.sinks(surface, part, step, glance)? => {
                pressed(surface, step).map(Some)
            }
            Change::Sinks(_) => Ok(None),
            Change::None => Ok(Some(Departure::None)),
        }
    }

    /// The start of the search behind the departure from a passable surface on which the motion is at rest, and which has acted.
    /// `None` if the motion stays within the rounding of the gap, or leaves the surface when the search ends.
    pub(super) fn way_on<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Option<Start> {
        let (from, above) = match self.first_change(surface, step) {
            Change::Rises(part) => (part, true),
            Change::Sinks(part) => (part, false),
            Change::None => return None,
        };
        let next = Start {
            above,
            ..Start::behind(from, start.until)
        };
        (from < start.until).then_some(next)
    }

    /// True if a gap that is negative at `part` is so by the motion, and not by the error of the integrator.
    fn sinks<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<bool, Outcome> {
        Ok(self.is_sunk(surface, step, glance)
            || is_accelerated(surface, step)?
            || sinks_by_its_second_rate(surface, step, part)?)
    }

    /// True if enclosures show that a touched gap stays on one side of 0 until a fraction of the step, within its rounding
    /// error.
    fn keeps_side<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        (until, is_above): (f64, bool),
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        self.path.enclose();
        let mut part = [0.0, LEAST_DEPARTURE];
        loop {
            let component = |i: usize| self.path.component(i, part);
            let time = self.path.time_model(part);
            let range = step.system.gap_along(surface, time, &component).range();
            step.counters.enclosures += 1;
            let reach = FLAT * self.rounding_at(surface, part[1], step);
            let keeps = match is_above {
                true => range.lo >= -reach,
                false => range.hi <= reach,
            };
            if !keeps || part[1] >= until {
                return keeps;
            }
            part = [part[1], (2.0 * part[1]).min(until)];
        }
    }

    /// True if the motion goes into a touched surface, false if it goes along it within rounding errors. Rounding
    /// errors accumulate along a wall, so their sum over the steps decides nothing.
    pub(super) fn is_pressed<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let rounding = self.rounding_at(surface, 1.0, step);
        let is_falling = |rate: f64| rate * glance.length < -rounding;
        glance.rate(surface).is_some_and(is_falling)
    }

    /// First change of a touched gap, from the start of the step on, that exceeds its rounding error.
    ///
    /// NOTE: at the end of a long step, the rate or the gap may be positive again although the motion went into the
    /// surface. The gap departs like a power of time, so that it is read at times in a geometric sequence. A motion that
    /// has just been released may sink by the error of the integrator; the second rate tells it from one that is pressed.
    fn first_change<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Change {
        // A touched gap differs from 0 at the start by the error of the motion so far.
        let start = step.system.gap(surface, step.t_start(), step.start());
        let mut change = Change::None;
        let mut octave = LEAST_DEPARTURE;
        while change == Change::None && octave < 1.0 {
            for part in [1.5 * octave, 2.0 * octave] {
                let gap = gap_at(surface, step, part);
                step.counters.event_evaluations += 1;
                let rounding = self.rounding_at(surface, part, step);
                if gap < start.min(0.0) - 2.0 * rounding {
                    change = Change::Sinks(part);
                    break;
                }
                if gap > start.max(0.0) + FLAT * rounding {
                    change = Change::Rises(part);
                    break;
                }
            }
            octave *= 2.0;
        }
        change
    }

    /// True if the gap is negative at the end of the step by more than its rounding error. A motion along a wall
    /// crosses it back and forth by less.
    pub(super) fn is_sunk<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> bool {
        let gap = glance.gaps.as_slice()[surface];
        if gap >= 0.0 {
            return false;
        }
        gap < -2.0 * self.rounding_at(surface, 1.0, step)
    }
}

/// A motion that is pressed into a touched surface.
fn pressed<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
) -> Result<Departure, Outcome> {
    let crosses = !is_accelerated(surface, step)? && crosses_at_rest(surface, step, 0.0)?;
    Ok(Departure::Pressed(match crosses {
        true => Outcome::TangentialCrossing { surface },
        false => Outcome::Contact { surface },
    }))
}
