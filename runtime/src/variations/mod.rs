//! First variations: derivatives of a run with respect to its initial state and its parameters.
//!
//! Between transitions the power series of the motion are recomputed over [`Dual`] numbers (forward-mode derivatives).
//! Their dual parts are the derivatives of the motion, exact to rounding, whichever integrator made the run. A
//! transition on a surface `h(t, z; k) = 0`, with parameters `k`, has the rates `f-` before and `f+` after it, and the
//! map `z+ = D(t, z; k)`. The differentials of its time `T` and, at a fixed time, of the state after it are
//!
//! ```text
//! dT  = -(h_z . dz- + h_k dk) / (h_z . f- + h_t)
//! dz+ = D_z (dz- + f- dT) + D_t dT + D_k dk - f+ dT
//! ```
//!
//! These formulas apply the saltation matrix. [`Variations`] is an observer that propagates these derivatives along a
//! run.
//!
//! [`Section`] is the Poincare map of a surface: the map from an arrival at it to a later one, with its derivative.
//! [`Section::periodic`] finds its fixed points, which are periodic orbits, and their Floquet multipliers.
//! [`Section::exponent`] computes its largest Lyapunov exponent. [`Section::modulo`] closes orbits up to a symmetry in
//! a [`Group`]. [`Section::image`] also gives the derivative with respect to a parameter, for families of orbits.
//!
//! Where the flow of a system with impacts has no derivative, the result is [`Undefined`].

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

/// Reason why a run has no derivative, or no digits beyond those of doubles.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Undefined {
    /// A grazing impact: rounding decides whether the surface is hit. The derivatives are infinite there, or differ on
    /// the two sides.
    Graze {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// Several surfaces were hit at the same time. Neighbouring runs hit them one after the other, possibly in another
    /// order.
    Corner {
        /// Time.
        t: f64,
        /// The surface of the last impact.
        surface: usize,
    },
    /// From this time on the motion is held by surfaces in a way for which derivatives are not available: by several
    /// surfaces, after an accumulation of impacts, or where neighbouring runs are not held.
    Held {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// The state after an impact is not the result of one application of the law in force, for example because an
    /// impact policy repeats the law.
    Unlawful {
        /// Time.
        t: f64,
        /// The surface.
        surface: usize,
    },
    /// The Lagrangian changes at a transition, and the reduced state of one of the modes does not contain momenta.
    /// Derivatives of the refraction are not available then.
    Refracted {
        /// Time.
        t: f64,
        /// The transition.
        surface: usize,
    },
    /// The motion, its derivatives or its extended digits are not finite from this time on.
    NotFinite {
        /// Time.
        t: f64,
    },
    /// A fault during the computation of derivatives or extended digits.
    Fault(Fault),
}

impl Undefined {
    /// The class of the reason in snake case, as in documents.
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
                "surface {surface} is grazed at t = {t}: rounding decides whether it is hit, and the motion has no derivative there"
            ),
            Self::Corner { t, surface } => write!(
                f,
                "surface {surface} is hit at t = {t} together with another, where the motion has no derivative"
            ),
            Self::Held { t, surface } => write!(
                f,
                "surface {surface} holds the motion at t = {t}; derivatives and further digits are not available for this kind of contact"
            ),
            Self::Unlawful { t, surface } => write!(
                f,
                "the state after the impact on surface {surface} at t = {t} is not the result of its law alone"
            ),
            Self::Refracted { t, surface } => write!(
                f,
                "transition {surface} changes the Lagrangian at t = {t}, and the state of one of its modes holds no \
                 momenta: derivatives and further digits are not available"
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
