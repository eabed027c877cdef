//! What the command line refuses, and how it says so: the flag, what was given, what is accepted.

use std::fmt::Write as _;
use std::path::PathBuf;

use dalembert::describe::{Assumption, Description};
use dalembert::{Fault, StateError};
use dalembert_driver::{AnyModel, Refusal, Uncertified};
use thiserror::Error;

/// A request that cannot be carried out.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CliError {
    /// A name that is not among the accepted ones.
    #[error("{place}: unknown {what} `{given}`{}", hints(given, accepted))]
    Unknown {
        /// The flag or argument.
        place: String,
        /// What is named: `parameter`, `surface`.
        what: &'static str,
        /// What was written.
        given: String,
        /// The names there are.
        accepted: Vec<String>,
    },
    /// A value of the wrong kind.
    #[error("{place}: `{given}` is not accepted; expected {expected}")]
    Value {
        /// The flag or argument.
        place: String,
        /// What was written.
        given: String,
        /// What is accepted.
        expected: String,
    },
    /// The wrong number of values.
    #[error("{place}: expected {} ({}), got {got}", counted(names.len(), "number"), names.join(", "))]
    Length {
        /// The flag or argument.
        place: String,
        /// One name per expected number.
        names: Vec<&'static str>,
        /// How many were given.
        got: usize,
    },
    /// Mistakes in the text of a model.
    #[error("{0}")]
    Declaration(dalembert_jit::Refused),
    /// A model that is too large to be run without a compiler.
    #[error(
        "MODEL: `{model}` has vectors of more than 32 components, or more than 64 parameters; compile it in a crate with `dalembert::model!`"
    )]
    Large {
        /// The model.
        model: &'static str,
    },
    /// The reduced form of a model that has none.
    #[error("--form reduced: `{model}` has no form reduced to D; `derive {model}` says why")]
    Unreduced {
        /// The model.
        model: &'static str,
    },
    /// The law `reset` for a surface without one.
    #[error("--law: surface `{surface}` declares no reset")]
    NoReset {
        /// The surface.
        surface: &'static str,
    },
    /// Variations of a scene that was declared without them.
    #[error("--scene: `{scene}` was declared without `variations`; add it to what the scene uses")]
    Invariable {
        /// The scene.
        scene: String,
    },
    /// A model that no motion is certified of.
    #[error("--certify: {0}")]
    Uncertified(Uncertified),
    /// Flags that do not go together, or one that needs another.
    #[error("{0}")]
    Usage(&'static str),
    /// A parameter against its declaration.
    #[error(
        "parameter `{name}` is {value}, but must be {expected}; change it with --set {name}=VALUE"
    )]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What the declaration asks for.
        expected: Assumption,
    },
    /// A parameter that has no default and was not set.
    #[error(
        "parameter `{name}` has no default; give it with --set {name}=VALUE (must be {expected})"
    )]
    Unset {
        /// Its name.
        name: &'static str,
        /// What the declaration asks for.
        expected: Assumption,
    },
    /// A state that the system refuses.
    #[error("{place}: {reason}")]
    State {
        /// Where the state came from.
        place: String,
        /// Why, in the model's names.
        reason: String,
    },
    /// A run that the runtime refuses to start.
    #[error("simulate: {0}")]
    Start(String),
    /// Input that is not the JSON it should be.
    #[error("{place}: {reason}")]
    Input {
        /// The file or stream, and the place in it.
        place: String,
        /// What is wrong and what is expected.
        reason: String,
    },
    /// A file that cannot be read or written.
    #[error("{flag} {}: {source}", path.display())]
    File {
        /// The flag that named it.
        flag: &'static str,
        /// Its path.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file that another run, or another flag of the same run, is writing.
    #[error(
        "{flag} {}: another run is writing this file; give another file, or wait until that run has ended",
        path.display()
    )]
    Busy {
        /// The flag that named it.
        flag: &'static str,
        /// Its path.
        path: PathBuf,
    },
    /// The standard output or input failed.
    #[error("standard streams: {0}")]
    Stream(#[from] std::io::Error),
    /// The generator refused the model's own source.
    #[error("derive: {0}")]
    Derive(String),
    /// A picture that could not be drawn.
    #[error("{flag} {}: {reason}", path.display())]
    Plot {
        /// The flag that asked for it.
        flag: &'static str,
        /// Where it should have gone.
        path: PathBuf,
        /// What went wrong.
        reason: String,
    },
}

impl CliError {
    /// An error about a value.
    pub fn value(
        place: impl Into<String>,
        given: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value {
            place: place.into(),
            given: given.into(),
            expected: expected.into(),
        }
    }

    /// A picture of `--plot` that could not be drawn.
    pub fn picture(plot: &Option<PathBuf>, reason: String) -> Self {
        Self::Plot {
            flag: "--plot",
            path: plot.clone().unwrap_or_default(),
            reason,
        }
    }

    /// Why a state was refused, in the model's names.
    pub fn state(place: &str, description: &Description, error: StateError) -> Self {
        if let StateError::Parameter(error) = error {
            let (name, expected) = (error.name, error.expected);
            return match error.value.is_nan() {
                true => Self::Unset { name, expected },
                false => Self::Parameter {
                    name,
                    value: error.value,
                    expected,
                },
            };
        }
        Self::State {
            place: place.to_owned(),
            reason: state_text(description, &error),
        }
    }

    /// A run that does not begin.
    pub fn refused(model: &dyn AnyModel, refusal: &Refusal) -> Self {
        Self::Start(refusal_text(&model.description(), refusal))
    }
}

/// Says in the model's names why a run does not begin.
pub fn refusal_text(description: &Description, refusal: &Refusal) -> String {
    match refusal {
        Refusal::State(error) => state_text(description, error),
        other => other.to_string(),
    }
}

/// Says in the model's names why a state was refused.
pub fn state_text(description: &Description, error: &StateError) -> String {
    match *error {
        StateError::OffConstraint {
            constraint,
            residual,
            scale,
        } => format!(
            "constraint `{}` is violated: residual {residual:e}, where the absolute values of its terms add up to \
             {scale:e}; correct the velocities, or use --off-constraint project (nearest allowed velocity) or \
             --off-constraint keep (as it is)",
            name(
                description
                    .constraints
                    .iter()
                    .map(|constraint| constraint.name),
                constraint
            )
        ),
        StateError::OffPosition {
            constraint,
            residual,
            scale,
        } => format!(
            "the positions violate the constraint `{}`: its sides differ by {residual:e}, where the absolute values of \
             its terms add up to {scale:e}; leave one of the positions out of --initial or `initial` (it is then solved \
             for), or use --off-constraint project (allowed positions near by) or --off-constraint keep (as it is)",
            name(
                description
                    .constraints
                    .iter()
                    .map(|constraint| constraint.name),
                constraint
            )
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

/// Says in the model's names what does not exist at a state.
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
            name(
                description
                    .constraints
                    .iter()
                    .map(|constraint| constraint.name),
                constraint
            )
        ),
        Fault::SingularFrame { quasi } => format!(
            "the declared frame is singular at this state: quasi-velocity `{}` follows from the others and the constraints",
            name(description.quasi_velocities.iter().copied(), quasi)
        ),
        Fault::SingularSurface { surface } => format!(
            "no impulse within the constraints changes the gap rate of surface `{}` here",
            name(
                description.surfaces.iter().map(|surface| surface.name),
                surface
            )
        ),
        Fault::ProjectionFailed { constraint } => format!(
            "no velocity that satisfies constraint `{}` was found near the given one",
            name(
                description
                    .constraints
                    .iter()
                    .map(|constraint| constraint.name),
                constraint
            )
        ),
        ref other => other.to_string(),
    }
}

/// The kind of a fault in snake case, as outcomes write it.
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

fn coordinate(description: &Description, index: usize) -> String {
    name(
        description
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name),
        index,
    )
}

fn name(mut names: impl Iterator<Item = &'static str>, index: usize) -> String {
    names
        .nth(index)
        .map_or_else(|| index.to_string(), str::to_owned)
}

/// `1 number`, `3 numbers`.
pub fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// The nearest accepted name, if one is near, and all of them.
fn hints(given: &str, accepted: &[String]) -> String {
    let mut text = String::new();
    if let Some(nearest) = nearest(given, accepted) {
        let _ = write!(text, "; did you mean `{nearest}`?");
    }
    match accepted {
        [] => text.push_str("; there are none"),
        names => {
            let _ = write!(text, "\n  accepted: {}", names.join(", "));
        }
    }
    text
}

/// The first of the names nearest to `given`, unless more than a third of its letters would have to change.
fn nearest<'a>(given: &str, accepted: &'a [String]) -> Option<&'a String> {
    let lower = given.to_lowercase();
    let distance = |name: &String| strsim::damerau_levenshtein(&lower, &name.to_lowercase());
    let best = accepted.iter().min_by_key(|name| distance(name))?;
    (distance(best) <= lower.chars().count().div_ceil(3)).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(given: &str, accepted: &[&str]) -> String {
        let accepted = accepted.iter().map(|&name| name.to_owned()).collect();
        CliError::Unknown {
            place: "MODEL".to_owned(),
            what: "model",
            given: given.to_owned(),
            accepted,
        }
        .to_string()
    }

    #[test]
    fn a_near_name_is_suggested_and_all_are_listed() {
        let text = unknown("roling_disk", &["pendulum", "rolling_disk"]);
        assert_eq!(
            text,
            "MODEL: unknown model `roling_disk`; did you mean `rolling_disk`?\n  accepted: pendulum, rolling_disk"
        );
    }

    #[test]
    fn a_far_name_is_not_suggested() {
        assert_eq!(
            unknown("zzz", &["pendulum"]),
            "MODEL: unknown model `zzz`\n  accepted: pendulum"
        );
        assert_eq!(
            unknown("zzz", &[]),
            "MODEL: unknown model `zzz`; there are none"
        );
    }
}
