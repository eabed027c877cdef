//! Taylor series of the motion, with the step sizes of Jorba and Zou.
//!
//! ```text
//! h_j = (tol e^-2.7 / |y_j|)^(1/j),   h = min(h_(p-1), h_p)
//! ```
//!
//! Here `|y_j|` is the largest coefficient of order `j` among the components of the state, each divided by the size
//! that its tolerance refers to. The order `p` is the one that costs the least work ([`order`]). The polynomial of the
//! step is its dense output. States inside the step are therefore as accurate as those at its ends, and cost no
//! evaluation.
//!
//! Coefficients are computed in a unit of time that is a power of two near the step. They neither overflow nor
//! underflow in any system of units, and the change of the unit is exact. The rounding error of state plus increment is
//! carried to the next step (compensated summation).
//!
//! No step is rejected because of its error estimate. A rate at the end that differs from the derivative of the
//! polynomial shows that the step passes a point where the motion is not analytic. The step is then halved, which needs
//! no new coefficients.
//!
//! References: A. Jorba and M. Zou, *A software package for the numerical integration of ODEs by means of high-order
//! Taylor methods*, Experimental Mathematics 14 (2005), sections 3.1 to 3.3; E. Hairer, C. Lubich, G. Wanner,
//! *Geometric Numerical Integration* (2006), VIII.5, for the carried rounding error.

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

/// The name of [`Taylor`] as a constant, independent of the type of the system.
pub const TAYLOR: &str = "taylor";

/// Largest step, in units of time of its expansion. Its powers stay far from overflow.
const LONGEST: f64 = (1 << 20) as f64;

/// Factor by which the unit of time shrinks when coefficients overflow.
const SHRINK: f64 = 1.0 / (1 << 16) as f64;

/// Largest growth of the step after one that was limited from outside.
const GROW: f64 = 8.0;

/// Largest accepted difference between the rate and the derivative of the polynomial at the end of a step, in units of
/// the allowed error. The truncation error of a regular step is a small fraction of it.
const DEFECT: f64 = 1024.0;

/// Additional rounding error accepted in a rate, relative to the size of its component.
const NOISE: f64 = 64.0 * f64::EPSILON;

/// Integrator by Taylor series, whose recurrences are generated.
///
/// # Examples
///
/// ```
/// use dalembert::{Simulation, System, Taylor, Tolerance};
///
/// dalembert::model! {
///     pub Oscillator {
///         coordinates { x; }
///         lagrangian = (dot(x)^2 - x^2)/2;
///     }
/// }
///
/// let system = Oscillator::default();
/// let start = system.state(0.0, &[1.0].into(), &[0.0].into())?;
/// let integrator = Taylor::new(Tolerance::new(1e-15)?);
/// let run = Simulation::new(&system, integrator, ()).run(0.0, start, 10.0, &mut ())?;
/// assert!((run.state[0] - 10.0_f64.cos()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Taylor<F: TaylorField> {
    tolerance: Tolerance,
    /// Order of the series; set at the start of a run.
    order: usize,
    given_order: Option<usize>,
    max_step: f64,
    first_step: Option<f64>,
    weights: Weights<F::State>,
    /// Unit of time of the present coefficients: a power of two.
    unit: f64,
    /// Unit of time of the coefficients of the next step: a power of two.
    next_unit: f64,
    /// Temporary limit of the step length, after a jump and at the start.
    limit: f64,
    /// Estimate of the error of the last step divided by the allowed error; an upper bound unless the step has the
    /// least length.
    error: f64,
    ends: Ends<F::State>,
    rates: [F::State; 2],
    expansion: Expansion<F, f64>,
    /// True if the coefficients of the last step are available. After a step in SIMD lanes they may be missing.
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
    /// An integrator with this tolerance. At the start of a run, its order is chosen from the tolerance and the work of
    /// the system's series.
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

    /// Sets the order of the series, clamped to the range from 3 to 32, in place of the chosen one.
    #[must_use]
    pub fn with_order(mut self, order: usize) -> Self {
        self.given_order = Some(order.clamp(LEAST_ORDER, LENGTH - 1));
        self
    }

    /// Limits the length of steps to `max_step`, in units of time; infinity means no limit. A pulse of a force may
    /// begin and end inside a step. It is detected if it lasts longer than `max_step`.
    ///
    /// # Errors
    /// [`MaxStepError`] if `max_step` is not positive.
    pub fn with_max_step(mut self, max_step: f64) -> Result<Self, MaxStepError> {
        self.max_step = check_max_step(max_step)?;
        Ok(self)
    }

    /// Limits the length of the first step. Values that are not positive and finite are ignored.
    #[must_use]
    pub fn with_first_step(mut self, first_step: f64) -> Self {
        self.first_step = (first_step > 0.0 && first_step.is_finite()).then_some(first_step);
        self
    }

    /// Order of the series that this integrator uses for a system.
    pub fn order_for(&self, field: &F) -> usize {
        let chosen = || order(self.tolerance.relative(), field.work());
        self.given_order.unwrap_or_else(chosen)
    }

    /// Sets `(now, state)` as the end of a step, at the start of a run or after a jump.
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

    /// Evaluates the rate and the other functions at the end of the step.
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

    /// Computes the coefficients at the start of the step. Returns the step length that they allow, in units of time.
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

    /// Step length that the last two coefficients allow, in units of time.
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

    /// Step length that the sizes of the last two coefficients allow, in units of time. The sizes are relative to the
    /// tolerance.
    #[inline(always)]
    fn reach_of(&self, sizes: [f64; 2]) -> f64 {
        let [last, before] = [(0, self.order), (1, self.order - 1)]
            .map(|(j, order)| (PART_OF_TOLERANCE - rough::log2(sizes[j])) * INVERSES[order]);
        rough::exp2(last.min(before))
    }

    /// Makes the end of the last step the start of the next.
    #[inline(always)]
    fn set_out(&mut self) {
        self.ends.move_on();
        self.rates[0] = self.rates[1];
        self.unit = self.next_unit;
    }

    /// Length of the step: the reach of the coefficients, limited by the bounds on steps.
    #[inline(always)]
    fn length(&self, reach: f64) -> f64 {
        let least = least_step(self.ends.t[0].t);
        reach.min(self.max_step).min(self.limit).max(least)
    }

    /// Unit of time of the series after a step whose coefficients allow the length `h`.
    ///
    /// NOTE: a motion under constant forces allows any length. Without the end of the run as a limit, the unit would grow
    /// with every impact until its powers overflow.
    #[inline(always)]
    fn unit_after(&self, h: f64, t_end: f64) -> f64 {
        rough::power_of_two(h.min(t_end - self.ends.t[0].t))
    }

    /// Records an accepted step. `made` is its length, `reach` the length that its coefficients allow.
    #[inline(always)]
    fn accept(&mut self, made: f64, reach: f64, counters: &mut Counters) {
        counters.accepted += 1;
        // The local error grows with the power `order + 1` of the step, which is at least 4.
        let part = made / reach;
        self.error = (part * part) * (part * part);
        self.limit = if made < reach {
            GROW * made.max(self.limit.min(reach))
        } else {
            f64::INFINITY
        };
    }

    /// Computes the end of the step at `theta` units of time. Returns the derivative of the polynomial there.
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

    /// True if the end of a step of `theta` units of time satisfies the vector field; see `is_motion`.
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

    /// True if the derivative of the polynomial at the end of a step equals the rate there, within [`DEFECT`] times the
    /// allowed error and rounding.
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

    /// The state at the fraction `theta` of the step, with its rounding error.
    #[inline(always)]
    fn state_at(&self, theta: f64) -> Precise<F::State> {
        let s = theta * (self.ends.length() / self.unit);
        let mut change = self.rates[1].zeroed();
        for coefficient in self.expansion.coefficients[1..=self.order].iter().rev() {
            let (sums, entries) = (change.padded_mut(), coefficient.padded());
            coefficient.for_each_place(|i| sums[i] = math::mul_add(sums[i], s, entries[i]));
        }
        self.ends.start.advanced(|i| change.padded()[i] * s)
    }

    /// Recomputes the coefficients of the last step, which was made in SIMD lanes.
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

    /// Restores the last accepted state after a failure.
    fn retract(&mut self, field: &F) -> Result<(), StepFailure> {
        self.ends.retract();
        self.begin(field)
    }
}
