//! What is known of a form of a model besides its kernels.

use super::Mode;
use crate::contract::Level;
use crate::describe::ParameterInfo;

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
    pub law: crate::law::Law,
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
    /// The modes, of a model that has some.
    pub modes: &'static [Mode],
}
