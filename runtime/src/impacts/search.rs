//! Event location along a step that the first tests left undecided. Finds falls of gaps through zero, selects the
//! impacts among them, and decides if motion that starts on a surface leaves it or presses into it.

use core::ops::ControlFlow;

use super::departure::Departure;
use super::fall::{Known, Sizes, first_fall};
use super::glance::Glance;
use super::place::Place;
use super::sides::Behind;
use super::tangency::{crosses_at_rest, is_accelerated};
use super::told::Told;
use super::watch::{Graze, Watch};
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::locate::{Bracket, Search, Start};
use crate::events::resolution::{error_within, resolution};
use crate::integrate::Stepper;
use crate::integrate::controller::least_trial;
use crate::math;
use crate::numbers::TaylorModel;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Maximum number of falls on one surface that are examined in a step before it is cut. Falls that are no impacts are
/// skipped.
const FALLS: u32 = 1024;

/// Factor of the part of a step that is searched again if rounding errors of its end hide the gap at its start, and
/// the least such part.
const CLOSER: f64 = 1.0 / 256.0;
const FINEST_PART: f64 = 1e-12;

/// Ratio of a gap rate to those at the ends of the step below which a grazing impact is possible.
const SLOW: f64 = 1.0 / (1 << 10) as f64;

/// Largest gap, in units of its rounding, at which a surface that the motion does not leave is still touched.
pub(super) const FLAT: f64 = 64.0;

/// Rise of a gap from a touched surface, relative to the gap at the end of the step, below which it may be a rounding error.
const FAINT: f64 = 1.0 / (1 << 26) as f64;

/// Largest ratio of the gap rates at the end and at the start of a hop that rounding may hide, with which the end counts as seen.
const UNEVEN: f64 = 8.0;

/// Bound of the growth of the local errors during a flight, relative to their sum.
const SAFETY: f64 = 8.0;

/// Maximum number of places near a hit at which the change of the gap rate is measured.
const LOOKS: u32 = 8;

/// Least distance of such a place from the hit, as a fraction of the step.
const NEAREST: f64 = 1.0 / (1_u64 << 40) as f64;

/// Distance from a fall, as a fraction of the step, at which the slope of a gap without derivatives is measured.
const ASIDE: f64 = 1.0 / (1 << 20) as f64;

/// The first hit of one surface in a step.
enum Found {
    Nothing,
    /// A hit at this fraction of the step, with this gap rate.
    Hit(f64, f64),
    Unfinished(f64),
    /// The motion comes to the forbidden side at this fraction of the step, without an impact.
    Behind(f64),
}

/// A fall of a gap that is no impact.
enum Fall {
    /// The surface does not count there, or the motion leaves it there.
    Elsewhere,
    /// The surface counts, but its gap rate is not negative.
    Unapproached,
}

impl<Sys: Impacting> Watch<Sys> {
    /// Finds the earliest hit along the dense output. `last_rates` are the gap rates at the end of the step; `first`
    /// is the first surface that is not clear, with its gap on the whole step if that is known.
    pub(super) fn search<Step: Stepper<Sys>>(
        &mut self,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
        last_rates: &Sys::Gaps,
        (first, mut whole): (usize, Option<TaylorModel>),
    ) -> Result<(), Outcome> {
        if self.path.refine(step)? {
            whole = None;
        }
        self.length = glance.length;
        self.parts.fill(None);
        self.is_shown_by_values.fill(false);
        let mut behind = None;
        for surface in first..self.parts.count() {
            if surface != first {
                match self.told(surface, step, glance) {
                    Told::Passed | Told::Clear => {
                        self.is_told[surface] = true;
                        continue;
                    }
                    Told::Unclear(model) => whole = model,
                }
            }
            let last_rate = last_rates.as_slice()[surface];
            let found = match self.first_hit(surface, step, glance, whole) {
                Err(pressed @ (Outcome::Contact { .. } | Outcome::TangentialCrossing { .. })) => {
                    return Err(self.reset_before(surface, pressed, step, glance)?);
                }
                found => found?,
            };
            if matches!(found, Found::Nothing) && self.has_fallen_unseen(surface, step, glance) {
                return Err(Outcome::Contact { surface });
            }
            let (part, rate) = match found {
                Found::Hit(part, rate) => (part, Some(rate)),
                // No shortening of the step decides such a gap. The step would be cut again and again at its start.
                Found::Unfinished(part) if part * self.length < least_trial(step.t_start()) => {
                    return Err(Outcome::StepUnderflow { t: step.t_start() });
                }
                Found::Unfinished(part) => (part, None),
                Found::Behind(part) => {
                    behind = Some((surface, part));
                    (part, None)
                }
                Found::Nothing if self.is_due(surface, glance) && is_active(surface, step, 1.0) => {
                    let rate = match last_rate.is_nan() {
                        true => rate_before(surface, step, 1.0)?,
                        false => last_rate,
                    };
                    if rate.is_nan() || rate >= 0.0 {
                        continue;
                    }
                    (1.0, Some(rate))
                }
                Found::Nothing => continue,
            };
            if let Some(rate) = rate {
                self.parts[surface] = Some(part);
                self.note_graze(surface, part, [rate, last_rate], step)?;
            }
            self.proposed = Some(self.proposed.map_or(part, |earliest| earliest.min(part)));
        }
        if let Some((surface, part)) = behind
            && self.proposed == Some(part)
        {
            self.cut_behind((surface, Behind::Pole), part, step);
        }
        Ok(())
    }

    /// The pressure on a waiting surface after this one, if there is any: its reset may lead the motion off. Else the given pressure.
    fn reset_before<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        pressed: Outcome,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<Outcome, Outcome> {
        if self.is_waiting(surface) {
            return Ok(pressed);
        }
        for other in surface + 1..self.parts.count() {
            if self.is_waiting(other) {
                self.first_hit(other, step, glance, None)?;
            }
        }
        Ok(pressed)
    }

    /// True if a gap reaches 0 at the end of the step within the rounding of times, and does not stay there all along.
    fn is_due(&self, surface: usize, glance: &Glance<Sys::Gaps>) -> bool {
        let is_off = self.gaps.as_slice()[surface] != 0.0 || self.rates.as_slice()[surface] > 0.0;
        is_off && glance.is_due(surface)
    }

    /// Lets the integrator solve for the hit at `theta`, if it can: the step then ends there. Returns the fraction of
    /// the step at which to cut it.
    pub(super) fn meet<Step: Stepper<Sys>>(
        &mut self,
        theta: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> f64 {
        let Some(surface) = self.parts.iter().position(|part| part == Some(theta)) else {
            return theta;
        };
        if theta <= 0.0 || self.is_passable(surface) || self.grazes[surface] != Graze::None {
            return theta;
        }
        let system = step.system;
        let gap = |t: f64, state: &Sys::State| {
            let rates = system.gap_rates(t, state)?;
            Ok((system.gap(surface, t, state), rates.as_slice()[surface]))
        };
        if !step.stepper.meet(system, theta, &gap, step.counters) {
            return theta;
        }
        let longer = self.length / step.length();
        for part in self.parts.iter_mut().flatten() {
            *part = if *part == theta {
                1.0
            } else {
                (*part * longer).max(1.0)
            };
        }
        (self.length, self.proposed) = (step.length(), Some(1.0));
        1.0
    }

    /// The first fall of this gap that is an impact: the surface counts there, and is approached.
    fn first_hit<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
        whole: Option<TaylorModel>,
    ) -> Result<Found, Outcome> {
        self.certify(surface, step, glance);
        let gap = self.gaps.as_slice()[surface];
        let slope = (gap == 0.0).then_some(self.rates.as_slice()[surface] * self.length);
        let until = self.proposed.unwrap_or(1.0);
        // A touched passable surface has acted already, or waits: the motion leaves it upwards, or crosses it.
        let crosses = self.lets_through(surface) && slope.is_some_and(|slope| slope <= 0.0);
        let mut start = Start {
            from: 0.0,
            above: gap >= 0.0 && !crosses,
            slope,
            until,
        };
        if crosses && slope == Some(0.0) {
            match self.way_on(surface, start, step) {
                Some(next) => start = next,
                None => return Ok(Found::Nothing),
            }
        }
        let ends = [gap, glance.gaps.as_slice()[surface]];
        // The motion behind another hit does not take place, and adds no rounding errors.
        let mut sizes = match until < 1.0 {
            true => Sizes::Until(until, self.sizes_at_start),
            false => Sizes::Known(self.sizes),
        };
        // If the times at both ends of the step cannot be distinguished, a motion with nonnegative gap rate leaves the
        // touched surface, whatever the rounding error of the gap.
        let leaves_at_once = slope >= Some(0.0) && glance.is_moment();
        let offset = match slope {
            Some(slope) if self.is_thrown_up(surface, slope) => {
                self.offset(surface, (slope, ends[1]), step)
            }
            _ => 0.0,
        };
        let mut tangential = None;
        for _ in 0..FALLS {
            let known = Known {
                series: self.series.known(),
                ends,
                whole,
                offset,
            };
            let found = first_fall(surface, step, &mut self.path, &mut sizes, known, start);
            let is_open = !(leaves_at_once && matches!(found, Search::Pole(..)));
            if is_open && let Some(part) = self.hidden(surface, found, start, step) {
                match self.depart(surface, start, step, glance)? {
                    ControlFlow::Continue(next) => start = next,
                    ControlFlow::Break(true) => return Ok(Found::Nothing),
                    ControlFlow::Break(false) => return Ok(Found::Unfinished(part)),
                }
                continue;
            }
            let places = match found {
                Search::Clear if start.until < until => {
                    return Ok(Found::Unfinished(start.until));
                }
                Search::Sinks(part) if part == 0.0 && self.is_far_off(surface, start, step) => {
                    start.until *= CLOSER;
                    sizes = Sizes::Until(start.until, self.sizes_at_start);
                    continue;
                }
                Search::Clear => {
                    return match tangential {
                        Some(part) if self.is_sunk(surface, step, glance) => {
                            Ok(Found::Hit(part, rate_at(surface, step, part)?))
                        }
                        _ => Ok(Found::Nothing),
                    };
                }
                Search::Unfinished(part) => return Ok(Found::Unfinished(part)),
                Search::Pole(..) if leaves_at_once => return Ok(Found::Nothing),
                Search::Pole(place, after) => {
                    if self.leads_behind(surface, [place, after], step) {
                        return Ok(Found::Behind(place));
                    }
                    start = Start::behind(after, until);
                    continue;
                }
                Search::Sinks(part) => Bracket {
                    before: part,
                    after: part,
                    nearest: part,
                },
                Search::Falls(bracket) => bracket,
            };
            step.counters.crossings += 1;
            match self.judge(surface, places, start, step, glance)? {
                ControlFlow::Break(found) => return Ok(found),
                ControlFlow::Continue(Fall::Unapproached) => {
                    tangential = tangential.or(Some(places.after));
                }
                ControlFlow::Continue(Fall::Elsewhere) => {}
            }
            start = Start::behind(places.after, until);
            if places.after >= 1.0 {
                return Ok(Found::Nothing);
            }
        }
        Ok(Found::Unfinished(start.from))
    }

    /// True if the rounding errors of a step that goes far hide a gap whose sign is certain at the start.
    fn is_far_off<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
    ) -> bool {
        let is_first = start.from == 0.0 && start.above && start.slope.is_none();
        if !is_first || start.until < FINEST_PART {
            return false;
        }
        let rounding = counted_rounding(surface, 0.0, step, &self.sizes_at_start);
        self.gaps.as_slice()[surface] > 2.0 * rounding
    }

    /// Decides a fall of the gap. Breaks with an impact, or where the motion goes along the surface; goes on behind the
    /// fall if it is no impact.
    fn judge<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        places: Bracket,
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<ControlFlow<Found, Fall>, Outcome> {
        if !is_active(surface, step, places.before) {
            return Ok(ControlFlow::Continue(Fall::Elsewhere));
        }
        let last = glance.gaps.as_slice()[surface];
        if !self.falls_at_start(surface, (places.before, last), start, step)? {
            let approach = self.approach(surface, step, places)?;
            if let Some((there, rate)) = approach {
                return Ok(ControlFlow::Break(Found::Hit(there, rate)));
            }
            // The motion rises from the surface, but the time of this flight cannot be resolved.
            let takes_no_time = start.slope.is_some() && step.time(places.after) == step.t_start();
            if !takes_no_time {
                return Ok(ControlFlow::Continue(Fall::Unapproached));
            }
        }
        match self.departure(surface, step, glance)? {
            Departure::Pressed(outcome) => Err(outcome),
            Departure::Rises(_) if places.after < 1.0 => Ok(ControlFlow::Continue(Fall::Elsewhere)),
            Departure::None if self.hops_below_rounding(surface, start, glance) => {
                Err(Outcome::Contact { surface })
            }
            _ => Ok(ControlFlow::Break(Found::Nothing)),
        }
    }

    /// Rounding error of a gap at a fraction of the step.
    pub(super) fn rounding_at<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        step: &mut StepView<'_, Sys, Step>,
    ) -> f64 {
        counted_rounding(surface, part, step, &self.sizes)
    }

    /// The fraction of the step at which the search on a touched surface ends because the rounding error of the gap hides
    /// its sign. A gap that is nothing but rounding errors may look like a pole.
    fn hidden<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        found: Search,
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Option<f64> {
        let is_touched = start.slope.is_some() && start.above && is_active(surface, step, 0.0);
        match found {
            Search::Unfinished(part) if is_touched => Some(part),
            Search::Pole(_, part) if is_touched => {
                let gap = gap_at(surface, step, part);
                step.counters.event_evaluations += 1;
                let rounding = self.rounding_at(surface, part, step);
                (gap.abs() <= 2.0 * rounding).then_some(part)
            }
            _ => None,
        }
    }

    /// The start of the search behind the part of the step where rounding hides the sign of a touched gap. Breaks with true
    /// if there is no hit in the step, with false if that remains open.
    fn depart<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
        glance: &Glance<Sys::Gaps>,
    ) -> Result<ControlFlow<bool, Start>, Outcome> {
        match self.unclear_departure(surface, step, glance)? {
            Some(Departure::Pressed(outcome)) => Err(outcome),
            Some(Departure::Rises(from)) if from < 1.0 => Ok(ControlFlow::Continue(Start {
                from,
                slope: None,
                ..start
            })),
            _ if self.hops_below_rounding(surface, start, glance) => {
                Err(Outcome::Contact { surface })
            }
            departure => Ok(ControlFlow::Break(departure == Some(Departure::None))),
        }
    }

    /// True if a fall of a touched surface belongs to the start of the step: it is there, or the gap has not risen
    /// beyond its rounding error since then. `last` is the gap at the end of the step. A fall of a motion that has crossed the
    /// surface at the start follows a rise from the other side.
    ///
    /// NOTE: rounding would otherwise produce an endless series of hops on a pressed surface, each a little later.
    fn falls_at_start<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        (part, last): (f64, f64),
        start: Start,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<bool, Outcome> {
        let Some(slope) = start.slope.filter(|_| start.above) else {
            return Ok(false);
        };
        if slope.is_nan() && is_approached_behind_start(surface, step) {
            return Ok(false);
        }
        if part == 0.0 || (slope <= 0.0 && is_accelerated(surface, step)?) {
            return Ok(true);
        }
        // A reset may set a rate that is far smaller than those before, but no rounding error. A hop ends about as fast.
        let is_thrown_up = self.is_thrown_up(surface, slope);
        if is_thrown_up && step.time(part) > step.t_start() {
            let arrival = -rate_at(surface, step, part)? * step.length();
            if arrival <= UNEVEN * slope {
                return Ok(false);
            }
        }
        // A rate that raises the gap by no more than its rounding error may itself be one.
        let rise = slope * part;
        if !is_thrown_up && rise > FAINT * last.abs() {
            return Ok(false);
        }
        let rounding = self.rounding_at(surface, part, step);
        if rise > rounding {
            return Ok(false);
        }
        // The gap may have risen by its curvature.
        step.counters.enclosures += 1;
        self.path.enclose();
        let (path, part) = (&self.path, [0.0, part]);
        let component = |i: usize| path.component(i, part);
        let gap = step
            .system
            .gap_along(surface, path.time_model(part), &component);
        Ok(gap.range().hi <= FLAT * rounding)
    }

    /// Place of an impact and the gap rate there; `None` if the surface is not approached.
    ///
    /// NOTE: the place is where the gap is closest to 0, on either side, except where no motion exists behind the
    /// surface. If it were always the allowed side, positions would be rounded away from the surface, and times and
    /// angular momenta would drift in proportion to the number of impacts.
    fn approach<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        places: Bracket,
    ) -> Result<Option<(f64, f64)>, Outcome> {
        let Bracket {
            before,
            after,
            nearest,
        } = places;
        self.place = match nearest > 0.0 && nearest != before {
            true => regular_place(step, nearest),
            false => None,
        };
        let (there, rate) = match &self.place {
            Some(place) => (nearest, place.rates.as_slice()[surface]),
            None => {
                let there = if before > 0.0 { before } else { after };
                (there, rate_at(surface, step, there)?)
            }
        };
        let rate = match rate.is_nan() {
            true => rate_before(surface, step, there)?,
            false => rate,
        };
        let falls = |part| Ok::<_, Outcome>(rate_at(surface, step, part)? < 0.0);
        let is_approached = rate < 0.0 || falls(before)? || falls(after)?;
        let slope = match is_approached {
            true => None,
            false => self.slope_by_values(surface, step, places)?,
        };
        self.is_shown_by_values[surface] = slope.is_some();
        Ok((is_approached || slope.is_some()).then(|| (there, slope.unwrap_or(rate))))
    }

    /// The slope of a gap from its values on both sides of a fall, if they differ from 0 beyond rounding and the rates there
    /// do not account for them. A gap with a kink along the motion has no derivative, and that of `tanh(h/eps)` may be
    /// rounded to 0.
    fn slope_by_values<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        step: &mut StepView<'_, Sys, Step>,
        Bracket { before, after, .. }: Bracket,
    ) -> Result<Option<f64>, Outcome> {
        let ends = [(before - ASIDE).max(0.0), (after + ASIDE).min(1.0)];
        let gap = |part: f64| gap_at(surface, step, part);
        let [first, last] = ends.map(gap);
        step.counters.event_evaluations += 2;
        let slope = (last - first) / ((ends[1] - ends[0]) * step.length());
        let [before, after] = [
            rate_at(surface, step, ends[0])?,
            rate_at(surface, step, ends[1])?,
        ];
        let is_known = math::larger(before.abs(), after.abs()) >= 0.5 * slope.abs();
        let mut is_clear = |part: f64, gap: f64| gap > 2.0 * self.rounding_at(surface, part, step);
        let falls = !is_known && is_clear(ends[0], first) && is_clear(ends[1], -last);
        Ok(falls.then_some(slope))
    }

    /// Absolute change of the gap rate per unit of time near a hit at `part` with gap rate `rate`, on the way to where the
    /// rate vanishes or doubles. The `secant` to an end of the step is far larger if the gap is steep there.
    fn bend_near<Step: Stepper<Sys>>(
        &self,
        surface: usize,
        part: f64,
        (rate, secant): (f64, f64),
        step: &StepView<'_, Sys, Step>,
    ) -> Result<f64, Outcome> {
        let (room, side) = if part > 0.5 {
            (part, -1.0)
        } else {
            (1.0 - part, 1.0)
        };
        let mut bend = secant;
        for _ in 0..LOOKS {
            let way = (rate.abs() / (bend * self.length)).max(NEAREST);
            let there = part + side * way;
            // In this form NaN fails the comparison.
            let is_inside = way < room;
            if !is_inside {
                break;
            }
            let change = rate_at(surface, step, there)? - rate;
            let found = change.abs() / ((there - part).abs() * self.length);
            let is_less = found < 0.5 * bend;
            if !is_less {
                break;
            }
            bend = found;
        }
        Ok(bend)
    }

    /// Marks a grazing impact: a hit so slow that the gap's lowest value would be within its rounding error, or within
    /// the error of the integrator. `rate` is the gap rate there, `last` that at the end of the step.
    fn note_graze<Step: Stepper<Sys>>(
        &mut self,
        surface: usize,
        part: f64,
        [rate, last]: [f64; 2],
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<(), Outcome> {
        let ends = [self.rates.as_slice()[surface], last];
        // Change of the gap rate between the hit and the farther end of the step, and the fraction of the step between.
        let (change, apart) = if part > 0.5 {
            (rate - ends[0], part)
        } else {
            (ends[1] - rate, 1.0 - part)
        };
        let secant = change.abs() / (apart * self.length);
        self.bends.as_mut_slice()[surface] = secant;
        let mut graze = Graze::None;
        let tolerance = step.stepper.tolerance();
        let missed = SAFETY * self.errors * tolerance.relative().max(tolerance.absolute());
        let slow = SLOW.max(2.0 * math::sqrt(missed));
        if rate.abs() <= slow * ends[0].abs().max(ends[1].abs()) {
            self.bends.as_mut_slice()[surface] =
                self.bend_near(surface, part, (rate, secant), step)?;
            let sizes = *Sizes::Until(part, self.sizes_at_start).along(&mut self.path);
            let mut evaluations = 0;
            let rounding = rounding_along(surface, step, part, &sizes, &mut evaluations);
            if self.is_slow(surface, rate, || rounding) {
                graze = Graze::WithinRounding;
            } else if self.errors > 0.0 && change > 0.0 {
                // NOTE: only a gap with positive second derivative would have turned before the surface.
                let scale = step.system.scale(step.t_end(), step.end());
                let unit = (&sizes, &scale, tolerance);
                let here = (step.time(part), &step.state(part));
                let error = error_within(step.system, surface, here, unit, &mut evaluations);
                if self.is_slow(surface, rate, || SAFETY * self.errors * error) {
                    graze = Graze::WithinError;
                }
            }
            step.counters.event_evaluations += evaluations;
        }
        if graze == Graze::WithinRounding && crosses_at_rest(surface, step, part)? {
            graze = Graze::Crossing;
        }
        self.grazes[surface] = graze;
        Ok(())
    }
}

/// Rounding error of a gap at a fraction of a step. `sizes`: the largest magnitudes that the components have had.
///
/// NOTE: the error is evaluated at that fraction. A gap that is steep elsewhere in the step has larger errors there,
/// which do not matter where it vanishes.
pub(super) fn rounding_along<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
    sizes: &Sys::State,
    evaluations: &mut u64,
) -> f64 {
    let (t, state) = (step.time(part), step.state(part));
    resolution(step.system, surface, t, &state, sizes, evaluations)
}

/// Same as [`rounding_along`]; the step counts the evaluations.
pub(super) fn counted_rounding<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    part: f64,
    step: &mut StepView<'_, Sys, Step>,
    sizes: &Sys::State,
) -> f64 {
    let mut evaluations = 0;
    let rounding = rounding_along(surface, step, part, sizes, &mut evaluations);
    step.counters.event_evaluations += evaluations;
    rounding
}

pub(super) fn is_active<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> bool {
    step.system
        .surface_active(surface, step.time(part), &step.state(part))
}

/// The quantities at a fraction of a step; `None` if the motion does not exist there.
fn regular_place<Sys: Impacting, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
    part: f64,
) -> Option<Place<Sys>> {
    let (t, state) = (step.time(part), step.state(part));
    let evaluations = &mut step.counters.event_evaluations;
    let place = Place::new(step.system, t, state, evaluations).ok()?;
    let exists = place.rates.is_finite() && step.system.outside_chart(&state).is_none();
    exists.then_some(place)
}

/// True if the gap rate is negative behind the start of a step and does not vanish there. At a kink the gap has no rate at the
/// start.
fn is_approached_behind_start<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
) -> bool {
    let rates = [NEAREST, ASIDE].map(|part| rate_at(surface, step, part));
    matches!(rates, [Ok(near), Ok(far)] if near < 0.0 && near.abs() > 0.5 * far.abs())
}

/// The gap rate shortly before a fraction of a step where it has none, or behind the start of the step; NaN if it has none
/// there either.
fn rate_before<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<f64, Outcome> {
    let (mut way, mut rate) = (NEAREST, f64::NAN);
    while rate.is_nan() && way < ASIDE {
        let there = if part > way { part - way } else { part + way };
        rate = rate_at(surface, step, there)?;
        way *= 8.0;
    }
    Ok(rate)
}

/// The gap rate at a fraction of a step.
fn rate_at<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Result<f64, Outcome> {
    let rates = step.system.gap_rates(step.time(part), &step.state(part))?;
    Ok(rates.as_slice()[surface])
}

/// The gap of a surface at a fraction of a step.
pub(super) fn gap_at<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> f64 {
    let (t, state) = (step.time(part), step.state(part));
    step.system.gap(surface, t, &state)
}
