//! End of a run: exactly one [`Outcome`] for every run. A run neither panics nor loops forever, and never returns a
//! silent NaN.

use core::fmt;

use crate::error::{Fault, ParameterError};

/// Reason for the end of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Outcome {
    /// The run reached its end time.
    Done,
    /// Impacts accumulate (Zeno): their times no longer differ, or the hops between them are below the rounding error
    /// of the gap.
    Zeno {
        /// Time of the accumulation, extrapolated from the last hops.
        t: f64,
        /// The surface of the last impact.
        surface: usize,
    },
    /// Impacts accumulate while the energy grows.
    Spasmodic {
        /// Time of the accumulation, extrapolated from the last flights.
        t: f64,
        /// The surface of the last impact.
        surface: usize,
    },
    /// Several surfaces were hit at the same time, and the state after the impacts depends on their order.
    Ambiguous {
        /// The smallest and the largest index of these surfaces.
        surfaces: [usize; 2],
    },
    /// The surface is still approached after its impact law.
    StillPenetrating {
        /// The surface.
        surface: usize,
        /// `dh(pi_D grad h) / dh(grad h)` at the impact.
        rho: f64,
    },
    /// A reset left the state off a constraint by more than 1e-9 of the sum of the absolute values of its terms.
    ResetOffConstraint {
        /// The surface.
        surface: usize,
        /// Index of the constraint.
        constraint: usize,
    },
    /// The law `reset` was selected for a surface that declares no reset.
    NoReset {
        /// The surface.
        surface: usize,
    },
    /// The motion reached a surface whose law is `stop`.
    StoppedAt {
        /// The surface.
        surface: usize,
        /// True if the motion may only have touched the surface: its contact is decided by rounding.
        graze: bool,
    },
    /// A single mode was run by itself, and reached a surface that leads to another mode.
    LeftMode {
        /// The surface.
        surface: usize,
    },
    /// The motion reached a surface with several transitions, and the conditions of none of them hold.
    Untaken {
        /// The last of these transitions.
        surface: usize,
    },
    /// Modes lead to each other at the same time, and none of them has a state from which the motion can continue.
    Trapped {
        /// The surface reached last.
        surface: usize,
    },
    /// The state rests on a surface and the motion presses into it. To continue it needs a contact force.
    Contact {
        /// The surface.
        surface: usize,
    },
    /// The surfaces that hold the motion move against each other, and no motion follows all of them.
    Squeezed {
        /// One of these surfaces, which the motion does not follow.
        surface: usize,
    },
    /// The motion crossed a surface with gap rate 0, where no impact law applies.
    TangentialCrossing {
        /// The surface.
        surface: usize,
    },
    /// The gap of an active surface is negative beyond rounding: at the start, after an impact, or behind a pole of the
    /// gap.
    StartsInside {
        /// The surface.
        surface: usize,
        /// Its gap.
        gap: f64,
    },
    /// The condition of a surface became true while its gap was negative.
    BeginsBehind {
        /// The surface.
        surface: usize,
        /// Its gap.
        gap: f64,
    },
    /// A coordinate reached the boundary of its chart interval.
    LeftChart {
        /// Index of the coordinate.
        coordinate: usize,
    },
    /// See [`Fault::MetricNotPositive`].
    MetricNotPositive {
        /// Index of the pivot.
        pivot: usize,
        /// Its value.
        value: f64,
    },
    /// See [`Fault::SingularConstraint`].
    SingularConstraint {
        /// Index of the constraint.
        constraint: usize,
        /// Estimated condition number.
        condition: f64,
    },
    /// See [`Fault::SingularFrame`].
    SingularFrame {
        /// Index of the quasi-velocity.
        quasi: usize,
    },
    /// See [`Fault::SingularSurface`].
    SingularSurface {
        /// Index of the surface.
        surface: usize,
    },
    /// See [`Fault::NotDerived`].
    NotDerived,
    /// See [`Fault::FirstOrder`].
    FirstOrder,
    /// See [`Fault::SeveralModes`].
    SeveralModes,
    /// See [`Fault::NonlinearConstraints`].
    NonlinearConstraints,
    /// A state or a rate is infinite or not a number.
    NonFinite {
        /// Index of the component of the state.
        component: usize,
    },
    /// A gap is not a number, or minus infinity. Its surface need not count there. The kind is `non_finite`, as above.
    UndefinedGap {
        /// Index of the surface.
        surface: usize,
    },
    /// The local error stays above the tolerance even in steps that no longer change the time.
    StepUnderflow {
        /// Time of the step.
        t: f64,
    },
    /// A step of fixed size led to a state with finite rates but no finite energy, for example outside the domain of
    /// `ln(x)`. The final state is that at the start of the step.
    LeftDomain,
    /// An implicit step has no solution near its start: it is too long for the fastest motion.
    NotConverged {
        /// Start of the step.
        t: f64,
    },
    /// The run used up its budget of steps.
    StepBudget,
    /// The run used up its budget of impacts.
    ImpactBudget,
    /// Projection did not bring the state back to a constraint. Levels are projected first, then velocities.
    ProjectionFailed {
        /// Index of the level, or of the constraint.
        constraint: usize,
    },
    /// The observer asked to stop.
    Stopped,
}

impl Outcome {
    /// The class of the outcome in snake case, as in tables and files.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Zeno { .. } => "zeno",
            Self::Spasmodic { .. } => "spasmodic",
            Self::Ambiguous { .. } => "ambiguous",
            Self::StillPenetrating { .. } => "still_penetrating",
            Self::ResetOffConstraint { .. } => "reset_off_constraint",
            Self::NoReset { .. } => "no_reset",
            Self::StoppedAt { .. } => "stopped_at",
            Self::LeftMode { .. } => "left_mode",
            Self::Untaken { .. } => "untaken",
            Self::Trapped { .. } => "trapped",
            Self::Contact { .. } => "contact",
            Self::Squeezed { .. } => "squeezed",
            Self::TangentialCrossing { .. } => "tangential_crossing",
            Self::StartsInside { .. } => "starts_inside",
            Self::BeginsBehind { .. } => "begins_behind",
            Self::LeftChart { .. } => "left_chart",
            Self::MetricNotPositive { .. } => "metric_not_positive",
            Self::SingularConstraint { .. } => "singular_constraint",
            Self::SingularFrame { .. } => "singular_frame",
            Self::SingularSurface { .. } => "singular_surface",
            Self::NotDerived => "not_derived",
            Self::FirstOrder => "first_order",
            Self::SeveralModes => "several_modes",
            Self::NonlinearConstraints => "nonlinear_constraints",
            Self::NonFinite { .. } | Self::UndefinedGap { .. } => "non_finite",
            Self::StepUnderflow { .. } => "step_underflow",
            Self::NotConverged { .. } => "not_converged",
            Self::LeftDomain => "left_domain",
            Self::StepBudget => "step_budget",
            Self::ImpactBudget => "impact_budget",
            Self::ProjectionFailed { .. } => "projection_failed",
            Self::Stopped => "stopped",
        }
    }

    /// True if the run reached its end time.
    pub const fn is_done(&self) -> bool {
        matches!(self, Self::Done)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Done => write!(f, "reached the requested end"),
            Self::Zeno { t, surface } => {
                write!(f, "impacts on surface {surface} accumulate at t = {t}")
            }
            Self::Spasmodic { t, surface } => write!(
                f,
                "impacts on surface {surface} accumulate at t = {t} while the energy grows"
            ),
            Self::Ambiguous {
                surfaces: [first, last],
            } => write!(
                f,
                "surfaces {first} and {last} are hit at one time, and the order of impacts matters"
            ),
            Self::StillPenetrating { surface, rho } => {
                write!(
                    f,
                    "the law of surface {surface} leaves the state approaching it (rho = {rho})"
                )
            }
            Self::ResetOffConstraint {
                surface,
                constraint,
            } => write!(
                f,
                "the reset of surface {surface} leaves the state off constraint {constraint}"
            ),
            Self::NoReset { surface } => write!(f, "surface {surface} declares no reset"),
            Self::StoppedAt { surface, graze } => {
                let reached = if graze {
                    "reached or touched"
                } else {
                    "reached"
                };
                write!(f, "the motion {reached} surface {surface}, which ends it")
            }
            Self::LeftMode { surface } => write!(
                f,
                "surface {surface} leads to another mode, and this one is run by itself"
            ),
            Self::Untaken { surface } => write!(
                f,
                "the conditions of none of the transitions at surface {surface} hold"
            ),
            Self::Trapped { surface } => write!(
                f,
                "at surface {surface} modes lead to each other, and none of them goes on"
            ),
            Self::Contact { surface } => write!(
                f,
                "the state rests on surface {surface} and is pressed into it"
            ),
            Self::Squeezed { surface } => write!(
                f,
                "surface {surface} and others that hold the motion move against each other"
            ),
            Self::TangentialCrossing { surface } => {
                write!(f, "surface {surface} was crossed at gap rate 0")
            }
            Self::StartsInside { surface, gap } => {
                write!(f, "surface {surface} counts where its gap is {gap:e}")
            }
            Self::BeginsBehind { surface, gap } => write!(
                f,
                "surface {surface} begins to count where its gap is {gap:e}"
            ),
            Self::LeftChart { coordinate } => {
                write!(f, "coordinate {coordinate} reached the end of its interval")
            }
            Self::MetricNotPositive { pivot, value } => {
                Fault::MetricNotPositive { pivot, value }.fmt(f)
            }
            Self::SingularConstraint {
                constraint,
                condition,
            } => Fault::SingularConstraint {
                constraint,
                condition,
            }
            .fmt(f),
            Self::SingularFrame { quasi } => Fault::SingularFrame { quasi }.fmt(f),
            Self::SingularSurface { surface } => Fault::SingularSurface { surface }.fmt(f),
            Self::NotDerived => Fault::NotDerived.fmt(f),
            Self::FirstOrder => Fault::FirstOrder.fmt(f),
            Self::SeveralModes => Fault::SeveralModes.fmt(f),
            Self::NonlinearConstraints => Fault::NonlinearConstraints.fmt(f),
            Self::NonFinite { component } => Fault::NonFinite { component }.fmt(f),
            Self::UndefinedGap { surface } => {
                write!(f, "the gap of surface {surface} has no value")
            }
            Self::StepUnderflow { t } => write!(f, "the step size underflows at t = {t}"),
            Self::NotConverged { t } => write!(
                f,
                "the equations of the implicit step at t = {t} have no solution within reach: a shorter step may have"
            ),
            Self::LeftDomain => f.write_str(
                "the motion left the domain of the energy, which is no finite number there",
            ),
            Self::StepBudget => write!(f, "the allowed number of steps was used up"),
            Self::ImpactBudget => write!(f, "the allowed number of impacts was used up"),
            Self::ProjectionFailed { constraint } => {
                write!(f, "projection to constraint {constraint} failed")
            }
            Self::Stopped => write!(f, "stopped on request"),
        }
    }
}

impl From<Fault> for Outcome {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::MetricNotPositive { pivot, value } => Self::MetricNotPositive { pivot, value },
            Fault::SingularConstraint {
                constraint,
                condition,
            } => Self::SingularConstraint {
                constraint,
                condition,
            },
            Fault::SingularFrame { quasi } => Self::SingularFrame { quasi },
            Fault::SingularSurface { surface } => Self::SingularSurface { surface },
            Fault::NotDerived => Self::NotDerived,
            Fault::FirstOrder => Self::FirstOrder,
            Fault::SeveralModes => Self::SeveralModes,
            Fault::NonlinearConstraints => Self::NonlinearConstraints,
            Fault::ProjectionFailed { constraint } => Self::ProjectionFailed { constraint },
            Fault::NonFinite { component } => Self::NonFinite { component },
        }
    }
}

/// Reason for the rejection of a run before its first step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StartError {
    /// A parameter of the system contradicts its declaration.
    Parameter(ParameterError),
    /// The times are not finite, or the end lies before the start.
    Times {
        /// Time of the start.
        t0: f64,
        /// Time of the end.
        t_end: f64,
    },
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Parameter(error) => error.fmt(f),
            Self::Times { t0, t_end } => write!(
                f,
                "a run goes forward between finite times, not from {t0} to {t_end}"
            ),
        }
    }
}

impl core::error::Error for StartError {}

impl From<ParameterError> for StartError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}
