//! Integrators behind a pointer: one of several that is chosen while a program runs.

use super::instant::Instant;
use super::stats::Counters;
use super::stepper::{Series, StepFailure, Stepper};
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;

/// An integrator that is chosen while the program runs.
///
/// Driver and effects are compiled once for all integrators that are used so, which is most of the time that a program with
/// many systems takes to build; a step costs a few calls through a pointer more. What it computes is the same to the bit.
pub struct Chosen<'a, F: VectorField> {
    steps: &'a mut dyn Steps<F>,
}

impl<'a, F: VectorField> Chosen<'a, F> {
    /// This integrator.
    pub fn new<S: Stepper<F>>(stepper: &'a mut S) -> Self {
        Self { steps: stepper }
    }
}

/// What [`Stepper`] has, without its name. Every method is there, also those that it has an answer for.
trait Steps<F: VectorField> {
    fn tolerance(&self) -> Tolerance;

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure>;

    fn fixed_step(&self) -> Option<f64>;

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure>;

    fn start_time(&self) -> Instant;

    fn end_time(&self) -> Instant;

    fn start_state(&self) -> &F::State;

    fn end_state(&self) -> &F::State;

    fn end_rates(&self) -> [&F::State; 2];

    fn series(&self) -> Option<Series>;

    fn gap_coefficient(&self, k: usize) -> &[f64];

    fn end_gaps(&self) -> &[f64];

    fn dense_ready(&self) -> bool;

    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault>;

    fn interpolate(&self, theta: f64) -> F::State;

    fn cut(&mut self, theta: f64) -> (Instant, F::State);
}

impl<F: VectorField, S: Stepper<F>> Steps<F> for S {
    fn tolerance(&self) -> Tolerance {
        <S as Stepper<F>>::tolerance(self)
    }

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        <S as Stepper<F>>::start(self, field, now, state, t_end, counters)
    }

    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        <S as Stepper<F>>::restart(self, field, now, state, limit, counters)
    }

    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        <S as Stepper<F>>::step(self, field, t_end, counters)
    }

    fn fixed_step(&self) -> Option<f64> {
        <S as Stepper<F>>::fixed_step(self)
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        <S as Stepper<F>>::replace_end(self, field, state, counters)
    }

    fn start_time(&self) -> Instant {
        <S as Stepper<F>>::start_time(self)
    }

    fn end_time(&self) -> Instant {
        <S as Stepper<F>>::end_time(self)
    }

    fn start_state(&self) -> &F::State {
        <S as Stepper<F>>::start_state(self)
    }

    fn end_state(&self) -> &F::State {
        <S as Stepper<F>>::end_state(self)
    }

    fn end_rates(&self) -> [&F::State; 2] {
        <S as Stepper<F>>::end_rates(self)
    }

    fn series(&self) -> Option<Series> {
        <S as Stepper<F>>::series(self)
    }

    fn gap_coefficient(&self, k: usize) -> &[f64] {
        <S as Stepper<F>>::gap_coefficient(self, k)
    }

    fn end_gaps(&self) -> &[f64] {
        <S as Stepper<F>>::end_gaps(self)
    }

    fn dense_ready(&self) -> bool {
        <S as Stepper<F>>::dense_ready(self)
    }

    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault> {
        <S as Stepper<F>>::prepare_dense(self, field, counters)
    }

    fn interpolate(&self, theta: f64) -> F::State {
        <S as Stepper<F>>::interpolate(self, theta)
    }

    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        <S as Stepper<F>>::cut(self, theta)
    }
}

impl<F: VectorField> Stepper<F> for Chosen<'_, F> {
    const NAME: &'static str = "chosen";

    fn tolerance(&self) -> Tolerance {
        self.steps.tolerance()
    }

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.steps.start(field, now, state, t_end, counters)
    }

    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.steps.restart(field, now, state, limit, counters)
    }

    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.steps.step(field, t_end, counters)
    }

    fn fixed_step(&self) -> Option<f64> {
        self.steps.fixed_step()
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.steps.replace_end(field, state, counters)
    }

    fn start_time(&self) -> Instant {
        self.steps.start_time()
    }

    fn end_time(&self) -> Instant {
        self.steps.end_time()
    }

    fn start_state(&self) -> &F::State {
        self.steps.start_state()
    }

    fn end_state(&self) -> &F::State {
        self.steps.end_state()
    }

    fn end_rates(&self) -> [&F::State; 2] {
        self.steps.end_rates()
    }

    fn series(&self) -> Option<Series> {
        self.steps.series()
    }

    fn gap_coefficient(&self, k: usize) -> &[f64] {
        self.steps.gap_coefficient(k)
    }

    fn end_gaps(&self) -> &[f64] {
        self.steps.end_gaps()
    }

    fn dense_ready(&self) -> bool {
        self.steps.dense_ready()
    }

    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault> {
        self.steps.prepare_dense(field, counters)
    }

    fn interpolate(&self, theta: f64) -> F::State {
        self.steps.interpolate(theta)
    }

    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        self.steps.cut(theta)
    }
}
