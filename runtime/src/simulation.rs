//! The driver: steps, cuts them where an effect proposes, lets the effects act, and ends in an [`Outcome`].

use core::ops::ControlFlow;

use crate::contract::System;
use crate::effects::{Change, Effect, Moment, StepView};
use crate::forces::{Along, Driven};
use crate::integrate::{Counters, Dop853, Stepper};
use crate::outcome::{Outcome, Run, StartError};
use crate::record::{Observer, Segment};
use crate::state::StateVector;

/// Steps a run may make unless told otherwise: more than a day's work for most systems, less than for ever.
pub const STEP_BUDGET: u64 = 1_000_000_000;

/// After an impact no step is longer than this many times the last flight, so that hops that shrink are followed
/// by steps of their own size.
const FLIGHTS: f64 = 4.0;

/// A system with an integrator and effects.
#[derive(Debug, Clone)]
pub struct Simulation<'a, Sys, Step, Effects> {
    system: &'a Sys,
    stepper: Step,
    effects: Effects,
    step_budget: u64,
}

impl<'a, Sys: System, Step: Stepper<Sys>, Effects: Effect<Sys>> Simulation<'a, Sys, Step, Effects> {
    /// Puts the three together. [`Scene::effects`](crate::Scene::effects) are the effects a system declares.
    pub fn new(system: &'a Sys, stepper: Step, effects: Effects) -> Self {
        Self {
            system,
            stepper,
            effects,
            step_budget: STEP_BUDGET,
        }
    }

    /// Ends runs after this many accepted steps instead of [`STEP_BUDGET`].
    #[must_use]
    pub fn with_step_budget(mut self, budget: u64) -> Self {
        self.step_budget = budget;
        self
    }

    /// The step that the integrator kept in the last run; `None` if it chooses every step anew.
    pub fn fixed_step(&self) -> Option<f64> {
        self.stepper.fixed_step()
    }

    /// The effects.
    pub fn effects(&mut self) -> &mut Effects {
        &mut self.effects
    }

    /// Runs from `state` at `t0` to `t_end`, showing `observer` what happens.
    ///
    /// # Errors
    /// [`StartError`]: times that are not finite or run backwards, a parameter against its declaration. Whatever
    /// happens after that is an [`Outcome`] with the last good state.
    pub fn run<O: Observer<Sys>>(
        &mut self,
        t0: f64,
        state: Sys::State,
        t_end: f64,
        observer: &mut O,
    ) -> Result<Run<Sys::State>, StartError> {
        if !(t0.is_finite() && t_end.is_finite() && t0 <= t_end) {
            return Err(StartError::Times { t0, t_end });
        }
        self.system.check_parameters()?;
        let mut course = Course {
            system: self.system,
            stepper: &mut self.stepper,
            effects: &mut self.effects,
            budget: self.step_budget,
            is_begun: false,
            t: t0,
            late: 0.0,
            flight: 0.0,
            state,
            counters: Counters::default(),
        };
        let outcome = match course.follow(t_end, observer) {
            Ok(()) => Outcome::Done,
            Err(outcome) => outcome,
        };
        Ok(Run {
            outcome,
            t: course.t,
            state: course.state,
            counters: course.counters,
        })
    }
}

/// A run on its way.
struct Course<'a, Sys: System, Step, Effects> {
    system: &'a Sys,
    stepper: &'a mut Step,
    effects: &'a mut Effects,
    budget: u64,
    /// Whether the integrator has made steps before.
    is_begun: bool,
    t: f64,
    /// The part of the time that `t` cannot hold: lengths of flights add up without losing it.
    late: f64,
    /// Time since the last cut, in full precision however short it is.
    flight: f64,
    state: Sys::State,
    counters: Counters,
}

impl<Sys: System, Step: Stepper<Sys>, Effects: Effect<Sys>> Course<'_, Sys, Step, Effects> {
    fn follow<O: Observer<Sys>>(&mut self, t_end: f64, observer: &mut O) -> Result<(), Outcome> {
        if let Some(component) = self
            .state
            .as_slice()
            .iter()
            .position(|value| !value.is_finite())
        {
            return Err(Outcome::NonFinite { component });
        }
        if let Some(coordinate) = self.system.outside_chart(&self.state) {
            return Err(Outcome::LeftChart { coordinate });
        }
        let mut now = Moment {
            system: self.system,
            t: self.t,
            state: &mut self.state,
            counters: &mut self.counters,
        };
        self.effects.begin(&mut now, observer)?;
        while self.t < t_end {
            match self.effects.forces() {
                None => self.drive(t_end, observer)?,
                Some(forces) => self.drive_under(forces, t_end, observer)?,
            }
        }
        Ok(())
    }

    /// Steps to the end, or to where the forces of the effects change.
    fn drive<O: Observer<Sys>>(&mut self, t_end: f64, observer: &mut O) -> Result<(), Outcome> {
        let (system, t, counters) = (self.system, self.t, &mut self.counters);
        match self.is_begun {
            false => self
                .stepper
                .start(system, t, &self.state, t_end, counters)?,
            true => self
                .stepper
                .restart(system, t, &self.state, f64::INFINITY, counters)?,
        }
        self.is_begun = true;
        let forces = self.effects.forces();
        while self.t < t_end {
            if self.counters.accepted >= self.budget {
                return Err(Outcome::StepBudget);
            }
            self.stepper.step(self.system, t_end, &mut self.counters)?;
            let mut view = StepView {
                system: self.system,
                counters: &mut self.counters,
                stepper: &mut *self.stepper,
            };
            match self.effects.propose(&mut view)? {
                None => self.pass(observer)?,
                Some(theta) => {
                    let limit = self.cut(theta, observer)?;
                    if self.effects.forces() != forces {
                        return Ok(());
                    }
                    let (t, counters) = (self.t, &mut self.counters);
                    self.stepper
                        .restart(self.system, t, &self.state, limit, counters)?;
                }
            }
        }
        Ok(())
    }

    /// Steps to the end, or to where the forces change. Whatever integrator was chosen, with [`Dop853`] at its
    /// tolerance: not every integrator takes forces that a system does not know.
    #[inline(never)]
    fn drive_under<O: Observer<Sys>>(
        &mut self,
        forces: Effects::Forces,
        t_end: f64,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let field = Driven {
            system: self.system,
            forces,
        };
        let mut stepper = Along {
            field: &field,
            stepper: Dop853::new(self.stepper.tolerance()),
        };
        let mut course = Course {
            system: self.system,
            stepper: &mut stepper,
            effects: &mut *self.effects,
            budget: self.budget,
            is_begun: false,
            t: self.t,
            late: self.late,
            flight: self.flight,
            state: self.state,
            counters: self.counters,
        };
        let end = course.drive(t_end, observer);
        let Course {
            t,
            late,
            flight,
            state,
            counters,
            ..
        } = course;
        (self.t, self.late, self.flight) = (t, late, flight);
        (self.state, self.counters) = (state, counters);
        end
    }

    /// The step passes whole.
    #[inline(always)]
    fn pass<O: Observer<Sys>>(&mut self, observer: &mut O) -> Result<(), Outcome> {
        if let Some(coordinate) = self.system.outside_chart(self.stepper.end_state()) {
            return Err(self.leave_chart(1.0, coordinate, observer));
        }
        self.t = self.stepper.t_end();
        self.flight += self.t - self.stepper.t_start();
        self.state = *self.stepper.end_state();
        let mut now = Moment {
            system: self.system,
            t: self.t,
            state: &mut self.state,
            counters: &mut self.counters,
        };
        if self.effects.settle(&mut now, false)? == Change::Changed {
            self.stepper
                .replace_end(self.system, &self.state, &mut self.counters)?;
        }
        self.show(observer)
    }

    /// The step ends at `theta`, where the effects act. Returns the longest step to go on with.
    #[inline(never)]
    fn cut<O: Observer<Sys>>(&mut self, theta: f64, observer: &mut O) -> Result<f64, Outcome> {
        if theta <= 0.0 {
            let mut now = Moment {
                system: self.system,
                t: self.t,
                state: &mut self.state,
                counters: &mut self.counters,
            };
            self.effects.act(theta, &mut now, observer)?;
            return Ok(f64::INFINITY);
        }
        let limit =
            FLIGHTS * (self.flight + theta * (self.stepper.t_end() - self.stepper.t_start()));
        self.flight = 0.0;
        self.arrive(theta)?;
        if let Some(coordinate) = self.system.outside_chart(&self.state) {
            return Err(self.leave_chart(theta, coordinate, observer));
        }
        let mut now = Moment {
            system: self.system,
            t: self.t,
            state: &mut self.state,
            counters: &mut self.counters,
        };
        self.effects.settle(&mut now, true)?;
        self.show(observer)?;
        let mut now = Moment {
            system: self.system,
            t: self.t,
            state: &mut self.state,
            counters: &mut self.counters,
        };
        self.effects.act(theta, &mut now, observer)?;
        Ok(limit)
    }

    /// Sets time and state to those at `theta`.
    fn arrive(&mut self, theta: f64) -> Result<(), Outcome> {
        let (start, end) = (self.stepper.t_start(), self.stepper.t_end());
        if theta >= 1.0 {
            self.t = end;
            self.state = *self.stepper.end_state();
            return Ok(());
        }
        self.stepper
            .prepare_dense(self.system, &mut self.counters)?;
        let length = theta * (end - start) + self.late;
        self.t = (start + length).min(end);
        self.late = length - (self.t - start);
        self.state = self.stepper.interpolate(theta);
        Ok(())
    }

    /// Shows the motion from the start of the step to the present.
    #[inline(always)]
    fn show<O: Observer<Sys>>(&mut self, observer: &mut O) -> Result<(), Outcome> {
        let t = [self.stepper.t_start(), self.t];
        let step = self.stepper.t_end() - t[0];
        let mut source = StepView {
            system: self.system,
            counters: &mut self.counters,
            stepper: &mut *self.stepper,
        };
        match observer.step(&mut Segment {
            t,
            end: &self.state,
            step,
            source: &mut source,
        }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Outcome::Stopped),
        }
    }

    /// At `theta` the motion is outside the chart: goes to the last state inside it, by bisection.
    #[cold]
    fn leave_chart<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        coordinate: usize,
        observer: &mut O,
    ) -> Outcome {
        match self.go_to_end_of_chart(theta, coordinate, observer) {
            Ok(coordinate) => Outcome::LeftChart { coordinate },
            Err(outcome) => outcome,
        }
    }

    /// Returns the coordinate that leaves the chart first.
    fn go_to_end_of_chart<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        coordinate: usize,
        observer: &mut O,
    ) -> Result<usize, Outcome> {
        self.stepper
            .prepare_dense(self.system, &mut self.counters)?;
        let (mut inside, mut outside, mut left) = (0.0, theta, coordinate);
        loop {
            let middle = 0.5 * (inside + outside);
            if middle <= inside || middle >= outside {
                break;
            }
            match self.system.outside_chart(&self.stepper.interpolate(middle)) {
                None => inside = middle,
                Some(coordinate) => (outside, left) = (middle, coordinate),
            }
        }
        self.arrive(inside)?;
        self.show(observer)?;
        Ok(left)
    }
}
