//! What was written, with the place of every part. Nothing is resolved: names are words, indices are expressions.

use dalembert_expr::Rational;
use proc_macro2::Span;

use crate::diagnostics::{Diagnostics, Location};

/// A declaration. Later stages name what is faulty by its id; [`Spec::location`] knows where that is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ItemId(u32);

/// A model as it was written.
#[derive(Debug)]
pub struct Spec {
    /// The type's name.
    pub name: Word,
    /// Its snake case, which names the module of indices.
    pub snake_name: String,
    /// Nothing, `pub`, `pub(crate)`.
    pub visibility: String,
    /// Lines of the doc comment.
    pub documentation: Vec<String>,
    /// The declaration as text.
    pub source: String,
    /// `const N = 8;`
    pub constants: Vec<Constant>,
    /// `coordinates { .. }`
    pub coordinates: Vec<Coordinate>,
    /// `parameters { .. }`
    pub parameters: Vec<Parameter>,
    /// `let ..;`, in order.
    pub definitions: Vec<Definition>,
    /// `lagrangian = ..;`
    pub lagrangian: Option<Lagrangian>,
    /// `field { .. }`
    pub field: Option<Field>,
    /// `constraints { .. }`
    pub constraints: Vec<Equation>,
    /// `inputs { .. }`
    pub inputs: Vec<Supplied>,
    /// `forces { .. }`
    pub forces: Vec<Quantity>,
    /// `frame { .. }`
    pub frame: Vec<Quantity>,
    /// `impacts { .. }`
    pub surfaces: Vec<Surface>,
    /// `initial { .. }`
    pub initial: Vec<InitialValue>,
    /// `view { .. }`
    pub view: View,
    /// `outputs { .. }`
    pub outputs: Vec<Quantity>,
    /// `scenes { .. }`
    pub scenes: Vec<Scene>,
    /// `claims { .. }` and `claims for SCENE { .. }`
    pub claims: Vec<Claim>,
    items: Vec<Location>,
}

impl Spec {
    /// A model of which only the name is known.
    pub(super) fn new(name: Word, snake_name: String) -> Self {
        Self {
            name,
            snake_name,
            visibility: String::new(),
            documentation: Vec::new(),
            source: String::new(),
            constants: Vec::new(),
            coordinates: Vec::new(),
            parameters: Vec::new(),
            definitions: Vec::new(),
            lagrangian: None,
            field: None,
            constraints: Vec::new(),
            inputs: Vec::new(),
            forces: Vec::new(),
            frame: Vec::new(),
            surfaces: Vec::new(),
            initial: Vec::new(),
            view: View::default(),
            outputs: Vec::new(),
            scenes: Vec::new(),
            claims: Vec::new(),
            items: Vec::new(),
        }
    }

    /// A model with the name of this one and nothing else declared.
    pub(super) fn beginning(&self) -> Self {
        Self {
            visibility: self.visibility.clone(),
            documentation: self.documentation.clone(),
            source: self.source.clone(),
            ..Self::new(self.name.clone(), self.snake_name.clone())
        }
    }

    /// A new declaration at this place.
    pub(super) fn item(&mut self, at: Location) -> ItemId {
        self.items.push(at);
        ItemId(u32::try_from(self.items.len() - 1).unwrap_or(u32::MAX))
    }

    /// Where a declaration was written; the model's name for an id of another model.
    pub fn location(&self, item: ItemId) -> Location {
        self.items
            .get(item.0 as usize)
            .copied()
            .unwrap_or(self.name.at)
    }

    /// The first token of a declaration.
    pub fn span(&self, item: ItemId) -> Span {
        self.location(item).first
    }
}

/// A name with its place.
#[derive(Debug, Clone)]
pub struct Word {
    /// The name.
    pub text: String,
    /// Its place.
    pub at: Location,
}

/// A declared name, alone or indexed: `x`, `theta[N]`, `X[0]`, `joint[i in 1..=N]`.
#[derive(Debug, Clone)]
pub struct Declared {
    /// The name.
    pub name: Word,
    /// What stands in brackets behind it.
    pub index: Option<Index>,
}

/// What stands in the brackets behind a declared name.
#[derive(Debug, Clone)]
pub enum Index {
    /// `[N]`: a size where a family is declared, one member elsewhere.
    One(Scalar),
    /// `[i in a..=b]`
    Each(Binder),
}

/// What indices stand for, of the constants of a model. The next stage says it, which knows what names mean.
#[derive(Debug, Clone, Copy)]
pub struct Indices {
    /// The members that a declared name with its index stands for, counted from 1.
    pub members: fn(&Spec, &Declared) -> Result<Vec<usize>, Diagnostics>,
    /// The value of an index.
    pub value: fn(&Spec, &Scalar) -> Result<i64, Diagnostics>,
}

/// `i in a..=b`
#[derive(Debug, Clone)]
pub struct Binder {
    /// The index.
    pub name: Word,
    /// Its first value.
    pub low: Box<Scalar>,
    /// Its last value.
    pub high: Box<Scalar>,
}

/// An expression.
#[derive(Debug, Clone)]
pub struct Scalar {
    /// What it is.
    pub kind: ScalarKind,
    /// Where it stands.
    pub at: Location,
}

/// The kinds of expressions. Sums and products are flat, so that the depth of the tree is bounded by the nesting
/// of what was written and not by its length.
#[derive(Debug, Clone)]
pub enum ScalarKind {
    /// An integer or a decimal, exact, and as it was written.
    Number(Rational, String),
    /// `x`
    Name(String),
    /// `theta[i + 1]`
    Member(Word, Box<Scalar>),
    /// `-e`
    Negative(Box<Scalar>),
    /// `a + b - c`; `true` marks what is subtracted.
    Sum(Vec<(bool, Scalar)>),
    /// `a * b / c % d`, from left to right.
    Product(Vec<(Operator, Scalar)>),
    /// `a^b`
    Power(Box<Scalar>, Box<Scalar>),
    /// `f(a, b)`
    Call(Word, Vec<Scalar>),
    /// `sum(i in a..=b: e)`
    SumOver(Binder, Box<Scalar>),
}

/// What stands before a factor; the first of a product has `Times`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// `*`
    Times,
    /// `/`
    Over,
    /// `%`
    Modulo,
}

/// `const N = 8;`
#[derive(Debug)]
pub struct Constant {
    /// Its name.
    pub name: Word,
    /// Its value, an integer.
    pub value: Scalar,
}

/// `theta: angle;`
#[derive(Debug)]
pub struct Coordinate {
    /// Its name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The set it runs through.
    pub topology: Topology,
    /// The declaration.
    pub item: ItemId,
}

/// What was written of the set that a coordinate runs through.
#[derive(Debug)]
pub enum Topology {
    /// `x;`
    Line,
    /// `x: angle;`
    Angle,
    /// `x in (a, b);`
    Interval(Box<[Scalar; 2]>),
}

/// `m[N] > 0 = [1, 2];`
#[derive(Debug)]
pub struct Parameter {
    /// Its name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The demand on its values.
    pub assumption: Assumption,
    /// Its default.
    pub default: Option<ParameterDefault>,
    /// The declaration.
    pub item: ItemId,
}

/// `thrust[2];`, an input.
#[derive(Debug)]
pub struct Supplied {
    /// Its name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The declaration.
    pub item: ItemId,
}

/// What was written of the values of a parameter.
#[derive(Debug)]
pub enum Assumption {
    /// Nothing.
    Finite,
    /// `> 0`
    Positive,
    /// `>= 0`
    NonNegative,
    /// `!= 0`
    NonZero,
    /// `in [a, b]`
    Within(Box<[Scalar; 2]>),
}

/// The default of a parameter or of all members of a family.
#[derive(Debug)]
pub enum ParameterDefault {
    /// `= e`
    One(Scalar),
    /// `= [e, ..]`
    List(Vec<Scalar>, Location),
}

/// `let name = e;`, `let name(args) = e;`, `let X[i in 1..=N] = e;`
#[derive(Debug)]
pub struct Definition {
    /// Its name, with the index of a family.
    pub declared: Declared,
    /// Its arguments, if it is a function.
    pub arguments: Option<Vec<Word>>,
    /// Its value.
    pub value: Scalar,
}

/// `lagrangian = e;`
#[derive(Debug)]
pub struct Lagrangian {
    /// Its value.
    pub value: Scalar,
    /// The declaration.
    pub item: ItemId,
}

/// `field { dot(x) = e; .. }`
#[derive(Debug)]
pub struct Field {
    /// The rates.
    pub rates: Vec<Rate>,
    /// The declaration.
    pub item: ItemId,
}

/// `dot(theta[i in 1..=N]) = e;`
#[derive(Debug)]
pub struct Rate {
    /// The coordinate with its index.
    pub declared: Declared,
    /// Its rate.
    pub value: Scalar,
}

/// `name: left = right;`
#[derive(Debug)]
pub struct Equation {
    /// Its name, with the index of a family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The left side.
    pub left: Scalar,
    /// The right side.
    pub right: Scalar,
    /// The declaration.
    pub item: ItemId,
}

/// `name: e;`
#[derive(Debug)]
pub struct Quantity {
    /// Its name, with the index of a family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Its value.
    pub value: Scalar,
    /// The declaration.
    pub item: ItemId,
}

/// `greater >= less` or `greater > less`, whichever way round it was written.
#[derive(Debug)]
pub struct Comparison {
    /// The side that is not less.
    pub greater: Scalar,
    /// The side that is not greater.
    pub less: Scalar,
    /// Whether both may be equal.
    pub is_closed: bool,
    /// The whole.
    pub at: Location,
}

/// `name: h >= 0 when g > 0 => LAW, instantaneous { .. };`
#[derive(Debug)]
pub struct Surface {
    /// Its name, with the index of a family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The allowed side.
    pub gap: Comparison,
    /// Where the surface counts.
    pub conditions: Vec<Comparison>,
    /// Whether it counts where no other surface of the same gap does.
    pub is_otherwise: bool,
    /// Its law; elastic if there is none.
    pub law: Option<Law>,
    /// The mode that is entered here, of a transition.
    pub enters: Option<Word>,
    /// `instantaneous { .. }`
    pub instantaneous: Vec<Equation>,
    /// The declaration.
    pub item: ItemId,
}

/// What one `model!` declares.
#[derive(Debug)]
pub enum Declaration {
    /// A model, in one piece.
    Model(Box<Spec>),
    /// A model with modes.
    Modes(Modes),
}

impl Declaration {
    /// The same without its claims.
    #[must_use]
    pub fn without_claims(mut self) -> Self {
        match &mut self {
            Self::Model(spec) => spec.claims.clear(),
            Self::Modes(modes) => modes
                .modes
                .iter_mut()
                .for_each(|mode| mode.spec.claims.clear()),
        }
        self
    }
}

/// A model with modes, families written out: what stands outside of `modes` belongs to each of them.
#[derive(Debug)]
pub struct Modes {
    /// The modes, in order; the first is where a run begins.
    pub modes: Vec<Mode>,
    /// The transitions, in order.
    pub transitions: Vec<Transition>,
}

/// A mode as a model of its own: what it shares with the others, its own declarations, and as surfaces the transitions
/// that leave it.
#[derive(Debug)]
pub struct Mode {
    /// Its name: `rough`, of a member of a family `spoke3`.
    pub name: Word,
    /// As a declaration writes it: `rough`, `spoke[3]`.
    pub written: String,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The model.
    pub spec: Spec,
}

/// Which modes a transition connects.
#[derive(Debug)]
pub struct Transition {
    /// Its name.
    pub name: Word,
    /// The mode that is left.
    pub from: Word,
    /// The mode that is entered.
    pub to: Word,
}

/// `newton(0.8)`
#[derive(Debug)]
pub struct Law {
    /// Its name.
    pub name: Word,
    /// Its coefficients.
    pub arguments: Vec<Scalar>,
    /// What stands in the braces of `reset { .. }`.
    pub assignments: Option<Vec<Assignment>>,
    /// The declaration.
    pub item: ItemId,
}

/// `theta = e;` or `dot(theta[i in 1..=N]) = e;` of a reset.
#[derive(Debug)]
pub struct Assignment {
    /// What is given.
    pub target: AssignmentTarget,
    /// The coordinate with its index.
    pub declared: Declared,
    /// Its value after the impact.
    pub value: Scalar,
}

/// What an entry of a reset gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AssignmentTarget {
    /// A position.
    Position,
    /// A velocity.
    Velocity,
}

/// `theta = e;`, `dot(theta[i in 1..=N]) = e;`, `until = e;`
#[derive(Debug)]
pub struct InitialValue {
    /// What is given.
    pub target: InitialTarget,
    /// The coordinate with its index, or `until`.
    pub declared: Declared,
    /// Its value.
    pub value: Scalar,
}

/// What an entry of `initial` gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialTarget {
    /// A position.
    Position,
    /// A velocity.
    Velocity,
    /// The horizon.
    Until,
}

/// `view { path: (a, b); region: h >= 0; }`
#[derive(Debug, Default)]
pub struct View {
    /// The point drawn.
    pub path: Option<[Scalar; 2]>,
    /// The allowed region.
    pub region: Option<Comparison>,
}

/// `windy: billiard, drag;`
#[derive(Debug)]
pub struct Scene {
    /// Its name.
    pub name: Word,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The forces, surfaces, scenes and extras that it uses.
    pub parts: Vec<Declared>,
    /// The declaration.
    pub item: ItemId,
}

/// A theorem about the model, to be proved or refuted while it builds.
#[derive(Debug)]
pub struct Claim {
    /// What is claimed.
    pub statement: Statement,
    /// Whether an answer that stays open is accepted: `assume ..`.
    pub is_assumed: bool,
    /// The scene it is about; the whole model if there is none.
    pub scene: Option<Word>,
    /// The declaration.
    pub item: ItemId,
}

/// What is claimed.
#[derive(Debug)]
pub enum Statement {
    /// `density: exact`
    Existence(Existence),
    /// `density = e`
    Density(Scalar),
    /// `conserved: e`, `not conserved: e`, `conserved under surface: e`
    Conserved {
        /// The quantity.
        value: Scalar,
        /// The surface across which it is conserved; along the motion if there is none.
        under: Option<Declared>,
        /// Whether it is claimed to be conserved.
        holds: bool,
    },
    /// `symmetry: e`, with `partial(x)` for the fields of the coordinates.
    Symmetry(Scalar),
    /// `invariant: e`, with `d(..)` and `^` between forms.
    Invariant(Scalar),
    /// `volume: kept`
    VolumeKept,
    /// `density under surface: factor = e`
    Factor {
        /// The surface.
        under: Declared,
        /// The factor of the volume.
        value: Scalar,
    },
    /// `symplectic`
    Symplectic,
    /// `energy under surface: not increasing`
    EnergyNotIncreasing(Declared),
}

/// Where a density that depends on the configuration alone exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existence {
    /// On all of Q.
    Global,
    /// Near generic configurations, and not on all of Q.
    Local,
    /// Nowhere.
    None,
}
