//! First variations: derivatives of a run with respect to its initial state and its parameters.
//!
//! Between transitions the power series of the motion are computed once more, over [`Dual`] numbers (forward mode):
//! their slopes are the derivatives of the motion, exact to rounding, with any integrator of the run. At a transition
//! on a surface `h(t, z; k) = 0`, with `f` the rate before and after it and the map `z+ = D(t, z; k)`,
//!
//! ```text
//! dT  = -(h_z . dz- + h_k dk) / (h_z . f- + h_t)
//! dz+ = D_z (dz- + f- dT) + D_t dT + D_k dk - f+ dT
//! ```
//!
//! is the differential of the transition by the saltation matrix. [`Variations`] is an observer that propagates both
//! along a run.
//!
//! [`Section`] is the map from one arrival at a surface to a later one (Poincare map), with its derivative.
//! [`Section::periodic`] finds its fixed points, periodic orbits, and their Floquet multipliers; [`Section::exponent`] is
//! its largest Lyapunov exponent. [`Section::modulo`] lets them close up to a symmetry of a [`Group`]. [`Section::image`] has the derivative in a parameter too, for families of orbits.
//!
//! The result is [`Undefined`] if the flow of a system with impacts has no derivative.

mod along;
mod chart;
mod dual;
mod eigenvalues;
mod extrapolation;
pub mod family;
mod flow;
pub(crate) mod graze;
pub mod group;
mod growth;
mod held;
mod observer;
pub mod orbit;
mod rates;
pub mod section;
mod slice;
pub(crate) mod transition;

use core::fmt;

pub use crate::contract::Tangent;
pub use dual::{DIRECTIONS, Dual};
pub use eigenvalues::{Multipliers, eigenvalues};
pub use family::{Anchor, Image};
pub use group::Group;
pub use observer::Variations;
pub use orbit::{Orbit, OrbitError};
pub use rates::rates;
pub use section::{Arrival, Itinerary, Section, SectionError};

use crate::error::Fault;

/// Reason why a run has no derivative, or no more digits than doubles have, with its place.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Undefined {
    /// A grazing impact: rounding decides if the surface was hit. Derivatives are infinite there, or differ on both
    /// sides.
    Graze {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// Several surfaces were hit at one time: a neighbouring run meets them one after the other, or in another order.
    Corner {
        /// Time.
        t: f64,
        /// The surface hit last.
        surface: usize,
    },
    /// From here on the motion is held in a way whose derivatives are not available: by several surfaces, after
    /// impacts that accumulate, or where a neighbouring run is not held.
    Held {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// The state after an impact is not the result of the law in force alone, for example because a policy repeats
    /// it.
    Unlawful {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// The Lagrangian changes at a transition where the state of one of the modes, reduced to its constraints, holds
    /// no momenta: the derivatives of the refraction are not available.
    Refracted {
        /// Time.
        t: f64,
        /// The transition.
        surface: usize,
    },
    /// The motion, its derivatives or its further digits could not be computed from here on.
    NotFinite {
        /// Time.
        t: f64,
    },
    /// A fault while derivatives or further digits were computed.
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
