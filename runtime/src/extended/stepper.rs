//! Adapter: gives a flight in extended precision the interface of an integrator in doubles, for the driver and its
//! effects.

use core::cell::RefCell;

use super::flight::{Flight, rounded};
use crate::contract::Variational;
use crate::error::Fault;
use crate::integrate::controller::{RETREAT, landing, least_step, least_trial};
use crate::integrate::rough::power_of_two;
use crate::integrate::{Counters, Instant, Series, StepFailure, Stepper, Tolerance};
use crate::jet::LENGTH;
use crate::math;
use crate::numbers::Row;
use crate::state::StateVector;
use dalembert_numbers::Extended;

/// Largest factor by which the step grows after a step that was limited from outside.
const GROW: f64 = 8.0;

/// The steps of a flight, rounded to doubles.
pub(super) struct Rounded<'r, 'a, Sys: Variational, const PARTS: usize> {
    flight: &'r RefCell<Flight<'a, Sys, PARTS>>,
    order: usize,
    unit: f64,
    theta: f64,
    /// Temporary limit of the step length after a jump.
    limit: f64,
    t: [Instant; 2],
    states: [Sys::State; 2],
    rates: [Sys::State; 2],
    /// Difference between the extended state at the start and its rounded value.
    rest: Sys::State,
    coefficients: [Sys::State; LENGTH],
    gaps: [Sys::Gaps<f64>; LENGTH],
    end_gaps: Sys::Gaps<f64>,
}

impl<'r, 'a, Sys: Variational, const PARTS: usize> Rounded<'r, 'a, Sys, PARTS> {
    pub(super) fn new(flight: &'r RefCell<Flight<'a, Sys, PARTS>>) -> Self {
        let zeros = Sys::State::zeros(Sys::State::CAPACITY);
        Self {
            flight,
            order: 1,
            unit: 1.0,
            theta: 0.0,
            limit: f64::INFINITY,
            t: [Instant::default(); 2],
            states: [zeros; 2],
            rates: [zeros; 2],
            rest: zeros,
            coefficients: [zeros; LENGTH],
            gaps: [Sys::Gaps::<f64>::zeros(Sys::Gaps::<f64>::CAPACITY); LENGTH],
            end_gaps: Sys::Gaps::<f64>::zeros(Sys::Gaps::<f64>::CAPACITY),
        }
    }

    /// Reads the present time and state of the flight, at the end of a step or after a transition.
    fn place(&mut self) -> Result<(), StepFailure> {
        self.flight.borrow_mut().begin()?;
        self.take_end();
        (self.t[0], self.states[0], self.rates[0]) = (self.t[1], self.states[1], self.rates[1]);
        Ok(())
    }

    fn take_end(&mut self) {
        let flight = self.flight.borrow();
        let end = &flight.ends[1];
        self.t[1] = instant(end.t);
        self.states[1] = end.rounded();
        self.rates[1] = rounded(flight.expansion.rate());
        round_into(self.end_gaps.as_mut_slice(), flight.expansion.begun_gaps());
    }

    /// Reads the coefficients of a step.
    fn take_series(&mut self) {
        let flight = self.flight.borrow();
        (self.order, self.unit) = (flight.order, flight.unit);
        for k in 0..=self.order {
            let row = flight.expansion.coefficients[k].as_slice();
            self.coefficients[k] = rounded(row);
            let gaps = flight.expansion.gaps[k].as_slice();
            round_into(self.gaps[k].as_mut_slice(), gaps);
        }
        let start = flight.ends[0].state.as_slice();
        for (entry, number) in self.rest.as_mut_slice().iter_mut().zip(start) {
            *entry = (*number - Extended::from(number.nearest())).nearest();
        }
    }
}

/// A time as a double and a remainder.
fn instant<const PARTS: usize>(t: Extended<PARTS>) -> Instant {
    let first = t.nearest();
    Instant {
        t: first,
        rest: (t - Extended::from(first)).nearest(),
    }
}

fn round_into<const PARTS: usize>(doubles: &mut [f64], numbers: &[Extended<PARTS>]) {
    for (double, number) in doubles.iter_mut().zip(numbers) {
        *double = number.nearest();
    }
}

impl<Sys: Variational, const PARTS: usize> Stepper<Sys> for Rounded<'_, '_, Sys, PARTS> {
    fn name(&self) -> &'static str {
        "extended"
    }

    fn tolerance(&self) -> Tolerance {
        Tolerance::LEAST
    }

    fn start(
        &mut self,
        _: &Sys,
        _: Instant,
        _: &Sys::State,
        _: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        counters.rate_evaluations += 1;
        self.place()
    }

    /// NOTE: the present state of the flight is the start. The driver passes a rounded copy of it, which is ignored.
    fn restart(
        &mut self,
        _: &Sys,
        now: Instant,
        _: &Sys::State,
        limit: f64,
        _: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.limit = limit;
        self.flight.borrow_mut().settle(now == self.t[0])?;
        self.place()
    }

    fn step(&mut self, _: &Sys, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        let t = self.t[1];
        (self.t[0], self.states[0], self.rates[0]) = (t, self.states[1], self.rates[1]);
        let flight = self.flight;
        let mut flight = flight.borrow_mut();
        counters.expansions += 1;
        counters.coefficients += flight.order as u64;
        let least = least_trial(t.t);
        let reach = flight.expand(Instant::new(t_end).since(t))?;
        let mut length = reach.min(self.limit).max(least_step(t.t));
        loop {
            let (made, arrival) = landing(t, length, t_end);
            length = made;
            let exact = match arrival == Instant::new(t_end) {
                true => Extended::from(t_end) - flight.ends[0].t,
                false => Extended::from(length),
            };
            counters.rate_evaluations += 1;
            let made = flight.make(exact);
            if let Ok(true) = made {
                break;
            }
            counters.rejected += 1;
            length *= if made.is_ok() { 0.5 } else { RETREAT };
            if length < least {
                flight.retract()?;
                return Err(made.err().unwrap_or(StepFailure::StepUnderflow { t: t.t }));
            }
        }
        counters.accepted += 1;
        self.theta = flight.theta;
        self.limit = match length < reach {
            true => GROW * length.max(self.limit.min(reach)),
            false => f64::INFINITY,
        };
        drop(flight);
        self.take_series();
        self.take_end();
        // The next series are computed in a unit of time near the length of this step.
        self.flight.borrow_mut().next_unit = power_of_two(length);
        Ok(())
    }

    /// NOTE: this function does nothing. A projection corrects the rounded state; the flight satisfies the constraints
    /// to all its digits and continues from its own state.
    fn replace_end(
        &mut self,
        _: &Sys,
        _: &Sys::State,
        _: &mut Counters,
    ) -> Result<(), StepFailure> {
        Ok(())
    }

    fn start_time(&self) -> Instant {
        self.t[0]
    }

    fn end_time(&self) -> Instant {
        self.t[1]
    }

    fn start_state(&self) -> &Sys::State {
        &self.states[0]
    }

    fn end_state(&self) -> &Sys::State {
        &self.states[1]
    }

    fn end_rates(&self) -> [&Sys::State; 2] {
        let [start, end] = &self.rates;
        [start, end]
    }

    fn series(&self) -> Option<Series> {
        Some(Series {
            unit: self.unit,
            order: self.order,
        })
    }

    fn gap_coefficient(&self, k: usize) -> &[f64] {
        self.gaps[k].as_slice()
    }

    fn end_gaps(&self) -> &[f64] {
        self.end_gaps.as_slice()
    }

    fn dense_ready(&self) -> bool {
        true
    }

    fn prepare_dense(&mut self, _: &Sys, _: &mut Counters) -> Result<(), Fault> {
        Ok(())
    }

    fn interpolate(&self, theta: f64) -> Sys::State {
        let s = theta * self.theta;
        let mut state = Sys::State::zeros(Sys::State::CAPACITY);
        for coefficient in self.coefficients[1..=self.order].iter().rev() {
            for (sum, entry) in state.as_mut_slice().iter_mut().zip(coefficient.as_slice()) {
                *sum = math::mul_add(*sum, s, *entry);
            }
        }
        let starts = self.states[0].as_slice().iter().zip(self.rest.as_slice());
        for (sum, (start, rest)) in state.as_mut_slice().iter_mut().zip(starts) {
            *sum = start + (*sum * s + rest);
        }
        state
    }

    fn powers(&self, coefficients: &mut [Sys::State; LENGTH]) -> usize {
        let mut power = 1.0;
        let known = &self.coefficients[..=self.order];
        for (to, from) in coefficients.iter_mut().zip(known) {
            let scaled = to.as_mut_slice().iter_mut().zip(from.as_slice());
            scaled.for_each(|(to, from)| *to = power * from);
            power *= self.theta;
        }
        self.order
    }

    fn cut(&mut self, theta: f64) -> (Instant, Sys::State) {
        self.flight.borrow_mut().cut = Some(theta * self.theta);
        match theta >= 1.0 {
            true => (self.t[1], self.states[1]),
            false => (
                self.t[0].after(theta * self.length()),
                self.interpolate(theta),
            ),
        }
    }
}
