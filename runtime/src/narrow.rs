//! Rates along a step against those that the step assumed: a force that acts in a part of it that no stage has seen is found here.
//!
//! On a part of the step all rates of the system are enclosed, for the states and times that the motion passes there:
//!
//! ```text
//! R = f(Y) and f(y_m) + [-1, 1] f'(Y) (b - a)/2,   Y the states on [a, b], y_m the one in the middle
//! ```
//!
//! and compared with the interval `P` of rates that the step's polynomial has there. What `R` exceeds `P` by is a force that the step
//! knows nothing of. It may be as large as what the rates of the step change by, or a quarter of them, since an enclosure is wider than the range; or so small that
//! the error allowed in the step covers it. Other parts are halved; where that does not help the step is too long. So it is where the
//! integral of `R` over the step does not contain what the step has gained. Of the shortest parts on which `R` has no bounds, as where a force
//! jumps or has a pole, nothing is known; those beside them tell.

use crate::contract::System;
use crate::effects::StepView;
use crate::events::path::Path;
use crate::integrate::Stepper;
use crate::numbers::{Interval, Rated};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Halvings of a step.
const DEPTH: u32 = 6;

/// The same where rates have no bounds.
const DEPTH_OF_POLES: u32 = 40;

/// Parts that are looked at: rates that have bounds nowhere are not looked for any longer.
const PARTS: u32 = 256;

/// Halvings that steps begin with whose error nobody estimates: their integral is to tell.
const DEPTH_OF_FIXED: u32 = 3;

/// A step no longer than this part of its time is no part of it that anybody could tell: its rates are not looked at.
const SAME_MOMENT: f64 = 64.0 * f64::EPSILON;

/// What an enclosure may exceed the rates of the step by: in parts of what these change by, and of their size.
const OF_CHANGE: f64 = 1.0;
const OF_SIZE: f64 = 0.25;

/// The part of a step up to which its rates are what it assumed: 1 if all of it is.
///
/// # Errors
/// Those of the dense output.
pub(crate) fn resolved<Sys: System, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
) -> Result<f64, Outcome> {
    if step.length() <= SAME_MOMENT * step.t_end().abs() {
        return Ok(1.0);
    }
    let mut path = Path::new(step.start());
    path.follow(step)?;
    let mut along = Along {
        system: step.system,
        path: &path,
        length: step.length(),
        allowed: allowed(step, &path),
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
            Rates::Exceeded if depth >= DEPTH => return Ok(part[0]),
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
            return Ok(match along.has_gained(step.start(), step.end()) {
                true => 1.0,
                false => 0.0,
            });
        }
    }
    Ok(0.0)
}

/// The error allowed in each component.
fn allowed<Sys: System, Step: Stepper<Sys>>(
    step: &StepView<'_, Sys, Step>,
    path: &Path<Sys::State>,
) -> Sys::State {
    let tolerance = step.stepper.tolerance();
    let mut allowed = step.system.scale(step.t_start(), step.start());
    for (i, entry) in allowed.as_mut_slice().iter_mut().enumerate() {
        let size = path.range(i).magnitude();
        *entry = tolerance.absolute() * *entry + tolerance.relative() * size;
    }
    allowed
}

/// What the rates on a part of a step are beside those that it assumed.
enum Rates {
    Assumed,
    Exceeded,
    Unbounded,
}

/// A step, and what it may err by.
struct Along<'a, Sys: System> {
    system: &'a Sys,
    path: &'a Path<Sys::State>,
    length: f64,
    allowed: Sys::State,
    /// Bounds of what the components gain on the parts that are known.
    gained: [Sys::State; 2],
    /// Whether there are parts of which nothing is known.
    has_pole: bool,
}

impl<Sys: System> Along<'_, Sys> {
    /// True if a step between these states has gained what the rates give, as far as that is known.
    fn has_gained(&self, start: &Sys::State, end: &Sys::State) -> bool {
        let is_within = |i: usize| {
            let change = end.as_slice()[i] - start.as_slice()[i];
            let [least, most] = [0, 1].map(|bound| self.gained[bound].as_slice()[i]);
            let allowed = self.allowed.as_slice()[i];
            least - allowed <= change && change <= most + allowed
        };
        self.has_pole || (0..start.count()).all(is_within)
    }

    /// Compares the rates on a part of the step with those that it assumed; what the components gain there is added if they are.
    fn compare(&mut self, part: [f64; 2]) -> Rates {
        let (path, width) = (self.path, part[1] - part[0]);
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
        let component = |i: usize| path.rated(i, part);
        let mut take = |i: usize, rate: Rated| {
            let reach = (rate.rate.magnitude() * 0.5) * width;
            let centred = Interval::point(centre.as_slice()[i]).widened(reach);
            let rates = length * rate.value.intersection(centred).unwrap_or(rate.value);
            let assumed = path.rated(i, part).rate;
            let excess = (rates.hi - assumed.hi).max(assumed.lo - rates.lo);
            let change = path.rated(i, [0.0, 1.0]).rate.width();
            let wider = OF_CHANGE * change + OF_SIZE * assumed.magnitude();
            let most = (wider * width).max(self.allowed.as_slice()[i]);
            // Not a comparison that NaN passes.
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
