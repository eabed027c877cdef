//! Self-description of a model: names, documentation, parameters, and the view.

pub use crate::assumption::Assumption;
use crate::held::Held;
use crate::kernel::Shape;

/// The set of values of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Topology {
    /// The real line.
    Line,
    /// A circle of period 2 pi, stored unwrapped.
    Circle,
    /// An open interval. A run ends with `LeftChart` when the coordinate leaves it.
    Interval {
        /// Lower end; may be minus infinity.
        low: f64,
        /// Upper end; may be infinity.
        high: f64,
    },
}

/// One coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoordinateInfo {
    /// Name on the command line: `x`, `theta.3`.
    pub name: &'static str,
    /// The set of its values.
    pub topology: Topology,
}

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Name on the command line: `m`, `m.3`.
    pub name: &'static str,
    /// Condition on its values.
    pub assumption: Assumption,
    /// The declared default.
    pub default: Option<f64>,
}

/// One constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintInfo {
    /// Declared name.
    pub name: &'static str,
    /// True if it is linear in the velocities with an affine part `eta_0`.
    pub affine: bool,
    /// Index among the position levels; `None` unless the constraint is integrable with a known level.
    pub level: Option<usize>,
}

/// One mode of a model with modes.
#[derive(Debug, PartialEq)]
pub struct ModeInfo {
    /// Declared name.
    pub name: &'static str,
    /// Indices of its coordinates among those of the model, in the order of the mode.
    pub coordinates: Held<[usize]>,
}

/// One impact surface.
#[derive(Debug, PartialEq)]
pub struct SurfaceInfo {
    /// Declared name.
    pub name: &'static str,
    /// Source text of the declared law; `elastic` if none is declared.
    pub law: Held<str>,
}

/// The declared `view`: the content of plots of the model.
#[derive(Debug, PartialEq)]
pub struct ViewInfo {
    /// Source texts of the two expressions of `path`.
    pub labels: [Held<str>; 2],
    /// Indices of the coordinates that span the plane; `None` unless `path` is a pair of coordinates.
    pub plane: Option<[usize; 2]>,
    /// True if a `region` was declared.
    pub region: bool,
}

/// Static description of a model. All lists are in the order of declaration.
#[derive(Debug, PartialEq)]
pub struct Description {
    /// Name of the type: `RollingDisk`.
    pub type_name: &'static str,
    /// Name on the command line, in snake case: `rolling_disk`.
    pub name: &'static str,
    /// The model's doc comment.
    pub documentation: Held<str>,
    /// Source text of the declaration.
    pub source: Held<str>,
    /// True if a `field` is declared in place of a Lagrangian. The state is then the position; there are no momenta and
    /// no energy.
    pub is_first_order: bool,
    /// The coordinates.
    pub coordinates: Held<[CoordinateInfo]>,
    /// The parameters; a family has one entry per member.
    pub parameters: Held<[ParameterInfo]>,
    /// The constraints.
    pub constraints: Held<[ConstraintInfo]>,
    /// The named forces.
    pub forces: Held<[&'static str]>,
    /// Names of the quasi-velocities of the form reduced to D. A quasi-velocity that is the velocity of a coordinate
    /// has the coordinate's name with `_dot`. Empty if the equations are solved in the global form.
    pub quasi_velocities: Held<[&'static str]>,
    /// The impact surfaces.
    pub surfaces: Held<[SurfaceInfo]>,
    /// The declared outputs.
    pub outputs: Held<[&'static str]>,
    /// Indices of the outputs that are integrals along a run. At a state, their function returns the integrand.
    pub integrals: Held<[usize]>,
    /// The scenes. The first one is `all`, the model itself. For a model with modes, each mode is listed as a scene,
    /// for `derive` and `check`; visitors of scenes do not visit modes.
    pub scenes: Held<[&'static str]>,
    /// The modes; empty for a model without modes.
    pub modes: Held<[ModeInfo]>,
    /// The view, if declared.
    pub view: Option<ViewInfo>,
}

/// A quantity of [`Kernel::Geometry`](crate::Kernel::Geometry): its name, and the shape of its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The name, as `eval` prints it.
    pub name: &'static str,
    /// The shape.
    pub shape: Shape,
}

/// The self-description of a form.
#[derive(Debug, PartialEq)]
pub struct Documentation {
    /// Names, doc comments, topologies and other data.
    pub description: Description,
    /// The inputs. Their values follow the parameters of the description.
    pub inputs: Held<[&'static str]>,
    /// One flag per coordinate: true if its initial position is declared.
    pub placed: Held<[bool]>,
    /// One flag per coordinate: true if its initial velocity is declared.
    pub named: Held<[bool]>,
    /// The quantities of [`Kernel::Geometry`](crate::Kernel::Geometry), in order.
    pub geometry: Held<[Quantity]>,
}
