//! Refusals and faults in the names of the model.

use dalembert::describe::Description;
use dalembert::{Fault, StateError};

use crate::names;
use crate::refusal::Refusal;

/// Advice about a state that violates the constraints, in the words of the interface that took it.
#[derive(Debug, Clone, Copy)]
pub struct Advice {
    /// Advice about velocities.
    pub off_constraint: &'static str,
    /// Advice about positions.
    pub off_position: &'static str,
}

/// The reason why a run does not start, in the model's names.
pub fn refusal_text(description: &Description, refusal: &Refusal, advice: &Advice) -> String {
    match refusal {
        Refusal::State(error) => state_text(description, error, advice),
        other => other.to_string(),
    }
}

/// The reason why a state was refused, in the model's names.
pub fn state_text(description: &Description, error: &StateError, advice: &Advice) -> String {
    match *error {
        StateError::OffConstraint {
            constraint,
            residual,
            scale,
        } => format!(
            "constraint `{}` is violated: residual {residual:e}, where the absolute values of its terms add up to \
             {scale:e}; {}",
            of_constraint(description, constraint),
            advice.off_constraint
        ),
        StateError::OffPosition {
            constraint,
            residual,
            scale,
        } => format!(
            "the positions violate the constraint `{}`: its sides differ by {residual:e}, where the absolute values of \
             its terms add up to {scale:e}; {}",
            of_constraint(description, constraint),
            advice.off_position
        ),
        StateError::NotFinite { component } => {
            let n = description.coordinates.len().max(1);
            let kind = if component < n {
                "position"
            } else {
                "velocity or momentum"
            };
            format!(
                "the {kind} of `{}` is not finite",
                coordinate(description, component % n)
            )
        }
        StateError::OutsideChart { coordinate: index } => {
            format!(
                "coordinate `{}` lies outside its interval",
                coordinate(description, index)
            )
        }
        StateError::Fault(ref fault) => fault_text(description, fault),
        ref other => other.to_string(),
    }
}

/// The reason why a quantity does not exist at a state, in the model's names.
pub fn fault_text(description: &Description, fault: &Fault) -> String {
    match *fault {
        Fault::MetricNotPositive { pivot, value } => format!(
            "the metric is not positive definite: the pivot at coordinate `{}` is {value}",
            coordinate(description, pivot)
        ),
        Fault::SingularConstraint {
            constraint,
            condition,
        } => format!(
            "constraint `{}` depends on the earlier ones at this state (condition {condition:e})",
            of_constraint(description, constraint)
        ),
        Fault::SingularFrame { quasi } => format!(
            "the declared frame is singular at this state: quasi-velocity `{}` follows from the others and the constraints",
            name(description.quasi_velocities.iter().copied(), quasi)
        ),
        Fault::SingularSurface { surface } => format!(
            "no impulse within the constraints changes the gap rate of surface `{}` here",
            name(names::surfaces(description), surface)
        ),
        Fault::ProjectionFailed { constraint } => format!(
            "no velocity that satisfies constraint `{}` was found near the given one",
            of_constraint(description, constraint)
        ),
        ref other => other.to_string(),
    }
}

/// The kind of a fault in snake case, as in outcomes.
pub const fn fault_kind(fault: &Fault) -> &'static str {
    match fault {
        Fault::MetricNotPositive { .. } => "metric_not_positive",
        Fault::SingularConstraint { .. } => "singular_constraint",
        Fault::SingularFrame { .. } => "singular_frame",
        Fault::SingularSurface { .. } => "singular_surface",
        Fault::FirstOrder => "first_order",
        Fault::NonlinearConstraints => "nonlinear_constraints",
        Fault::ProjectionFailed { .. } => "projection_failed",
        Fault::NonFinite { .. } => "non_finite",
        _ => "fault",
    }
}

/// Name of a constraint.
pub(crate) fn of_constraint(description: &Description, index: usize) -> String {
    let names = description.constraints.iter();
    name(names.map(|constraint| constraint.name), index)
}

fn coordinate(description: &Description, index: usize) -> String {
    name(names::coordinates(description), index)
}

fn name(mut names: impl Iterator<Item = &'static str>, index: usize) -> String {
    names
        .nth(index)
        .map_or_else(|| index.to_string(), str::to_owned)
}
