//! Step of an embedded Runge-Kutta pair: trial, error estimate, then acceptance or a shorter trial.
//!
//! First same as last (FSAL): the rate at the end of an accepted step is the first stage of the next one. If the error
//! estimate does not use this rate, it is evaluated only after acceptance.

use super::controller::{
    Control, MaxStepError, Memory, Weights, check_max_step, first_step, landing_within, least_step,
    least_trial, not_finite,
};
use super::ends::Ends;
use super::instant::Instant;
use super::precise::Precise;
use super::stats::Counters;
use super::stepper::{GapAt, StepFailure, Stepper};
use super::tableau::{Term, sum};
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::state::StateVector;

/// Maximum number of times that a step is repeated to end on a surface.
const ARRIVALS: u32 = 4;

/// Largest distance in time, relative to the step, over which the motion to the surface is straight to rounding: the square
/// root of the rounding.
const STRAIGHT: f64 = 1.0 / (1 << 26) as f64;

/// Largest accepted difference between the length of a step that ends on a surface and the length from dense output,
/// relative to the step.
const BESIDE: f64 = 1.0 / 64.0;

/// A vector field that counts its evaluations.
pub struct Counted<'a, F> {
    pub(super) field: &'a F,
    pub(super) counters: &'a mut Counters,
}

impl<F: VectorField> Counted<'_, F> {
    /// Evaluates the rate and counts the evaluation.
    #[inline(always)]
    pub(super) fn rate(
        &mut self,
        t: f64,
        state: &F::State,
        rate: &mut F::State,
    ) -> Result<(), Fault> {
        self.counters.rate_evaluations += 1;
        self.field.rate(t, state, rate)
    }
}

/// One step: its start, length and end.
#[derive(Debug, Clone, Copy)]
pub struct Span<'a, S> {
    pub(super) t: f64,
    pub(super) h: f64,
    pub(super) start: &'a Precise<S>,
    pub(super) end: &'a Precise<S>,
}

impl<S: StateVector> Span<'_, S> {
    /// Difference between the end of the step and an Euler step from its start, component `i`. `weights` are those of
    /// the solution at the end. The difference is computed from the stages, which is far more accurate than from the
    /// two states. A later displacement of the end is added.
    #[inline(always)]
    pub(super) fn bend(&self, stages: &[S], weights: &[Term], i: usize) -> f64 {
        let differences = sum(stages, weights, i);
        let length = self.h * (stages[0].as_slice()[i] + differences);
        let moved = self.end.value.as_slice()[i] - self.start.plus(i, length);
        self.h * differences + moved
    }
}

/// Coefficients of an embedded pair, and the functions computed from them. Implemented by the schemes of this crate
/// only.
pub trait Scheme {
    /// See [`Stepper::name`].
    const NAME: &'static str;
    /// Order of the solution at the end of a step.
    const ORDER: usize;
    /// Order of the dense output inside a step.
    const DENSE_ORDER: usize;
    /// Index of the stage that is the rate at the end of the step.
    const LAST: usize;
    /// True if the error estimate uses the stage [`Scheme::LAST`].
    const ERROR_TAKES_LAST: bool;
    /// Largest error of dense output inside a step, as a multiple of the error of the step. Observed, not a bound.
    const DENSE_ERROR: f64;
    /// Constants of the step-size control.
    #[doc(hidden)]
    const CONTROL: Control;

    /// Storage for the stages.
    type Stages<S: StateVector>: Copy + AsRef<[S]> + AsMut<[S]>;
    /// Dense output of a step.
    type Dense<S: StateVector>: Copy;

    /// Zero stages, with as many components as `like`.
    fn stages<S: StateVector>(like: &S) -> Self::Stages<S>;

    /// Zero dense output, for states with as many components as `like`.
    fn dense<S: StateVector>(like: &S) -> Self::Dense<S>;

    /// Weights of the solution at the end.
    #[doc(hidden)]
    const WEIGHTS: &'static [Term];

    /// Nodes of the stages.
    #[doc(hidden)]
    const NODES: &'static [f64];

    /// Computes all stages after the first except [`Scheme::LAST`]. The first and the last stage hold rates; the others
    /// hold the differences between their rates and that of the first. `inside` is storage for one state.
    #[doc(hidden)]
    fn advance<F: VectorField>(
        field: &mut Counted<'_, F>,
        t: f64,
        h: f64,
        start: &F::State,
        stages: &mut [F::State],
        inside: &mut F::State,
    ) -> Result<(), Fault>;

    /// Error of the step divided by the allowed error; `allowed(i)` is the allowed error of component `i`.
    #[doc(hidden)]
    fn error<S: StateVector>(h: f64, stages: &[S], allowed: impl Fn(usize) -> f64) -> f64;

    /// Builds the dense output of a step. Evaluates the extra stages that it needs.
    #[doc(hidden)]
    fn build_dense<F: VectorField>(
        field: &mut Counted<'_, F>,
        span: Span<'_, F::State>,
        stages: &mut [F::State],
        dense: &mut Self::Dense<F::State>,
    ) -> Result<(), Fault>;

    /// Writes the coefficients of the dense output in powers of `theta`; see [`Stepper::powers`]. Returns the degree.
    #[doc(hidden)]
    fn dense_powers<S: StateVector>(dense: &Self::Dense<S>, powers: &mut [S; LENGTH]) -> usize;

    /// The state at `theta`, with its rounding error.
    #[doc(hidden)]
    fn dense_at<S: StateVector>(dense: &Self::Dense<S>, theta: f64) -> Precise<S>;
}

/// Integrator of an embedded pair.
#[derive(Debug, Clone, Copy)]
pub struct Embedded<S: StateVector, M: Scheme> {
    tolerance: Tolerance,
    max_step: f64,
    first_step: Option<f64>,
    weights: Weights<S>,
    memory: Memory,
    /// Length of the next trial step.
    next: f64,
    /// Error of the last step divided by the allowed error.
    error: f64,
    ends: Ends<S>,
    stages: M::Stages<S>,
    dense: M::Dense<S>,
    dense_ready: bool,
}

impl<S: StateVector, M: Scheme> Embedded<S, M> {
    /// An integrator with this tolerance.
    pub fn new(tolerance: Tolerance) -> Self {
        let zeros = S::zeros(0);
        Self {
            tolerance,
            max_step: f64::INFINITY,
            first_step: None,
            weights: Weights::new(tolerance, &zeros),
            memory: Memory::new(),
            next: 0.0,
            error: 0.0,
            ends: Ends::new(),
            stages: M::stages(&zeros),
            dense: M::dense(&zeros),
            dense_ready: false,
        }
    }

    /// Limits the length of steps to `max_step`, in units of time; infinity means no limit. A pulse of a force may
    /// begin and end between two stages of a step. It is detected if it lasts longer than `max_step`.
    ///
    /// # Errors
    /// [`MaxStepError`] if `max_step` is not positive.
    pub fn with_max_step(mut self, max_step: f64) -> Result<Self, MaxStepError> {
        self.max_step = check_max_step(max_step)?;
        Ok(self)
    }

    /// Sets the length of the first trial step, which is otherwise chosen automatically. Values that are not positive
    /// and finite are ignored.
    #[must_use]
    pub fn with_first_step(mut self, first_step: f64) -> Self {
        self.first_step = (first_step > 0.0 && first_step.is_finite()).then_some(first_step);
        self
    }

    /// Sets `(now, state)` as the end of a step, at the start of a run or after a jump.
    fn place<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        now: Instant,
        precise: Precise<S>,
    ) -> Result<(), StepFailure> {
        let (t, state) = (now.t, &precise.value);
        self.ends.place(now, precise);
        self.dense_ready = false;
        self.memory = Memory::new();
        self.weights = Weights::new(self.tolerance, &field.field.scale(t, state));
        let rate = &mut self.stages.as_mut()[M::LAST];
        field.rate(t, state, rate)?;
        match not_finite(state.as_slice()).or(not_finite(rate.as_slice())) {
            Some(component) => Err(StepFailure::NonFinite { component }),
            None => Ok(()),
        }
    }

    /// Makes the end of the last step the start of the next.
    #[inline(always)]
    fn move_on(&mut self) {
        self.ends.move_on();
        let stages = self.stages.as_mut();
        stages[0] = stages[M::LAST];
        self.dense_ready = false;
    }

    /// One trial step of length `h`. Returns the error divided by the allowed error; the step is accepted if this is at
    /// most 1.
    #[inline(always)]
    fn attempt<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        h: f64,
    ) -> Result<f64, StepFailure> {
        let t = self.ends.t[0].t;
        let stages = self.stages.as_mut();
        M::advance(
            field,
            t,
            h,
            &self.ends.start.value,
            stages,
            &mut self.ends.end.value,
        )?;
        self.ends.end = self
            .ends
            .start
            .advanced(|i| h * (stages[0].padded()[i] + sum(stages, M::WEIGHTS, i)));
        let end = &self.ends.end.value;
        if M::ERROR_TAKES_LAST {
            field.rate(t + h, end, &mut stages[M::LAST])?;
        }
        let error = M::error(h, stages, |i| {
            self.weights.allowed(i, &self.ends.start.value, end)
        });
        if error > 1.0 {
            return Ok(error);
        }
        if !M::ERROR_TAKES_LAST {
            field.rate(t + h, end, &mut stages[M::LAST])?;
        }
        match not_finite(end.as_slice()).or(not_finite(stages[M::LAST].as_slice())) {
            Some(component) => Err(StepFailure::NonFinite { component }),
            None if error.is_nan() => Err(StepFailure::NonFinite { component: 0 }),
            None => Ok(error),
        }
    }

    /// Repeats the last step so that it ends on a surface; see [`Stepper::meet`]. `None` if that fails.
    ///
    /// NOTE: the state at the end of a step is of higher order than dense output. Where every flight ends with an impact,
    /// dense output would determine the accuracy of the whole run.
    fn arrive<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        theta: f64,
        gap: &GapAt<'_, S>,
    ) -> Option<()> {
        let start = self.ends.t[0];
        let mut length = theta * self.ends.length();
        for _ in 0..ARRIVALS {
            if self.attempt(field, length).ok()? > 1.0 {
                return None;
            }
            let (value, rate) = gap(start.t + length, &self.ends.end.value).ok()?;
            let late = -value / rate;
            if late.abs() <= STRAIGHT * length {
                let rates = self.stages.as_ref()[M::LAST];
                self.ends.end = self.ends.end.advanced(|i| late * rates.padded()[i]);
                self.ends.t[1] = start.after(length + late);
                self.dense_ready = false;
                return Some(());
            }
            length += late;
            let is_beside = late.abs() <= BESIDE * length;
            if !is_beside {
                return None;
            }
        }
        None
    }

    /// Restores the last accepted state after a failure.
    fn retract(&mut self) {
        self.ends.retract();
        let stages = self.stages.as_mut();
        stages[M::LAST] = stages[0];
    }
}

impl<F: VectorField, M: Scheme> Stepper<F> for Embedded<F::State, M> {
    fn name(&self) -> &'static str {
        M::NAME
    }

    fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    fn max_step(&self) -> f64 {
        self.max_step
    }

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        let t = now.t;
        let mut field = Counted { field, counters };
        (self.stages, self.dense) = (M::stages(state), M::dense(state));
        self.place(&mut field, now, Precise::new(*state))?;
        let rate = self.stages.as_ref()[M::LAST];
        let rate_after = |h: f64| {
            let mut moved = *state;
            for i in 0..state.count() {
                moved.as_mut_slice()[i] += h * rate.as_slice()[i];
            }
            let mut after = state.zeroed();
            let known = field.rate(t + h, &moved, &mut after).is_ok();
            (known && after.is_finite()).then_some(after)
        };
        self.next = match self.first_step {
            Some(h) => h,
            None => first_step(
                M::CONTROL.power,
                t_end - t,
                &self.weights,
                (state, &rate),
                rate_after,
            ),
        };
        Ok(())
    }

    #[inline]
    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.next = self.next.min(limit);
        let precise = self.ends.kept(state);
        self.place(&mut Counted { field, counters }, now, precise)
    }

    #[inline]
    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.move_on();
        let mut field = Counted { field, counters };
        let t = self.ends.t[0].t;
        let least = least_trial(t);
        let mut h = self.next.min(self.max_step).max(least_step(t));
        loop {
            let (made, arrival) = landing_within(self.max_step, self.ends.t[0], h, t_end);
            let attempt = self.attempt(&mut field, made);
            if let Ok(error) = attempt
                && error <= 1.0
            {
                field.counters.accepted += 1;
                self.ends.t[1] = arrival;
                self.error = error;
                self.next = made * self.memory.accept(&M::CONTROL, error);
                return Ok(());
            }
            field.counters.rejected += 1;
            let factor = match attempt {
                Ok(error) => self.memory.reject(&M::CONTROL, error),
                Err(_) => self.memory.retreat(),
            };
            h = made * factor;
            if h < least {
                self.retract();
                return Err(attempt.err().unwrap_or(StepFailure::StepUnderflow { t }));
            }
        }
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn meet(
        &mut self,
        field: &F,
        theta: f64,
        gap: &GapAt<'_, F::State>,
        counters: &mut Counters,
    ) -> bool {
        if M::DENSE_ERROR * self.error < 1.0 {
            return false;
        }
        let kept = (self.ends, self.stages, self.dense, self.dense_ready);
        let arrived = self.arrive(&mut Counted { field, counters }, theta, gap);
        if arrived.is_none() {
            (self.ends, self.stages, self.dense, self.dense_ready) = kept;
        }
        arrived.is_some()
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.ends.end = self.ends.end.kept(state);
        let rate = &mut self.stages.as_mut()[M::LAST];
        Counted { field, counters }.rate(self.ends.t[1].t, state, rate)?;
        Ok(())
    }

    #[inline(always)]
    fn start_time(&self) -> Instant {
        self.ends.t[0]
    }

    #[inline(always)]
    fn end_time(&self) -> Instant {
        self.ends.t[1]
    }

    #[inline(always)]
    fn start_state(&self) -> &F::State {
        &self.ends.start.value
    }

    #[inline(always)]
    fn end_state(&self) -> &F::State {
        &self.ends.end.value
    }

    #[inline(always)]
    fn end_rates(&self) -> [&F::State; 2] {
        let stages = self.stages.as_ref();
        [&stages[0], &stages[M::LAST]]
    }

    #[inline(always)]
    fn dense_ready(&self) -> bool {
        self.dense_ready
    }

    #[inline]
    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault> {
        if self.dense_ready {
            return Ok(());
        }
        counters.dense_constructions += 1;
        let span = Span {
            t: self.ends.t[0].t,
            h: self.ends.length(),
            start: &self.ends.start,
            end: &self.ends.end,
        };
        M::build_dense(
            &mut Counted { field, counters },
            span,
            self.stages.as_mut(),
            &mut self.dense,
        )?;
        self.dense_ready = true;
        Ok(())
    }

    #[inline(always)]
    fn interpolate(&self, theta: f64) -> F::State {
        M::dense_at(&self.dense, theta).value
    }

    #[inline]
    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize {
        M::dense_powers(&self.dense, coefficients)
    }

    #[inline]
    fn sway(&self) -> Option<F::State> {
        let (h, stages) = (self.ends.length(), self.stages.as_ref());
        let first = stages[0].padded();
        let (mut bends, mut twists) = (stages[0].zeroed(), stages[0].zeroed());
        stages[0].for_each_place(|i| {
            let gained = h * (stages[M::LAST].padded()[i] - first[i]);
            let bend = self.ends.end.minus(&self.ends.start, i) - h * first[i];
            bends.padded_mut()[i] = bend;
            twists.padded_mut()[i] = 2.0 * bend - gained;
        });
        let mut sway = stages[0].zeroed();
        for k in 1..M::LAST {
            let node = M::NODES[k];
            stages[0].for_each_place(|i| {
                let cubic =
                    node * (2.0 * bends.padded()[i] + (2.0 - 3.0 * node) * twists.padded()[i]);
                let apart = (h * stages[k].padded()[i] - cubic).abs();
                let largest = &mut sway.padded_mut()[i];
                *largest = largest.max(apart);
            });
        }
        Some(sway)
    }

    #[inline]
    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        let (length, dense) = (self.ends.length(), &self.dense);
        self.ends.cut(theta, length, || M::dense_at(dense, theta))
    }
}
