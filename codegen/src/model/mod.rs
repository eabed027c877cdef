//! Stage 2, check: from what was written to a model with every name resolved and nothing derived yet.
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
    /// The rates of the coordinates of a first-order system, functions of `(t, q)`; its Lagrangian stands for none.
    pub field: Option<Vec<ExprId>>,
    /// Constraints, families expanded.
    pub constraints: Vec<Constraint>,
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
    /// What is used besides forces and surfaces.
    pub extras: Extras,
    /// The declared claims.
    pub claims: Vec<Claim>,
    /// Symbols that stand for derived quantities in outputs and claims.
    pub derived: DerivedSymbols,
    /// Remarks a person should see: velocity-linear terms, integrable constraints, unused parameters.
    pub notes: Vec<String>,
}

impl Model {
    /// Whether the rates of the coordinates were declared, in place of a Lagrangian.
    pub fn is_first_order(&self) -> bool {
        self.field.is_some()
    }

    /// The inputs, with their indices among the parameters.
    pub fn inputs(&self) -> impl Iterator<Item = (usize, &Parameter)> {
        let all = self.parameters.iter().enumerate();
        all.filter(|(_, own)| own.is_input)
    }

    /// Whether some constraint is not linear in the velocities.
    pub fn is_nonlinear(&self) -> bool {
        self.constraints.iter().any(|own| own.nonlinear.is_some())
    }
}

/// A name as the user knows it, and as Rust and formulas write it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// As messages and the command line write it: `theta`, `theta.3`.
    pub display: String,
    /// The Rust field or family: `theta`.
    pub field: String,
    /// 1-based index in its family.
    pub member: Option<usize>,
}

/// A coordinate with its velocity.
#[derive(Debug, Clone)]
pub struct Coordinate {
    /// Its name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The set it runs through.
    pub topology: Topology,
    /// The symbol of the coordinate.
    pub q: SymbolId,
    /// The symbol of its velocity; named `dot(x)`.
    pub qdot: SymbolId,
    /// Where it was declared.
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
    /// Its name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The demand on its values.
    pub assumption: Assumption,
    /// Its default, an expression without symbols.
    pub default: Option<ExprId>,
    /// Whether it is an input: held like a parameter until the caller changes it, at every instant if need be. Inputs come
    /// after all parameters.
    pub is_input: bool,
    /// Its symbol.
    pub symbol: SymbolId,
    /// Where it was declared.
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
    /// Where it was declared.
    pub item: ItemId,
}

/// `eta(qdot) + eta_0 = 0`.
#[derive(Debug, Clone)]
pub struct Constraint {
    /// Its name.
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
    /// Whether the equation itself is one of positions, `f = 0` with `f` the level.
    pub is_of_positions: bool,
    /// Where it was declared.
    pub item: ItemId,
}

impl Constraint {
    /// `eta` and `eta_0`.
    pub fn expressions(&self) -> impl Iterator<Item = ExprId> {
        self.form.iter().copied().chain([self.affine])
    }
}

/// A force as a one-form; coefficients may depend on coordinates, velocities and time.
#[derive(Debug, Clone)]
pub struct Force {
    /// Its name.
    pub name: Name,
    /// N entries.
    pub form: Vec<ExprId>,
    /// Where it was declared.
    pub item: ItemId,
}

/// A one-form whose value on the velocity is a quasi-velocity.
#[derive(Debug, Clone)]
pub struct QuasiForm {
    /// Its name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// N entries.
    pub form: Vec<ExprId>,
    /// Where it was declared.
    pub item: ItemId,
}

/// A condition on time and position: that a function of them is positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The function.
    pub margin: ExprId,
    /// Whether it may be 0, too.
    pub is_closed: bool,
}

/// How a surface goes with others of the same gap. A list of conditions holds where all of them hold.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Beside {
    /// It counts by its own conditions.
    #[default]
    Independent,
    /// `otherwise`: it counts where none of these lists, those of the others, holds.
    Otherwise(Vec<Vec<Condition>>),
    /// The last of several transitions of one gap: where neither its own conditions nor one of these lists holds, a motion
    /// that comes to the surface ends.
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
    /// All functions whose signs say where the surface counts: its own first, then those of the others, list after list.
    pub fn margins(&self) -> impl Iterator<Item = ExprId> {
        let others = self.beside.others().iter().flatten();
        self.conditions.iter().chain(others).map(|own| own.margin)
    }
}

/// An impact surface `h = 0`; motion is allowed where `h >= 0`.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Its name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// `h(t, q)`.
    pub gap: ExprId,
    /// What must hold for the surface to count.
    pub conditions: Vec<Condition>,
    /// What is said of the other surfaces of the same gap.
    pub beside: Beside,
    /// Its law.
    pub law: Law,
    /// The map of the law `reset`.
    pub reset: Option<Reset>,
    /// The mode that is entered here.
    pub transition: Option<Transition>,
    /// Constraints that hold in the moment of an impact, and while the motion is held by the surface; without levels.
    pub instantaneous: Vec<Constraint>,
    /// Where it was declared.
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

/// What a picture shows.
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
    /// Its name.
    pub name: Name,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// An expression of coordinates, velocities, parameters, time and [`DerivedSymbols`].
    pub value: ExprId,
    /// Where it was declared.
    pub item: ItemId,
}

/// A theorem about the model that its author states.
#[derive(Debug, Clone)]
pub struct Claim {
    /// What is claimed.
    pub statement: Statement,
    /// The claim as written: `conserved: energy`.
    pub text: String,
    /// Whether an answer that stays open is accepted.
    pub is_assumed: bool,
    /// The index of the scene that it is about; the model itself if there is none.
    pub scene: Option<usize>,
    /// Where it was declared.
    pub item: ItemId,
}

/// What is claimed; expressions of coordinates, velocities, parameters, time and [`DerivedSymbols`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Statement {
    /// Where a density of the configuration exists.
    Existence(Existence),
    /// This function times `mu_C` is invariant.
    Density(ExprId),
    /// A quantity is conserved, or not.
    Conserved {
        /// The quantity.
        value: ExprId,
        /// The index of the surface across which it is; along the motion if there is none.
        under: Option<usize>,
        /// Whether it is claimed to be conserved.
        holds: bool,
    },
    /// The flow of this vector field, N components, keeps the Lagrangian and the constraints.
    Symmetry(Vec<ExprId>),
    /// The motion and all that happens at surfaces keep a differential form.
    Invariant(ExteriorForm),
    /// One invariant volume is kept by the motion and by all that happens at surfaces.
    VolumeKept,
    /// Factor of the volume at a surface.
    Factor {
        /// The factor.
        value: ExprId,
        /// The index of the surface.
        under: usize,
    },
    /// The motion and all that happens at surfaces keep the symplectic form.
    Symplectic,
    /// The energy after an impact at the surface of an index is not above that before.
    EnergyNotIncreasing(usize),
}

impl Statement {
    /// What it is about.
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
            Self::Invariant(form) => form.expressions().collect(),
        }
    }

    /// The index of the surface that it names.
    pub fn surface(&self) -> Option<usize> {
        match self {
            Self::Conserved { under, .. } => *under,
            Self::Factor { under, .. } | Self::EnergyNotIncreasing(under) => Some(*under),
            _ => None,
        }
    }

    /// The same about a surface of another index.
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
