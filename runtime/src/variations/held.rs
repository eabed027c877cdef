//! Variations along motion that a surface holds, or that slides between two modes (sliding mode).
//!
//! No power series is generated for the contact force, or for the mixture of two fields. Over dual numbers the field is
//!
//! ```text
//! f + lambda w,        lambda = -h''/dh(w)            held by h, whose impulses are along w
//! f_b + s (f_a - f_b),  s = r_b/(r_a + r_b)            sliding between modes a and b
//! ```
//!
//! Here `r_a` is the gap rate, along `f_a`, of the transition from mode a to mode b, and `r_b` the reverse. Gap rates
//! and the second rate `h''` along `f` follow from coefficients 1 and 2 of the gaps' series.
//!
//! Where held motion begins, variations jump as at any transition, with the held field as `f+`, because neighbouring
//! motions are held from the surface on as well. Where the contact force vanishes, the field is continuous and
//! variations do not jump.

use super::flow::{Flow, dual_parameters, dual_state};
use super::{Dual, Undefined};
use crate::contract::Variational;
use crate::numbers::{Numbers, Row};
use crate::record::Hold;
use crate::state::StateVector;

/// Allowed jump of the field at the end of held motion, relative to the largest component of the field.
const JUMP: f64 = 1e-5;

/// Cause of held motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holder {
    Surface(usize),
    /// The transition back to the other mode, and the transition that was taken.
    Slide {
        back: usize,
        across: usize,
    },
}

impl Holder {
    pub(super) fn of<S>(hold: &Hold<S>) -> Self {
        match hold.back {
            Some(back) => Self::Slide {
                back,
                across: hold.surface,
            },
            None => Self::Surface(hold.surface),
        }
    }

    /// The surface in the mode of the state.
    pub(super) fn surface(self) -> usize {
        match self {
            Self::Surface(surface) | Self::Slide { back: surface, .. } => surface,
        }
    }

    pub(super) fn undefined(self, t: f64) -> Undefined {
        let surface = self.surface();
        Undefined::Held { t, surface }
    }
}

impl<Sys: Variational> Flow<Sys> {
    /// The rate of a held state.
    pub(super) fn rate(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        holder: Holder,
        t: f64,
        state: &Sys::Row<Dual>,
    ) -> Result<Sys::Row<Dual>, Undefined> {
        match holder {
            Holder::Surface(surface) => self.pressed(system, parameters, surface, t, state),
            Holder::Slide { back, across } => {
                self.slid(system, parameters, [back, across], t, state)
            }
        }
    }

    /// The rate of a state without variations. With a holder, it is the rate of held motion.
    pub(super) fn rate_of(
        &mut self,
        system: &Sys,
        holder: Option<Holder>,
        t: f64,
        state: &Sys::State,
    ) -> Result<Sys::State, Undefined> {
        let Some(holder) = holder else {
            let mut rate = system.zero_state();
            system.rate(t, state, &mut rate)?;
            return Ok(rate);
        };
        let parameters = dual_parameters(system, &[]);
        let row = dual_state::<Sys>(state, &[]);
        let row = self.rate(system, &parameters, holder, t, &row)?;
        Ok(values::<Sys>(&row))
    }

    /// The rate of a state in free motion, and coefficient `k` of the series of a surface's gap along it.
    fn free(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        (surface, k): (usize, usize),
        t: f64,
        state: &Sys::Row<Dual>,
    ) -> Result<(Sys::Row<Dual>, Dual), Undefined> {
        self.expansion
            .begin(system, parameters, Dual::of(t), state)?;
        self.expansion
            .advance(system, parameters, Dual::of(1.0), k, state);
        let gaps = self.expansion.gaps[k].as_slice();
        let gap = *gaps.get(surface).ok_or(Undefined::Held { t, surface })?;
        Ok((self.expansion.coefficients[1], gap))
    }

    /// The rate of motion that a surface holds.
    fn pressed(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        surface: usize,
        t: f64,
        state: &Sys::Row<Dual>,
    ) -> Result<Sys::Row<Dual>, Undefined> {
        let (mut rate, half) = self.free(system, parameters, (surface, 2), t, state)?;
        let now = Dual::of(t);
        let collision = system.collision(parameters, surface, now, state)?;
        let [gap_rate, _, _, compliance, ..] = *collision.as_slice() else {
            return Err(Undefined::Held { t, surface });
        };
        let mut second = half + half;
        if let Some(traced) = system.trace(parameters, surface, now, state, &rate)? {
            // A gap rate is affine in the velocity variables, so that its change by a force is the difference of two
            // gap rates.
            let forced = sum(state, &sum(&traced, &rate, -1.0), 1.0);
            let collision = system.collision(parameters, surface, now, &forced)?;
            second = second + (collision.as_slice()[0] - gap_rate);
            rate = traced;
        }
        let size = -(second / compliance);
        let first = system.motion_start(&values::<Sys>(state));
        let directions = &collision.as_slice()[5..];
        for (entry, direction) in rate.as_mut_slice()[first..].iter_mut().zip(directions) {
            *entry = size.mul_add(*direction, *entry);
        }
        Ok(rate)
    }

    /// The rate of sliding between two modes that lead into each other.
    fn slid(
        &mut self,
        system: &Sys,
        parameters: &Sys::Parameters<Dual>,
        [back, across]: [usize; 2],
        t: f64,
        state: &Sys::Row<Dual>,
    ) -> Result<Sys::Row<Dual>, Undefined> {
        let (rate_here, leaves) = self.free(system, parameters, (back, 1), t, state)?;
        let other = system.passed(parameters, back, Dual::of(t), state)?;
        let other = other.ok_or(Undefined::Unlawful { t, surface: back })?;
        let (other, enters) = self.free(system, parameters, (across, 1), t, &other)?;
        let share = leaves / (leaves + enters);
        let mut rate = rate_here;
        for (entry, other) in rate.as_mut_slice().iter_mut().zip(other.as_slice()) {
            *entry = share.mul_add(*other - *entry, *entry);
        }
        Ok(rate)
    }

    /// Refuses an end of held motion at which the field jumps. The contact force does not vanish there, so the motion
    /// is released for another reason.
    pub(super) fn check_release(
        &mut self,
        system: &Sys,
        holder: Holder,
        t: f64,
        [before, after]: [&Sys::State; 2],
    ) -> Result<(), Undefined> {
        let along = self.rate_of(system, Some(holder), t, before)?;
        let free = self.rate_of(system, None, t, after)?;
        let pairs = || along.as_slice().iter().zip(free.as_slice());
        let size = pairs().fold(0.0, |size: f64, (a, b)| size.max(a.abs()).max(b.abs()));
        match pairs().all(|(along, free)| (along - free).abs() <= JUMP * size) {
            true => Ok(()),
            false => Err(holder.undefined(t)),
        }
    }
}

/// Values of a row of dual numbers.
fn values<Sys: Variational>(row: &Sys::Row<Dual>) -> Sys::State {
    let mut values = Sys::State::zeros(row.as_slice().len());
    for (value, entry) in values.as_mut_slice().iter_mut().zip(row.as_slice()) {
        *value = entry.value;
    }
    values
}

/// `a + factor b`
pub(super) fn sum<R: Row<Dual>>(a: &R, b: &R, factor: f64) -> R {
    let mut sum = *a;
    let factor = Dual::of(factor);
    for (entry, b) in sum.as_mut_slice().iter_mut().zip(b.as_slice()) {
        *entry = b.mul_add(factor, *entry);
    }
    sum
}
