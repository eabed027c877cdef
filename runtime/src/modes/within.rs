//! An effect that belongs to one mode: it sees the states of that mode, and nothing of the others.

use super::{Mode, index, placed, taken};
use crate::contract::System;
use crate::effects::{Change, Effect, Moment, SceneEffects};
use crate::forces::NoForces;
use crate::outcome::Outcome;
use crate::record::Observer;

/// An effect of a mode, as one of the model. It begins anew each time the mode is entered.
///
/// Only what an effect does after smooth motion is carried over ([`Effect::begin`] and [`Effect::settle`]): the search for
/// crossings belongs to the model as a whole.
#[derive(Debug, Clone)]
pub struct Within<M, E> {
    effect: E,
    is_inside: bool,
    mode: core::marker::PhantomData<M>,
}

impl<M: Mode, E: Effect<M>> Within<M, E> {
    /// The effect in its mode.
    pub fn new(effect: E) -> Self {
        Self {
            effect,
            is_inside: false,
            mode: core::marker::PhantomData,
        }
    }

    /// Begins the effect where the mode has been entered.
    fn enter(&mut self, now: &mut Moment<'_, M::Model>) -> Result<(), Outcome>
    where
        M::Model: System,
    {
        let is_inside = index(now.state) == M::INDEX;
        if is_inside && !self.is_inside {
            let (mode, mut own) = (M::of(now.system), taken::<M>(now.state));
            let mut inside = Moment {
                system: &mode,
                t: now.t,
                state: &mut own,
                counters: &mut *now.counters,
            };
            self.effect.begin(&mut inside, &mut ())?;
        }
        self.is_inside = is_inside;
        Ok(())
    }
}

impl<M: Mode, E: Effect<M>> Effect<M::Model> for Within<M, E>
where
    M::Model: System,
{
    type Forces = NoForces;

    fn begin<O: Observer<M::Model>>(
        &mut self,
        now: &mut Moment<'_, M::Model>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        self.is_inside = false;
        self.enter(now)
    }

    #[inline]
    fn settle(&mut self, now: &mut Moment<'_, M::Model>, cut: bool) -> Result<Change, Outcome> {
        if !self.is_inside {
            return Ok(Change::Kept);
        }
        let (mode, mut own) = (M::of(now.system), taken::<M>(now.state));
        let mut inside = Moment {
            system: &mode,
            t: now.t,
            state: &mut own,
            counters: &mut *now.counters,
        };
        let change = self.effect.settle(&mut inside, cut)?;
        if change == Change::Changed {
            *now.state = placed::<M>(&own);
        }
        Ok(change)
    }

    fn act<O: Observer<M::Model>>(
        &mut self,
        _: f64,
        now: &mut Moment<'_, M::Model>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        self.enter(now)
    }
}

impl<M: Mode, E: SceneEffects<M>> SceneEffects<M::Model> for Within<M, E>
where
    M::Model: System,
{
    fn set_projection(&mut self, on: bool) {
        self.effect.set_projection(on);
    }
}
