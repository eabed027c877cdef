//! Run-time errors: small `Copy` values with the place of the failure.

use core::fmt;

use dalembert_numbers::description::Assumption;
use dalembert_numbers::tables::Mode;

/// A quantity that the equations of motion need is undefined at this state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// The metric is not positive definite: this pivot of its `LDL^T` factorisation, in the order of the coordinates,
    /// is not positive.
    MetricNotPositive {
        /// Index of the coordinate at which the factorisation stopped.
        pivot: usize,
        /// The pivot's value; may be NaN.
        value: f64,
    },
    /// The constraint one-forms are linearly dependent, or too nearly so to solve for the multipliers. A run ends with
    /// this fault at the last state before the forms become dependent. That holds even if they are dependent only at
    /// one instant between two evaluations of the rates ([`System::rank_drop`](crate::System::rank_drop)). A run does
    /// not begin at such a state.
    SingularConstraint {
        /// Index of the first constraint that depends on the earlier ones.
        constraint: usize,
        /// Estimated condition number of the forms in the metric. Infinite if the forms are dependent at the state, or
        /// if a run reaches such a state.
        condition: f64,
    },
    /// The form of a declared quasi-velocity depends on the constraints and the other forms. The quasi-velocities do
    /// not determine the velocities at this state.
    SingularFrame {
        /// Index of the quasi-velocity.
        quasi: usize,
    },
    /// `dh(pi_D grad h)` is not positive, so no impulse that respects the constraints can change the gap rate. Or the
    /// instantaneous constraints of the surface depend on each other or on the constraints.
    SingularSurface {
        /// Index of the surface.
        surface: usize,
    },
    /// The called function was not derived for this system, such as a function of a global form that the declaration does
    /// not ask for.
    NotDerived,
    /// Momenta, an energy or an impulse were requested of a first-order system, which has none.
    FirstOrder,
    /// A system with modes was asked for the terms of Lagrange and d'Alembert's principle, or for a state from
    /// positions and velocities over general numbers. Both belong to a single mode.
    SeveralModes,
    /// A system with constraints that are nonlinear in the velocities was asked for an impulse or for a step of a
    /// discrete principle. Neither is defined for such constraints.
    NonlinearConstraints,
    /// No velocity that satisfies this constraint was found near the given one.
    ProjectionFailed {
        /// Index of the constraint.
        constraint: usize,
    },
    /// A state, a rate or a gap is infinite or not a number.
    NonFinite {
        /// Index of the component of the state, or of its rate.
        component: usize,
    },
}

impl Fault {
    /// Replaces indices of a mode (coordinate, surface, constraint) by those of the model.
    pub(crate) fn of_mode(self, mode: &Mode) -> Self {
        let of_model = |places: &[usize], index: usize| places.get(index).copied().unwrap_or(index);
        match self {
            Self::MetricNotPositive { pivot, value } => Self::MetricNotPositive {
                pivot: of_model(&mode.coordinates, pivot),
                value,
            },
            Self::SingularSurface { surface } => Self::SingularSurface {
                surface: of_model(&mode.surfaces, surface),
            },
            Self::SingularConstraint {
                constraint,
                condition,
            } => Self::SingularConstraint {
                constraint: of_model(&mode.constraints, constraint),
                condition,
            },
            Self::ProjectionFailed { constraint } => Self::ProjectionFailed {
                constraint: of_model(&mode.constraints, constraint),
            },
            fault => fault,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::MetricNotPositive { pivot, value } => {
                write!(
                    f,
                    "the metric is not positive definite: pivot {pivot} is {value}"
                )
            }
            Self::SingularConstraint {
                constraint,
                condition,
            } => write!(
                f,
                "constraint {constraint} depends on the earlier ones at this state (condition {condition:e})"
            ),
            Self::SingularFrame { quasi } => write!(
                f,
                "the declared frame is singular: quasi-velocity {quasi} follows from the others and the constraints"
            ),
            Self::SingularSurface { surface } => write!(
                f,
                "surface {surface}: no impulse within the constraints changes its gap rate here"
            ),
            Self::SeveralModes => write!(
                f,
                "a step of a discrete principle, or a state from positions and velocities, belongs to one mode, and the \
                 system has several"
            ),
            Self::NotDerived => write!(
                f,
                "the called function was not derived for this system; what needs the global form asks for it with \
                 `#[global]` before the model"
            ),
            Self::FirstOrder => {
                write!(
                    f,
                    "a first-order system has no momenta, no energy and no impulses"
                )
            }
            Self::NonlinearConstraints => write!(
                f,
                "constraints that are not linear in the velocities define no impulses and no discrete principle"
            ),
            Self::ProjectionFailed { constraint } => write!(
                f,
                "no velocity that satisfies constraint {constraint} was found near the given one"
            ),
            Self::NonFinite { component } => {
                write!(f, "component {component} is not finite")
            }
        }
    }
}

/// A parameter's value contradicts its declaration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterError {
    /// The parameter's name as declared: `m`, or `m.2` in a family.
    pub name: &'static str,
    /// The refused value.
    pub value: f64,
    /// The declared assumption.
    pub expected: Assumption,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "parameter `{}` is {}, but must be {}",
            self.name, self.value, self.expected
        )
    }
}

/// Reason for the rejection of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StateError {
    /// A parameter of the system contradicts its declaration.
    Parameter(ParameterError),
    /// A position or velocity is infinite or not a number.
    NotFinite {
        /// Index into q followed by qdot (or p).
        component: usize,
    },
    /// The velocity violates a constraint by more than 1e-9 of the sum of the absolute values of its terms.
    OffConstraint {
        /// Index of the constraint.
        constraint: usize,
        /// `eta(qdot) + eta_0` at the given state.
        residual: f64,
        /// The sum of the absolute values of the terms of `residual`.
        scale: f64,
    },
    /// The positions violate a position-level constraint by more than 1e-9 of the sum of the absolute values of its
    /// terms.
    OffPosition {
        /// Index of the constraint.
        constraint: usize,
        /// Left side minus right side.
        residual: f64,
        /// The sum of the absolute values of the terms of `residual`.
        scale: f64,
    },
    /// A coordinate lies outside the open interval of its chart.
    OutsideChart {
        /// Index of the coordinate.
        coordinate: usize,
    },
    /// The system exceeds the fixed buffers of the called function.
    TooLarge {
        /// Largest number of coordinates that the buffers hold.
        limit: usize,
    },
    /// The equations of motion are undefined at this state.
    Fault(Fault),
}

impl fmt::Display for StateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Parameter(error) => error.fmt(f),
            Self::NotFinite { component } => {
                write!(f, "component {component} of (q, qdot) is not finite")
            }
            Self::OffConstraint {
                constraint,
                residual,
                scale,
            } => write!(
                f,
                "constraint {constraint} is violated: residual {residual:e} against terms of size {scale:e}; \
                 use `state_projected` to project or `state_unchecked` to keep it"
            ),
            Self::OffPosition {
                constraint,
                residual,
                scale,
            } => write!(
                f,
                "the positions violate constraint {constraint}: its sides differ by {residual:e} against terms of size \
                 {scale:e}; use `complete_position` to solve for some of them, or `state_projected` to move all"
            ),
            Self::OutsideChart { coordinate } => {
                write!(f, "coordinate {coordinate} lies outside its interval")
            }
            Self::TooLarge { limit } => write!(f, "the system has more than {limit} coordinates"),
            Self::Fault(fault) => fault.fmt(f),
        }
    }
}

impl From<Fault> for StateError {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl From<ParameterError> for StateError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl core::error::Error for Fault {}
impl core::error::Error for ParameterError {}
impl core::error::Error for StateError {}
