//! Syntax tree: the declaration as written, with the location of every part. Nothing is resolved: names are words,
//! indices are expressions.

mod claim;

use dalembert_expr::Rational;
use proc_macro2::Span;

use crate::diagnostics::{Diagnostics, Location};

pub use claim::{Claim, Existence, Statement};

/// Id of a declaration, by which later stages refer to it in errors. [`Spec::location`] gives its location.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ItemId(u32);

/// A model as written.
#[derive(Debug)]
pub struct Spec {
    /// Name of the type.
    pub name: Word,
    /// The name in snake case, which is that of the module of indices.
    pub snake_name: String,
    /// Visibility: empty, `pub` or `pub(crate)`.
    pub visibility: String,
    /// Lines of the doc comment.
    pub documentation: Vec<String>,
    /// The place of `#[global]`, which asks for the global form besides the reduced one. Only emitted Rust depends on it.
    pub global: Option<Location>,
    /// Text of the declaration.
    pub source: String,
    /// Hash of the tokens of the declaration: the seed of the random points at which its expressions are compared.
    pub seed: u64,
    /// `const N = 8;`
    pub constants: Vec<Constant>,
    /// `coordinates { .. }`
    pub coordinates: Vec<Coordinate>,
    /// `parameters { .. }`
    pub parameters: Vec<Parameter>,
    /// `let ..;`, in order of declaration
    pub definitions: Vec<Definition>,
    /// `lagrangian = ..;`
    pub lagrangian: Option<Lagrangian>,
    /// `field { .. }`
    pub field: Option<Field>,
    /// `constraints { .. }`
    pub constraints: Vec<Equation>,
    /// `inputs { .. }`
    pub inputs: Vec<Supplied>,
    /// `cost { .. }`
    pub cost: Option<Cost>,
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
    /// A model with a name and no declarations.
    pub(super) fn new(name: Word, snake_name: String) -> Self {
        Self {
            name,
            snake_name,
            visibility: String::new(),
            documentation: Vec::new(),
            global: None,
            source: String::new(),
            seed: 0,
            constants: Vec::new(),
            coordinates: Vec::new(),
            parameters: Vec::new(),
            definitions: Vec::new(),
            lagrangian: None,
            field: None,
            constraints: Vec::new(),
            inputs: Vec::new(),
            cost: None,
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

    /// A model with the header of this one and no declarations.
    pub(super) fn beginning(&self) -> Self {
        Self {
            visibility: self.visibility.clone(),
            documentation: self.documentation.clone(),
            source: self.source.clone(),
            seed: self.seed,
            ..Self::new(self.name.clone(), self.snake_name.clone())
        }
    }

    /// Registers a declaration at a location.
    pub(super) fn item(&mut self, at: Location) -> ItemId {
        self.items.push(at);
        ItemId(u32::try_from(self.items.len() - 1).unwrap_or(u32::MAX))
    }

    /// Location of a declaration; the location of the model's name if no declaration has this id.
    pub fn location(&self, item: ItemId) -> Location {
        self.items
            .get(item.0 as usize)
            .copied()
            .unwrap_or(self.name.at)
    }

    /// First token of a declaration.
    pub fn span(&self, item: ItemId) -> Span {
        self.location(item).first
    }
}

/// A name with its location.
#[derive(Debug, Clone)]
pub struct Word {
    /// The name.
    pub text: String,
    /// Location.
    pub at: Location,
}

/// A declared name, alone or indexed: `x`, `theta[N]`, `X[0]`, `joint[i in 1..=N]`.
#[derive(Debug, Clone)]
pub struct Declared {
    /// The name.
    pub name: Word,
    /// Index in brackets, if any.
    pub index: Option<Index>,
}

/// Content of the brackets after a declared name.
#[derive(Debug, Clone)]
pub enum Index {
    /// `[N]`: the size in the declaration of a family, a member elsewhere.
    One(Scalar),
    /// `[i in a..=b]`
    Each(Binder),
}

/// Evaluation of indices from the constants of a model. The next stage provides it, because it knows the meaning of
/// names.
#[derive(Debug, Clone, Copy)]
pub struct Indices {
    /// The members, counted from 1, that a declared name with its index stands for.
    pub members: fn(&Spec, &Declared) -> Result<Vec<usize>, Diagnostics>,
    /// The value of an index.
    pub value: fn(&Spec, &Scalar) -> Result<i64, Diagnostics>,
}

/// `i in a..=b`
#[derive(Debug, Clone)]
pub struct Binder {
    /// The index.
    pub name: Word,
    /// First value.
    pub low: Box<Scalar>,
    /// Last value.
    pub high: Box<Scalar>,
}

/// An expression.
#[derive(Debug, Clone)]
pub struct Scalar {
    /// Kind.
    pub kind: ScalarKind,
    /// Location.
    pub at: Location,
}

/// Kinds of expressions. Sums and products are flat, so that the depth of the tree is bounded by the nesting of the
/// text, not by its length.
#[derive(Debug, Clone)]
pub enum ScalarKind {
    /// An integer or a decimal: exact value, and text as written.
    Number(Rational, String),
    /// `x`
    Name(String),
    /// `theta[i + 1]`
    Member(Word, Box<Scalar>),
    /// `-e`
    Negative(Box<Scalar>),
    /// `a + b - c`; the flag is true for subtracted terms.
    Sum(Vec<(bool, Scalar)>),
    /// `a * b / c % d`, from left to right
    Product(Vec<(Operator, Scalar)>),
    /// `a^b`
    Power(Box<Scalar>, Box<Scalar>),
    /// `f(a, b)`
    Call(Word, Vec<Scalar>),
    /// `sum(i in a..=b: e)`
    SumOver(Binder, Box<Scalar>),
}

/// Operator before a factor. The first factor of a product has [`Operator::Times`].
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
    /// Name.
    pub name: Word,
    /// Value, an integer.
    pub value: Scalar,
}

/// `theta: angle;`
#[derive(Debug)]
pub struct Coordinate {
    /// Name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Set of its values.
    pub topology: Topology,
    /// The declaration.
    pub item: ItemId,
}

/// Declared set of values of a coordinate.
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
    /// Name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Declared condition on its values.
    pub assumption: Assumption,
    /// Default value.
    pub default: Option<ParameterDefault>,
    /// The declaration.
    pub item: ItemId,
}

/// `thrust[2];`, an input.
#[derive(Debug)]
pub struct Supplied {
    /// Name; the index is the size of the family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The declaration.
    pub item: ItemId,
}

/// `cost { running = e; terminal = e; }`
#[derive(Debug)]
pub struct Cost {
    /// Running cost, integrated over the motion.
    pub running: Option<Scalar>,
    /// Terminal cost, at the end of the motion.
    pub terminal: Option<Scalar>,
    /// The declaration.
    pub item: ItemId,
}

/// Declared condition on the values of a parameter.
#[derive(Debug)]
pub enum Assumption {
    /// No condition.
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

/// Default of a parameter, or of the members of a family.
#[derive(Debug)]
pub enum ParameterDefault {
    /// `= e`, for all members
    One(Scalar),
    /// `= [e, ..]`, one value per member; with the location of the list
    List(Vec<Scalar>, Location),
}

/// `let name = e;`, `let name(args) = e;`, `let X[i in 1..=N] = e;`
#[derive(Debug)]
pub struct Definition {
    /// Name, with the index of a family.
    pub declared: Declared,
    /// Arguments; `None` if it is not a function.
    pub arguments: Option<Vec<Word>>,
    /// Value.
    pub value: Scalar,
}

/// `lagrangian = e;`
#[derive(Debug)]
pub struct Lagrangian {
    /// Value.
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
    /// Rate.
    pub value: Scalar,
}

/// `name: left = right;`
#[derive(Debug)]
pub struct Equation {
    /// Name, with the index of a family.
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
    /// Name, with the index of a family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// Value.
    pub value: Scalar,
    /// The declaration.
    pub item: ItemId,
}

/// `greater >= less` or `greater > less`, in either notation.
#[derive(Debug)]
pub struct Comparison {
    /// The greater side.
    pub greater: Scalar,
    /// The smaller side.
    pub less: Scalar,
    /// True if equality is allowed.
    pub is_closed: bool,
    /// Location of the whole comparison.
    pub at: Location,
}

/// `name: h >= 0 when g > 0 => LAW, instantaneous { .. };`
#[derive(Debug)]
pub struct Surface {
    /// Name, with the index of a family.
    pub declared: Declared,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The comparison that holds on the allowed side.
    pub gap: Comparison,
    /// Conditions under which the surface counts.
    pub conditions: Vec<Comparison>,
    /// True for `otherwise`: the surface counts where no other surface with the same gap counts.
    pub is_otherwise: bool,
    /// Law; `None` means elastic.
    pub law: Option<Law>,
    /// For a transition: the mode that it enters.
    pub enters: Option<Word>,
    /// `instantaneous { .. }`
    pub instantaneous: Vec<Equation>,
    /// The declaration.
    pub item: ItemId,
}

/// Contents of one `model!`.
#[derive(Debug)]
pub enum Declaration {
    /// A model without modes.
    Model(Box<Spec>),
    /// A model with modes.
    Modes(Modes),
}

impl Declaration {
    /// The declaration without its claims.
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

/// A model with modes, with families written out. Declarations outside of `modes` belong to every mode.
#[derive(Debug)]
pub struct Modes {
    /// The modes, in order. A run begins in the first one.
    pub modes: Vec<Mode>,
    /// The transitions, in order of declaration.
    pub transitions: Vec<Transition>,
}

/// A mode as a model of its own. Its declarations are the shared ones and its own; its surfaces include the transitions
/// that leave it.
#[derive(Debug)]
pub struct Mode {
    /// Name: `rough`, or `spoke3` for member 3 of a family.
    pub name: Word,
    /// Name as written in the declaration: `rough`, `spoke[3]`.
    pub written: String,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The mode as a model.
    pub spec: Spec,
}

/// A transition and the modes that it connects.
#[derive(Debug)]
pub struct Transition {
    /// Name.
    pub name: Word,
    /// The mode that is left.
    pub from: Word,
    /// The mode that is entered.
    pub to: Word,
}

/// `newton(0.8)`
#[derive(Debug)]
pub struct Law {
    /// Name.
    pub name: Word,
    /// Coefficients.
    pub arguments: Vec<Scalar>,
    /// Contents of the braces of `reset { .. }`.
    pub assignments: Option<Vec<Assignment>>,
    /// The declaration.
    pub item: ItemId,
}

/// An entry of a reset: `theta = e;` or `dot(theta[i in 1..=N]) = e;`
#[derive(Debug)]
pub struct Assignment {
    /// Target.
    pub target: AssignmentTarget,
    /// The coordinate with its index.
    pub declared: Declared,
    /// Value after the impact.
    pub value: Scalar,
}

/// Target of an entry of a reset.
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
    /// Target.
    pub target: InitialTarget,
    /// The coordinate with its index, or `until`.
    pub declared: Declared,
    /// Value.
    pub value: Scalar,
}

/// Target of an entry of `initial`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialTarget {
    /// A position.
    Position,
    /// A velocity.
    Velocity,
    /// The end time of runs.
    Until,
}

/// `view { path: (a, b); region: h >= 0; }`
#[derive(Debug, Default)]
pub struct View {
    /// The plotted point.
    pub path: Option<[Scalar; 2]>,
    /// The region where motion is allowed.
    pub region: Option<Comparison>,
}

/// `windy: billiard, drag;`
#[derive(Debug)]
pub struct Scene {
    /// Name.
    pub name: Word,
    /// Lines of its doc comment.
    pub documentation: Vec<String>,
    /// The forces, surfaces, scenes and extras in use.
    pub parts: Vec<Declared>,
    /// The declaration.
    pub item: ItemId,
}
