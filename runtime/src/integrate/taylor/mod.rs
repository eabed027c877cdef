//! Taylor series of the motion, with the steps of Jorba and Zou.
//!
//! ```text
//! h_j = (tol e^-2.7 / |y_j|)^(1/j),   h = min(h_(p-1), h_p)
//! ```
//!
//! with `|y_j|` the largest of the coefficients `j` of the state's components, each over the size that its tolerance
//! is relative to. The order `p` is the one of least work ([`order`]). The step's polynomial is its dense output, so that states
//! between its ends are as accurate as those at them and cost no evaluation.
//!
//! Coefficients are computed in a unit of time that is a power of two near the step: they neither overflow nor vanish
//! whatever units the system has, and the change of unit is exact. What rounding takes from the sum of state and
//! increment is carried to the next step.
//!
//! No step is rejected because of its error. A rate at the end that is not the derivative of the polynomial shows a
//! step past a point where the motion is not analytic; it is halved, which takes no new coefficients.
//!
//! References: A. Jorba and M. Zou, *A software package for the numerical integration of ODEs by means of high-order
//! Taylor methods*, Experimental Mathematics 14 (2005), sections 3.1 to 3.3; E. Hairer, C. Lubich, G. Wanner, *Geometric
//! Numerical Integration* (2006), VIII.5, for the carried rest.

pub(crate) mod expansion;
#[cfg(feature = "lanes")]
pub(crate) mod lanes;
pub(crate) mod reach;
mod step;

use core::fmt;

use expansion::{Expansion, row, state, sum};

use super::controller::{
    MaxStepError, Weights, check_max_step, least_step, least_trial, not_finite,
};
use super::ends::Ends;
use super::instant::Instant;
use super::order::{LEAST_ORDER, PART_OF_TOLERANCE, order};
use super::precise::Precise;
use super::rough;
use super::stats::Counters;
use super::stepper::StepFailure;
use super::tolerance::Tolerance;
use crate::contract::TaylorField;
use crate::error::Fault;
use crate::jet::{INVERSES, LENGTH};
use crate::math;
use crate::numbers::Row;
use crate::state::StateVector;

/// The name of [`Taylor`], known without a system.
pub const TAYLOR: &str = "taylor";

/// Largest step in units of time of its expansion: powers up to the highest stay far from overflow.
const LONGEST: f64 = (1 << 20) as f64;

/// Factor by which the unit of time shrinks when coefficients overflow.
const SHRINK: f64 = 1.0 / (1 << 16) as f64;

/// Largest factor between a step that was limited from outside and the next.
const GROW: f64 = 8.0;

/// How far rate and polynomial may be apart at the end of a step, in units of the error allowed: the truncation error
/// of a step in order is a small part of it.
const DEFECT: f64 = 1024.0;

/// Rounding errors that a rate may have besides, in units of the size of its component.
const NOISE: f64 = 64.0 * f64::EPSILON;

/// Generated Taylor series at work.
pub struct Taylor<F: TaylorField> {
    tolerance: Tolerance,
    /// The order of the series, once a run has begun.
    order: usize,
    given_order: Option<usize>,
    max_step: f64,
    first_step: Option<f64>,
    weights: Weights<F::State>,
    /// Unit of time of the coefficients, a power of two; and that of the next ones.
    unit: f64,
    next_unit: f64,
    /// No step longer than this for now: after a jump, and at the start.
    limit: f64,
    /// At least the error of the last step over what is allowed.
    error: f64,
    ends: Ends<F::State>,
    rates: [F::State; 2],
    expansion: Expansion<F, f64>,
    /// Whether the coefficients of the last step are at hand: they are not where it was made abreast of others.
    is_expanded: bool,
}

impl<F: TaylorField> Clone for Taylor<F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: TaylorField> Copy for Taylor<F> {}

impl<F: TaylorField> fmt::Debug for Taylor<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Taylor")
            .field("tolerance", &self.tolerance)
            .field("order", &self.order)
            .field("t", &self.ends.t)
            .field("end", &self.ends.end.value)
            .finish_non_exhaustive()
    }
}

impl<F: TaylorField> Taylor<F> {
    /// An integrator with this tolerance, of the order that belongs to it.
    pub fn new(tolerance: Tolerance) -> Self {
        let zeros = F::State::zeros(0);
        Self {
            tolerance,
            order: 0,
            given_order: None,
            max_step: f64::INFINITY,
            first_step: None,
            weights: Weights::new(tolerance, &zeros),
            unit: 1.0,
            next_unit: 1.0,
            limit: f64::INFINITY,
            error: 0.0,
            ends: Ends::new(),
            rates: [zeros; 2],
            expansion: Expansion::unset(),
            is_expanded: true,
        }
    }

    /// With series of this order, between 3 and 32, instead of the one that belongs to the tolerance.
    #[must_use]
    pub fn with_order(mut self, order: usize) -> Self {
        self.given_order = Some(order.clamp(LEAST_ORDER, LENGTH - 1));
        self
    }

    /// With no step longer than `max_step`, in units of time; infinity is no limit. A short force, such as a blow between two
    /// steps, is seen if it lasts longer than this.
    ///
    /// # Errors
    /// [`MaxStepError`] unless `max_step` is positive.
    pub fn with_max_step(mut self, max_step: f64) -> Result<Self, MaxStepError> {
        self.max_step = check_max_step(max_step)?;
        Ok(self)
    }

    /// With no first step longer than this. Anything but a positive number is ignored.
    #[must_use]
    pub fn with_first_step(mut self, first_step: f64) -> Self {
        self.first_step = (first_step > 0.0 && first_step.is_finite()).then_some(first_step);
        self
    }

    /// The order of the series of a system.
    pub fn order_for(&self, field: &F) -> usize {
        let chosen = || order(self.tolerance.relative(), field.work());
        self.given_order.unwrap_or_else(chosen)
    }

    /// Takes `(now, state)` for the end of a step, as a start does.
    fn place(
        &mut self,
        field: &F,
        now: Instant,
        precise: Precise<F::State>,
    ) -> Result<(), StepFailure> {
        let state = &precise.value;
        self.ends.place(now, precise);
        self.weights = Weights::new(self.tolerance, &field.scale(now.t, state));
        if let Some(component) = not_finite(state.as_slice()) {
            return Err(StepFailure::NonFinite { component });
        }
        self.begin(field)
    }

    /// What is known at the end of the step, the rate among it.
    #[inline(always)]
    fn begin(&mut self, field: &F) -> Result<(), StepFailure> {
        self.expansion.begin(
            field,
            &field.parameters(),
            self.ends.t[1].t,
            &row::<F>(&self.ends.end.value),
        )?;
        self.rates[1] = state::<F>(self.expansion.rate());
        match not_finite(self.rates[1].as_slice()) {
            Some(component) => Err(StepFailure::NonFinite { component }),
            None => Ok(()),
        }
    }

    /// The coefficients at the start of the step; the step they allow, in units of time.
    fn expand(&mut self, field: &F, counters: &mut Counters) -> Result<f64, StepFailure> {
        loop {
            counters.expansions += 1;
            counters.coefficients += self.order as u64;
            let start = row::<F>(&self.ends.start.value);
            self.expansion
                .advance(field, &field.parameters(), self.unit, self.order, &start);
            let last = |j: usize| self.expansion.coefficients[self.order - j].as_slice();
            let Some(component) = not_finite(last(0)).or(not_finite(last(1))) else {
                return Ok(self.reach());
            };
            counters.rejected += 1;
            self.unit *= SHRINK;
            if self.unit < least_trial(self.ends.t[0].t) {
                return Err(StepFailure::NonFinite { component });
            }
        }
    }

    /// The step that the last two coefficients allow, in units of time.
    #[inline(always)]
    fn reach(&self) -> f64 {
        let mut factors = self.expansion.coefficients[0].zeroed();
        for (i, factor) in factors.as_mut_slice().iter_mut().enumerate() {
            *factor = 1.0
                / self
                    .weights
                    .allowed(i, &self.ends.start.value, &self.ends.start.value);
        }
        self.reach_of(self.expansion.sizes(self.order, &factors))
    }

    /// The step that the sizes of the last two coefficients allow, in units of time. The sizes hold the tolerance already.
    #[inline(always)]
    fn reach_of(&self, sizes: [f64; 2]) -> f64 {
        let [last, before] = [(0, self.order), (1, self.order - 1)]
            .map(|(j, order)| (PART_OF_TOLERANCE - rough::log2(sizes[j])) * INVERSES[order]);
        rough::exp2(last.min(before))
    }

    /// The end of the last step is the start of the next.
    #[inline(always)]
    fn set_out(&mut self) {
        self.ends.move_on();
        self.rates[0] = self.rates[1];
        self.unit = self.next_unit;
    }

    /// The length of the step that the coefficients reach, as far as it is wanted.
    #[inline(always)]
    fn length(&self, reach: f64) -> f64 {
        let least = least_step(self.ends.t[0].t);
        reach.min(self.max_step).min(self.limit).max(least)
    }

    /// What is left to do when a step of this length was made.
    #[inline(always)]
    fn accept(&mut self, made: f64, reach: f64, counters: &mut Counters) {
        counters.accepted += 1;
        // The error grows with a power of the step that is the order and more.
        let part = made / reach;
        self.error = (part * part) * (part * part);
        self.limit = if made < reach {
            GROW * made.max(self.limit.min(reach))
        } else {
            f64::INFINITY
        };
    }

    /// Sets the end of the step at `theta` units of time, and gives the derivative of the polynomial there.
    #[inline(always)]
    fn arrive(&mut self, theta: f64) -> F::Row<f64> {
        let [change, slope] = self.expansion.change(self.order, theta);
        for (i, change) in change.as_slice().iter().enumerate() {
            let Ends { start, end, .. } = &mut self.ends;
            let (value, rest) = (start.value.as_slice()[i], start.rest.as_slice()[i]);
            let [value, rest] = sum(value, *change, rest);
            end.value.as_mut_slice()[i] = value;
            end.rest.as_mut_slice()[i] = rest;
        }
        slope
    }

    /// Whether the motion at the end of a step of `theta` units is that of the vector field.
    #[inline(always)]
    fn attempt(
        &mut self,
        field: &F,
        theta: f64,
        arrival: Instant,
        counters: &mut Counters,
    ) -> Result<bool, StepFailure> {
        let slope = self.arrive(theta);
        self.ends.t[1] = arrival;
        counters.rate_evaluations += 1;
        self.begin(field)?;
        if let Some(component) = not_finite(self.ends.end.value.as_slice()) {
            return Err(StepFailure::NonFinite { component });
        }
        Ok(self.is_motion(theta, &slope))
    }

    /// Whether the derivative of the polynomial at the end of a step is the rate there.
    #[inline(always)]
    fn is_motion(&self, theta: f64, slope: &F::Row<f64>) -> bool {
        let length = theta * self.unit;
        (0..self.rates[1].count()).all(|i| {
            let rate = self.rates[1].as_slice()[i];
            let defect = (rate - slope.as_slice()[i] / self.unit).abs() * length;
            let size = self.ends.end.value.as_slice()[i].abs() + rate.abs() * length;
            defect
                <= DEFECT
                    * (self
                        .weights
                        .allowed(i, &self.ends.start.value, &self.ends.end.value)
                        + NOISE * size)
        })
    }

    /// The state at a part of the step, and what it is rounded off.
    #[inline(always)]
    fn state_at(&self, theta: f64) -> Precise<F::State> {
        let s = theta * (self.ends.length() / self.unit);
        let mut change = self.rates[1].zeroed();
        for coefficient in self.expansion.coefficients[1..=self.order].iter().rev() {
            for (i, entry) in coefficient.as_slice().iter().enumerate() {
                let sum = &mut change.padded_mut()[i];
                *sum = math::mul_add(*sum, s, *entry);
            }
        }
        self.ends.start.advanced(|i| change.padded()[i] * s)
    }

    /// The coefficients of the last step, which was made abreast of others.
    fn expand_again(&mut self, field: &F) -> Result<(), Fault> {
        let (parameters, start) = (field.parameters(), row::<F>(&self.ends.start.value));
        let end = self.expansion.firsts;
        self.expansion
            .begin(field, &parameters, self.ends.t[0].t, &start)?;
        self.expansion
            .advance(field, &parameters, self.unit, self.order, &start);
        self.expansion.firsts = end;
        self.is_expanded = true;
        Ok(())
    }

    /// Puts the last good state back in place after a failure.
    fn retract(&mut self, field: &F) -> Result<(), StepFailure> {
        self.ends.retract();
        self.begin(field)
    }
}
