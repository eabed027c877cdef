//! A run in extended precision. The driver of ordinary runs is applied to the steps of a flight, rounded to doubles.

use core::cell::RefCell;
use core::ops::ControlFlow;

use super::flight::{Flight, rounded, widened};
use super::stepper::Rounded;
use crate::contract::{TaylorField, Variational};
use crate::effects::Effect;
use crate::integrate::Counters;
use crate::law::Law;
use crate::numbers::Row;
use crate::outcome::{Outcome, StartError};
use crate::record::{Event, Hold, Observer, Segment};
use crate::simulation::{STEP_BUDGET, Simulation};
use crate::state::StateVector;
use crate::variations::Undefined;
use dalembert_numbers::Extended;

/// A time and the state at it.
#[derive(Debug)]
pub struct At<Sys: TaylorField, const PARTS: usize> {
    /// The time.
    pub t: Extended<PARTS>,
    /// The state, in the order of the system's state.
    pub state: Sys::Row<Extended<PARTS>>,
}

/// An impact or transition at a surface.
#[derive(Debug)]
pub struct Impact<Sys: TaylorField, const PARTS: usize> {
    /// Time.
    pub t: Extended<PARTS>,
    /// Index of the surface.
    pub surface: usize,
    /// The law that was applied.
    pub law: Law,
    /// State just before. Its gap vanishes up to rounding.
    pub before: Sys::Row<Extended<PARTS>>,
    /// The state just after.
    pub after: Sys::Row<Extended<PARTS>>,
}

/// A finished run in extended numbers.
#[derive(Debug)]
pub struct ExtendedRun<Sys: TaylorField, const PARTS: usize> {
    /// Reason for the end: an ordinary [`Outcome`], or the reason why the extended digits are undefined from here on.
    pub outcome: Result<Outcome, Undefined>,
    /// Final time and state: at the requested end, after the last impact, or at the end of the last whole step. A new
    /// run can start from it.
    pub end: At<Sys, PARTS>,
    /// Work done.
    pub counters: Counters,
}

macro_rules! copied {
    ($($name:ident)*) => {$(
        impl<Sys: TaylorField, const PARTS: usize> Clone for $name<Sys, PARTS> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<Sys: TaylorField, const PARTS: usize> Copy for $name<Sys, PARTS> {}
    )*};
}

copied!(At Impact ExtendedRun);

impl<Sys: TaylorField, const PARTS: usize> At<Sys, PARTS> {
    /// A state and time given in doubles.
    pub fn of(t: f64, state: &Sys::State) -> Self {
        Self {
            t: Extended::from(t),
            state: widened(state.as_slice()),
        }
    }

    /// The state rounded to doubles.
    pub fn rounded(&self) -> Sys::State {
        rounded(self.state.as_slice())
    }
}

/// A simulation in extended precision with `PARTS` doubles per number; see the [module](super).
#[derive(Debug, Clone)]
pub struct ExtendedSimulation<'a, Sys, Effects, const PARTS: usize> {
    system: &'a Sys,
    effects: Effects,
    step_budget: u64,
}

impl<'a, Sys: Variational, Effects: Effect<Sys>, const PARTS: usize>
    ExtendedSimulation<'a, Sys, Effects, PARTS>
{
    /// Combines a system with effects. [`Scene::effects`](crate::Scene::effects) returns the effects that a system
    /// declares.
    pub fn new(system: &'a Sys, effects: Effects) -> Self {
        Self {
            system,
            effects,
            step_budget: STEP_BUDGET,
        }
    }

    /// Ends the run after this many steps instead of [`STEP_BUDGET`].
    #[must_use]
    pub fn with_step_budget(mut self, budget: u64) -> Self {
        self.step_budget = budget;
        self
    }

    /// Runs from `start` to the time `t_end`. Calls `see` after every impact; it may stop the run by
    /// `ControlFlow::Break`.
    ///
    /// # Errors
    /// [`StartError`] in the cases of [`Simulation::run`].
    pub fn run(
        self,
        start: At<Sys, PARTS>,
        t_end: f64,
        see: impl FnMut(&Impact<Sys, PARTS>) -> ControlFlow<()>,
    ) -> Result<ExtendedRun<Sys, PARTS>, StartError> {
        let t = start.t.nearest();
        let flight = RefCell::new(Flight::new(self.system, start, t_end - t));
        let mut witness = Witness {
            flight: &flight,
            see,
            undefined: None,
        };
        let run = Simulation::new(self.system, Rounded::new(&flight), self.effects)
            .with_step_budget(self.step_budget)
            .run(t, start.rounded(), t_end, &mut witness)?;
        let undefined = witness.undefined;
        let mut flight = flight.into_inner();
        let mut outcome = undefined.map_or(Ok(run.outcome), Err);
        // A step that was cut is not part of the flight.
        if flight.cut.is_some() || run.t < flight.ends[1].t.nearest() {
            flight.forget();
        }
        if outcome == Ok(Outcome::Done)
            && let Err(failure) = flight.land(t_end)
        {
            outcome = Ok(failure.into());
        }
        Ok(ExtendedRun {
            outcome,
            end: flight.ends[1],
            counters: run.counters,
        })
    }
}

/// Carries out the transitions of the rounded steps in the flight.
struct Witness<'r, 'a, Sys: Variational, See, const PARTS: usize> {
    flight: &'r RefCell<Flight<'a, Sys, PARTS>>,
    see: See,
    undefined: Option<Undefined>,
}

impl<Sys: Variational, See, const PARTS: usize> Witness<'_, '_, Sys, See, PARTS> {
    fn end(&mut self, undefined: Undefined) -> ControlFlow<()> {
        self.flight.borrow_mut().forget();
        self.undefined = Some(undefined);
        ControlFlow::Break(())
    }
}

impl<Sys, See, const PARTS: usize> Observer<Sys> for Witness<'_, '_, Sys, See, PARTS>
where
    Sys: Variational,
    See: FnMut(&Impact<Sys, PARTS>) -> ControlFlow<()>,
{
    fn step(&mut self, _: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        let looked = self.flight.borrow().look_for_grazes();
        match looked {
            Ok(()) => ControlFlow::Continue(()),
            Err(undefined) => self.end(undefined),
        }
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        let crossed = self.flight.borrow_mut().cross(event);
        match crossed {
            Ok(impact) => (self.see)(&impact),
            Err(undefined) => self.end(undefined),
        }
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        let (t, surface) = (hold.t, hold.surface);
        self.undefined = Some(Undefined::Held { t, surface });
        ControlFlow::Break(())
    }
}
