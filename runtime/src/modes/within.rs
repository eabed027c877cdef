//! An effect in the present mode of the motion.

use crate::contract::System;
use crate::effects::{Change, Effect, Moment, SceneEffects};
use crate::forces::NoForces;
use crate::kernels::{Declared, Part};
use crate::outcome::Outcome;
use crate::record::Observer;

/// An effect that sees a model with modes as its present mode. It begins anew whenever a mode is entered.
///
/// Only [`Effect::begin`] and [`Effect::settle`] are forwarded to the effect: event location belongs to the model as a
/// whole.
#[derive(Debug, Clone)]
pub struct InMode<E> {
    effect: E,
    /// The mode in which the effect has begun; `None` if it does not act in the present mode.
    mode: Option<usize>,
}

impl<E> InMode<E> {
    /// Makes the effect act in each mode.
    pub fn new(effect: E) -> Self {
        Self { effect, mode: None }
    }

    /// Calls `act` with the present mode as the system.
    fn inside<S: Declared, T>(
        &mut self,
        now: &mut Moment<'_, S>,
        act: impl FnOnce(&mut E, &mut Moment<'_, S>) -> Result<T, Outcome>,
    ) -> Result<T, Outcome> {
        let part = Part::of(now.system, crate::state::StateVector::as_slice(now.state));
        let here = part.starting_here();
        let mut inside = Moment {
            system: &here,
            t: now.t,
            state: &mut *now.state,
            counters: &mut *now.counters,
        };
        act(&mut self.effect, &mut inside).map_err(|outcome| part.outcome(outcome))
    }

    /// Begins the effect if a new mode has been entered.
    fn enter<S: Declared>(&mut self, now: &mut Moment<'_, S>) -> Result<(), Outcome>
    where
        E: Effect<S>,
    {
        let number = now.system.mode(now.state);
        if self.mode == Some(number) {
            return Ok(());
        }
        let drifts = Part::numbered(now.system, number).tables.drifts;
        self.mode = drifts.then_some(number);
        match drifts {
            true => self.inside(now, |effect, inside| effect.begin(inside, &mut ())),
            false => Ok(()),
        }
    }
}

impl<S: Declared, E: Effect<S>> Effect<S> for InMode<E> {
    type Forces = NoForces;

    fn begin<O: Observer<S>>(&mut self, now: &mut Moment<'_, S>, _: &mut O) -> Result<(), Outcome> {
        self.mode = None;
        self.enter(now)
    }

    #[inline]
    fn settle(&mut self, now: &mut Moment<'_, S>, cut: bool) -> Result<Change, Outcome> {
        match self.mode {
            None => Ok(Change::Kept),
            Some(_) => self.inside(now, |effect, inside| effect.settle(inside, cut)),
        }
    }

    fn act<O: Observer<S>>(
        &mut self,
        _: f64,
        now: &mut Moment<'_, S>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        self.enter(now)
    }
}

impl<S: Declared, E: SceneEffects<S>> SceneEffects<S> for InMode<E> {
    fn set_projection(&mut self, on: bool) {
        self.effect.set_projection(on);
    }
}
