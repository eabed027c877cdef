//! The saltation matrix of a transition, applied to variations at a fixed time.

use super::along::Neighbours;
use super::flow::{Flow, dual_parameters, dual_state, take_slopes};
use super::held::Holder;
use super::{DIRECTIONS, Dual, Tangent, Undefined};
use crate::contract::Variational;
use crate::error::Fault;
use crate::law::Law;
use crate::numbers::{Numbers, Row};
use crate::record::Event;
use crate::state::StateVector;

/// Allowed difference between the state after a transition and the result of its law, relative to the largest
/// component before and after. Differences from corrections of rounding errors are far smaller; differences from any
/// other cause are far larger.
const LAWFUL: f64 = 1e-6;

/// Maximum number of transitions at one moment. A longer sequence means that two modes pass the motion back and forth.
const SEQUENCE: usize = 8;

/// Rates at an arrival at a surface.
pub(crate) struct Arrival<Sys: Variational> {
    /// The rate of the state before the transition.
    rate: Sys::State,
    /// The rate of the gap.
    pub(crate) gap_rate: f64,
}

/// Propagates all directions across transitions at one moment. `holders` hold the motion before and after them.
pub(super) fn cross<Sys: Variational>(
    system: &Sys,
    sequence: &Sequence<Sys::State>,
    holders: [Option<Holder>; 2],
    flow: &mut Flow<Sys>,
    tangents: &mut [Tangent<Sys>],
) -> Result<(), Undefined> {
    let (event, last) = (sequence.first(), sequence.last());
    let before = flow.rate_of(system, holders[0], event.t, &event.before)?;
    let arrival = arrival_at(system, event, before)?;
    let rate = flow.rate_of(system, holders[1], event.t, &last.after)?;
    for some in tangents.chunks_mut(DIRECTIONS) {
        let parameters = dual_parameters(system, some);
        let (t, state) = arrival.met(system, event, &parameters, some)?;
        let mut now = Neighbours::<Sys> {
            parameters,
            t,
            state,
        };
        for (k, event) in sequence.iter() {
            let (t, surface) = (event.t, event.surface);
            if k > 0 && !now.share_gap(system, surface)? {
                // Neighbouring motions meet the surfaces at different times.
                return Err(Undefined::Corner { t, surface });
            }
            now.state = struck::<Sys, Dual>(system, &parameters, event, now.t, &now.state)?;
            check_near(event, &event.after, now.state.as_slice())?;
        }
        let after = now.state;
        for (k, tangent) in some.iter_mut().enumerate() {
            let parts = after.as_slice().iter().zip(rate.as_slice());
            for (entry_of, (entry, rate)) in tangent.state.as_mut_slice().iter_mut().zip(parts) {
                *entry_of = entry.slopes()[k] - rate * t.slopes()[k];
            }
        }
        check_finite(last, some)?;
    }
    Ok(())
}

/// Transitions in sequence at one moment.
pub(super) struct Sequence<S> {
    events: [Event<S>; SEQUENCE],
    count: usize,
}

impl<S: Copy> Sequence<S> {
    pub(super) fn of(event: &Event<S>) -> Self {
        Self {
            events: [*event; SEQUENCE],
            count: 1,
        }
    }

    /// Adds a transition at the same moment. Returns false if it is at another moment, or if the sequence is full.
    pub(super) fn add(&mut self, event: &Event<S>) -> bool {
        let follows = event.simultaneous && event.t == self.first().t;
        let is_added = follows && self.count < SEQUENCE;
        if is_added {
            self.events[self.count] = *event;
            self.count += 1;
        }
        is_added
    }

    pub(super) fn first(&self) -> &Event<S> {
        &self.events[0]
    }

    pub(super) fn last(&self) -> &Event<S> {
        &self.events[self.count - 1]
    }

    fn iter(&self) -> impl Iterator<Item = (usize, &Event<S>)> {
        self.events[..self.count].iter().enumerate()
    }
}

/// Moves all directions from the time of an arrival to the surface, before the transition.
pub(super) fn arrive<Sys: Variational>(
    system: &Sys,
    event: &Event<Sys::State>,
    holder: Option<Holder>,
    flow: &mut Flow<Sys>,
    tangents: &mut [Tangent<Sys>],
) -> Result<(), Undefined> {
    let rate = flow.rate_of(system, holder, event.t, &event.before)?;
    let arrival = arrival_at(system, event, rate)?;
    for some in tangents.chunks_mut(DIRECTIONS) {
        let parameters = dual_parameters(system, some);
        let (_, state) = arrival.met(system, event, &parameters, some)?;
        take_slopes(&state, some);
        check_finite(event, some)?;
    }
    Ok(())
}

/// A time as a dual number, varied along the first direction.
fn passing(t: f64) -> Dual {
    Dual::new(t, [1.0, 0.0, 0.0, 0.0])
}

/// Rates at an arrival by free motion.
///
/// # Errors
/// [`Undefined`] for a grazing impact, a corner, or a fault of the rates.
pub(crate) fn arrival<Sys: Variational>(
    system: &Sys,
    event: &Event<Sys::State>,
) -> Result<Arrival<Sys>, Undefined> {
    let mut rate = system.zero_state();
    system.rate(event.t, &event.before, &mut rate)?;
    arrival_at(system, event, rate)
}

/// Rates at an arrival by a motion with this rate of the state.
fn arrival_at<Sys: Variational>(
    system: &Sys,
    event: &Event<Sys::State>,
    rate: Sys::State,
) -> Result<Arrival<Sys>, Undefined> {
    let (t, surface) = (event.t, event.surface);
    if event.graze {
        return Err(Undefined::Graze { t, surface });
    }
    if event.simultaneous {
        return Err(Undefined::Corner { t, surface });
    }
    let gap_rate = gap_rate(system, event, &rate)?;
    match gap_rate < 0.0 {
        true => Ok(Arrival { rate, gap_rate }),
        false => Err(Undefined::Graze { t, surface }),
    }
}

/// `h_z . f + h_t`, along the motion before a transition.
pub(super) fn gap_rate<Sys: Variational>(
    system: &Sys,
    event: &Event<Sys::State>,
    rate: &Sys::State,
) -> Result<f64, Fault> {
    let along = [Tangent::of_state(*rate)];
    let parameters = dual_parameters(system, &along);
    let t = passing(event.t);
    let state = dual_state(&event.before, &along);
    let gaps = system.clearances(&parameters, t, &state)?;
    Ok(gaps.as_slice()[event.surface].slopes()[0])
}

impl<Sys: Variational> Arrival<Sys> {
    /// Time and state at which neighbouring motions meet the surface.
    fn met(
        &self,
        system: &Sys,
        event: &Event<Sys::State>,
        parameters: &Sys::Parameters<Dual>,
        tangents: &[Tangent<Sys>],
    ) -> Result<(Dual, Sys::Row<Dual>), Undefined> {
        let t = Dual::of(event.t);
        let mut state = dual_state(&event.before, tangents);
        let gaps = system.clearances(parameters, t, &state)?;
        let gap = &gaps.as_slice()[event.surface];
        let later = gap.slopes().map(|slope| -slope / self.gap_rate);
        let parts = state.as_mut_slice().iter_mut().zip(self.rate.as_slice());
        for (entry, rate) in parts {
            let mut slopes = entry.slopes();
            for (slope, later) in slopes.iter_mut().zip(later) {
                *slope += rate * later;
            }
            *entry = Dual::new(entry.value, slopes);
        }
        Ok((Dual::new(event.t, later), state))
    }
}

/// The state after the law of an impact.
pub(crate) fn struck<Sys: Variational, L: Numbers>(
    system: &Sys,
    parameters: &Sys::Parameters<L>,
    event: &Event<Sys::State>,
    t: L,
    state: &Sys::Row<L>,
) -> Result<Sys::Row<L>, Undefined> {
    let surface = event.surface;
    let (declared, _) = system.declared_law(parameters, surface);
    let strike = Strike {
        surface,
        // A law chosen for the run has a constant coefficient.
        chosen: (declared != event.law).then_some(event.law),
        motion_start: system.motion_start(&event.before),
    };
    let after = strike.applied(system, parameters, t, state)?;
    let t = event.t;
    after.ok_or(match event.law {
        Law::Transition => Undefined::Refracted { t, surface },
        _ => Undefined::Unlawful { t, surface },
    })
}

/// A law that acts at a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strike {
    pub(crate) surface: usize,
    /// The law that replaces the declared one.
    pub(crate) chosen: Option<Law>,
    /// Index of the first momentum or quasi-velocity in the state.
    pub(crate) motion_start: usize,
}

impl Strike {
    /// The law in force.
    pub(crate) fn law<Sys: Variational, L: Numbers>(
        &self,
        system: &Sys,
        parameters: &Sys::Parameters<L>,
    ) -> Law {
        let declared = system.declared_law(parameters, self.surface).0;
        self.chosen.unwrap_or(declared)
    }

    /// The state after the law. `None` if the map of the law is not available for this number type, or if the sign of
    /// the gap rate after the instantaneous constraints is not the same for all values of the numbers.
    ///
    /// # Errors
    /// A [`Fault`] of the impact or of the reset.
    pub(crate) fn applied<Sys: Variational, L: Numbers>(
        &self,
        system: &Sys,
        parameters: &Sys::Parameters<L>,
        t: L,
        state: &Sys::Row<L>,
    ) -> Result<Option<Sys::Row<L>>, Fault> {
        let surface = self.surface;
        let (declared, coefficient) = system.declared_law(parameters, surface);
        let (law, coefficient) = match self.chosen {
            Some(law) => (law, L::of(law.coefficient().unwrap_or(0.0))),
            None => (declared, coefficient),
        };
        if law.is_map() {
            return system.passed(parameters, surface, t, state);
        }
        let focused = system.focus(parameters, surface, t, state)?;
        let mut after = focused.unwrap_or(*state);
        let collision = system.collision(parameters, surface, t, &after)?;
        if focused.is_some() {
            match collision.as_slice()[0].is_below_zero() {
                Some(true) => {}
                // The impulse of the instantaneous constraints has already reversed the approach.
                Some(false) => return Ok(Some(after)),
                None => return Ok(None),
            }
        }
        let motion = &mut after.as_mut_slice()[self.motion_start..];
        law.strike(coefficient, collision.as_slice(), motion);
        Ok(Some(after))
    }
}

/// Checks that a state of the run, before or after an event, agrees with a computed state.
pub(crate) fn check_near<S: StateVector, L: Numbers>(
    event: &Event<S>,
    run: &S,
    state: &[L],
) -> Result<(), Undefined> {
    let states = [&event.before, &event.after];
    let components = states.into_iter().flat_map(StateVector::as_slice);
    let size = components.fold(0.0, |size, value| f64::max(size, value.abs()));
    let mut pairs = state.iter().zip(run.as_slice());
    match pairs.all(|(component, run)| (component.lane(0) - run).abs() <= LAWFUL * size) {
        true => Ok(()),
        false => Err(Undefined::Unlawful {
            t: event.t,
            surface: event.surface,
        }),
    }
}

fn check_finite<Sys: Variational>(
    event: &Event<Sys::State>,
    tangents: &[Tangent<Sys>],
) -> Result<(), Undefined> {
    match tangents.iter().all(|tangent| tangent.state.is_finite()) {
        true => Ok(()),
        false => Err(Undefined::NotFinite { t: event.t }),
    }
}
