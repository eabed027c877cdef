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

mod chart;
mod dual;
mod eigenvalues;
mod flow;
pub(crate) mod graze;
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
    /// Several surfaces were hit at one time: a neighbouring run meets them in another order.
    Corner {
        /// When.
        t: f64,
        /// The surface hit last.
        surface: usize,
    },
    /// A surface holds the motion from here on, by a force that the power series do not know.
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
                "surface {surface} holds the motion from t = {t}, by a force that has no power series"
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
    undefined: Option<Undefined>,
}

impl<'a, Sys: Variational> Variations<'a, Sys> {
    /// Variations of the run that comes, from these directions.
    pub fn new(system: &'a Sys, tangents: &'a mut [Tangent<Sys>]) -> Self {
        Self {
            system,
            tangents,
            flow: Flow::new(),
            undefined: None,
        }
    }

    /// The derivatives at the end of what was observed.
    ///
    /// # Errors
    /// [`Undefined`]: the first place where the run has none.
    pub fn tangents(&self) -> Result<&[Tangent<Sys>], Undefined> {
        match self.undefined {
            Some(undefined) => Err(undefined),
            None => Ok(self.tangents),
        }
    }

    /// Takes a stretch of smooth motion, unless derivatives have ended.
    pub(crate) fn flow(&mut self, segment: &Segment<'_, Sys::State>) {
        if self.undefined.is_none() {
            let t = [segment.t_start(), segment.t_end()];
            let flown = self
                .flow
                .follow(self.system, t, segment.start(), self.tangents);
            self.undefined = flown.err();
        }
    }

    /// Takes a transition, unless derivatives have ended.
    pub(crate) fn cross(&mut self, event: &Event<Sys::State>) {
        if self.undefined.is_none() {
            let crossed = transition::cross(self.system, event, self.tangents);
            self.undefined = crossed.err();
        }
    }

    /// Moves the directions from a fixed time to the surface that is met there.
    pub(crate) fn arrive(&mut self, event: &Event<Sys::State>) {
        if self.undefined.is_none() {
            let arrived = transition::arrive(self.system, event, self.tangents);
            self.undefined = arrived.err();
        }
    }
}

impl<Sys: Variational> Observer<Sys> for Variations<'_, Sys> {
    fn step(&mut self, segment: &mut Segment<'_, Sys::State>) -> ControlFlow<()> {
        self.flow(segment);
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.cross(event);
        ControlFlow::Continue(())
    }

    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        let (t, surface) = (hold.t, hold.surface);
        self.undefined.get_or_insert(Undefined::Held { t, surface });
        ControlFlow::Continue(())
    }
}
