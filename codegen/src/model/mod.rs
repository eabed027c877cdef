//! Stage 2, check: resolves every name of a declaration and checks every rule of the language. Nothing is derived yet.
//!
//! A [`Model`] comes from [`check()`], or is derived from such a model. It satisfies all rules of the language: the
//! Lagrangian is natural, the metric is not singular everywhere, the constraints are independent at some state, the
//! surfaces can be reached. Indices follow the order of declaration: `i, j, k` for coordinates, `a, b` for constraints,
//! `s` for surfaces.

mod call;
mod check;
mod culprit;
mod definitions;
mod degree;
mod exterior;
mod form;
mod graph;
mod index;
mod latex;
mod law;
mod natural;
mod order;
mod periodic;
mod polynomial;
mod range;
mod resolve;
mod scene;
mod symbols;
mod transition;
mod unknown;

use dalembert_expr::{ExprId, Pool, Rational, SymbolId};

use crate::spec::ItemId;

pub use crate::spec::Existence;
pub use check::check;
pub(crate) use check::check_within;
pub use exterior::{ExteriorForm, Wedge};
pub use graph::{Entry, Mode, ModeGraph, Places, check_modes};
pub use index::INDICES;
pub use latex::greek_letter;
pub use law::{Law, Reset};
pub use scene::{Extras, Parts, Scene};
pub use transition::{Map, Transition};

/// A checked model. All its expressions are in `pool`.
#[derive(Debug, Clone)]
pub struct Model {
    /// The pool of the expressions.
    pub pool: Pool,
    /// Name of the type, for example `RollingDisk`.
    pub name: String,
    /// Name in snake case, for example `rolling_disk`.
    pub snake_name: String,
    /// Visibility as written: empty, `pub`, `pub(crate)`.
    pub visibility: String,
    /// Lines of the doc comment.
    pub documentation: Vec<String>,
    /// Text of the declaration.
    pub source: String,
    /// Symbol of the time `t`.
    pub time: SymbolId,
    /// Coordinates, with families expanded.
    pub coordinates: Vec<Coordinate>,
    /// Parameters, with families expanded, followed by the inputs.
    pub parameters: Vec<Parameter>,
    /// The Lagrangian and its parts.
    pub lagrangian: Lagrangian,
    /// Rates of the coordinates of a first-order system, functions of `(t, q)`. The Lagrangian is unused then.
    pub field: Option<Vec<ExprId>>,
    /// Constraints, with families expanded.
    pub constraints: Vec<Constraint>,
    /// Cost that an optimal input minimises.
    pub cost: Option<Cost>,
    /// Named forces.
    pub forces: Vec<Force>,
    /// Declared quasi-velocities: N - M of them, or none.
    pub frame: Vec<QuasiForm>,
    /// Impact surfaces, with families expanded.
    pub surfaces: Vec<Surface>,
    /// The declared initial condition.
    pub initial: Initial,
    /// The declared view.
    pub view: Option<View>,
    /// The declared outputs.
    pub outputs: Vec<Output>,
    /// Declared scenes. A scene has none itself.
    pub scenes: Vec<Scene>,
    /// Optional parts of the generated code that are in use, besides forces and surfaces.
    pub extras: Extras,
    /// The declared claims.
    pub claims: Vec<Claim>,
    /// Symbols for derived quantities in outputs and claims.
    pub derived: DerivedSymbols,
    /// Notes for the author, for example on velocity-linear terms, integrable constraints or unused parameters.
    pub notes: Vec<String>,
}

impl Model {
    /// True if the model declares rates of its coordinates instead of a Lagrangian.
    pub fn is_first_order(&self) -> bool {
        self.field.is_some()
    }

    /// The inputs, with their indices in `parameters`.
    pub fn inputs(&self) -> impl Iterator<Item = (usize, &Parameter)> {
        let all = self.parameters.iter().enumerate();
        all.filter(|(_, parameter)| parameter.is_input)
    }

    /// True if some constraint is not linear in the velocities.
    pub fn is_nonlinear(&self) -> bool {
        self.constraints
            .iter()
            .any(|constraint| constraint.nonlinear.is_some())
    }
}

/// A name in messages, and in Rust and formulas.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// The name in messages and on the command line: `theta`, `theta.3`.
    pub display: String,
    /// Name of the Rust field or family: `theta`.
    pub field: String,
    /// 1-based index in its family.
    pub member: Option<usize>,
}

impl Name {
    /// The name of a coordinate's velocity: `theta_dot`, `theta_dot.3`.
    pub fn velocity(&self) -> String {
        match self.member {
            Some(member) => format!("{}_dot.{member}", self.field),
            None => format!("{}_dot", self.display),
        }
    }

    /// The name of a coordinate's momentum: `p_theta`, `p_theta.3`.
    pub fn momentum(&self) -> String {
        format!("p_{}", self.display)
    }
}

/// A coordinate with its velocity.
#[derive(Debug, Clone)]
pub struct Coordinate {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The set of its values.
    pub topology: Topology,
    /// The symbol of the coordinate.
    pub q: SymbolId,
    /// The symbol of its velocity, named `dot(x)`.
    pub qdot: SymbolId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// The set of values of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topology {
    /// The real line.
    Line,
    /// A circle of period 2 pi, stored unwrapped.
    Angle,
    /// An open interval between two constants (expressions without symbols).
    Interval {
        /// Lower end.
        low: ExprId,
        /// Upper end.
        high: ExprId,
    },
}

/// A parameter.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Declared condition on its values.
    pub assumption: Assumption,
    /// Default value, an expression without symbols.
    pub default: Option<ExprId>,
    /// True for an input: a parameter that the caller may change at every instant. Inputs come after all parameters.
    pub is_input: bool,
    /// Symbol.
    pub symbol: SymbolId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// Condition on the values of a parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Assumption {
    /// Any finite number.
    Finite,
    /// `> 0`
    Positive,
    /// `>= 0`
    NonNegative,
    /// `!= 0`
    NonZero,
    /// `in [low, high]`
    Within {
        /// Lower end.
        low: Rational,
        /// Upper end.
        high: Rational,
    },
}

/// `L = 1/2 qdot^T g qdot + A.qdot - V`.
#[derive(Debug, Clone)]
pub struct Lagrangian {
    /// The whole Lagrangian as written, in coordinates, velocities, parameters and time.
    pub whole: ExprId,
    /// `g`, N rows of N, symmetric, independent of velocities.
    pub metric: Vec<Vec<ExprId>>,
    /// `A`, N entries, independent of velocities. All zero without velocity-linear terms.
    pub linear: Vec<ExprId>,
    /// `V`, independent of velocities.
    pub potential: ExprId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A constraint `eta(qdot) + eta_0 = 0`.
#[derive(Debug, Clone)]
pub struct Constraint {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// `eta`, N entries, of the left side minus the right side.
    pub form: Vec<ExprId>,
    /// `eta_0`
    pub affine: ExprId,
    /// `f(t, q)` with `df = eta + eta_0 dt`, if the form is exact with a known integral.
    pub level: Option<ExprId>,
    /// `phi(t, q, qdot)` for a constraint `phi = 0` that is nonlinear in the velocities. Then `form` is `dphi/dqdot`
    /// and `affine` is `phi - eta(qdot)`, both functions of the velocities.
    pub nonlinear: Option<ExprId>,
    /// True if the equation was written at position level: `f = 0`, with `f` the level.
    pub is_of_positions: bool,
    /// Place of the declaration.
    pub item: ItemId,
}

impl Constraint {
    /// The entries of `eta`, then `eta_0`.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.form.iter().copied().chain([self.affine])
    }
}

/// The cost `J = integral of running dt + terminal at the end`, which an optimal input minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Running cost: a function of time, state and inputs, quadratic in the inputs.
    pub running: ExprId,
    /// Terminal cost: a function of time and state.
    pub terminal: ExprId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A force as a one-form. Its coefficients may depend on coordinates, velocities and time.
#[derive(Debug, Clone)]
pub struct Force {
    /// Name.
    pub name: Name,
    /// The coefficients, N entries.
    pub form: Vec<ExprId>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A one-form. Its value on the velocity is a quasi-velocity.
#[derive(Debug, Clone)]
pub struct QuasiForm {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The coefficients, N entries.
    pub form: Vec<ExprId>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A condition on time and position: `margin > 0`, or `margin >= 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The margin, a function of time and position.
    pub margin: ExprId,
    /// True for `margin >= 0`.
    pub is_closed: bool,
}

/// Relation of a surface to others with the same gap. A list of conditions holds if all its conditions hold.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Beside {
    /// The surface counts by its own conditions.
    #[default]
    Independent,
    /// `otherwise`: the surface counts where none of these lists of conditions of other surfaces holds.
    Otherwise(Vec<Vec<Condition>>),
    /// The last of several transitions with the same gap. A motion that reaches the surface ends there if neither the
    /// conditions of this transition nor one of these lists holds.
    Last(Vec<Vec<Condition>>),
}

impl Beside {
    /// The lists of conditions of the other surfaces.
    pub fn others(&self) -> &[Vec<Condition>] {
        match self {
            Self::Independent => &[],
            Self::Otherwise(others) | Self::Last(others) => others,
        }
    }
}

impl Surface {
    /// All functions whose signs decide if the surface counts: its own margins first, then those of the other surfaces,
    /// list by list.
    pub fn margins(&self) -> impl Iterator<Item = ExprId> {
        let others = self.beside.others().iter().flatten();
        self.conditions
            .iter()
            .chain(others)
            .map(|condition| condition.margin)
    }
}

/// An impact surface `h = 0`. Motion is allowed where `h >= 0`.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The gap `h(t, q)`.
    pub gap: ExprId,
    /// Conditions under which the surface counts.
    pub conditions: Vec<Condition>,
    /// Relation to other surfaces with the same gap.
    pub beside: Beside,
    /// Impact law.
    pub law: Law,
    /// The map of the law `reset`.
    pub reset: Option<Reset>,
    /// The transition to another mode, if the surface is one.
    pub transition: Option<Transition>,
    /// Constraints that hold during an impact, and while the surface holds the motion. They have no levels.
    pub instantaneous: Vec<Constraint>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// The declared initial condition. All values are expressions of the parameters.
#[derive(Debug, Clone, Default)]
pub struct Initial {
    /// Positions by coordinate. `None` means 0, or the value that holonomic constraints determine.
    pub q: Vec<Option<ExprId>>,
    /// Velocities by coordinate. `None` means that the velocity is determined by the constraints and the given
    /// velocities.
    pub qdot: Vec<Option<ExprId>>,
    /// End time of the run.
    pub until: Option<ExprId>,
}

/// The view of the configuration that plots show.
#[derive(Debug, Clone)]
pub struct View {
    /// The plotted point, two functions of `(t, q)`.
    pub path: [ExprId; 2],
    /// The two expressions of `path` as written.
    pub labels: [String; 2],
    /// Indices of the two coordinates, if `path` consists of coordinates.
    pub plane: Option<[usize; 2]>,
    /// A function of `(t, q)` that is positive where motion is allowed.
    pub region: Option<ExprId>,
}

/// A quantity written to tables and plots.
#[derive(Debug, Clone)]
pub struct Output {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// An expression of coordinates, velocities, parameters, time and [`DerivedSymbols`].
    pub value: ExprId,
    /// True for the integral of the expression along a run.
    pub is_integral: bool,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A claim: a theorem about the model, stated by its author.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Statement.
    pub statement: Statement,
    /// The claim as written, for example `conserved: energy`.
    pub text: String,
    /// True if an undecided verdict is accepted.
    pub is_assumed: bool,
    /// Index of the scene that the claim is about; `None` for the model itself.
    pub scene: Option<usize>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// One of several functions in a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedFunction {
    /// The function.
    pub value: ExprId,
    /// The function as written.
    pub written: String,
}

/// Statement of a claim. Its expressions may contain coordinates, velocities, parameters, time and [`DerivedSymbols`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Statement {
    /// Existence of a density of the configuration: on all of Q, locally, or none.
    Existence(Existence),
    /// The measure `mu_C` multiplied by this density is invariant.
    Density(ExprId),
    /// A quantity is conserved, or is claimed not to be.
    Conserved {
        /// The quantity.
        value: ExprId,
        /// Index of the surface across which it is conserved; `None` for the motion itself.
        under: Option<usize>,
        /// True if the quantity is claimed to be conserved.
        holds: bool,
    },
    /// The flow of this vector field, N components, preserves the constraints, and the Lagrangian up to a total time
    /// derivative.
    Symmetry(Vec<ExprId>),
    /// The motion and every event at a surface preserve a differential form.
    Invariant(ExteriorForm),
    /// The brackets of these functions with each other vanish.
    Involution(Vec<StatedFunction>),
    /// Integrability: these functions are conserved by motion and events, in involution and independent, and there are
    /// as many of them as D has dimensions.
    Integrable(Vec<StatedFunction>),
    /// The motion and every event at a surface preserve one invariant volume.
    VolumeKept,
    /// Factor by which a surface multiplies the volume.
    Factor {
        /// The factor.
        value: ExprId,
        /// Index of the surface.
        under: usize,
    },
    /// The motion and every event at a surface preserve the symplectic form.
    Symplectic,
    /// An impact at the surface of this index does not increase the energy.
    EnergyNotIncreasing(usize),
}

impl Statement {
    /// Expressions of the statement.
    pub fn expressions(&self) -> Vec<ExprId> {
        match self {
            Self::Existence(_)
            | Self::VolumeKept
            | Self::Symplectic
            | Self::EnergyNotIncreasing(_) => Vec::new(),
            Self::Density(value) | Self::Conserved { value, .. } | Self::Factor { value, .. } => {
                vec![*value]
            }
            Self::Symmetry(field) => field.clone(),
            Self::Involution(functions) | Self::Integrable(functions) => {
                functions.iter().map(|function| function.value).collect()
            }
            Self::Invariant(form) => form.expressions().collect(),
        }
    }

    /// Index of the surface that the statement names, if it names one.
    pub fn surface(&self) -> Option<usize> {
        match self {
            Self::Conserved { under, .. } => *under,
            Self::Factor { under, .. } | Self::EnergyNotIncreasing(under) => Some(*under),
            _ => None,
        }
    }

    /// The same statement about the surface of another index. Other statements are unchanged.
    pub(crate) fn at_surface(self, surface: usize) -> Self {
        match self {
            Self::Conserved { value, holds, .. } => Self::Conserved {
                value,
                under: Some(surface),
                holds,
            },
            Self::Factor { value, .. } => Self::Factor {
                value,
                under: surface,
            },
            Self::EnergyNotIncreasing(_) => Self::EnergyNotIncreasing(surface),
            other => other,
        }
    }
}

/// Symbols for derived quantities in outputs and claims.
#[derive(Debug, Clone)]
pub struct DerivedSymbols {
    /// `energy`
    pub energy: SymbolId,
    /// `momentum(x)`, N symbols.
    pub momenta: Vec<SymbolId>,
    /// `multiplier(a)`, M symbols.
    pub multipliers: Vec<SymbolId>,
}
