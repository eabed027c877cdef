//! What a model says of itself: names, documentation, parameters, and where to look at it.

pub use crate::assumption::Assumption;
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
    /// Where it runs.
    pub topology: Topology,
}

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterInfo {
    /// Name as the command line writes it: `m`, `m.3`.
    pub name: &'static str,
    /// What its values must satisfy.
    pub assumption: Assumption,
    /// The declared default.
    pub default: Option<f64>,
}

/// One constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintInfo {
    /// Declared name.
    pub name: &'static str,
    /// Whether it has an affine part `eta_0`.
    pub affine: bool,
    /// Index among the position-level values when the constraint is integrable with a known function.
    pub level: Option<usize>,
}

/// One mode of a model with modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeInfo {
    /// Declared name.
    pub name: &'static str,
    /// Indices of its coordinates among those of the model, in its own order.
    pub coordinates: &'static [usize],
}

/// One impact surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceInfo {
    /// Declared name.
    pub name: &'static str,
    /// The declared law as written, `elastic` when none was.
    pub law: &'static str,
}

/// The declared `view`: what a picture of the model shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewInfo {
    /// The two expressions of `path`, as written.
    pub labels: [&'static str; 2],
    /// Indices of the coordinates that span the plane, when `path` is a pair of coordinates.
    pub plane: Option<[usize; 2]>,
    /// Whether a `region` was declared.
    pub region: bool,
}

/// Everything static that is known of a model. Orders are orders of declaration throughout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Description {
    /// The type's name, `RollingDisk`.
    pub type_name: &'static str,
    /// Snake case, as the command line writes it: `rolling_disk`.
    pub name: &'static str,
    /// The model's doc comment.
    pub documentation: &'static str,
    /// The declaration, as given to the macro.
    pub source: &'static str,
    /// Whether a `field` was declared in place of a Lagrangian: the state is the position, and there are no momenta and
    /// no energy.
    pub is_first_order: bool,
    /// The coordinates.
    pub coordinates: &'static [CoordinateInfo],
    /// The parameters; a family takes one entry per member.
    pub parameters: &'static [ParameterInfo],
    /// The constraints.
    pub constraints: &'static [ConstraintInfo],
    /// The named forces.
    pub forces: &'static [&'static str],
    /// The quasi-velocities of the form reduced to D; a coordinate's velocity goes by the coordinate's name with
    /// `_dot`. None where the equations are solved in the global form.
    pub quasi_velocities: &'static [&'static str],
    /// The impact surfaces.
    pub surfaces: &'static [SurfaceInfo],
    /// The declared outputs.
    pub outputs: &'static [&'static str],
    /// The scenes; `all`, the model itself, comes first. Of a model with modes each mode by itself is one for `derive` and
    /// `check`; a visitor of scenes is not shown them.
    pub scenes: &'static [&'static str],
    /// The modes; none of a model in one piece.
    pub modes: &'static [ModeInfo],
    /// The view, if declared.
    pub view: Option<ViewInfo>,
}

/// A quantity that [`Kernel::Geometry`](crate::Kernel::Geometry) gives: its name, and how its numbers are arranged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The name, as `eval` prints it.
    pub name: &'static str,
    /// The shape.
    pub shape: Shape,
}

/// The self-description of a form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Documentation {
    /// Names, docs, topology and the like.
    pub description: Description,
    /// The inputs; their values are the parameters after those of the description.
    pub inputs: &'static [&'static str],
    /// Of each coordinate, whether its position was declared.
    pub placed: &'static [bool],
    /// Of each coordinate, whether its velocity was declared.
    pub named: &'static [bool],
    /// The quantities of [`Kernel::Geometry`](crate::Kernel::Geometry), in order.
    pub geometry: &'static [Quantity],
}
