//! Resting on surfaces and sliding along them: begin and end of contact.
//!
//! Every change happens where a step is cut: at its start if the motion presses into a touched surface, inside where a
//! contact force would have to pull, or at an impact on another surface.

use core::ops::ControlFlow;

use super::held::Held;
use super::hits::Hits;
use super::instantaneous::is_rough;
use super::release::first_release;
use super::repeats::Repeats;
use super::sliding::Slide;
use crate::contract::Impacting;
use crate::effects::{Moment, StepView};
use crate::error::Fault;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::per_surface::PerSurface;
use crate::record::{Hold, Observer};
use crate::state::StateVector;

/// Maximum number of changes at one time is this, times the number of surfaces plus one. After more changes the run
/// ends, because no set of held surfaces seems to continue the motion.
const CHANGES: u32 = 4;

/// Number of resets of a motion at rest at one time beyond which they count as endless.
const RESETS: u32 = 1000;

/// Ratio to the kinetic energy below which the square of a gap rate counts as 0: the square of `2^-36`, as for impacts.
const STILL: f64 = 1.0 / (1_u128 << 72) as f64;

/// Number of kinks in succession, and their distance in time relative to the time, at which the motion counts as held in
/// a crease: it would move back and forth across it without end.
const CREASE: (u32, f64) = (8, 1.0 / (1 << 22) as f64);

/// Number of steps that end at a kink, and their time relative to the time, after which the motion counts as held there.
const STAY: (u32, f64) = (8, 1.0 / (1 << 16) as f64);

/// Reason for a cut of the step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Turn {
    Nothing,
    /// The motion presses into this surface.
    Press(usize),
    /// The contact force of this surface would have to pull, or the surface no longer counts.
    Leave(usize),
    /// The gap of a held surface has passed a kink.
    Kink,
    /// A sliding motion meets this surface of the other mode.
    Across(usize),
}

/// The surfaces that the state rests on.
#[derive(Debug, Clone)]
pub(super) struct Resting<G: StateVector> {
    held: Held<G>,
    turn: Turn,
    /// Times at which impacts on a surface accumulated, until they are reported.
    accumulated: PerSurface<Option<f64>, G>,
    /// Changes of surfaces at one time.
    changes: Repeats,
    /// Time of the last kink that was passed, and the number of kinks in close succession before it.
    kinks: (f64, u32),
    /// Beginning of the present stay at a kink, and the number of its steps.
    stay: Option<(f64, u32)>,
    /// The gap rates before the last kink, until they are taken from those behind it.
    rates: Option<G>,
}

impl<G: StateVector> Resting<G> {
    /// No surface, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self {
            held: Held::none(like),
            turn: Turn::Nothing,
            accumulated: PerSurface::all(like, None),
            changes: Repeats::none(),
            kinks: (f64::NEG_INFINITY, 0),
            stay: None,
            rates: None,
        }
    }

    pub(super) fn is_none(&self) -> bool {
        self.held.is_empty()
    }

    pub(super) fn held(&self) -> &Held<G> {
        &self.held
    }

    pub(super) fn forces(&self) -> Option<Held<G>> {
        (!self.held.is_empty()).then_some(self.held)
    }

    /// Records that impacts on a surface accumulate at this time.
    pub(super) fn note_accumulation(&mut self, surface: usize, t: f64) {
        self.accumulated[surface] = Some(t);
    }

    /// Records that the motion presses into a surface at the start of a step, at `t`.
    pub(super) fn press(&mut self, surface: usize, t: f64) -> Result<Option<f64>, Outcome> {
        self.count(surface, t)?;
        self.turn = Turn::Press(surface);
        Ok(Some(0.0))
    }

    /// Counts a change of surfaces. Ends the run if changes repeat too often at one time.
    pub(super) fn count(&mut self, surface: usize, t: f64) -> Result<(), Outcome> {
        if self.changes.add(t) > CHANGES * (self.accumulated.count() as u32 + 1) {
            return Err(Outcome::Contact { surface });
        }
        Ok(())
    }

    /// Counts a reset of a motion at rest. True if there are too many at one time.
    pub(super) fn are_endless(&mut self, t: f64) -> bool {
        self.changes.add(t) > RESETS
    }

    /// The earliest of a hit, the first release in a step, and `end`: where a held surface no longer counts.
    pub(super) fn look<Sys: Impacting<Gaps = G>, Step: Stepper<Sys>>(
        &mut self,
        hit: Option<f64>,
        end: Option<(f64, usize)>,
        step: &mut StepView<'_, Sys, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let released = first_release(&self.held, step)?;
        let first = match end {
            Some((part, surface)) if released.is_none_or(|(before, _)| part < before) => {
                Some((part, Some(surface)))
            }
            _ => released,
        };
        match first {
            Some((part, surface)) if hit.is_none_or(|hit| part < hit) => {
                if let Some(surface) = surface {
                    self.count(surface, step.time(part))?;
                    self.turn = Turn::Leave(surface);
                }
                Ok(Some(part))
            }
            _ => Ok(hit),
        }
    }

    /// Cuts the step at `part`, where a sliding motion meets a surface of the other mode.
    pub(super) fn meet_across(&mut self, (part, surface): (f64, usize)) -> f64 {
        self.turn = Turn::Across(surface);
        part
    }

    /// The surface of the other mode that a sliding motion meets, if the step was cut there.
    pub(super) fn take_across(&mut self) -> Option<usize> {
        let Turn::Across(surface) = self.turn else {
            return None;
        };
        self.turn = Turn::Nothing;
        Some(surface)
    }

    /// Cuts the step at `part`, where the gap of a held surface has passed a kink: its rate may have jumped, so that the
    /// surface acts anew. A change found later in the step is withdrawn. `rates` are the gap rates before the kink.
    pub(super) fn pass_kink(&mut self, part: f64, rates: Option<G>) -> f64 {
        self.turn = Turn::Kink;
        self.rates = rates;
        part
    }

    /// Counts a kink behind which the step was cut, and takes errors of the motion before it from the gap rates, so that
    /// what is left of these is the jump at the kink. Ends the run in a crease, where no direction is that of the force.
    /// `length` is that of the step.
    pub(super) fn arrive_at_kink<Sys: Impacting<Gaps = G>>(
        &mut self,
        length: f64,
        now: &mut Moment<'_, Sys>,
    ) -> Result<(), Outcome> {
        if !self.is_behind_kink() {
            return Ok(());
        }
        let ((last, count), t) = (self.kinks, now.t);
        let (most, close) = CREASE;
        let count = if t - last <= close * t.abs() {
            count + 1
        } else {
            0
        };
        self.kinks = (t, count);
        if let Some(surface) = self.held.iter().next()
            && count > most
        {
            return Err(Outcome::Zeno { t, surface });
        }
        if let Some(rates) = self.rates.take()
            && self.held.are_errors(&rates, length, now)?
        {
            self.held.cancel(&rates, now)?;
        }
        Ok(())
    }

    /// Counts a step at whose end the motion is still at a kink, within rounding errors. Ends the run if it stays there.
    pub(super) fn stay_at_kink(&mut self, t: f64) -> Result<(), Outcome> {
        let (since, count) = self.stay.unwrap_or((t, 0));
        self.stay = Some((since, count + 1));
        let (most, close) = STAY;
        match self.held.iter().next() {
            Some(surface) if count > most && t - since > close * t.abs() => {
                Err(Outcome::Zeno { t, surface })
            }
            _ => Ok(()),
        }
    }

    /// Records a step that ends at no kink.
    pub(super) fn leave_kinks(&mut self) {
        self.stay = None;
    }

    /// True if the step was cut behind a kink.
    pub(super) fn is_behind_kink(&self) -> bool {
        self.turn == Turn::Kink
    }

    /// Carries out the change for which the step was cut. True if there is one.
    pub(super) fn turn<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<bool, Outcome> {
        match core::mem::replace(&mut self.turn, Turn::Nothing) {
            Turn::Nothing | Turn::Kink | Turn::Across(_) => return Ok(false),
            Turn::Leave(surface) => match self.held.slide() {
                Some(slide) => self.end_slide(slide, surface, now, observer)?,
                None => self.leave(surface, now, observer)?,
            },
            Turn::Press(surface) => {
                // The division of a common impulse between two surfaces with instantaneous constraints is
                // undetermined.
                let (system, t) = (now.system, now.t);
                if is_rough(system, surface, t, now.state)?
                    && self.held.is_rough(system, t, now.state)?
                {
                    return Err(Outcome::Contact { surface });
                }
                self.held.hold(surface);
                if self.held.sizes(now.system, now.t, now.state)?.is_none() {
                    return Err(Outcome::Contact { surface });
                }
                self.drop_pulling(Some(surface), now, observer)?;
                self.held.settle(now)?;
                let accumulation = self.accumulated[surface].take();
                show_begin(surface, accumulation, now, observer)?;
            }
        }
        Ok(true)
    }

    /// Rests on several surfaces at once, where impacts on them accumulate.
    pub(super) fn rest_on<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        surfaces: Held<G>,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let before = self.held;
        for surface in before.iter().filter(|&surface| !surfaces.is_held(surface)) {
            self.leave(surface, now, observer)?;
        }
        self.held = surfaces;
        surfaces.settle(now)?;
        for surface in surfaces.iter().filter(|&surface| !before.is_held(surface)) {
            show_begin(surface, Some(now.t), now, observer)?;
        }
        Ok(())
    }

    /// Leaves the surfaces from which the motion rises after impacts, and those that would have to pull.
    pub(super) fn bounce<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        if self.held.is_empty() || self.held.slide().is_some() {
            return Ok(());
        }
        let (system, t) = (now.system, now.t);
        let rates = system.gap_rates(t, now.state)?;
        for surface in 0..self.accumulated.count() {
            let rate = rates.as_slice()[surface];
            if self.held.is_held(surface)
                && rate > 0.0
                && !is_at_rest(system, surface, rate, (t, now.state))?
            {
                self.leave(surface, now, observer)?;
            }
        }
        self.held.settle_rates(now)?;
        self.drop_pulling(None, now, observer)
    }

    /// Leaves the surfaces that a reset of positions has moved away from.
    pub(super) fn keep<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        hits: &Hits<G>,
        now: &Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let is_left = |surface: usize| !hits.is_at_hand(surface);
        if let Some(slide) = self.held.slide() {
            return match is_left(slide.back) {
                true => self.show_end_of_slide(slide, now, observer),
                false => Ok(()),
            };
        }
        for surface in 0..self.accumulated.count() {
            if self.held.is_held(surface) && is_left(surface) {
                self.leave(surface, now, observer)?;
            }
        }
        Ok(())
    }

    /// Begins sliding between two modes that lead into each other.
    pub(super) fn begin_slide<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        slide: Slide,
        now: &Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.count(slide.back, now.t)?;
        self.held.slide_along(slide);
        show(
            observer,
            Hold {
                t: now.t,
                surface: slide.across,
                back: Some(slide.back),
                state: *now.state,
                begins: true,
                accumulation: None,
            },
        )
    }

    /// Ends sliding where one of the two modes no longer leads into the surface: the mode that the transition `surface`
    /// leaves. The motion continues in this mode.
    pub(super) fn end_slide<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        slide: Slide,
        surface: usize,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        if surface == slide.across {
            *now.state = slide.across(now.system, now.t, now.state)?;
        }
        self.show_end_of_slide(slide, now, observer)
    }

    fn show_end_of_slide<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        slide: Slide,
        now: &Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.held = Held::none(&now.system.zero_gaps());
        show(
            observer,
            Hold {
                t: now.t,
                surface: slide.across,
                back: Some(slide.back),
                state: *now.state,
                begins: false,
                accumulation: None,
            },
        )
    }

    /// Leaves surfaces that would have to pull, one after the other, except the one just pressed.
    fn drop_pulling<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        pressed: Option<usize>,
        now: &mut Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        if self.held.iter().nth(1).is_some()
            && let Some(pushing) = self.held.pushing(now.system, now.t, now.state)?
            && pressed.is_none_or(|surface| pushing.held.is_held(surface))
        {
            let held = self.held;
            for surface in held
                .iter()
                .filter(|&surface| !pushing.held.is_held(surface))
            {
                self.leave(surface, now, observer)?;
            }
            return Ok(());
        }
        loop {
            let Some(sizes) = self.held.sizes(now.system, now.t, now.state)? else {
                return Ok(());
            };
            let size = |surface: usize| sizes.as_slice()[surface];
            let pulling = self.held.iter().filter(|&surface| Some(surface) != pressed);
            let worst = pulling.min_by(|&a, &b| size(a).total_cmp(&size(b)));
            match worst {
                Some(surface) if size(surface) < 0.0 => self.leave(surface, now, observer)?,
                _ => return Ok(()),
            }
        }
    }

    fn leave<Sys: Impacting<Gaps = G>, O: Observer<Sys>>(
        &mut self,
        surface: usize,
        now: &Moment<'_, Sys>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        self.held.release(surface);
        show(
            observer,
            Hold {
                t: now.t,
                surface,
                back: None,
                state: *now.state,
                begins: false,
                accumulation: None,
            },
        )
    }
}

/// True if a gap rate counts as 0, compared with the kinetic energy.
pub(super) fn is_at_rest<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    rate: f64,
    at: (f64, &Sys::State),
) -> Result<bool, Fault> {
    Ok(rate * rate <= STILL * squared_rate(system, surface, at)?)
}

/// The square of the gap rate of a motion straight to a surface with the kinetic energy of the state, up to a factor of 2.
pub(super) fn squared_rate<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    (t, state): (f64, &Sys::State),
) -> Result<f64, Fault> {
    let (qdot, p) = (system.velocity(t, state)?, system.momentum(t, state)?);
    let pairs = qdot.as_slice().iter().zip(p.as_slice());
    let energy: f64 = pairs.map(|(v, p)| (v * p).abs()).sum();
    let contact = system.contact(surface, t, state)?;
    Ok(energy * contact.constrained_compliance)
}

/// Reports that a surface begins to hold the motion.
fn show_begin<Sys: Impacting, O: Observer<Sys>>(
    surface: usize,
    accumulation: Option<f64>,
    now: &Moment<'_, Sys>,
    observer: &mut O,
) -> Result<(), Outcome> {
    show(
        observer,
        Hold {
            t: now.t,
            surface,
            back: None,
            state: *now.state,
            begins: true,
            accumulation,
        },
    )
}

fn show<Sys: Impacting, O: Observer<Sys>>(
    observer: &mut O,
    hold: Hold<Sys::State>,
) -> Result<(), Outcome> {
    match observer.hold(&hold) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Outcome::Stopped),
    }
}
