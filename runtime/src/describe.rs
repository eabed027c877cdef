//! What a model says of itself: names, documentation, parameters, and where to look at it.
//!
//! Implemented by `model!` for every model, so that a tool can list, set and re-derive any of them.

pub use crate::assumption::Assumption;
use crate::contract::{System, Variational};
use crate::effects::Scene;
use crate::error::Fault;

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
    /// `check`; `Described::visit_scenes` does not show them.
    pub scenes: &'static [&'static str],
    /// The modes; none of a model in one piece.
    pub modes: &'static [ModeInfo],
    /// The view, if declared.
    pub view: Option<ViewInfo>,
}

/// A declared model with values for its parameters: what it tells of itself, and of its states.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a model declared with `dalembert::model!`"
)]
pub trait Instance: System + Clone {
    /// Names, docs, topology, parameters, surfaces, scenes, source text.
    fn description(&self) -> &'static Description;

    /// The inputs; their values are the parameters after those of the description.
    fn inputs(&self) -> &'static [&'static str] {
        &[]
    }

    /// Shows the system to a visitor if its runs can be varied: the model itself can, and scenes with `variations`.
    fn visit_variational<Visitor: VariationalVisitor>(
        &self,
        visitor: Visitor,
    ) -> Option<Visitor::Output> {
        let _ = visitor;
        None
    }

    /// The same system in its global form, with the state (q, p) on T*Q, off the constraints too. The model itself
    /// where it has no form reduced to D.
    type Global: Instance<Vector = Self::Vector, Global = Self::Global> + Scene + 'static;

    /// The system in its global form.
    fn global(&self) -> Self::Global;

    /// Value of the parameter of this index in [`Description::parameters`]; NaN past the end.
    fn parameter(&self, index: usize) -> f64;

    /// Sets a parameter by index; an index past the end changes nothing.
    fn set_parameter(&mut self, index: usize, value: f64);

    /// Chooses the mode, by number, in which states are made and that a run begins in; a number past the end changes
    /// nothing, and so does any where there are no modes.
    fn set_mode(&mut self, mode: usize) {
        let _ = mode;
    }

    /// The declared `initial` at this system's parameters.
    fn initial(&self) -> Initial<Self::Vector>;

    /// The declared outputs at a state, written in order; `values` has their number of entries.
    ///
    /// # Errors
    /// A [`Fault`] where an output needs the equations of motion and they do not exist.
    fn outputs(&self, t: f64, state: &Self::State, values: &mut [f64]) -> Result<(), Fault>;

    /// The declared view's point in the plane; `None` without a view.
    fn view_path(&self, t: f64, state: &Self::State) -> Option<[f64; 2]>;

    /// The declared region's function, positive where motion is allowed; `None` without a region.
    fn view_region(&self, t: f64, q: &Self::Vector) -> Option<f64>;

    /// Reports everything that is derived at a state, by name (see [`Report`]).
    ///
    /// # Errors
    /// A [`Fault`] where the equations of motion do not exist.
    fn inspect(&self, t: f64, state: &Self::State, report: &mut dyn Report) -> Result<(), Fault>;

    /// Reports what is derived in the frame of D alone: quasi-velocities and their rates, `X_0`, the rows `X_i`, `G_D`, the
    /// density of `mu_C` in positions and quasi-velocities. Nothing in global form.
    ///
    /// # Errors
    /// A [`Fault`] where the equations of motion do not exist.
    fn inspect_frame(
        &self,
        t: f64,
        state: &Self::State,
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        let _ = (t, state, report);
        Ok(())
    }
}

/// Sees a system whose runs can be varied (see [`Instance::visit_variational`]).
pub trait VariationalVisitor {
    /// What it makes of it.
    type Output;

    /// The system, in its own type.
    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output;
}

/// The declared initial condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Initial<V> {
    /// Positions; coordinates that were not named are 0.
    pub q: V,
    /// Velocities, meaningful where `named` is 1.
    pub qdot: V,
    /// 1 where the position was named, 0 where equations of positions among the constraints may choose it.
    pub placed: V,
    /// 1 where the velocity was named, 0 where the constraints may choose it.
    pub named: V,
    /// The declared `until`, if any.
    pub until: Option<f64>,
}

/// Receives named quantities. Names are those of the command line's `eval`.
pub trait Report {
    /// A number.
    fn scalar(&mut self, name: &str, value: f64);

    /// A vector, in order of declaration.
    fn vector(&mut self, name: &str, values: &[f64]);

    /// A matrix, stored row after row.
    fn matrix(&mut self, name: &str, rows: usize, columns: usize, values: &[f64]);
}
