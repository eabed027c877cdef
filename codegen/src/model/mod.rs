//! Stage 2, check: resolves every name of a declaration and checks every rule of the language. Nothing is derived yet.
//!
//! A [`Model`] can only be had from [`check()`], so it satisfies every rule a declaration must: the Lagrangian is
//! natural, the metric is not degenerate, the constraints are independent, surfaces can be
//! reached. Indices are in order of declaration throughout: `i, j, k` coordinates, `a, b` constraints, `s` surfaces.

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
#[cfg(test)]
mod refusals;
mod resolve;
mod scene;
mod symbols;
#[cfg(test)]
mod tests;
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

/// A checked model: all expressions live in `pool`.
#[derive(Debug, Clone)]
pub struct Model {
    /// The expressions.
    pub pool: Pool,
    /// The type's name, `RollingDisk`.
    pub name: String,
    /// Snake case of `name`, `rolling_disk`.
    pub snake_name: String,
    /// The visibility as written: ``, `pub`, `pub(crate)`.
    pub visibility: String,
    /// Lines of the doc comment.
    pub documentation: Vec<String>,
    /// The declaration as text.
    pub source: String,
    /// The symbol of time `t`.
    pub time: SymbolId,
    /// Coordinates, families expanded.
    pub coordinates: Vec<Coordinate>,
    /// Parameters, families expanded; then inputs.
    pub parameters: Vec<Parameter>,
    /// The Lagrangian and its parts.
    pub lagrangian: Lagrangian,
    /// The rates of the coordinates of a first-order system, functions of `(t, q)`. The Lagrangian has no meaning then.
    pub field: Option<Vec<ExprId>>,
    /// Constraints, families expanded.
    pub constraints: Vec<Constraint>,
    /// The cost that an optimal input makes least.
    pub cost: Option<Cost>,
    /// Named forces.
    pub forces: Vec<Force>,
    /// The declared quasi-velocities, N - M or none.
    pub frame: Vec<QuasiForm>,
    /// Impact surfaces, families expanded.
    pub surfaces: Vec<Surface>,
    /// The declared initial condition.
    pub initial: Initial,
    /// The declared view.
    pub view: Option<View>,
    /// The declared outputs.
    pub outputs: Vec<Output>,
    /// The declared scenes; a scene itself has none.
    pub scenes: Vec<Scene>,
    /// Extras in use besides forces and surfaces.
    pub extras: Extras,
    /// The declared claims.
    pub claims: Vec<Claim>,
    /// Symbols that stand for derived quantities in outputs and claims.
    pub derived: DerivedSymbols,
    /// Remarks a person should see: velocity-linear terms, integrable constraints, unused parameters.
    pub notes: Vec<String>,
}

impl Model {
    /// True if the rates of the coordinates were declared, in place of a Lagrangian.
    pub fn is_first_order(&self) -> bool {
        self.field.is_some()
    }

    /// The inputs, with their indices among the parameters.
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

/// A name as the user knows it, and as Rust and formulas write it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// Form in messages and on the command line: `theta`, `theta.3`.
    pub display: String,
    /// The Rust field or family: `theta`.
    pub field: String,
    /// 1-based index in its family.
    pub member: Option<usize>,
}

/// A coordinate with its velocity.
#[derive(Debug, Clone)]
pub struct Coordinate {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The set it runs through.
    pub topology: Topology,
    /// The symbol of the coordinate.
    pub q: SymbolId,
    /// The symbol of its velocity; named `dot(x)`.
    pub qdot: SymbolId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// The set a coordinate runs through.
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
    /// The demand on its values.
    pub assumption: Assumption,
    /// Default, an expression without symbols.
    pub default: Option<ExprId>,
    /// True for an input: a parameter that the caller may change at every instant. Inputs come after all parameters.
    pub is_input: bool,
    /// Symbol.
    pub symbol: SymbolId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// The demand on a parameter's values.
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
    /// The whole as written, in coordinates, velocities, parameters and time.
    pub whole: ExprId,
    /// `g`, N rows of N, symmetric, free of velocities.
    pub metric: Vec<Vec<ExprId>>,
    /// `A`, N entries, free of velocities; zero without velocity-linear terms.
    pub linear: Vec<ExprId>,
    /// `V`, free of velocities.
    pub potential: ExprId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// `eta(qdot) + eta_0 = 0`.
#[derive(Debug, Clone)]
pub struct Constraint {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// `eta`, N entries: left side minus right side, exactly as written.
    pub form: Vec<ExprId>,
    /// `eta_0`.
    pub affine: ExprId,
    /// `f(t, q)` with `df = eta + eta_0 dt`, when the form is exact with a known function.
    pub level: Option<ExprId>,
    /// `phi(t, q, qdot)` of a constraint `phi = 0` that is not linear in the velocities. Its form is `dphi/dqdot`, its affine
    /// part `phi - eta(qdot)`, both functions of the velocities.
    pub nonlinear: Option<ExprId>,
    /// True if the equation itself is one of positions, `f = 0` with `f` the level.
    pub is_of_positions: bool,
    /// Place of the declaration.
    pub item: ItemId,
}

impl Constraint {
    /// `eta` and `eta_0`.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.form.iter().copied().chain([self.affine])
    }
}

/// `J = integral of running + terminal at the end`, which an optimal input makes least.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// A function of time, state and inputs, quadratic in the inputs.
    pub running: ExprId,
    /// A function of time and state.
    pub terminal: ExprId,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A force as a one-form; coefficients may depend on coordinates, velocities and time.
#[derive(Debug, Clone)]
pub struct Force {
    /// Name.
    pub name: Name,
    /// N entries.
    pub form: Vec<ExprId>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A one-form whose value on the velocity is a quasi-velocity.
#[derive(Debug, Clone)]
pub struct QuasiForm {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// N entries.
    pub form: Vec<ExprId>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A condition on time and position: a function of them is positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The function.
    pub margin: ExprId,
    /// True if it may be 0, too.
    pub is_closed: bool,
}

/// Relation of a surface to others with the same gap. A list of conditions holds if all of them hold.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Beside {
    /// The surface counts by its own conditions.
    #[default]
    Independent,
    /// `otherwise`: the surface counts where none of these lists, those of the others, holds.
    Otherwise(Vec<Vec<Condition>>),
    /// The last of several transitions with one gap. Where neither its own conditions nor one of these lists holds, a
    /// motion that reaches the surface ends.
    Last(Vec<Vec<Condition>>),
}

impl Beside {
    /// The conditions of the others.
    pub fn others(&self) -> &[Vec<Condition>] {
        match self {
            Self::Independent => &[],
            Self::Otherwise(others) | Self::Last(others) => others,
        }
    }
}

impl Surface {
    /// All functions whose signs decide where the surface counts: its own first, then those of the others, list after
    /// list.
    pub fn margins(&self) -> impl Iterator<Item = ExprId> {
        let others = self.beside.others().iter().flatten();
        self.conditions
            .iter()
            .chain(others)
            .map(|condition| condition.margin)
    }
}

/// An impact surface `h = 0`; motion is allowed where `h >= 0`.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// `h(t, q)`.
    pub gap: ExprId,
    /// Conditions under which the surface counts.
    pub conditions: Vec<Condition>,
    /// Relation to the other surfaces of the same gap.
    pub beside: Beside,
    /// Law.
    pub law: Law,
    /// The map of the law `reset`.
    pub reset: Option<Reset>,
    /// The mode that is entered here.
    pub transition: Option<Transition>,
    /// Constraints that hold at an impact, and while the surface holds the motion; without levels.
    pub instantaneous: Vec<Constraint>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// The declared initial condition: expressions of the parameters.
#[derive(Debug, Clone, Default)]
pub struct Initial {
    /// Positions by coordinate; unnamed ones are 0.
    pub q: Vec<Option<ExprId>>,
    /// Velocities by coordinate; unnamed ones follow from the constraints.
    pub qdot: Vec<Option<ExprId>>,
    /// The horizon.
    pub until: Option<ExprId>,
}

/// View of a picture.
#[derive(Debug, Clone)]
pub struct View {
    /// The point drawn, two functions of `(t, q)`.
    pub path: [ExprId; 2],
    /// The two expressions of the path as written.
    pub labels: [String; 2],
    /// The indices of the coordinates that `path` consists of, if it does.
    pub plane: Option<[usize; 2]>,
    /// A function of `(t, q)`, positive in the region where motion is allowed.
    pub region: Option<ExprId>,
}

/// A quantity carried to tables and plots.
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

/// A theorem about the model that its author states.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Statement.
    pub statement: Statement,
    /// The claim as written: `conserved: energy`.
    pub text: String,
    /// True if an open answer is accepted.
    pub is_assumed: bool,
    /// Index of the scene; `None` for the model itself.
    pub scene: Option<usize>,
    /// Place of the declaration.
    pub item: ItemId,
}

/// A function of a claim about several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedFunction {
    /// The function.
    pub value: ExprId,
    /// The function as written.
    pub written: String,
}

/// Statement of a claim. Its expressions depend on coordinates, velocities, parameters, time and [`DerivedSymbols`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Statement {
    /// Extent to which a density of the configuration exists.
    Existence(Existence),
    /// The measure with this factor of `mu_C` is invariant.
    Density(ExprId),
    /// A quantity is conserved, or not.
    Conserved {
        /// The quantity.
        value: ExprId,
        /// Index of the surface across which it is conserved; `None` for the motion itself.
        under: Option<usize>,
        /// True if the quantity is claimed to be conserved.
        holds: bool,
    },
    /// The flow of this vector field, N components, keeps the Lagrangian and the constraints.
    Symmetry(Vec<ExprId>),
    /// The motion and every event at a surface keep a differential form.
    Invariant(ExteriorForm),
    /// The brackets of these functions with each other are 0.
    Involution(Vec<StatedFunction>),
    /// These functions are as many as D has dimensions, conserved by motion and events, in involution and independent.
    Integrable(Vec<StatedFunction>),
    /// The motion and every event at a surface keep one invariant volume.
    VolumeKept,
    /// Factor of the volume at a surface.
    Factor {
        /// The factor.
        value: ExprId,
        /// The index of the surface.
        under: usize,
    },
    /// The motion and every event at a surface keep the symplectic form.
    Symplectic,
    /// The energy after an impact at the surface of this index is not above that before it.
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

    /// Index of the surface that it names.
    pub fn surface(&self) -> Option<usize> {
        match self {
            Self::Conserved { under, .. } => *under,
            Self::Factor { under, .. } | Self::EnergyNotIncreasing(under) => Some(*under),
            _ => None,
        }
    }

    /// The same statement about a surface of another index.
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

/// Symbols that stand for derived quantities where outputs and claims name them.
#[derive(Debug, Clone)]
pub struct DerivedSymbols {
    /// `energy`
    pub energy: SymbolId,
    /// `momentum(x)`, N symbols.
    pub momenta: Vec<SymbolId>,
    /// `multiplier(a)`, M symbols.
    pub multipliers: Vec<SymbolId>,
}
