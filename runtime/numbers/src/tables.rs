//! Data of a form of a model, apart from its kernels.

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
    /// Positions only: the model is a first-order system.
    FirstOrder,
}

/// Sizes of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimensions {
    /// Components of a state. In a model with modes, a state has room for that of every mode, and one more component.
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

/// Relation of a surface to others of the same gap. A list of conditions holds where all its conditions hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// It counts by its own conditions.
    Independent,
    /// It counts where no list of another surface holds.
    Otherwise,
    /// It counts where its own conditions hold, or where no list of another surface holds.
    Last,
}

/// A surface.
#[derive(Debug, PartialEq)]
pub struct Surface {
    /// The law, with 0 in place of its coefficient, which may depend on parameters.
    pub law: Law,
    /// The name of the coefficient, for errors.
    pub coefficient: Option<&'static str>,
    /// Its conditions.
    pub conditions: Held<[Condition]>,
    /// Conditions of the other surfaces of the same gap, list after list.
    pub others: Held<[Held<[Condition]>]>,
    /// Rule by which `conditions` and `others` decide if the surface counts.
    pub beside: Beside,
    /// Number of absolute values in the gap. Their arguments follow the margins of all conditions.
    pub kinks: usize,
    /// Bit set of the coordinates that the gap depends on. The last bit stands for all coordinates from its index on.
    pub takes: u64,
    /// True if the declared reset changes nothing that the gap depends on, so that the state after it lies on the surface.
    pub keeps_gap: bool,
}

/// A position level: a function of the positions that a constraint keeps constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Index of the constraint.
    pub constraint: usize,
    /// True if the constraint is declared as an equation of positions: the level is 0 at every state that satisfies it.
    pub is_zero: bool,
}

/// The rule by which a transition makes the state of the mode that it enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// The state is declared.
    Declared,
    /// First-order systems: the position stays.
    Kept,
    /// Both modes have the same Lagrangian: the state moves to the focusing point.
    Focused,
    /// The Lagrangian changes: the motion is refracted or reflected.
    Refracted,
}

/// A transition of a surface to another mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The mode that is entered.
    pub enters: usize,
    /// Rule of the entry.
    pub passage: Passage,
    /// True if the motion may be on both sides of the surface: another transition of the same mode has the negative of
    /// its gap.
    pub has_no_side: bool,
    /// Between first-order modes, the surface of the model whose transition can lead back at once.
    pub opposite: Option<usize>,
    /// The surfaces of the model that bound the entered mode and have the same gap, and the negative of it, if the positions
    /// are kept.
    pub meets: [Option<usize>; 2],
}

/// A mode of a model: its own tables, and the places of its quantities among those of the model.
#[derive(Debug, PartialEq)]
pub struct Mode {
    /// Tables of the mode by itself.
    pub tables: Held<Tables>,
    /// Its self-description.
    pub documentation: Held<Documentation>,
    /// Index of its kernels among those of the model.
    pub kernels: usize,
    /// Index of the kernels of its global form, which may be the same.
    pub global: usize,
    /// Indices of its coordinates among those of the model.
    pub coordinates: Held<[usize]>,
    /// Indices of its constraints.
    pub constraints: Held<[usize]>,
    /// Indices of its surfaces.
    pub surfaces: Held<[usize]>,
    /// Indices of its outputs.
    pub outputs: Held<[usize]>,
    /// One entry per surface of the mode: its transition, if it leads to another mode.
    pub transitions: Held<[Option<Transition>]>,
}

/// Data of a form.
#[derive(Debug, PartialEq)]
pub struct Tables {
    /// Components of a state.
    pub form: Form,
    /// Sizes.
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
    /// True if time occurs in rates, gaps, conditions or laws.
    pub depends_on_time: bool,
    /// True if integration drifts off the constraints, so that runs project states back onto them.
    pub drifts: bool,
    /// True if constraints are linear or affine in the velocities.
    pub is_linear: bool,
    /// True if runs of the form can be differentiated.
    pub varies: bool,
    /// The position levels of constraints, if some are declared.
    pub levels: Held<[Level]>,
    /// The surfaces.
    pub surfaces: Held<[Surface]>,
    /// The configuration from which the density of the invariant volume is integrated, if it has no closed form.
    pub density_reference: Option<Held<[f64]>>,
    /// The modes; empty for a model without modes.
    pub modes: Held<[Mode]>,
}

/// Work of the expansions of a system, in multiplications.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// Work of one evaluation of the rate, and of the gaps if there are surfaces.
    pub values: u32,
    /// Number of sums over products of coefficients. Each needs a multiplication for every pair of coefficients.
    pub sums: u32,
    /// Degree of the series of motion and gaps, if they are polynomials for all values of the parameters.
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
