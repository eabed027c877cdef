//! The step interface of [`Taylor`].

use super::{LONGEST, TAYLOR, Taylor};
use crate::contract::TaylorField;
use crate::error::Fault;
use crate::integrate::controller::{RETREAT, landing_within, least_trial};
use crate::integrate::instant::Instant;
use crate::integrate::precise::Precise;
use crate::integrate::rough::power_of_two;
use crate::integrate::stats::Counters;
use crate::integrate::stepper::{Series, StepFailure, Stepper};
use crate::integrate::tolerance::Tolerance;
use crate::jet::LENGTH;
use crate::numbers::Row;
use crate::state::StateVector;

impl<F: TaylorField> Stepper<F> for Taylor<F> {
    fn name(&self) -> &'static str {
        TAYLOR
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
        counters.rate_evaluations += 1;
        self.order = self.order_for(field);
        self.expansion.make_room(field);
        self.place(field, now, Precise::new(*state))?;
        self.limit = self.first_step.unwrap_or(f64::INFINITY);
        let size = self.weights.norm(state, |i| state.as_slice()[i]);
        let speed = self.weights.norm(state, |i| self.rates[1].as_slice()[i]);
        let time = size / speed;
        let known = time > 0.0 && time.is_finite();
        let time = if known { time } else { t_end - now.t };
        self.next_unit = power_of_two(time.min(t_end - now.t));
        Ok(())
    }

    #[inline]
    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        _: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.limit = limit;
        let precise = self.ends.kept(state);
        self.place(field, now, precise)
    }

    #[inline]
    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.set_out();
        self.is_expanded = true;
        let t = self.ends.t[0].t;
        let reach = self.expand(field, counters)?.min(LONGEST) * self.unit;
        let mut h = self.length(reach);
        self.next_unit = self.unit_after(h, t_end);
        loop {
            let (made, arrival) = landing_within(self.max_step, self.ends.t[0], h, t_end);
            let attempt = self.attempt(field, made / self.unit, arrival, counters);
            if let Ok(true) = attempt {
                self.accept(made, reach, counters);
                return Ok(());
            }
            counters.rejected += 1;
            h = made * if attempt.is_ok() { 0.5 } else { RETREAT };
            if h < least_trial(t) {
                self.retract(field)?;
                return Err(attempt.err().unwrap_or(StepFailure::StepUnderflow { t }));
            }
        }
    }

    fn error(&self) -> f64 {
        self.error
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.ends.end = self.ends.end.kept(state);
        counters.rate_evaluations += 1;
        self.begin(field)
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
        let [start, end] = &self.rates;
        [start, end]
    }

    #[inline(always)]
    fn series(&self) -> Option<Series> {
        Some(Series {
            unit: self.unit,
            order: self.order,
        })
    }

    #[inline(always)]
    fn gap_coefficient(&self, k: usize) -> &[f64] {
        self.expansion.gaps[k].as_slice()
    }

    #[inline(always)]
    fn end_gaps(&self) -> &[f64] {
        self.expansion.begun_gaps()
    }

    #[inline(always)]
    fn dense_ready(&self) -> bool {
        self.is_expanded
    }

    #[inline(always)]
    fn prepare_dense(&mut self, field: &F, _: &mut Counters) -> Result<(), Fault> {
        match self.is_expanded {
            true => Ok(()),
            false => self.expand_again(field),
        }
    }

    #[inline(always)]
    fn interpolate(&self, theta: f64) -> F::State {
        self.state_at(theta).value
    }

    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize {
        let part = self.ends.length() / self.unit;
        let mut power = 1.0;
        let known = &self.expansion.coefficients[..=self.order];
        for (to, from) in coefficients.iter_mut().zip(known) {
            let to = to.padded_mut();
            from.for_each_place(|i| to[i] = power * from.padded()[i]);
            power *= part;
        }
        self.order
    }

    #[inline]
    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        let inside = match theta >= 1.0 {
            true => self.ends.end,
            false => self.state_at(theta),
        };
        self.ends.cut(theta, self.ends.length(), || inside)
    }
}
