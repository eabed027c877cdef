//! First variations: derivatives of a run with respect to its initial state and its parameters.
//!
//! Between transitions the power series of the motion are computed once more, over [`Dual`] numbers: their slopes are the
//! derivatives of the motion, exact to rounding, whatever integrator makes the run. At a transition on a surface
//! `h(t, z; k) = 0`, with `f` the rate before and after it and the map `z+ = D(t, z; k)`,
//!
//! ```text
//! dT  = -(h_z . dz- + h_k dk) / (h_z . f- + h_t)
//! dz+ = D_z (dz- + f- dT) + D_t dT + D_k dk - f+ dT
//! ```
//!
//! is the augmented differential (saltation) of the transition. [`Variations`] is an observer that does both along a run.
//!
//! [`Section`] is the map from one arrival at a surface to a later one, with its derivative; [`Section::periodic`] finds the
//! points that return to themselves, and their multipliers.
//!
//! Where the flow of a system with impacts has no derivative, none is given: see [`Undefined`].

mod along;
mod chart;
mod dual;
mod eigenvalues;
mod extrapolation;
mod flow;
pub(crate) mod graze;
mod held;
pub mod orbit;
pub mod section;
mod tangent;
pub(crate) mod transition;

use core::fmt;
use core::ops::ControlFlow;

pub use dual::{DIRECTIONS, Dual};
pub use eigenvalues::Multipliers;
pub use orbit::{Orbit, OrbitError};
pub use section::{Arrival, Section, SectionError};
pub use tangent::Tangent;

use crate::contract::Variational;
use crate::error::Fault;
use crate::record::{Event, Hold, Observer, Segment};
use flow::Flow;
use held::Holder;
use transition::Sequence;

/// Why a run has no derivative, or no more digits than doubles have, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Undefined {
    /// A surface was touched or hit so lightly that rounding decides whether it was hit: derivatives are infinite there,
    /// or differ to both sides.
    Graze {
        /// When.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// Several surfaces were hit at one time: a neighbouring run meets them one after the other, or in another order.
    Corner {
        /// When.
        t: f64,
        /// The surface hit last.
        surface: usize,
    },
    /// From here on the motion is held in a way whose derivatives are not known: by several surfaces, after impacts that
    /// accumulate, or where a neighbouring run is not held.
    Held {
        /// When.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// What happened at an impact is not what the law in force does alone, as where a policy repeats it.
    Unlawful {
        /// When.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// The Lagrangian changes at a transition where the state of one of the modes, reduced to its constraints, holds no
    /// momenta: the derivatives of the refraction are not known.
    Refracted {
        /// When.
        t: f64,
        /// The transition.
        surface: usize,
    },
    /// The motion, its derivatives or more of its digits could not be computed from here on.
    NotFinite {
        /// When.
        t: f64,
    },
    /// A fault met while derivatives or more digits were computed.
    Fault(Fault),
}

impl Undefined {
    /// The class in snake case, as documents write it.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Graze { .. } => "graze",
            Self::Corner { .. } => "corner",
            Self::Held { .. } => "held",
            Self::Unlawful { .. } => "unlawful",
            Self::Refracted { .. } => "refracted",
            Self::NotFinite { .. } => "not_finite",
            Self::Fault(_) => "fault",
        }
    }
}

impl fmt::Display for Undefined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Graze { t, surface } => write!(
                f,
                "surface {surface} is grazed at t = {t}, where rounding decides and the motion has no derivative"
            ),
            Self::Corner { t, surface } => write!(
                f,
                "surface {surface} is hit at t = {t} together with another, where the motion has no derivative"
            ),
            Self::Held { t, surface } => write!(
                f,
                "surface {surface} holds the motion at t = {t} in a way whose derivatives and digits are not known"
            ),
            Self::Unlawful { t, surface } => write!(
                f,
                "the impact on surface {surface} at t = {t} is not that of its law alone"
            ),
            Self::Refracted { t, surface } => write!(
                f,
                "transition {surface} changes the Lagrangian at t = {t}, of a mode that is reduced to its constraints: \
                 what it does is known in doubles alone"
            ),
            Self::NotFinite { t } => write!(
                f,
                "the series of the motion cannot be computed beyond t = {t}"
            ),
            Self::Fault(fault) => fault.fmt(f),
        }
    }
}

impl core::error::Error for Undefined {}

impl From<Fault> for Undefined {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// Carries first variations along a run that it observes.
///
/// The directions are the caller's: any number of them, varied state and parameters in each. Observe one run, then ask for
/// [`Variations::tangents`]. Any integrator will do; derivatives are those of the motion from the states that it gives.
pub struct Variations<'a, Sys: Variational> {
    system: &'a Sys,
    tangents: &'a mut [Tangent<Sys>],
    flow: Flow<Sys>,
    /// What holds the motion.
    holder: Option<Holder>,
    /// Transitions at one moment, and what held the motion before. What holds it after is known when it goes on.
    crossing: Option<(Sequence<Sys::State>, Option<Holder>)>,
    /// The end of the last stretch of motion.
    end: Option<Sys::State>,
    undefined: Option<Undefined>,
}

impl<'a, Sys: Variational> Variations<'a, Sys> {
    /// Variations of the run that comes, from these directions.
    pub fn new(system: &'a Sys, tangents: &'a mut [Tangent<Sys>]) -> Self {
        Self {
            system,
            tangents,
            flow: Flow::new(),
            holder: None,
            crossing: None,
            end: None,
            undefined: None,
        }
    }

    /// The derivatives at the end of what was observed.
    ///
    /// # Errors
    /// [`Undefined`]: the first place where the run has none.
    pub fn tangents(&mut self) -> Result<&[Tangent<Sys>], Undefined> {
        self.go_on();
        match self.undefined {
            Some(undefined) => Err(undefined),
            None => Ok(self.tangents),
        }
    }

    /// Moves the directions from a fixed time to the surface that is met there.
    pub(crate) fn arrive(&mut self, event: &Event<Sys::State>) {
        self.go_on();
        if self.undefined.is_none() {
            let (flow, holder) = (&mut self.flow, self.holder);
            let arrived = transition::arrive(self.system, event, holder, flow, self.tangents);
            self.undefined = arrived.err();
        }
    }

    /// Carries the directions across the last transitions, unless derivatives have ended.
    fn go_on(&mut self) {
        if let Some((sequence, before)) = self.crossing.take()
            && self.undefined.is_none()
        {
            self.undefined = self.cross(&sequence, [before, self.holder]).err();
        }
    }

    fn cross(
        &mut self,
        sequence: &Sequence<Sys::State>,
        holders: [Option<Holder>; 2],
    ) -> Result<(), Undefined> {
        let (system, last) = (self.system, sequence.last());
        let t = last.t;
        if let [Some(holder), Some(_)] = holders {
            // What the impact makes of the motion depends on the surface that holds it.
            return Err(holder.undefined(t));
        }
        transition::cross(system, sequence, holders, &mut self.flow, self.tangents)?;
        match holders[1] {
            Some(holder) => holder.check_along(system, t, &last.after, self.tangents),
            None => Ok(()),
        }
    }

    /// Takes a beginning or an end of held motion.
    fn turn(&mut self, hold: &Hold<Sys::State>) -> Result<(), Undefined> {
        let (system, t) = (self.system, hold.t);
        let holder = Holder::of(hold);
        let held = core::mem::replace(&mut self.holder, hold.begins.then_some(holder));
        let crosses = self.crossing.is_some();
        match (held, hold.begins) {
            (None, true) if hold.accumulation.is_some() => Err(holder.undefined(t)),
            (None, true) if crosses => Ok(()),
            // At the start of a run.
            (None, true) if self.end.is_none() => {
                holder.check_along(system, t, &hold.state, self.tangents)
            }
            (Some(held), false) if held == holder => match &self.end {
                Some(end) if !crosses => {
                    let ends = [end, &hold.state];
                    self.flow.check_release(system, holder, t, ends)
                }
                _ => Ok(()),
            },
            _ => Err(holder.undefined(t)),
        }
    }
}

impl<Sys: Variational> Observer<Sys> for Variations<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        self.go_on();
        if self.undefined.is_none() {
            let followed = self
                .flow
                .follow(self.system, self.holder, segment, self.tangents);
            self.undefined = followed.err();
        }
        self.end = Some(*segment.end());
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        let follows = |(sequence, _): &mut (Sequence<_>, _)| sequence.add(event);
        if !self.crossing.as_mut().is_some_and(follows) {
            self.go_on();
            self.crossing = Some((Sequence::of(event), self.holder));
        }
        ControlFlow::Continue(())
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        if self.undefined.is_none() {
            self.undefined = self.turn(hold).err();
        }
        ControlFlow::Continue(())
    }
}
