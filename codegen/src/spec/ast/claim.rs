//! Claims as written.

use super::{Declared, ItemId, Scalar, Word};

/// A theorem about the model, to be proved or refuted while it builds.
#[derive(Debug)]
pub struct Claim {
    /// Statement.
    pub statement: Statement,
    /// True if an undecided claim is accepted: `assume ..`.
    pub is_assumed: bool,
    /// The scene it is about; the whole model if there is none.
    pub scene: Option<Word>,
    /// The declaration.
    pub item: ItemId,
}

/// Statement of a claim.
#[derive(Debug)]
pub enum Statement {
    /// `density: exact`
    Existence(Existence),
    /// `density = e`
    Density(Scalar),
    /// `conserved: e`, `not conserved: e`, `conserved under surface: e`
    Conserved {
        /// The quantity.
        value: Scalar,
        /// The surface across which it is conserved; along the motion if there is none.
        under: Option<Declared>,
        /// True if it is claimed to be conserved.
        holds: bool,
    },
    /// `symmetry: e`, with `partial(x)` for the fields of the coordinates.
    Symmetry(Scalar),
    /// `invariant: e`, with `d(..)` and `^` between forms.
    Invariant(Scalar),
    /// `involution: f, g, ..`
    Involution(Vec<Scalar>),
    /// `integrable: f, g, ..`
    Integrable(Vec<Scalar>),
    /// `volume: kept`
    VolumeKept,
    /// `density under surface: factor = e`
    Factor {
        /// The surface.
        under: Declared,
        /// The factor of the volume.
        value: Scalar,
    },
    /// `symplectic`
    Symplectic,
    /// `energy under surface: not increasing`
    EnergyNotIncreasing(Declared),
}

/// Configurations at which a density exists that depends only on the configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existence {
    /// On all of Q.
    Global,
    /// Near generic configurations, and not on all of Q.
    Local,
    /// Nowhere.
    None,
}
