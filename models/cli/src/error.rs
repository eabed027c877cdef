//! Errors of the command line: the flag, the given value, the accepted values.

use std::path::PathBuf;

use dalembert::StateError;
use dalembert::describe::{Assumption, Description};
use dalembert::erased::Excess;
use dalembert_driver::course::LawError;
use dalembert_driver::names::Unknown;
use dalembert_driver::words::{self, Advice};
use dalembert_driver::{AnyModel, Refusal, Uncertified};
use thiserror::Error;

/// A request that cannot be carried out.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CliError {
    /// A name that is not among the accepted ones.
    #[error("{place}: {unknown}")]
    Unknown {
        /// The flag or argument.
        place: String,
        /// The given name and the accepted names.
        unknown: Unknown,
    },
    /// A value of the wrong kind.
    #[error("{place}: `{given}` is not accepted; expected {expected}")]
    Value {
        /// The flag or argument.
        place: String,
        /// The given text.
        given: String,
        /// A description of accepted values.
        expected: String,
    },
    /// The wrong number of values.
    #[error("{place}: expected {} ({}), got {got}", counted(names.len(), "number"), names.join(", "))]
    Length {
        /// The flag or argument.
        place: String,
        /// One name per expected number.
        names: Vec<&'static str>,
        /// Number of given values.
        got: usize,
    },
    /// Mistakes in the text of a model.
    #[error("{0}")]
    Declaration(dalembert_jit::Refused),
    /// A model that is too large to run without a compiler.
    #[error(
        "MODEL: `{model}` has {excess} without a compiler; compile it in a crate with `dalembert::model!`"
    )]
    Large {
        /// The model.
        model: &'static str,
        /// The number that is too large.
        excess: Excess,
    },
    /// The reduced form, requested for a model without one.
    #[error("--form reduced: `{model}` has no form reduced to D; {}", match .is_free {
        true => "it has no constraints",
        false => "`derive` says why",
    })]
    Unreduced {
        /// The model.
        model: &'static str,
        /// True if the model has no constraints.
        is_free: bool,
    },
    /// A law that cannot be used.
    #[error("--law: {0}")]
    Law(LawError),
    /// Variations, requested for a scene declared without them.
    #[error(
        "--scene: `{scene}` was declared without `variations`; add it to what the scene uses, or leave out --scene"
    )]
    Invariable {
        /// The scene.
        scene: String,
    },
    /// A model whose motion cannot be certified.
    #[error("--certify: {0}")]
    Uncertified(Uncertified),
    /// Incompatible flags, or a flag that needs another.
    #[error("{0}")]
    Usage(&'static str),
    /// A parameter with a value that its declaration rules out.
    #[error(
        "parameter `{name}` is {value}, but must be {expected}; change it with --set {name}=VALUE"
    )]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The declared assumption.
        expected: Assumption,
    },
    /// A parameter that has no default and was not set.
    #[error(
        "parameter `{name}` has no default; give it with --set {name}=VALUE (must be {expected})"
    )]
    Unset {
        /// Its name.
        name: &'static str,
        /// The declared assumption.
        expected: Assumption,
    },
    /// A state that the system refuses.
    #[error("{place}: {reason}")]
    State {
        /// The origin of the state.
        place: String,
        /// The reason, in the model's names.
        reason: String,
    },
    /// A run that the runtime refuses to start.
    #[error("the run cannot start: {0}")]
    Start(String),
    /// Input that is not valid JSON or has the wrong structure.
    #[error("{place}: {reason}")]
    Input {
        /// The file or stream, and the position in it.
        place: String,
        /// The defect, and what is expected.
        reason: String,
    },
    /// A file that cannot be read or written.
    #[error("{flag} {}: {source}", path.display())]
    File {
        /// The flag that named it.
        flag: &'static str,
        /// Its path.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file that another run, or another flag of the same run, is writing.
    #[error(
        "{flag} {}: another flag or another run is writing this file; give another file, or wait until the other run has ended",
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
    /// The generator refused the source of the model.
    #[error("derive: {0}")]
    Derive(String),
    /// A field of `--modulo` that is not a usable symmetry, or fields that do not generate a group.
    #[error("--modulo: {0}")]
    Modulo(String),
    /// A picture that could not be drawn.
    #[error("{flag} {}: {reason}", path.display())]
    Plot {
        /// The flag that requested it.
        flag: &'static str,
        /// Its intended path.
        path: PathBuf,
        /// The reason.
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

    /// The error for a refused state, in the model's names.
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

    /// The error for a run that does not start.
    pub fn refused(model: &dyn AnyModel, refusal: &Refusal) -> Self {
        let reason = refusal_text(model.description(), refusal);
        match refusal {
            Refusal::Large(_) => Self::Input {
                place: "MODEL".to_owned(),
                reason,
            },
            _ => Self::Start(reason),
        }
    }
}

/// Advice about states that violate the constraints.
pub(crate) const ADVICE: Advice = Advice {
    off_constraint: "correct the velocities, or use --off-constraint project (nearest allowed velocity) or \
         --off-constraint keep (as it is)",
    off_position: "leave one of the positions out of --initial or `initial` (it is then solved for), or use \
         --off-constraint project (allowed positions near by) or --off-constraint keep (as it is)",
};

/// Explains, in the model's names, why a run does not start.
pub fn refusal_text(description: &Description, refusal: &Refusal) -> String {
    words::refusal_text(description, refusal, &ADVICE)
}

/// Explains, in the model's names, why a state was refused.
pub fn state_text(description: &Description, error: &StateError) -> String {
    words::state_text(description, error, &ADVICE)
}

/// `1 number`, `3 numbers`.
pub fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}
