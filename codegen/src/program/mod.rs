//! Stage 4, lower: turns expressions into straight-line programs in static single assignment form.
//!
//! A [`Function`] is a list of operations in execution order: every operand is defined before it is used. Linear
//! algebra has become operations at this stage (see [`linear`]), with guards for pivots that must be positive. Later
//! stages take no decisions: `dalembert-emit` writes the operations as Rust, and [`interpret`] executes them without a
//! compiler.

pub mod builder;
pub mod coframe;
pub mod constraints;
pub mod cost;
pub mod expression;
pub mod interpret;
pub mod jet;
pub mod kernel;
pub mod kernels;
pub mod linear;
pub mod linked;
pub mod lower;
pub mod mass;
pub mod recipes;
pub mod reduced;
pub mod schedule;
pub mod verify;

use dalembert_expr::{Function as Elementary, Rational};

pub use cost::Cost;
pub use lower::{Lowered, lower};

/// A value of a function: the result of the operation with this index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(u32);

impl Value {
    pub(crate) fn new(index: usize) -> Self {
        Self(u32::try_from(index).unwrap_or(u32::MAX))
    }

    /// Index of the operation.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Meaning of an argument of a function. Indices follow the order of declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Input {
    /// Time.
    Time,
    /// A coordinate.
    Coordinate(usize),
    /// A velocity.
    Velocity(usize),
    /// A momentum.
    Momentum(usize),
    /// A quasi-velocity.
    Quasi(usize),
    /// A parameter.
    Parameter(usize),
    /// Deviation of the level of an integrable constraint.
    Excess(usize),
    /// Rate of a momentum or quasi-velocity, or the change of one by an impulse.
    MotionRate(usize),
    /// A multiplier of a constraint.
    Multiplier(usize),
}

/// An operation.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Op {
    /// An argument.
    Input(Input),
    /// An exact number, which is rounded once when it is emitted.
    Number(Rational),
    /// The number pi.
    Pi,
    /// `-a`
    Neg(Value),
    /// `a + b`
    Add(Value, Value),
    /// `a - b`
    Sub(Value, Value),
    /// `a * b`
    Mul(Value, Value),
    /// `a / b`
    Div(Value, Value),
    /// Square root.
    Sqrt(Value),
    /// `a` to a constant power whose exponent is no multiple of 1/2.
    Power(Value, Rational),
    /// An elementary function.
    Call(Elementary, Value),
    /// `atan2(y, x)`
    Atan2(Value, Value),
    /// A check without a value: the function ends with a fault unless the guard holds.
    Guard(Guard),
}

/// A condition that must hold for the function to continue.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Guard {
    /// `value > 0`; the fault is `MetricNotPositive`.
    Pivot {
        /// Index of the pivot.
        pivot: usize,
        /// The pivot.
        value: Value,
    },
    /// `squared > LEAST_SQUARED_RATIO * reference`; the fault is `SingularConstraint`. Both are squared norms of a
    /// constraint form: after and before projection orthogonal to the earlier forms. Where the forms of a block have
    /// factors that may vanish, they are the squares of a factor and of its bound. Without `reference` the condition is
    /// `squared > 0`.
    Constraint {
        /// Index of the constraint.
        constraint: usize,
        /// Squared norm after projection.
        squared: Value,
        /// Squared norm before projection; `None` if independence is proved.
        reference: Option<Value>,
    },
    /// `pivot > LEAST_PIVOT_RATIO * diagonal`; the fault is `SingularConstraint`. The two values are a pivot of the
    /// constraint mass matrix and its diagonal entry.
    Mass {
        /// Index of the constraint.
        constraint: usize,
        /// The pivot.
        pivot: Value,
        /// The diagonal entry.
        diagonal: Value,
    },
    /// Same as [`Guard::Constraint`] for the form of a quasi-velocity; the fault is `SingularFrame`.
    Frame {
        /// Index of the quasi-velocity.
        quasi: usize,
        /// Squared norm after projection.
        squared: Value,
        /// Squared norm before projection.
        reference: Option<Value>,
    },
    /// `squared > 0`, or with `reference` as [`Guard::Constraint`] for an instantaneous constraint of the surface; the
    /// fault is `SingularSurface`.
    Surface {
        /// Index of the surface.
        surface: usize,
        /// `dh(pi_D grad h)`, or the squared norm of the form after projection.
        squared: Value,
        /// Squared norm of the form before projection.
        reference: Option<Value>,
    },
}

impl Guard {
    /// Ratio of squared norms below which a form counts as dependent on the earlier ones: the square of `4 * 2^-52`.
    /// Below it the projected form consists of rounding errors.
    pub const LEAST_SQUARED_RATIO: f64 = 16.0 * f64::EPSILON * f64::EPSILON;

    /// Ratio of a pivot of the constraint mass matrix to its diagonal entry below which the solution loses more than
    /// six digits.
    pub const LEAST_PIVOT_RATIO: f64 = 1e-6;

    /// The values that the guard reads.
    pub fn operands(&self) -> impl Iterator<Item = Value> {
        let (first, second) = match *self {
            Self::Pivot { value, .. } => (value, None),
            Self::Constraint {
                squared, reference, ..
            }
            | Self::Frame {
                squared, reference, ..
            }
            | Self::Surface {
                squared, reference, ..
            } => (squared, reference),
            Self::Mass {
                pivot, diagonal, ..
            } => (pivot, Some(diagonal)),
        };
        core::iter::once(first).chain(second)
    }
}

impl Input {
    /// Component of the state `(q, p)` or `(q, u)` that the input refers to; `n` is the number of coordinates.
    pub fn component(self, n: usize) -> Option<usize> {
        match self {
            Self::Coordinate(i) => Some(i),
            Self::Momentum(i) | Self::Quasi(i) => Some(n + i),
            Self::Time
            | Self::Velocity(_)
            | Self::Parameter(_)
            | Self::Excess(_)
            | Self::MotionRate(_)
            | Self::Multiplier(_) => None,
        }
    }
}

impl Op {
    /// The values that the operation reads.
    pub fn operands(&self) -> Vec<Value> {
        match self {
            Self::Input(_) | Self::Number(_) | Self::Pi => Vec::new(),
            Self::Neg(a) | Self::Sqrt(a) | Self::Power(a, _) | Self::Call(_, a) => vec![*a],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Atan2(a, b) => {
                vec![*a, *b]
            }
            Self::Guard(guard) => guard.operands().collect(),
        }
    }

    /// True for an argument or a constant, which costs no operation.
    pub fn is_leaf(&self) -> bool {
        matches!(self, Self::Input(_) | Self::Number(_) | Self::Pi)
    }
}

/// A straight-line function.
#[derive(Debug, Clone)]
pub struct Function {
    /// The operations, in execution order.
    pub ops: Vec<Op>,
    /// Names of meaningful values, indexed by value.
    pub names: Vec<Option<String>>,
    /// The values of the results.
    pub outputs: Vec<Value>,
    /// Operation counts.
    pub cost: Cost,
}

impl Function {
    /// True if the function contains a guard, so that it can end with a fault.
    pub fn is_fallible(&self) -> bool {
        self.ops.iter().any(|op| matches!(op, Op::Guard(_)))
    }
}

/// The variables of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Positions and momenta, `(q, p)` on T*Q: N + N numbers.
    Global,
    /// Positions and quasi-velocities, `(q, u)` on D: N + (N - M) numbers.
    Reduced,
    /// Positions of a first-order system: N numbers.
    FirstOrder,
}

/// All functions of a model in one form. Functions of features that are not declared are absent. `s` is the state:
/// `(q, p)`, `(q, u)` or `q`. For a first-order system, functions of momenta and impulses are empty or have no
/// mechanical meaning, and are not emitted.
#[derive(Debug)]
pub struct Program {
    /// The form.
    pub form: Form,
    /// `(t, s) -> (qdot, pdot)`, `(qdot, udot)` or `qdot`
    pub rate: Function,
    /// True if the rates may vary strongly within a small fraction of a step.
    pub can_be_narrow: bool,
    /// Taylor coefficients along the motion: of the rates and, if they are analytic, of the gaps.
    pub jet: jet::Jet,
    /// `(t, q) ->` units of the components of the state
    pub scale: Function,
    /// `(t, s) -> qdot`
    pub velocity: Function,
    /// `(t, q, qdot) -> p`
    pub momentum: Function,
    /// `(t, s) -> energy`
    pub energy: Function,
    /// `(t, q, qdot) -> f = dL/dq + F`
    pub force: Function,
    /// Functions of the reduced form.
    pub reduced: Option<Reduced>,
    /// Derived quantities at a state, by name. The global form has all of them, also for states off the constraints.
    /// The reduced form has only quantities of the frame.
    pub geometry: recipes::Geometry,
    /// Functions of constraints.
    pub constrained: Option<Constrained>,
    /// Functions of surfaces.
    pub impacting: Option<Impacting>,
    /// Functions of the density form, if the model uses volumes.
    pub density: Option<Density>,
    /// Functions of a proved invariant volume.
    pub volume: Option<InvariantVolume>,
    /// Functions of the powers of named forces.
    pub powers: Option<Powers>,
    /// The declared outputs: `(t, s) -> values`.
    pub outputs: Option<Function>,
    /// The view's path: `(t, q) -> (x, y)`.
    pub view_path: Option<Function>,
    /// The view's region: `(t, q) -> h`.
    pub view_region: Option<Function>,
    /// The initial condition: `() -> q, qdot`, with 0 for undeclared values.
    pub initial: Function,
    /// The declared end time of runs.
    pub until: Option<Function>,
}

impl Program {
    /// Largest number of operations of a function. An N-link chain reaches it near N = 40. Compilers take minutes for
    /// longer functions.
    pub const OPERATIONS: usize = 50_000;

    /// All functions.
    pub fn functions(&self) -> Vec<&Function> {
        // NOTE: destructuring makes a new field a compile error until it is added here.
        let Self {
            form: _,
            rate,
            can_be_narrow: _,
            jet,
            scale,
            velocity,
            momentum,
            energy,
            force,
            reduced,
            geometry,
            constrained,
            impacting,
            density,
            volume,
            powers,
            outputs,
            view_path,
            view_region,
            initial,
            until,
        } = self;
        let mut functions = vec![rate, scale, velocity, momentum, energy, force];
        functions.extend([&jet.function, &geometry.function]);
        functions.extend(reduced.iter().flat_map(Reduced::functions));
        functions.extend(density.iter().flat_map(Density::functions));
        functions.push(initial);
        let declared = [outputs, view_path, view_region, until];
        functions.extend(declared.into_iter().flatten());
        functions.extend(constrained.iter().flat_map(Constrained::functions));
        functions.extend(impacting.iter().flat_map(Impacting::functions));
        functions.extend(volume.iter().flat_map(InvariantVolume::functions));
        functions.extend(powers.iter().map(|powers| &powers.function));
        functions
    }

    /// Number of operations of the longest function.
    pub fn longest(&self) -> usize {
        let lengths = self.functions().into_iter();
        lengths
            .map(|function| function.cost.total())
            .max()
            .unwrap_or(0)
    }
}

/// Functions of a system in reduced form.
#[derive(Debug)]
pub struct Reduced {
    /// `(t, q, u) -> p`
    pub momentum: Function,
    /// `(t, q, qdot) -> u`
    pub quasi: Function,
    /// `(t, q, p) -> u` of the velocity on D nearest to the velocity of `p`
    pub nearest_momenta: Function,
    /// `(t, q, qdot) -> u` of the velocity on D nearest to `qdot`
    pub nearest_velocities: Function,
}

impl Reduced {
    fn functions(&self) -> [&Function; 4] {
        let Self {
            momentum,
            quasi,
            nearest_momenta,
            nearest_velocities,
        } = self;
        [momentum, quasi, nearest_momenta, nearest_velocities]
    }
}

/// Functions of a system with constraints.
#[derive(Debug)]
pub struct Constrained {
    /// True unless the constraint forms are proved to stay independent.
    pub can_lose_rank: bool,
    /// `(t, s) -> lambda`
    pub multipliers: Function,
    /// `(t, q, qdot) -> residuals, scales`
    pub residuals: Function,
    /// `(t, q) -> eta` (M rows of N, row-major), then `eta_0`. With constraints nonlinear in velocities: `(t, q, qdot)`
    pub forms: Function,
    /// Functions that project a state in global form to D.
    pub return_to_constraints: Option<Return>,
    /// `(t, q) -> f`, one per integrable constraint.
    pub levels: Function,
    /// `(t, q) -> scale of f`, one per integrable constraint, 0 for levels that are not declared; `None` if no level is
    /// declared.
    pub level_scales: Option<Function>,
    /// `(t, q, excess) -> change of q`
    pub level_correction: Function,
    /// `(t, q, lambda) -> lambda_a eta^a`
    pub reaction_force: Function,
    /// `(t, q, p) -> qdot, mu`: the velocity on D at the momentum `p + mu_a eta^a`, and `mu`
    pub constrained_velocity: Function,
}

impl Constrained {
    fn functions(&self) -> Vec<&Function> {
        let Self {
            can_lose_rank: _,
            multipliers,
            residuals,
            forms,
            return_to_constraints,
            levels,
            level_scales,
            level_correction,
            reaction_force,
            constrained_velocity,
        } = self;
        let mut functions = vec![multipliers, residuals, forms, levels, level_correction];
        functions.extend(level_scales);
        functions.extend([reaction_force, constrained_velocity]);
        functions.extend(return_to_constraints.iter().flat_map(Return::functions));
        functions
    }
}

/// Functions that project a state in global form to the constraints.
#[derive(Debug)]
pub struct Return {
    /// `(t, q, qdot) -> p` of the velocity on D nearest to `qdot`
    pub nearest: Function,
    /// `(t, q, p) -> p` on D*, for the correction after a step
    pub restore: Function,
}

impl Return {
    fn functions(&self) -> [&Function; 2] {
        [&self.nearest, &self.restore]
    }
}

/// Powers: rates of change of the energy, by cause.
#[derive(Debug)]
pub struct Powers {
    /// The causes: named forces in order, then `constraints` and `time` if they do work.
    pub names: Vec<String>,
    /// `(t, s) ->` powers. Their sum is the rate of the energy.
    pub function: Function,
}

/// Effect of the motion on the volume `mu_C`.
#[derive(Debug)]
pub struct Density {
    /// The divergence with respect to `mu_C`: `(t, s) -> div`.
    pub divergence: Function,
    /// The density form: `(t, q) -> theta`.
    pub form: Function,
}

impl Density {
    fn functions(&self) -> [&Function; 2] {
        let Self { divergence, form } = self;
        [divergence, form]
    }
}

/// Functions of a system with an invariant volume `exp(G) mu_C`.
#[derive(Debug)]
pub struct InvariantVolume {
    /// `(t, q) -> G`, without the part that is an integral
    pub log_density: Function,
    /// `(t, q) -> G + ln det g - ln |det A_dep|`, without the part that is an integral
    pub log_volume: Function,
    /// Reference configuration, and gradient of the part of `G` without closed form. This part is integrated along a
    /// path from the reference configuration.
    pub gradient: Option<(Vec<f64>, Function)>,
    /// Indices of the velocities that are coordinates of the volume in addition to the positions.
    pub independent: Vec<usize>,
    /// True if `G` is single-valued on Q, not only as a function of unwrapped angles.
    pub is_single_valued: bool,
}

impl InvariantVolume {
    fn functions(&self) -> impl Iterator<Item = &Function> {
        let Self {
            log_density,
            log_volume,
            gradient,
            independent: _,
            is_single_valued: _,
        } = self;
        let gradient = gradient.as_ref().map(|(_, function)| function);
        [log_density, log_volume].into_iter().chain(gradient)
    }
}

/// Functions of a system with surfaces.
#[derive(Debug)]
pub struct Impacting {
    /// `(t, q) -> h_s`
    pub gaps: Function,
    /// Per surface: `(t, q) -> h_s`, for enclosures of a single gap
    pub gap_alone: Vec<Function>,
    /// `(t, s) -> dh_s(qdot) + d_t h_s`
    pub gap_rates: Function,
    /// `(t, s, w) -> d^2h_s/dt^2` for the rates `w` of momenta or quasi-velocities
    pub gap_accelerations: Function,
    /// `(t, s, w) ->` changes of the gap rates by an impulse `w`
    pub gap_responses: Function,
    /// Per surface: `(t, q) -> margins of its conditions, then arguments of absolute values in its gap`; `None` without
    /// either.
    pub conditions: Vec<Option<Function>>,
    /// Per surface: `(t, s) -> size, share, direction`. By its law, the impulse is `size * direction` and removes this
    /// share of the gap rate. `None` for a law that is no impulse.
    pub blows: Vec<Option<Function>>,
    /// Per surface:
    /// `(t, s) -> gap_rate, constrained_rate, surface_rate, constrained_compliance, free_compliance, direction`
    pub contacts: Vec<Function>,
    /// Per surface: coefficient of its law, a function of the parameters; `None` for a law without a coefficient.
    pub coefficients: Vec<Option<Function>>,
    /// Per surface: `(t, s) -> q, qdot` after the law `reset`; `None` for other laws.
    pub resets: Vec<Option<Function>>,
    /// Per surface: `(t, s) -> q, qdot` in the entered mode; `None` unless it leads to another mode with a declared
    /// state.
    pub entries: Vec<Option<Function>>,
    /// Per surface: `(t, s) ->` impulse that establishes its instantaneous constraints; `None` without these.
    pub focuses: Vec<Option<Function>>,
    /// Per surface: `(t, s, w) ->` addition to the rates `w` that maintains its instantaneous constraints; `None`
    /// without these.
    pub traces: Vec<Option<Function>>,
}

impl Impacting {
    fn functions(&self) -> Vec<&Function> {
        let Self {
            gaps,
            gap_alone,
            gap_rates,
            gap_accelerations,
            gap_responses,
            conditions,
            blows,
            contacts,
            coefficients,
            resets,
            entries,
            focuses,
            traces,
        } = self;
        let declared = conditions
            .iter()
            .chain(blows)
            .chain(coefficients)
            .chain(resets)
            .chain(entries)
            .chain(focuses)
            .chain(traces)
            .flatten();
        let moving = [gap_rates, gap_accelerations, gap_responses];
        core::iter::once(gaps)
            .chain(moving)
            .chain(gap_alone)
            .chain(contacts)
            .chain(declared)
            .collect()
    }
}
