//! What is known of a form of a model besides its kernels.

use crate::description::{Documentation, ParameterInfo};
use crate::law::Law;

/// What a state consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Positions and momenta.
    Global,
    /// Positions and quasi-velocities.
    Reduced,
    /// Positions alone, of a first-order system.
    FirstOrder,
}

/// Numbers of things.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimensions {
    /// Components of a state; those of a model with modes are one more than those of the longest mode.
    pub state: usize,
    /// Coordinates, of whatever mode.
    pub coordinates: usize,
    /// Momenta or quasi-velocities in a state, of the mode that has most.
    pub motion: usize,
    /// Constraints, of the mode that has most.
    pub constraints: usize,
    /// Integrable constraints whose function is known, of the mode that has most.
    pub levels: usize,
    /// Surfaces, of whatever mode.
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
    /// Whether a margin of 0 is enough.
    pub is_closed: bool,
}

/// How a surface goes with others of the same gap. A list of conditions holds where all of them hold.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// The law, with a coefficient of 0 where it has one.
    pub law: Law,
    /// The name of the coefficient, for errors.
    pub coefficient: Option<&'static str>,
    /// Its conditions.
    pub conditions: &'static [Condition],
    /// Those of others of the same gap, list after list.
    pub others: &'static [&'static [Condition]],
    /// How both decide whether it counts.
    pub beside: Beside,
    /// The coordinates that the gap takes, by bits; all from the last bit on share it.
    pub takes: u64,
}

/// What a level belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Index of the constraint.
    pub constraint: usize,
    /// Whether the constraint is an equation of positions, so that the level of every state is 0.
    pub is_zero: bool,
}

/// The rule by which a transition makes the state of the mode that it leads to.
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

/// A surface that leads to another mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The mode that is entered.
    pub enters: usize,
    /// How it is entered.
    pub passage: Passage,
    /// Whether the surface counts from both sides: the opposite of its gap belongs to another transition of the same mode.
    pub has_no_side: bool,
    /// The surface of the model that leads back at once, between first-order modes.
    pub opposite: Option<usize>,
}

/// A mode of a model: its own tables, and the places of what it has among what the model has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// What is known of the mode by itself.
    pub tables: &'static Tables,
    /// What it says of itself.
    pub documentation: &'static Documentation,
    /// The place of its kernels among those of the model.
    pub kernels: usize,
    /// That of the kernels of its global form, which may be the same.
    pub global: usize,
    /// Coordinates.
    pub coordinates: &'static [usize],
    /// Constraints.
    pub constraints: &'static [usize],
    /// Surfaces.
    pub surfaces: &'static [usize],
    /// Outputs.
    pub outputs: &'static [usize],
    /// Of each of its surfaces, where it leads.
    pub transitions: &'static [Option<Transition>],
}

/// What is known of a form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tables {
    /// What a state consists of.
    pub form: Form,
    /// Numbers of things.
    pub dimensions: Dimensions,
    /// The parameters, without inputs.
    pub parameters: &'static [ParameterInfo],
    /// Coordinates that must stay in an interval.
    pub charts: &'static [Chart],
    /// Whether smooth motion is known to keep the energy.
    pub conserves_energy: bool,
    /// Whether rates may have narrow features.
    pub can_be_narrow: bool,
    /// Whether constraint forms may become dependent.
    pub can_lose_rank: bool,
    /// Whether states drift off constraints that runs bring them back to.
    pub drifts: bool,
    /// Whether constraints are linear or affine in the velocities.
    pub is_linear: bool,
    /// Whether its runs can be varied.
    pub varies: bool,
    /// The levels, where some are declared.
    pub levels: &'static [Level],
    /// The surfaces.
    pub surfaces: &'static [Surface],
    /// The configuration from which on the density of the invariant volume is integrated, if it has no closed form.
    pub density_reference: Option<&'static [f64]>,
    /// The modes, of a model that has some.
    pub modes: &'static [Mode],
}

/// What the expansions of a system take, in multiplications.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// Values at one moment: of a rate, and of gaps where there are surfaces.
    pub values: u32,
    /// Sums over products of coefficients: each takes a multiplication for every pair of coefficients.
    pub sums: u32,
    /// The order after which the series of motion and gaps end, if they do whatever the numbers are.
    pub degree: Option<u32>,
}

impl Work {
    /// The greater of each, of what expansions of two modes take.
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
