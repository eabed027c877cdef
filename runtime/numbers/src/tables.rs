//! Data of a form of a model besides its kernels.

use crate::description::{Documentation, ParameterInfo};
use crate::held::Held;
use crate::law::Law;

/// Components of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Positions and momenta.
    Global,
    /// Positions and quasi-velocities.
    Reduced,
    /// Positions alone, of a first-order system.
    FirstOrder,
}

/// Counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimensions {
    /// Components of a state; one more than those of the longest mode for a model with modes.
    pub state: usize,
    /// Coordinates, of all modes together.
    pub coordinates: usize,
    /// Momenta or quasi-velocities in a state, of the mode with the most.
    pub motion: usize,
    /// Constraints, of the mode with the most.
    pub constraints: usize,
    /// Integrable constraints whose function is known, of the mode with the most.
    pub levels: usize,
    /// Surfaces, of all modes together.
    pub surfaces: usize,
    /// Parameters.
    pub parameters: usize,
}

/// An open interval that a coordinate must stay in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chart {
    /// The index of the coordinate.
    pub coordinate: usize,
    /// The ends.
    pub ends: [f64; 2],
}

/// A condition of a surface: its margin is positive, or not negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// True if a margin of 0 satisfies it.
    pub is_closed: bool,
}

/// Relation of a surface to others of the same gap. A list of conditions holds where all of them hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// It counts by its own conditions.
    Independent,
    /// It counts where no other list holds.
    Otherwise,
    /// It counts where its own conditions hold, or no other list does.
    Last,
}

/// A surface.
#[derive(Debug, PartialEq)]
pub struct Surface {
    /// The law, with a coefficient of 0 where it has one.
    pub law: Law,
    /// The name of the coefficient, for errors.
    pub coefficient: Option<&'static str>,
    /// Its conditions.
    pub conditions: Held<[Condition]>,
    /// Conditions of the other surfaces of the same gap, list after list.
    pub others: Held<[Held<[Condition]>]>,
    /// Rule by which both decide if the surface counts.
    pub beside: Beside,
    /// The coordinates that the gap depends on, by bits; all from the last bit on share it.
    pub takes: u64,
}

/// Constraint of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Index of the constraint.
    pub constraint: usize,
    /// True if the constraint is an equation of positions, so that the level of every state is 0.
    pub is_zero: bool,
}

/// The rule by which a transition makes the state of the mode that it enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// The state is declared.
    Declared,
    /// First-order systems: the position stays.
    Kept,
    /// Both modes have the same Lagrangian: the focusing point.
    Focused,
    /// The Lagrangian changes: refraction or reflection.
    Refracted,
}

/// A transition of a surface to another mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The mode that is entered.
    pub enters: usize,
    /// Rule of the entry.
    pub passage: Passage,
    /// True if the surface counts from both sides: the opposite of its gap belongs to another transition of the same mode.
    pub has_no_side: bool,
    /// The surface of the model that leads back at once, between first-order modes.
    pub opposite: Option<usize>,
}

/// A mode of a model: its own tables, and the places of its quantities among those of the model.
#[derive(Debug, PartialEq)]
pub struct Mode {
    /// Tables of the mode by itself.
    pub tables: Held<Tables>,
    /// Its self-description.
    pub documentation: Held<Documentation>,
    /// The place of its kernels among those of the model.
    pub kernels: usize,
    /// The place of the kernels of its global form, which may be the same.
    pub global: usize,
    /// Coordinates.
    pub coordinates: Held<[usize]>,
    /// Constraints.
    pub constraints: Held<[usize]>,
    /// Surfaces.
    pub surfaces: Held<[usize]>,
    /// Outputs.
    pub outputs: Held<[usize]>,
    /// The transition of each of its surfaces, where it leads to another mode.
    pub transitions: Held<[Option<Transition>]>,
}

/// Data of a form.
#[derive(Debug, PartialEq)]
pub struct Tables {
    /// Components of a state.
    pub form: Form,
    /// Counts.
    pub dimensions: Dimensions,
    /// The parameters, without inputs.
    pub parameters: Held<[ParameterInfo]>,
    /// Coordinates that must stay in an interval.
    pub charts: Held<[Chart]>,
    /// True if smooth motion is known to keep the energy.
    pub conserves_energy: bool,
    /// True if rates may have narrow features.
    pub can_be_narrow: bool,
    /// True if constraint forms may become dependent.
    pub can_lose_rank: bool,
    /// True if states drift off constraints to which runs bring them back.
    pub drifts: bool,
    /// True if constraints are linear or affine in the velocities.
    pub is_linear: bool,
    /// True if its runs can be varied.
    pub varies: bool,
    /// The levels, where some are declared.
    pub levels: Held<[Level]>,
    /// The surfaces.
    pub surfaces: Held<[Surface]>,
    /// The configuration from which the density of the invariant volume is integrated, if it has no closed form.
    pub density_reference: Option<Held<[f64]>>,
    /// The modes, of a model that has some.
    pub modes: Held<[Mode]>,
}

/// Work of the expansions of a system, in multiplications.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// Work of values at one moment: of a rate, and of gaps where there are surfaces.
    pub values: u32,
    /// Number of sums over products of coefficients. Each needs a multiplication for every pair of coefficients.
    pub sums: u32,
    /// The order after which the series of motion and gaps end, if they end for all numbers.
    pub degree: Option<u32>,
}

impl Work {
    /// Maximum of the work of two modes, field by field.
    #[must_use]
    pub fn most(self, other: Self) -> Self {
        let degrees = self.degree.zip(other.degree);
        Self {
            values: self.values.max(other.values),
            sums: self.sums.max(other.sums),
            degree: degrees.map(|(a, b)| a.max(b)),
        }
    }
}
