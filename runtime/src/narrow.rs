//! Comparison of the rates along a step with the rates that the step assumed. It finds forces that act only between the
//! stages of a step.
//!
//! On a part of the step all rates of the system are enclosed, for the states and times on the motion's path there:
//!
//! ```text
//! R = the intersection of f(Y) and f(y_m) + [-1, 1] f'(Y) (b - a)/2,   Y the states on [a, b], y_m the middle one
//! ```
//!
//! and compared with the interval `P` of the rates of the step's polynomial there. The excess of `R` over `P` is a
//! force that the step has not seen. Since an enclosure is wider than the range, an excess is accepted up to the change
//! of the rates over the step plus a quarter of their size. It is also accepted if the error allowed in the step covers
//! it. Parts with a larger excess are halved. If halving does not help, the step is too long. It is also too long if
//! the integral of `R` over the step does not contain the change of the state over the step. The shortest parts on
//! which `R` has no bounds, for example at a pole or at a jump of a force, are left undecided; the other parts decide.

use crate::contract::System;
use crate::effects::StepView;
use crate::events::path::Path;
use crate::integrate::Stepper;
use crate::numbers::{Interval, Rated};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Maximum number of halvings of a step.
const DEPTH: u32 = 6;

/// Maximum number of halvings where rates have no bounds.
const DEPTH_OF_POLES: u32 = 40;

/// Maximum number of parts that are examined. It ends the search if rates have no bounds anywhere.
const PARTS: u32 = 256;

/// Number of initial halvings of a fixed step, which has no error estimate. The integral of its rates must be enclosed
/// well enough to decide.
const DEPTH_OF_FIXED: u32 = 3;

/// Shortest step that should be examined, as a fraction of its time. Times inside a shorter step cannot be distinguished.
pub(crate) const SAME_MOMENT: f64 = 64.0 * f64::EPSILON;

/// Bound for the rounding error of a step, relative to the size of a component.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Allowed excess of an enclosure over the rates of the step, relative to the change of these rates over the step.
const OF_CHANGE: f64 = 1.0;
/// Allowed further excess, relative to the size of these rates.
const OF_SIZE: f64 = 0.25;

/// Result of the comparison along a step.
pub(crate) struct Resolved {
    /// Fraction of the step up to which its rates agree with the assumed rates; 1 if they agree everywhere.
    pub part: f64,
    /// True if the step contains a place where the rates have no bounds.
    pub has_pole: bool,
}

/// Compares the rates along a step with the assumed rates.
///
/// # Errors
/// The [`Outcome`] of a failed dense output.
pub(crate) fn resolved<Sys: System, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
) -> Result<Resolved, Outcome> {
    let path = assumed(step)?;
    let mut along = Along {
        system: step.system,
        path: &path,
        length: step.length(),
        allowed: allowed(step, &path),
        changes: changes(step.start(), &path),
        gained: [step.start().zeroed(); 2],
        has_pole: false,
    };
    let least = match step.stepper.fixed_step() {
        Some(_) => DEPTH_OF_FIXED,
        None => 0,
    };
    let (mut index, mut depth) = (0_u64, least);
    for _ in 0..PARTS {
        let count = (1_u64 << depth) as f64;
        let part = [index as f64 / count, (index + 1) as f64 / count];
        step.counters.rate_evaluations += 1;
        let is_split = match along.compare(part) {
            Rates::Assumed => false,
            Rates::Exceeded if depth >= DEPTH => return Ok(along.until(part[0])),
            Rates::Exceeded => true,
            Rates::Unbounded if depth >= DEPTH_OF_POLES => {
                along.has_pole = true;
                false
            }
            Rates::Unbounded => true,
        };
        if is_split {
            (index, depth) = (2 * index, depth + 1);
            continue;
        }
        index += 1;
        while index.is_multiple_of(2) && depth > least {
            (index, depth) = (index / 2, depth - 1);
        }
        if index == 1 << depth {
            let has_gained = along.has_gained(step.start(), step.end());
            return Ok(along.until(f64::from(u8::from(has_gained))));
        }
    }
    Ok(along.until(0.0))
}

/// The error allowed in each component: that of the tolerance, or the rounding error of a step if that is larger.
fn allowed<Sys: System, Step: Stepper<Sys>>(
    step: &StepView<'_, Sys, Step>,
    path: &Path<Sys::State>,
) -> Sys::State {
    let tolerance = step.stepper.tolerance();
    let mut allowed = step.system.scale(step.t_start(), step.start());
    for (i, entry) in allowed.as_mut_slice().iter_mut().enumerate() {
        let size = path.range(i).magnitude();
        let tolerated = tolerance.absolute() * *entry + tolerance.relative() * size;
        *entry = tolerated.max(ROUNDING * size);
    }
    allowed
}

/// The path of a step as its result assumes it: the cubic through its ends, with an error bound from the rates inside
/// the step, as far as the cubic makes them plausible. The dense output, for methods without rates inside.
///
/// NOTE: a stage without weight in the result, or one of the dense output alone, may have met a force that the result has
/// not. It would pass for one that the step assumed.
fn assumed<Sys: System, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
) -> Result<Path<Sys::State>, Outcome> {
    let mut path = Path::new(step.start());
    let Some(mut sway) = step.stepper.sway() else {
        path.follow(step)?;
        return Ok(path);
    };
    path.take_ends(step, &sway.zeroed());
    let allowed = allowed(step, &path);
    for (i, entry) in sway.as_mut_slice().iter_mut().enumerate() {
        let rate = path.rated(i, [0.0, 1.0]).rate;
        let plausible = OF_CHANGE * rate.width() + OF_SIZE * rate.magnitude();
        *entry = entry.min(plausible + allowed.as_slice()[i]);
    }
    path.take_ends(step, &sway);
    Ok(path)
}

/// Width of the range of each rate over the whole step. Rates are with respect to the fraction of the step.
fn changes<S: StateVector>(like: &S, path: &Path<S>) -> S {
    let mut changes = like.zeroed();
    for (i, entry) in changes.as_mut_slice().iter_mut().enumerate() {
        *entry = path.rated(i, [0.0, 1.0]).rate.width();
    }
    changes
}

/// Relation of the enclosed rates on a part of a step to the rates that the step assumed.
enum Rates {
    Assumed,
    Exceeded,
    Unbounded,
}

/// A step and the error allowed in it.
struct Along<'a, Sys: System> {
    system: &'a Sys,
    path: &'a Path<Sys::State>,
    length: f64,
    allowed: Sys::State,
    /// Change of each rate over the whole step.
    changes: Sys::State,
    /// Bounds of the change of the components over the parts with bounded rates.
    gained: [Sys::State; 2],
    /// True if there are parts on which the rates have no bounds.
    has_pole: bool,
}

impl<Sys: System> Along<'_, Sys> {
    /// Agreement up to this fraction.
    fn until(&self, part: f64) -> Resolved {
        Resolved {
            part,
            has_pole: self.has_pole,
        }
    }

    /// True if the change between these states agrees with the integral of the rates, or if the integral has no bounds.
    fn has_gained(&self, start: &Sys::State, end: &Sys::State) -> bool {
        let is_within = |i: usize| {
            let change = end.as_slice()[i] - start.as_slice()[i];
            let [least, most] = [0, 1].map(|bound| self.gained[bound].as_slice()[i]);
            let allowed = self.allowed.as_slice()[i];
            least - allowed <= change && change <= most + allowed
        };
        self.has_pole || (0..start.count()).all(is_within)
    }

    /// Compares the rates on a part of the step with the rates that the step assumed. If they agree, adds their
    /// integral to `gained`.
    fn compare(&mut self, part: [f64; 2]) -> Rates {
        let (path, changes, width) = (self.path, &self.changes, part[1] - part[0]);
        let mut gained = self.gained;
        let middle = 0.5 * (part[0] + part[1]);
        let mut state = self.allowed.zeroed();
        for (i, entry) in state.as_mut_slice().iter_mut().enumerate() {
            *entry = path.at(i, middle);
        }
        let t = path.time([middle, middle]).value.middle();
        let mut centre = state.zeroed();
        if self.system.rate(t, &state, &mut centre).is_err() {
            return Rates::Unbounded;
        }
        let (mut is_assumed, mut is_bounded) = (true, true);
        let length = Interval::point(self.length);
        let mut motion = Sys::State::each(state.count(), Rated::steady(Interval::point(0.0)));
        for (i, rated) in motion.as_mut().iter_mut().enumerate() {
            *rated = path.rated(i, part);
        }
        let component = |i: usize| motion.as_ref()[i];
        let mut take = |i: usize, rate: Rated| {
            let reach = (rate.rate.magnitude() * 0.5) * width;
            let centred = Interval::point(centre.as_slice()[i]).widened(reach);
            let rates = length * rate.value.intersection(centred).unwrap_or(rate.value);
            let assumed = motion.as_ref()[i].rate;
            let excess = (rates.hi - assumed.hi).max(assumed.lo - rates.lo);
            let wider = OF_CHANGE * changes.as_slice()[i] + OF_SIZE * assumed.magnitude();
            let most = (wider * width).max(self.allowed.as_slice()[i]);
            // Written so that NaN fails the comparison.
            is_assumed &= excess * width <= most;
            is_bounded &= rates.lo.is_finite() && rates.hi.is_finite();
            gained[0].as_mut_slice()[i] += width * rates.lo;
            gained[1].as_mut_slice()[i] += width * rates.hi;
        };
        let along = self
            .system
            .rates_along(path.time(part), &component, &mut take);
        match (is_assumed, is_bounded && along.is_ok()) {
            (_, false) => Rates::Unbounded,
            (false, true) => Rates::Exceeded,
            (true, true) => {
                self.gained = gained;
                Rates::Assumed
            }
        }
    }
}
