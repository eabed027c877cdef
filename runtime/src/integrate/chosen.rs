//! Dynamic dispatch: an integrator behind a pointer, chosen at run time.

use super::instant::Instant;
use super::stats::Counters;
use super::stepper::{GapAt, Rebound, Series, StepFailure, Stepper};
use super::tolerance::Tolerance;
use crate::contract::VectorField;
use crate::error::Fault;
use crate::jet::LENGTH;

/// An integrator that is chosen at run time.
///
/// Driver and effects are compiled once for all integrators used in this way. A program with forty systems and eight
/// integrators builds in a third less time. A step costs a few more calls through a pointer; the results are bitwise
/// equal.
// NOTE: every method is forwarded, including those with a default in `Stepper`.
pub struct Chosen<'a, F: VectorField> {
    stepper: &'a mut dyn Stepper<F>,
}

impl<'a, F: VectorField> Chosen<'a, F> {
    /// Wraps an integrator.
    pub fn new<S: Stepper<F>>(stepper: &'a mut S) -> Self {
        Self { stepper }
    }
}

impl<F: VectorField> Stepper<F> for Chosen<'_, F> {
    fn name(&self) -> &'static str {
        self.stepper.name()
    }

    fn tolerance(&self) -> Tolerance {
        self.stepper.tolerance()
    }

    fn max_step(&self) -> f64 {
        self.stepper.max_step()
    }

    fn start(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        t_end: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper.start(field, now, state, t_end, counters)
    }

    fn restart(
        &mut self,
        field: &F,
        now: Instant,
        state: &F::State,
        limit: f64,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper.restart(field, now, state, limit, counters)
    }

    fn step(&mut self, field: &F, t_end: f64, counters: &mut Counters) -> Result<(), StepFailure> {
        self.stepper.step(field, t_end, counters)
    }

    fn error(&self) -> f64 {
        self.stepper.error()
    }

    fn fixed_step(&self) -> Option<f64> {
        self.stepper.fixed_step()
    }

    fn replace_end(
        &mut self,
        field: &F,
        state: &F::State,
        counters: &mut Counters,
    ) -> Result<(), StepFailure> {
        self.stepper.replace_end(field, state, counters)
    }

    fn start_time(&self) -> Instant {
        self.stepper.start_time()
    }

    fn end_time(&self) -> Instant {
        self.stepper.end_time()
    }

    fn start_state(&self) -> &F::State {
        self.stepper.start_state()
    }

    fn end_state(&self) -> &F::State {
        self.stepper.end_state()
    }

    fn end_rates(&self) -> [&F::State; 2] {
        self.stepper.end_rates()
    }

    fn series(&self) -> Option<Series> {
        self.stepper.series()
    }

    fn gap_coefficient(&self, k: usize) -> &[f64] {
        self.stepper.gap_coefficient(k)
    }

    fn end_gaps(&self) -> &[f64] {
        self.stepper.end_gaps()
    }

    fn dense_ready(&self) -> bool {
        self.stepper.dense_ready()
    }

    fn prepare_dense(&mut self, field: &F, counters: &mut Counters) -> Result<(), Fault> {
        self.stepper.prepare_dense(field, counters)
    }

    fn interpolate(&self, theta: f64) -> F::State {
        self.stepper.interpolate(theta)
    }

    fn powers(&self, coefficients: &mut [F::State; LENGTH]) -> usize {
        self.stepper.powers(coefficients)
    }

    fn sway(&self) -> Option<F::State> {
        self.stepper.sway()
    }

    fn meet(
        &mut self,
        field: &F,
        theta: f64,
        gap: &GapAt<'_, F::State>,
        counters: &mut Counters,
    ) -> bool {
        self.stepper.meet(field, theta, gap, counters)
    }

    fn rebound(
        &mut self,
        field: &F,
        rebound: &Rebound<'_, F::State>,
        state: &mut F::State,
        counters: &mut Counters,
    ) {
        self.stepper.rebound(field, rebound, state, counters);
    }

    fn cut(&mut self, theta: f64) -> (Instant, F::State) {
        self.stepper.cut(theta)
    }
}
