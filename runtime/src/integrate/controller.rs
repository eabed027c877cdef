//! Step-size control (Hairer, Norsett, Wanner I, II.4; Gustafsson's PI controller).

use core::fmt;

use super::instant::Instant;
use super::tableau::larger;
use super::tolerance::Tolerance;
use crate::math;
use crate::state::StateVector;

/// Constants of the controller of one scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Order of the error estimate plus one: the error is modelled as proportional to `h` to this power.
    pub(super) power: f64,
    /// Gustafsson's `beta`, the exponent of the last error. 0 gives the classical controller.
    pub(super) beta: f64,
    /// Least factor between successive step sizes.
    pub(super) shrink: f64,
    /// Largest factor between successive step sizes.
    pub(super) grow: f64,
}

/// Safety factor of the predicted step size, so that most trials pass.
const SAFETY: f64 = 0.9;

/// Least error in the controller's memory. Smaller errors do not predict the next one.
const LEAST_ERROR: f64 = 1e-4;

/// Factor after a trial without an error estimate: a fault, or numbers that are not finite.
pub(crate) const RETREAT: f64 = 0.25;

/// Memory of the controller between steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Memory {
    last_error: f64,
    rejected: bool,
}

impl Memory {
    /// Memory before the first step.
    pub(super) const fn new() -> Self {
        Self {
            last_error: LEAST_ERROR,
            rejected: false,
        }
    }

    /// Factor for the next step size after a step with this error (at most 1) was accepted.
    #[inline]
    pub(super) fn accept(&mut self, control: &Control, error: f64) -> f64 {
        let mut predicted = SAFETY * power(error, -(1.0 / control.power - 0.75 * control.beta));
        if control.beta != 0.0 {
            predicted *= power(self.last_error, control.beta);
        }
        // The step does not grow right after a rejection, because it would often be rejected again.
        let grow = if self.rejected { 1.0 } else { control.grow };
        *self = Self {
            last_error: error.max(LEAST_ERROR),
            rejected: false,
        };
        predicted.clamp(control.shrink, grow)
    }

    /// Factor for the next trial after one with this error (more than 1) was rejected.
    #[inline]
    pub(super) fn reject(&mut self, control: &Control, error: f64) -> f64 {
        self.rejected = true;
        (SAFETY * power(error, -1.0 / control.power)).clamp(control.shrink, 1.0)
    }

    /// Factor for the next trial after one without an error estimate.
    pub(super) fn retreat(&mut self) -> f64 {
        self.rejected = true;
        RETREAT
    }
}

/// `x^e`; infinite for `x = 0` with negative `e`.
#[inline]
fn power(x: f64, e: f64) -> f64 {
    if x > 0.0 {
        math::powf(x, e)
    } else {
        f64::INFINITY
    }
}

/// Error weights: the error allowed in component `i` is `absolute * scale_i + relative * size_i`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights<S> {
    relative: f64,
    floor: S,
}

impl<S: StateVector> Weights<S> {
    /// Weights of a tolerance at this scale of the system. A scale that is not a positive finite number counts as 1.
    pub(super) fn new(tolerance: Tolerance, scale: &S) -> Self {
        let mut floor = *scale;
        for value in floor.as_mut_slice() {
            let usable = *value > 0.0 && value.is_finite();
            *value = tolerance.absolute() * if usable { *value } else { 1.0 };
        }
        Self {
            relative: tolerance.relative(),
            floor,
        }
    }

    /// The error allowed in component `i` between two states.
    #[inline(always)]
    pub(super) fn allowed(&self, i: usize, y0: &S, y1: &S) -> f64 {
        self.floor.as_slice()[i]
            + self.relative * y0.as_slice()[i].abs().max(y1.as_slice()[i].abs())
    }

    /// Maximum over `i` of `value(i)` divided by the error allowed at a state.
    pub(super) fn norm(&self, at: &S, value: impl Fn(usize) -> f64) -> f64 {
        let ratios = (0..at.count()).map(|i| (value(i) / self.allowed(i, at, at)).abs());
        ratios.fold(0.0, larger)
    }
}

/// Shortest step that the controller chooses: sixteen units in the last place of the time. Without this limit, a
/// tolerance relative to a component that is 0, for example at a wall, would require steps of length 0.
pub(crate) fn least_step(t: f64) -> f64 {
    (16.0 * f64::EPSILON * t.abs()).max(f64::MIN_POSITIVE)
}

/// Lower limit for shortening a failed step: a 64th of a unit in the last place of the time. Times are kept in two
/// parts, so that such a step moves them.
pub(crate) fn least_trial(t: f64) -> f64 {
    (f64::EPSILON / 64.0 * t.abs()).max(f64::MIN_POSITIVE)
}

/// Length of a step, relative to the time, above which it is computed as the difference of two rounded times.
const LONG: f64 = 1024.0 * f64::EPSILON;

/// Length and end of a step of about `h`. The end is `t_end` itself if a step one percent longer would reach it.
///
/// A step that is long relative to the last place of the time keeps the low part of the time. Its length has no digits
/// below that place: such digits of `h` depend on the units, and a run must not depend on the units.
#[inline(always)]
pub(crate) fn landing(start: Instant, h: f64, t_end: f64) -> (f64, Instant) {
    let end = Instant::new(t_end);
    let left = end.since(start);
    if 1.01 * h >= left {
        return (left, end);
    }
    if h <= LONG * start.t.abs() {
        return (h, start.after(h));
    }
    let t = start.t + h;
    (t - start.t, Instant { t, ..start })
}

/// Factor by which a step may exceed the largest allowed one, because its ends are rounded.
const ROUNDED: f64 = 1.0 + 1e-9;

/// Same as [`landing`], but in two steps if the step that reaches `t_end` is longer than `max_step`.
#[inline(always)]
pub(crate) fn landing_within(max_step: f64, start: Instant, h: f64, t_end: f64) -> (f64, Instant) {
    let (made, arrival) = landing(start, h, t_end);
    if arrival.t == t_end && made > h && made > ROUNDED * max_step {
        return landing(start, 0.5 * made, t_end);
    }
    (made, arrival)
}

/// Error for a largest step that is not a positive number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxStepError {
    /// The refused value.
    pub value: f64,
}

impl fmt::Display for MaxStepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the largest step must be a positive number, not {}",
            self.value
        )
    }
}

impl core::error::Error for MaxStepError {}

/// Returns the largest step if it is positive.
pub(super) fn check_max_step(value: f64) -> Result<f64, MaxStepError> {
    match value > 0.0 {
        true => Ok(value),
        false => Err(MaxStepError { value }),
    }
}

/// The first component that is not finite.
pub(super) fn not_finite(components: &[f64]) -> Option<usize> {
    components.iter().position(|value| !value.is_finite())
}

/// Size of the first step, from the difference between the rates at both ends of an explicit Euler step (Hairer,
/// Norsett, Wanner I, II.4). `rate_after(h)` returns the rate after an Euler step of `h`. If it fails, the result is
/// the cautious first guess.
///
/// The book's fallbacks are absolute numbers. Here they are fractions of the span, and time is measured in units of
/// `|y| / |y'|`, so that the choice does not depend on units.
pub(super) fn first_step<S: StateVector>(
    power: f64,
    span: f64,
    weights: &Weights<S>,
    (state, rate): (&S, &S),
    rate_after: impl FnOnce(f64) -> Option<S>,
) -> f64 {
    let size = weights.norm(state, |i| state.as_slice()[i]);
    let speed = weights.norm(state, |i| rate.as_slice()[i]);
    let known = size >= 1e-5 && speed * span >= 1e-5;
    let unit = if known {
        (size / speed).min(100.0 * span)
    } else {
        1e-4 * span
    };
    let cautious = 0.01 * unit;
    let Some(after) = rate_after(cautious) else {
        return cautious;
    };
    let bend = weights.norm(state, |i| after.as_slice()[i] - rate.as_slice()[i]) / cautious;
    let change = (speed * unit).max(bend * unit * unit);
    let step = if change > 1e-15 {
        unit * math::powf(0.01 / change, 1.0 / power)
    } else {
        unit
    };
    if step.is_finite() {
        step.min(unit).min(span)
    } else {
        cautious
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use nalgebra::SVector;

    const CONTROL: Control = Control {
        power: 5.0,
        beta: 0.04,
        shrink: 0.2,
        grow: 10.0,
    };

    #[test]
    fn steps_grow_after_small_errors_but_not_right_after_a_rejection() {
        let mut memory = Memory::new();
        assert_eq!(memory.accept(&CONTROL, 0.0), CONTROL.grow);
        assert!(memory.reject(&CONTROL, 1e3) < 0.3);
        assert_eq!(memory.accept(&CONTROL, 1e-8), 1.0);
        assert!(memory.accept(&CONTROL, 1e-8) > 1.0);
    }

    #[test]
    fn first_step_does_not_depend_on_units() {
        type State = SVector<f64, 2>;
        let tolerance = Tolerance::new(1e-9).unwrap();
        // An oscillator in units of length and time that are powers of two.
        let step = |length: f64, time: f64| {
            let (state, rate) = (State::new(length, 0.0), State::new(0.0, -length / time));
            let weights = Weights::new(tolerance, &State::repeat(length));
            first_step(8.0, 10.0 * time, &weights, (&state, &rate), |h| {
                Some(State::new(h * rate[1] / time, -length / time))
            }) / time
        };
        assert_eq!(step(1.0, 1.0), step(1024.0, 0.125));
    }

    #[test]
    fn unusable_scales_count_as_one() {
        let tolerance = Tolerance::new(1e-3).unwrap();
        let weights = Weights::new(tolerance, &SVector::<f64, 2>::new(f64::NAN, 10.0));
        let zero = SVector::<f64, 2>::zeros();
        assert_eq!(
            [
                weights.allowed(0, &zero, &zero),
                weights.allowed(1, &zero, &zero)
            ],
            [1e-3, 1e-2]
        );
    }
}
