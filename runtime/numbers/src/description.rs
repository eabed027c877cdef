//! Self-description of a model: names, documentation, parameters, and the view.

pub use crate::assumption::Assumption;
use crate::held::Held;
use crate::kernel::Shape;

/// The set a coordinate runs through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Topology {
    /// The real line.
    Line,
    /// A circle of period 2 pi, stored unwrapped.
    Circle,
    /// An open interval; leaving it ends a run with `LeftChart`.
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
    /// Name as the command line writes it: `x`, `theta.3`.
    pub name: &'static str,
    /// The set of its values.
    pub topology: Topology,
}

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Name as the command line writes it: `m`, `m.3`.
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
    /// True if it has an affine part `eta_0`.
    pub affine: bool,
    /// Index among the position-level values when the constraint is integrable with a known function.
    pub level: Option<usize>,
}

/// One mode of a model with modes.
#[derive(Debug, PartialEq)]
pub struct ModeInfo {
    /// Declared name.
    pub name: &'static str,
    /// Indices of its coordinates among those of the model, in its own order.
    pub coordinates: Held<[usize]>,
}

/// One impact surface.
#[derive(Debug, PartialEq)]
pub struct SurfaceInfo {
    /// Declared name.
    pub name: &'static str,
    /// The declared law as written, `elastic` when none was.
    pub law: Held<str>,
}

/// The declared `view`: the content of a picture of the model.
#[derive(Debug, PartialEq)]
pub struct ViewInfo {
    /// The two expressions of `path`, as written.
    pub labels: [Held<str>; 2],
    /// Indices of the coordinates that span the plane, when `path` is a pair of coordinates.
    pub plane: Option<[usize; 2]>,
    /// True if a `region` was declared.
    pub region: bool,
}

/// Static description of a model. All lists are in the order of declaration.
#[derive(Debug, PartialEq)]
pub struct Description {
    /// The type's name, `RollingDisk`.
    pub type_name: &'static str,
    /// Snake case, as the command line writes it: `rolling_disk`.
    pub name: &'static str,
    /// The model's doc comment.
    pub documentation: Held<str>,
    /// The declaration, as given to the macro.
    pub source: Held<str>,
    /// True if a `field` was declared in place of a Lagrangian: the state is the position, and there are no momenta and no energy.
    pub is_first_order: bool,
    /// The coordinates.
    pub coordinates: Held<[CoordinateInfo]>,
    /// The parameters; a family has one entry per member.
    pub parameters: Held<[ParameterInfo]>,
    /// The constraints.
    pub constraints: Held<[ConstraintInfo]>,
    /// The named forces.
    pub forces: Held<[&'static str]>,
    /// The quasi-velocities of the form reduced to D. The velocity of a coordinate has the coordinate's name with `_dot`.
    /// Empty where the equations are solved in the global form.
    pub quasi_velocities: Held<[&'static str]>,
    /// The impact surfaces.
    pub surfaces: Held<[SurfaceInfo]>,
    /// The declared outputs.
    pub outputs: Held<[&'static str]>,
    /// The outputs that are integrals along a run, by index. At a state their function gives the integrand.
    pub integrals: Held<[usize]>,
    /// The scenes; `all`, the model itself, comes first. For a model with modes, each mode by itself is a scene of
    /// `derive` and `check`; a visitor of scenes does not see it.
    pub scenes: Held<[&'static str]>,
    /// The modes; empty for a model without modes.
    pub modes: Held<[ModeInfo]>,
    /// The view, if declared.
    pub view: Option<ViewInfo>,
}

/// A quantity that [`Kernel::Geometry`](crate::Kernel::Geometry) gives: its name, and the arrangement of its numbers.
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
    /// Names, docs, topology and the like.
    pub description: Description,
    /// The inputs; their values are the parameters after those of the description.
    pub inputs: Held<[&'static str]>,
    /// True for coordinates whose position was declared, in order.
    pub placed: Held<[bool]>,
    /// True for coordinates whose velocity was declared, in order.
    pub named: Held<[bool]>,
    /// The quantities of [`Kernel::Geometry`](crate::Kernel::Geometry), in order.
    pub geometry: Held<[Quantity]>,
}
