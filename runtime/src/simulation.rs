//! The driver: makes steps, cuts them where an effect proposes a cut, lets the effects act, and ends in an [`Outcome`].

use core::ops::ControlFlow;

use crate::chart::{self, Exit};
use crate::contract::{RankDrop, System};
use crate::effects::{Change, Effect, Moment, StepView};
use crate::error::Fault;
use crate::events::first::narrowed;
use crate::forces::{Along, Driven};
use crate::independence;
use crate::integrate::controller::least_step;
use crate::integrate::{Chosen, Counters, Dop853, Instant, Rebound, Stepper};
use crate::narrow::{self, Resolved};
use crate::outcome::{Outcome, StartError};
use crate::record::{Observer, Segment};
use crate::run::Run;
use crate::state::StateVector;

/// Maximum number of steps in a row that are too short to be examined.
const MOMENTS: u32 = 1000;

/// Largest count of steps with places where the rates have no bounds. Each such step counts [`POLE`], every other step
/// lowers the count by 1. A larger count means that the steps cross a jump of the rates back and forth: motion that is turned
/// back there does not go on.
const POLES: u32 = 300;
const POLE: u32 = 3;

/// Default limit of the number of steps of a run.
pub const STEP_BUDGET: u64 = 1_000_000_000;

/// Longest step after an impact, as a multiple of the last flight: shrinking hops get steps of their own size.
const FLIGHTS: f64 = 4.0;

/// Maximum number of times that a settled state is moved to what was proposed. Newton's iteration doubles the number of
/// correct digits each time.
const AIMS: u32 = 4;

/// A step during which a force acts only between two stages is repeated. The repeated step ends before the force if
/// that leaves at least this fraction of the length, and has this fraction of the length otherwise.
const AHEAD: f64 = 1.0 / 8.0;

/// Factor of the length of a step that is repeated because its dense output meets dependent constraints. The stages of
/// the shorter step are at other times.
const SHORTER: f64 = 0.3;

/// A system with an integrator and effects.
///
/// # Examples
///
/// ```
/// use dalembert::{Outcome, Scene, Simulation, System, Taylor, Tolerance};
///
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// let pendulum = Pendulum::default();
/// let state = pendulum.state(0.0, &[1.0].into(), &[0.0].into())?;
/// let integrator = Taylor::new(Tolerance::new(1e-12)?);
/// let mut simulation = Simulation::new(&pendulum, integrator, pendulum.effects());
/// let run = simulation.run(0.0, state, 20.0, &mut ())?;
/// assert_eq!(run.outcome, Outcome::Done);
/// assert!((pendulum.energy(run.t, &run.state)? + 1.0_f64.cos()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Simulation<'a, Sys, Step, Effects> {
    system: &'a Sys,
    stepper: Step,
    effects: Effects,
    step_budget: u64,
}

impl<'a, Sys: System, Step: Stepper<Sys>, Effects: Effect<Sys>> Simulation<'a, Sys, Step, Effects> {
    /// Combines a system, an integrator and effects. [`Scene::effects`](crate::Scene::effects) are the declared
    /// effects.
    pub fn new(system: &'a Sys, stepper: Step, effects: Effects) -> Self {
        Self {
            system,
            stepper,
            effects,
            step_budget: STEP_BUDGET,
        }
    }

    /// Sets the number of accepted steps after which a run ends, instead of [`STEP_BUDGET`].
    #[must_use]
    pub fn with_step_budget(mut self, budget: u64) -> Self {
        self.step_budget = budget;
        self
    }

    /// The step size of the last run with a fixed step; `None` with step-size control.
    pub fn fixed_step(&self) -> Option<f64> {
        self.stepper.fixed_step()
    }

    /// The effects.
    pub fn effects(&mut self) -> &mut Effects {
        &mut self.effects
    }

    /// Runs from `state` at `t0` to `t_end`, and reports the run to `observer`.
    ///
    /// # Errors
    /// [`StartError`] for times that are not finite or run backwards, or a parameter that contradicts its
    /// declaration. Any later failure is an [`Outcome`] with the last good state.
    pub fn run<O: Observer<Sys>>(
        &mut self,
        t0: f64,
        state: Sys::State,
        t_end: f64,
        observer: &mut O,
    ) -> Result<Run<Sys::State>, StartError> {
        check_start(self.system, t0, t_end)?;
        let mut progress = Progress::new(t0, state);
        let mut course = Course {
            system: self.system,
            stepper: &mut self.stepper,
            effects: &mut self.effects,
            budget: self.step_budget,
            progress: &mut progress,
        };
        let outcome = match course.follow(t_end, observer) {
            Ok(()) => Outcome::Done,
            Err(outcome) => outcome,
        };
        Ok(progress.ended(outcome))
    }
}

/// Checks that a run may begin with these times and parameters.
pub(crate) fn check_start(system: &impl System, t0: f64, t_end: f64) -> Result<(), StartError> {
    if !(t0.is_finite() && t_end.is_finite() && t0 <= t_end) {
        return Err(StartError::Times { t0, t_end });
    }
    Ok(system.check_parameters()?)
}

/// True if the energy of a state is a finite number.
fn has_energy<Sys: System>(system: &Sys, t: f64, state: &Sys::State) -> bool {
    system.energy(t, state).is_ok_and(f64::is_finite)
}

/// Progress of a run.
pub(crate) struct Progress<S> {
    /// True if the integrator has been started.
    is_begun: bool,
    /// True if the energy is checked: it is finite at the start, and the steps are of fixed size without an error
    /// estimate.
    watches_energy: bool,
    /// True if steps are checked for forces that act only between their stages.
    watches_rates: bool,
    pub(crate) t: f64,
    /// Rounding error of `t`, kept so that lengths of steps and flights add up without loss.
    rest: f64,
    /// Time since the last cut. It keeps its precision however short it is.
    flight: f64,
    /// Number of steps in a row that are too short to be examined for such forces.
    moments: u32,
    /// Count of recent steps with places where the rates have no bounds; see [`POLES`].
    poles: u32,
    pub(crate) state: S,
    pub(crate) counters: Counters,
}

impl<S> Progress<S> {
    pub(crate) fn new(t: f64, state: S) -> Self {
        Self {
            is_begun: false,
            watches_energy: false,
            watches_rates: false,
            t,
            rest: 0.0,
            flight: 0.0,
            moments: 0,
            poles: 0,
            state,
            counters: Counters::default(),
        }
    }

    /// The time with its rounding error.
    fn now(&self) -> Instant {
        Instant {
            t: self.t,
            rest: self.rest,
        }
    }

    /// Sets the time.
    fn set_time(&mut self, Instant { t, rest }: Instant) {
        (self.t, self.rest) = (t, rest);
    }

    pub(crate) fn ended(self, outcome: Outcome) -> Run<S> {
        Run {
            outcome,
            t: self.t,
            state: self.state,
            counters: self.counters,
        }
    }
}

/// A run in progress.
pub(crate) struct Course<'a, Sys: System, Step, Effects> {
    pub(crate) system: &'a Sys,
    pub(crate) stepper: &'a mut Step,
    pub(crate) effects: &'a mut Effects,
    pub(crate) budget: u64,
    pub(crate) progress: &'a mut Progress<Sys::State>,
}

/// Action after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Next {
    /// Another step.
    Step,
    /// Forces of effects begin or end: restart the integrator.
    Forces,
}

impl<Sys: System, Step: Stepper<Sys>, Effects: Effect<Sys>> Course<'_, Sys, Step, Effects> {
    fn follow<O: Observer<Sys>>(&mut self, t_end: f64, observer: &mut O) -> Result<(), Outcome> {
        self.begin(observer)?;
        while self.progress.t < t_end {
            match self.effects.forces() {
                None => self.drive(t_end, observer)?,
                Some(forces) => self.drive_under(forces, t_end, observer)?,
            }
        }
        Ok(())
    }

    /// Prepares the run before its first step.
    pub(crate) fn begin<O: Observer<Sys>>(&mut self, observer: &mut O) -> Result<(), Outcome> {
        let Progress {
            t,
            state,
            counters,
            watches_energy,
            watches_rates,
            ..
        } = &mut *self.progress;
        if let Some(component) = state.as_slice().iter().position(|value| !value.is_finite()) {
            return Err(Outcome::NonFinite { component });
        }
        if let Some(coordinate) = self.system.outside_chart(state) {
            return Err(Outcome::LeftChart { coordinate });
        }
        *watches_rates = self.system.can_be_narrow() && self.system.has_narrow_rates();
        *watches_energy = self.stepper.fixed_step().is_some() && has_energy(self.system, *t, state);
        let mut now = Moment {
            system: self.system,
            t: *t,
            state,
            counters,
        };
        self.effects.begin(&mut now, observer)
    }

    /// Makes steps to the end, or to the next change of the effects' forces.
    fn drive<O: Observer<Sys>>(&mut self, t_end: f64, observer: &mut O) -> Result<(), Outcome> {
        self.set_off(t_end)?;
        let forces = self.effects.forces();
        while self.progress.t < t_end {
            self.check_budget()?;
            self.stepper
                .step(self.system, t_end, &mut self.progress.counters)?;
            if self.go_on(&forces, observer)? == Next::Forces {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Starts or restarts the integrator at the present state of the run.
    pub(crate) fn set_off(&mut self, t_end: f64) -> Result<(), Outcome> {
        let now = self.progress.now();
        let Progress {
            is_begun,
            state,
            counters,
            ..
        } = &mut *self.progress;
        match *is_begun {
            false => self
                .stepper
                .start(self.system, now, state, t_end, counters)?,
            true => self
                .stepper
                .restart(self.system, now, state, f64::INFINITY, counters)?,
        }
        *is_begun = true;
        Ok(())
    }

    pub(crate) fn check_budget(&self) -> Result<(), Outcome> {
        match self.progress.counters.accepted >= self.budget {
            true => Err(Outcome::StepBudget),
            false => Ok(()),
        }
    }

    /// Applies the effects to the step just made under `forces`, and returns the next action.
    pub(crate) fn go_on<O: Observer<Sys>>(
        &mut self,
        forces: &Option<Effects::Forces>,
        observer: &mut O,
    ) -> Result<Next, Outcome> {
        if self.system.can_lose_rank() && self.shorten_where_dependent()? {
            return Ok(Next::Step);
        }
        let is_checked = self.system.can_be_narrow() && self.progress.watches_rates;
        if is_checked && forces.is_none() && self.shorten_where_narrow()? {
            return Ok(Next::Step);
        }
        if forces.is_some() && self.shorten_where_hidden()? {
            return Ok(Next::Step);
        }
        let mut view = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        let proposed = match self.effects.propose(&mut view) {
            Err(outcome @ Outcome::UndefinedGap { .. }) => {
                return self.shorten_where_undefined(outcome);
            }
            proposed => proposed?,
        };
        if let Some(exit) = chart::exit(&mut view, proposed.unwrap_or(1.0))? {
            return Err(self.leave_chart(exit, observer));
        }
        if self.system.can_lose_rank() {
            self.keep_rank(proposed.unwrap_or(1.0), observer)?;
        }
        let Some(theta) = proposed else {
            self.pass(observer)?;
            return Ok(Next::Step);
        };
        let limit = self.cut(theta, observer)?;
        if self.effects.forces() != *forces {
            return Ok(Next::Forces);
        }
        let now = self.progress.now();
        let (system, motion_start) = (self.system, self.system.motion_start(&self.progress.state));
        let Progress {
            state, counters, ..
        } = &mut *self.progress;
        if system.conserves_energy() {
            let rebound = Rebound {
                limit,
                motion_start,
                energy: &|t, state| system.energy(t, state),
            };
            self.stepper.rebound(system, &rebound, state, counters);
        }
        self.stepper.restart(system, now, state, limit, counters)?;
        Ok(Next::Step)
    }

    /// Makes steps to the end, or to the next change of the forces, always with [`Dop853`] at the chosen integrator's
    /// tolerance and longest step. Not every integrator accepts forces that are not part of the system.
    #[inline(never)]
    pub(crate) fn drive_under<O: Observer<Sys>>(
        &mut self,
        forces: Effects::Forces,
        t_end: f64,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let field = Driven {
            system: self.system,
            forces,
        };
        let unlimited = Dop853::new(self.stepper.tolerance());
        let limited = unlimited.with_max_step(self.stepper.max_step());
        let mut along = Along {
            field: &field,
            stepper: limited.unwrap_or(unlimited),
        };
        // NOTE: behind a pointer, so that the effects are compiled once for it and all chosen integrators.
        let mut stepper = Chosen::new(&mut along);
        // The integrator of this part of the run has made no step yet.
        let was_begun = core::mem::replace(&mut self.progress.is_begun, false);
        let mut course = Course {
            system: self.system,
            stepper: &mut stepper,
            effects: &mut *self.effects,
            budget: self.budget,
            progress: &mut *self.progress,
        };
        let end = course.drive(t_end, observer);
        self.progress.is_begun = was_begun;
        end
    }

    /// Accepts the whole step.
    #[inline(always)]
    fn pass<O: Observer<Sys>>(&mut self, observer: &mut O) -> Result<(), Outcome> {
        if let Some(coordinate) = self.system.outside_chart(self.stepper.end_state()) {
            return Err(self.leave_chart_before(1.0, coordinate, observer));
        }
        if self.progress.watches_energy
            && !has_energy(self.system, self.stepper.t_end(), self.stepper.end_state())
        {
            return Err(Outcome::LeftDomain);
        }
        self.progress.set_time(self.stepper.end_time());
        self.progress.flight += self.stepper.length();
        self.progress.state = *self.stepper.end_state();
        let mut now = Moment {
            system: self.system,
            t: self.progress.t,
            state: &mut self.progress.state,
            counters: &mut self.progress.counters,
        };
        let settled = self.effects.settle(&mut now, false);
        if let Err(outcome) = settled {
            // The run ends where the motion arrived.
            self.progress.state = *self.stepper.end_state();
            self.show(1.0, observer)?;
            return Err(outcome);
        }
        if settled? == Change::Changed {
            self.stepper.replace_end(
                self.system,
                &self.progress.state,
                &mut self.progress.counters,
            )?;
        }
        self.show(1.0, observer)
    }

    /// Ends the step at `theta`, where the effects act. Returns the longest step with which to continue.
    #[inline(never)]
    fn cut<O: Observer<Sys>>(&mut self, theta: f64, observer: &mut O) -> Result<f64, Outcome> {
        if theta <= 0.0 {
            let mut now = Moment {
                system: self.system,
                t: self.progress.t,
                state: &mut self.progress.state,
                counters: &mut self.progress.counters,
            };
            self.effects.act(theta, &mut now, observer)?;
            return Ok(f64::INFINITY);
        }
        let limit = FLIGHTS * (self.progress.flight + theta * self.stepper.length());
        self.progress.flight = 0.0;
        self.arrive_settled(theta, observer)?;
        self.show(theta, observer)?;
        let mut now = Moment {
            system: self.system,
            t: self.progress.t,
            state: &mut self.progress.state,
            counters: &mut self.progress.counters,
        };
        self.effects.act(theta, &mut now, observer)?;
        Ok(limit)
    }

    /// Sets time and state to those where the settled motion meets what was proposed at `theta`.
    fn arrive_settled<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.arrive(theta)?;
        if let Some(coordinate) = self.system.outside_chart(&self.progress.state) {
            return Err(self.leave_chart_before(theta, coordinate, observer));
        }
        for is_last in (0..=AIMS).map(|count| count == AIMS) {
            let arrived = self.progress.state;
            let mut now = Moment {
                system: self.system,
                t: self.progress.t,
                state: &mut self.progress.state,
                counters: &mut self.progress.counters,
            };
            match self.effects.settle(&mut now, true) {
                Err(outcome) => {
                    // The run ends where the motion arrived.
                    self.progress.state = arrived;
                    self.show(theta, observer)?;
                    return Err(outcome);
                }
                Ok(Change::Kept) => break,
                Ok(Change::Changed) if is_last => break,
                Ok(Change::Changed) => {}
            }
            let Some(late) = self.effects.aim(theta, &mut now)? else {
                break;
            };
            // So short a way is straight.
            let mut rate = now.state.zeroed();
            now.counters.rate_evaluations += 1;
            now.system.rate(now.t, now.state, &mut rate)?;
            for (entry, rate) in now.state.as_mut_slice().iter_mut().zip(rate.as_slice()) {
                *entry += late * rate;
            }
            let there = self.progress.now().after(late);
            self.progress.set_time(there);
        }
        Ok(())
    }

    /// Sets time and state to those at `theta`.
    fn arrive(&mut self, theta: f64) -> Result<(), Outcome> {
        if theta < 1.0 {
            self.stepper
                .prepare_dense(self.system, &mut self.progress.counters)?;
        }
        let (now, state) = self.stepper.cut(theta);
        self.progress.set_time(now);
        self.progress.state = state;
        Ok(())
    }

    /// Reports to the observer the motion from the start of the step to the current time, which is the fraction `part`
    /// of the step.
    #[inline(always)]
    fn show<O: Observer<Sys>>(&mut self, part: f64, observer: &mut O) -> Result<(), Outcome> {
        let t = [self.stepper.t_start(), self.progress.t];
        let step = self.stepper.length();
        let mut source = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        match observer.step(&mut Segment {
            t,
            end: &self.progress.state,
            step,
            part,
            source: &mut source,
        }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Outcome::Stopped),
        }
    }

    /// Prepares the dense output. If a rate in it meets dependent constraints, the step is repeated from the same start
    /// with a shorter length. True if it is repeated.
    fn shorten_where_dependent(&mut self) -> Result<bool, Outcome> {
        let now = self.progress.now();
        let Progress {
            state, counters, ..
        } = &mut *self.progress;
        match self.stepper.prepare_dense(self.system, counters) {
            Ok(()) => Ok(false),
            Err(Fault::SingularConstraint { .. }) => {
                let shorter = SHORTER * self.stepper.length();
                self.stepper
                    .restart(self.system, now, state, shorter, counters)?;
                Ok(true)
            }
            Err(fault) => Err(fault.into()),
        }
    }

    /// Repeats the step from the same start with a shorter length if a force acts only between its stages. True if it
    /// is repeated. Ends the run if it does not get on: where rates lose their slope, every longer step may be too long.
    #[inline(never)]
    fn shorten_where_narrow(&mut self) -> Result<bool, Outcome> {
        let t = self.stepper.t_start();
        let is_moment = self.stepper.length() <= narrow::SAME_MOMENT * t.abs();
        if is_moment {
            self.progress.moments += 1;
            if self.progress.moments > MOMENTS {
                return Err(Outcome::StepUnderflow { t });
            }
            return Ok(false);
        }
        let mut view = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        let Resolved { part, has_pole } = narrow::resolved(&mut view)?;
        if part >= 1.0 {
            self.progress.moments = 0;
            self.progress.poles = match has_pole {
                true => self.progress.poles + POLE,
                false => self.progress.poles.saturating_sub(1),
            };
            if self.progress.poles > POLES {
                return Err(Outcome::StepUnderflow { t });
            }
        }
        self.shorten_to(part)
    }

    /// Repeats the step in the same way if it does not show forces of the effects. True if it is repeated.
    fn shorten_where_hidden(&mut self) -> Result<bool, Outcome> {
        let mut view = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        let shown = self.effects.shown(&mut view)?;
        self.shorten_to(shown)
    }

    /// Repeats the step from the same start with half its length, because a gap is not finite at its end. A surface may be
    /// met before. At the shortest step the run ends with `outcome`.
    #[cold]
    fn shorten_where_undefined(&mut self, outcome: Outcome) -> Result<Next, Outcome> {
        match self.shorten_to(0.5) {
            Ok(_) => Ok(Next::Step),
            Err(Outcome::StepUnderflow { .. }) => Err(outcome),
            Err(other) => Err(other),
        }
    }

    /// Repeats the step from the same start if it resolves only a fraction of itself. True if it is repeated.
    fn shorten_to(&mut self, resolved: f64) -> Result<bool, Outcome> {
        if resolved >= 1.0 {
            return Ok(false);
        }
        let (t, length) = (self.stepper.t_start(), self.stepper.length());
        let shorter = length * if resolved >= AHEAD { resolved } else { AHEAD };
        if shorter < least_step(t) {
            return Err(Outcome::StepUnderflow { t });
        }
        let now = self.progress.now();
        let Progress {
            state, counters, ..
        } = &mut *self.progress;
        counters.rejected += 1;
        self.stepper
            .restart(self.system, now, state, shorter, counters)?;
        Ok(true)
    }

    /// Ends the run where the constraint forms become dependent between the start of the step and `reach`.
    #[inline(never)]
    fn keep_rank<O: Observer<Sys>>(&mut self, reach: f64, observer: &mut O) -> Result<(), Outcome> {
        let view = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        let Some(RankDrop { theta, constraint }) = independence::drop(&view, reach) else {
            return Ok(());
        };
        self.arrive(theta)?;
        self.show(theta, observer)?;
        Err(Outcome::SingularConstraint {
            constraint,
            condition: f64::INFINITY,
        })
    }

    /// Ends the run in the last state inside the chart, for a coordinate that is outside at `theta` although no
    /// enclosure has shown its exit.
    #[cold]
    fn leave_chart_before<O: Observer<Sys>>(
        &mut self,
        theta: f64,
        coordinate: usize,
        observer: &mut O,
    ) -> Outcome {
        let mut view = StepView {
            system: self.system,
            counters: &mut self.progress.counters,
            stepper: &mut *self.stepper,
        };
        if let Err(fault) = view.prepare() {
            return fault.into();
        }
        let onset = narrowed([0.0, theta], |part| chart::outside(&view, part).is_some());
        let coordinate = chart::outside(&view, onset.after).unwrap_or(coordinate);
        self.leave_chart(Exit { onset, coordinate }, observer)
    }

    /// Ends the run in the last state inside the chart.
    #[cold]
    fn leave_chart<O: Observer<Sys>>(&mut self, exit: Exit, observer: &mut O) -> Outcome {
        let inside = exit.onset.before;
        let arrived = self.arrive(inside);
        match arrived.and_then(|()| self.show(inside, observer)) {
            Ok(()) => Outcome::LeftChart {
                coordinate: exit.coordinate,
            },
            Err(outcome) => outcome,
        }
    }
}
