//! Steps of fixed size: the common code of the methods without error estimate.
//!
//! A run is a grid of steps of the given size, or of the size that the tolerance suggests at the start. Exceptions: the
//! last step lands on the end. After an impact, steps grow back from the length that the driver allows. A step in which
//! the vector field does not exist is shortened until it exists. An implicit step that cannot be solved is divided into
//! 2, 4, 8, .. equal parts, which keeps the grid and the invariants of the method.

use super::collision;
use super::controller::{RETREAT, Weights, first_step, least_step, least_trial, not_finite};
use super::dense::{Cubic, INNER, Polynomial};
use super::embedded::Counted;
use super::ends::Ends;
use super::instant::Instant;
use super::precise::Precise;
use super::stats::Counters;
use super::stepper::{EnergyAt, GapAt, Rebound, StepFailure, Stepper};
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;
use crate::state::StateVector;

/// Largest factor between successive steps while they grow back to the size of the run.
const GROW: f64 = 4.0;

/// Largest remainder before the end of a run, as a fraction of a step, that is joined to the last step, since it comes
/// from rounding only.
const SLIVER: f64 = 1e-6;

/// Maximum number of parts of an implicit step.
const PARTS: u32 = 1 << 10;

/// Maximum number of automatic steps in a run. Without this limit, a method of low order would make unreasonably many
/// steps for a tight tolerance. A step set by the caller may be shorter.
pub const AUTOMATIC_STEPS: f64 = (1_u32 << 22) as f64;

/// A method of fixed step size: its names and orders. Implemented by the methods of this crate.
pub trait Method: Copy {
    /// See [`Stepper::name`].
    const NAME: &'static str;
    /// Order of the solution at the ends of steps.
    const ORDER: usize;
    /// Order of the dense output between them.
    const DENSE_ORDER: usize;
    /// Number of refinements of the cubic through the ends by two rates inside. Each raises its order by one, at
    /// most to 5.
    const REFINEMENTS: u32;

    /// Data besides the state that the method keeps for the next step.
    type Memory<S: StateVector>: Copy;

    /// True for implicit steps: shorter steps may have a solution where a longer one has none.
    const IS_IMPLICIT: bool = false;

    /// True if the method solves for impacts inside the step.
    const MEETS: bool = false;

    /// True if the method has [`Method::mean_energy`].
    const KEEPS_ENERGY: bool = false;

    /// Mean of an energy over the stages of the step from `start` over `h`: the negative derivative of the step's
    /// action with respect to `h`. For methods that follow from a discrete action and store their stages.
    #[doc(hidden)]
    fn mean_energy<S: StateVector>(
        (t, h): (f64, f64),
        start: &Precise<S>,
        memory: &Self::Memory<S>,
        energy: &EnergyAt<'_, S>,
    ) -> Option<f64> {
        let _ = (t, h, start, memory, energy);
        None
    }

    /// Empty memory, for states with as many components as `like`.
    fn memory<S: StateVector>(like: &S) -> Self::Memory<S>;
}

/// One step of a method on a system.
pub trait Advance<F: VectorField>: Method {
    /// Makes a step from `departure` over `h`, and returns the state at its end.
    #[doc(hidden)]
    fn advance(
        field: &mut Counted<'_, F>,
        h: f64,
        departure: &Departure<'_, F::State>,
        memory: &mut Self::Memory<F::State>,
    ) -> Result<Precise<F::State>, StepFailure>;
}

/// Start of a step.
#[derive(Debug, Clone, Copy)]
pub struct Departure<'a, S> {
    pub(super) t: f64,
    pub(super) state: &'a Precise<S>,
    pub(super) rate: &'a S,
    /// Unit of each component: [`VectorField::scale`] at the start of the run.
    pub(super) units: &'a S,
}

/// Grid of the times of steps of one size.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Grid {
    start: Instant,
    /// Number of steps made so far.
    steps: u64,
}

impl Grid {
    /// Grid with this start.
    fn starting(start: Instant) -> Self {
        Self { start, steps: 0 }
    }

    /// The end of the next step of this size.
    ///
    /// NOTE: the product of the number of steps and their size does not accumulate rounding errors.
    fn next(&self, step: f64) -> Instant {
        self.start.after((self.steps + 1) as f64 * step)
    }
}

/// Integrator of a method with steps of one size.
#[derive(Debug, Clone, Copy)]
pub struct FixedStep<S: StateVector, M: Method> {
    tolerance: Tolerance,
    given: Option<f64>,
    /// Step size of the run.
    pub(super) step: f64,
    /// Size of the next step: that of the run, or less after an impact.
    next: f64,
    /// The length of the last step.
    pub(super) made: f64,
    /// Number of parts of the last step.
    pub(super) parts: u32,
    /// True if the length of the last step was solved for an impact at its end.
    pub(super) has_met: bool,
    /// Point of the grid to be reached after an impact inside a step.
    pub(super) target: Option<Instant>,
    /// Value of `target` before the last step.
    pub(super) pending: Option<Instant>,
    /// True if several impacts fell into one step, until a whole step passes without any.
    pub(super) is_crowded: bool,
    /// True if the last step leads to the end of the run.
    pub(super) is_at_end: bool,
    /// Length of the step whose end is `target`.
    pub(super) span: f64,
    grid: Grid,
    pub(super) units: S,
    pub(super) ends: Ends<S>,
    pub(super) rates: [S; 2],
    pub(super) memory: M::Memory<S>,
    dense: Polynomial<S, 5>,
    pub(super) dense_ready: bool,
}

impl<S: StateVector, M: Method> FixedStep<S, M> {
    /// Order of the solution at the ends of steps.
    pub const ORDER: usize = M::ORDER;

    /// An integrator that chooses its step at the start and then keeps it. The step is the automatic first step for
    /// this tolerance and the method's order, rounded down to a power of two, but long enough for at most about
    /// [`AUTOMATIC_STEPS`] steps. It depends on the motion at the start only: prefer [`FixedStep::with_step`] if the
    /// motion becomes faster later.
    pub fn new(tolerance: Tolerance) -> Self {
        let zeros = S::zeros(0);
        Self {
            tolerance,
            given: None,
            step: 0.0,
            next: 0.0,
            made: 0.0,
            parts: 1,
            has_met: false,
            target: None,
            pending: None,
            is_at_end: false,
            is_crowded: false,
            span: 0.0,
            grid: Grid::default(),
            units: zeros,
            ends: Ends::new(),
            rates: [zeros; 2],
            memory: M::memory(&zeros),
            dense: Polynomial::zero(&zeros),
            dense_ready: false,
        }
    }

    /// Sets the step size. Anything but a positive finite number is ignored.
    #[must_use]
    pub fn with_step(mut self, step: f64) -> Self {
        self.given = (step > 0.0 && step.is_finite()).then_some(step);
        self
    }

    /// Sets time and state as the end of a step of length 0, from which the next step starts.
    fn place<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        now: Instant,
        precise: Precise<S>,
    ) -> Result<(), StepFailure> {
        let (t, state) = (now.t, &precise.value);
        // While surfaces hold the motion, another method steps.
        let keeps_grid = self.has_met && now == self.ends.t[1];
        self.ends.place(now, precise);
        self.made = 0.0;
        if !keeps_grid {
            (self.grid, self.target) = (Grid::starting(now), None);
        }
        self.has_met = false;
        self.dense_ready = false;
        self.memory = M::memory(state);
        self.units = usable(field.field.scale(t, state));
        self.rates = [state.zeroed(); 2];
        evaluate(field, t, state, &mut self.rates[1])?;
        check_finite(state, &self.rates[1])
    }

    /// The automatic first step, rounded down to a power of two so that the times of the grid are exact. It is so long
    /// that the run has at most about [`AUTOMATIC_STEPS`] steps.
    fn automatic_step<F: VectorField<State = S>>(
        &self,
        field: &mut Counted<'_, F>,
        t: f64,
        state: &S,
        t_end: f64,
    ) -> f64 {
        let weights = Weights::new(self.tolerance, &self.units);
        let (power, rate) = ((M::ORDER + 1) as f64, self.rates[1]);
        let span = t_end - t;
        let step = first_step(power, t_end - t, &weights, (state, &rate), |h| {
            let mut moved = *state;
            for i in 0..state.count() {
                moved.as_mut_slice()[i] += h * rate.as_slice()[i];
            }
            let mut after = state.zeroed();
            let known = evaluate(field, t + h, &moved, &mut after).is_ok();
            (known && after.is_finite()).then_some(after)
        });
        // The least power of two that keeps the number of steps below the maximum.
        let least = 2.0 * power_below(span / AUTOMATIC_STEPS);
        power_below(step).max(least.min(span))
    }

    /// The end of the last step becomes the start of the next.
    fn move_on(&mut self) {
        self.ends.move_on();
        self.is_crowded &= self.made == 0.0 || self.pending.is_some();
        self.rates[0] = self.rates[1];
        self.dense_ready = false;
        self.has_met = false;
    }

    /// Restores the last good state after a failure.
    fn retract(&mut self) {
        self.ends.retract();
        self.rates[1] = self.rates[0];
    }

    /// Length of a step of about `h`, and the time at its end, which is `t_end` if the step reaches it.
    fn aim(&self, h: f64, t_end: f64) -> (f64, Instant) {
        let end = Instant::new(t_end);
        let rest = end.since(self.ends.t[0]);
        let (made, arrival) = self.aim_within_run(h);
        if rest <= made + SLIVER * made {
            (rest, end)
        } else {
            (made, arrival)
        }
    }

    /// Same as [`Self::aim`], without the end of the run.
    pub(super) fn aim_within_run(&self, h: f64) -> (f64, Instant) {
        let now = self.ends.t[0];
        let next = self.grid.next(self.step);
        // NOTE: the length of a step does not depend on the time at which it is made.
        match self.target {
            None if h == self.step => (h, next),
            None => (h, now.after(h)),
            Some(target) => {
                let rest = target.since(now);
                if rest <= SLIVER * self.step && h == self.step {
                    (next.since(now), next)
                } else if rest > 0.0 && rest <= h + SLIVER * h {
                    (rest, target)
                } else {
                    (h, now.after(h))
                }
            }
        }
    }

    /// Makes the step in the smallest number of equal parts, a power of two, that can be solved.
    fn cross<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        h: f64,
    ) -> Result<u32, StepFailure>
    where
        M: Advance<F>,
    {
        if M::KEEPS_ENERGY && self.target.is_some() {
            let memory = self.memory;
            match self.cross_pieces(field, self.departing(h)) {
                Err(StepFailure::NotConverged { .. } | StepFailure::NonFinite { .. }) => {
                    self.memory = memory;
                }
                outcome => return outcome.map(|()| 1),
            }
        }
        let mut parts = 1;
        loop {
            let memory = self.memory;
            match self.cross_in(field, h, parts) {
                Err(StepFailure::NotConverged { .. }) if parts < PARTS => {
                    field.counters.rejected += 1;
                    self.memory = memory;
                    parts *= 2;
                }
                // Near the edge of the domain of the vector field, or in a diverging iteration.
                Err(StepFailure::NonFinite { .. }) if M::IS_IMPLICIT && parts < PARTS => {
                    field.counters.rejected += 1;
                    self.memory = memory;
                    parts *= 2;
                }
                outcome => return outcome.map(|()| parts),
            }
        }
    }

    pub(super) fn cross_in<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        h: f64,
        parts: u32,
    ) -> Result<(), StepFailure>
    where
        M: Advance<F>,
    {
        let part = h / f64::from(parts);
        (self.ends.end, self.rates[1]) = (self.ends.start, self.rates[0]);
        for k in 0..parts {
            let departure = Departure {
                t: self.ends.t[0].t + f64::from(k) * part,
                state: &self.ends.end,
                rate: &self.rates[1],
                units: &self.units,
            };
            let end = M::advance(field, part, &departure, &mut self.memory)?;
            let t = self.ends.t[0].t + f64::from(k + 1) * part;
            self.ends.end = end;
            evaluate(field, t, &end.value, &mut self.rates[1])?;
            check_finite(&end.value, &self.rates[1])?;
        }
        Ok(())
    }

    /// Makes the step in pieces of these lengths.
    pub(super) fn cross_pieces<F: VectorField<State = S>>(
        &mut self,
        field: &mut Counted<'_, F>,
        pieces: [f64; 2],
    ) -> Result<(), StepFailure>
    where
        M: Advance<F>,
    {
        (self.ends.end, self.rates[1]) = (self.ends.start, self.rates[0]);
        let mut t = self.ends.t[0].t;
        for piece in pieces.into_iter().filter(|piece| *piece != 0.0) {
            let departure = Departure {
                t,
                state: &self.ends.end,
                rate: &self.rates[1],
                units: &self.units,
            };
            let end = M::advance(field, piece, &departure, &mut self.memory)?;
            t += piece;
            self.ends.end = end;
            evaluate(field, t, &end.value, &mut self.rates[1])?;
            check_finite(&end.value, &self.rates[1])?;
        }
        Ok(())
    }

    /// Records a step that was made.
    fn accept(&mut self, made: f64, arrival: Instant, parts: u32) {
        self.ends.t[1] = arrival;
        self.made = made;
        self.parts = parts;
        self.pending = self.target;
        self.next = (GROW * made).min(self.step);
        if let Some(target) = self.target
            && self.reaches_grid(arrival, target)
        {
            self.next = self.step;
        } else if made == self.step && self.target.is_none() {
            self.grid.steps += 1;
        } else if self.target.is_none_or(|target| arrival.since(target) > 0.0) {
            (self.grid, self.target) = (Grid::starting(arrival), None);
        }
    }

    /// True if a step after an impact ends on the grid again: at the end of the step that was cut, or one step further.
    /// Records the return to the grid.
    fn reaches_grid(&mut self, arrival: Instant, target: Instant) -> bool {
        let next = self.grid.next(self.step);
        let reaches = arrival == target || arrival == next;
        if arrival == next {
            self.grid.steps += 1;
        }
        if reaches {
            self.target = None;
        }
        reaches
    }
}

/// The largest power of two that is no larger than a positive number.
fn power_below(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
    f64::from_bits(x.to_bits() & !MANTISSA)
}

/// The units, with 1 in place of values that are not positive and finite.
fn usable<S: StateVector>(mut units: S) -> S {
    for unit in units.as_mut_slice() {
        if !(*unit > 0.0 && unit.is_finite()) {
            *unit = 1.0;
        }
    }
    units
}

/// Evaluates the rate. It is never inlined, so that a long rate is compiled once for all methods.
#[inline(never)]
pub(super) fn evaluate<F: VectorField>(
    field: &mut Counted<'_, F>,
    t: f64,
    state: &F::State,
    rate: &mut F::State,
) -> Result<(), Fault> {
    field.rate(t, state, rate)
}

fn check_finite<S: StateVector>(state: &S, rate: &S) -> Result<(), StepFailure> {
    match not_finite(state.as_slice()).or(not_finite(rate.as_slice())) {
        Some(component) => Err(StepFailure::NonFinite { component }),
        None => Ok(()),
    }
}

impl<F: VectorField, M: Advance<F>> Stepper<F> for FixedStep<F::State, M> {
    fn name(&self) -> &'static str {
        M::NAME
    }

    fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        let mut field = Counted { field, counters };
        self.place(&mut field, now, Precise::new(*state))?;
        self.step = match self.given {
            Some(step) => step,
            None => self.automatic_step(&mut field, now.t, state, t_end),
        };
        self.next = self.step;
        Ok(())
    }

    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.next = self.step.min(limit);
        let precise = self.ends.kept(state);
        self.place(&mut Counted { field, counters }, now, precise)
    }

    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.move_on();
        let mut field = Counted { field, counters };
        let t = self.ends.t[0].t;
        let least = least_trial(t);
        let mut h = self.next.max(least_step(t));
        loop {
            let (made, arrival) = self.aim(h, t_end);
            let attempt = match arrival.since(self.ends.t[0]) > 0.0 {
                true => self.cross(&mut field, made),
                false => Err(StepFailure::StepUnderflow { t }),
            };
            let failure = match attempt {
                Ok(parts) => {
                    field.counters.accepted += 1;
                    self.accept(made, arrival, parts);
                    self.is_at_end = arrival == Instant::new(t_end);
                    return Ok(());
                }
                Err(failure) => failure,
            };
            field.counters.rejected += 1;
            h = made * RETREAT;
            let is_curable = matches!(
                failure,
                StepFailure::Fault(_) | StepFailure::NonFinite { .. }
            );
            if !is_curable || h < least {
                self.retract();
                return Err(failure);
            }
        }
    }

    fn fixed_step(&self) -> Option<f64> {
        Some(self.step)
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.ends.end = self.ends.end.kept(state);
        evaluate(
            &mut Counted { field, counters },
            self.ends.t[1].t,
            state,
            &mut self.rates[1],
        )?;
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
        [&self.rates[0], &self.rates[1]]
    }

    #[inline(always)]
    fn dense_ready(&self) -> bool {
        self.dense_ready
    }

    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault> {
        if self.dense_ready {
            return Ok(());
        }
        counters.dense_constructions += 1;
        let mut field = Counted { field, counters };
        let h = self.made;
        self.dense = Polynomial::zero(&self.ends.start.value);
        for i in 0..self.rates[0].count() {
            let [first, last] = [0, 1].map(|end| h * self.rates[end].as_slice()[i]);
            let cubic = Cubic {
                rate: first,
                bend: self.ends.end.minus(&self.ends.start, i) - first,
                gained: last - first,
                rounding: 0.0,
            };
            self.dense.set_cubic(i, &self.ends.start, cubic);
        }
        for _ in 0..M::REFINEMENTS {
            let mut inner = [self.rates[0].zeroed(); 2];
            for (theta, rate) in [INNER, 1.0 - INNER].into_iter().zip(&mut inner) {
                evaluate(
                    &mut field,
                    self.ends.t[0].t + theta * h,
                    &self.dense.at(theta),
                    rate,
                )?;
            }
            self.dense.set_inner(h, [&inner[0], &inner[1]]);
        }
        self.dense_ready = true;
        Ok(())
    }

    fn meet(
        &mut self,
        field: &F,
        theta: f64,
        gap: &GapAt<'_, F::State>,
        counters: &mut Counters,
    ) -> bool {
        M::MEETS && collision::meet(self, field, theta, gap, counters)
    }

    fn rebound(
        &mut self,
        field: &F,
        rebound: &Rebound<'_, F::State>,
        state: &mut F::State,
        counters: &mut Counters,
    ) {
        if self.has_met
            && let Some(solved) = collision::rebound(self, field, rebound, state, counters)
        {
            *state = solved;
        }
    }

    #[inline(always)]
    fn interpolate(&self, theta: f64) -> F::State {
        self.dense.at(theta)
    }

    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize {
        self.dense.powers(coefficients)
    }

    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        let (length, dense) = (self.made, &self.dense);
        self.ends.cut(theta, length, || dense.precisely_at(theta))
    }
}
