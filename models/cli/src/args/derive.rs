//! The flags of `derive`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{ClaimsArgs, FeedbackArgs};

/// Format of a derivation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DeriveFormat {
    /// For people.
    Text,
    /// For documents.
    Latex,
    /// For programs.
    Json,
}

/// `derive`
#[derive(Debug, Args)]
pub struct DeriveArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// Scene, a selection of forces and surfaces. `list --format json` prints the scenes.
    #[arg(long, value_name = "SCENE", default_value = "all")]
    pub scene: String,
    /// Feedback laws of inputs.
    #[command(flatten)]
    pub feedback: FeedbackArgs,
    /// Claims.
    #[command(flatten)]
    pub claims: ClaimsArgs,
    /// Print the bracket of two functions instead of the equations. The functions depend on positions, velocities and
    /// momenta: `x,momentum(x)`.
    #[arg(
        long,
        value_name = "F,G",
        conflicts_with = "jacobiator",
        allow_hyphen_values = true
    )]
    pub bracket: Option<String>,
    /// Print the Jacobiator of three functions instead of the equations.
    #[arg(long, value_name = "F,G,H", allow_hyphen_values = true)]
    pub jacobiator: Option<String>,
    /// Print the reduction by symmetries instead of the equations: locked inertia, momentum map, connection, curvature,
    /// reduced equations. Fields are written as in claims: `partial(x),partial(y)`.
    #[arg(long, value_name = "XI,..", conflicts_with_all = ["bracket", "jacobiator"], allow_hyphen_values = true)]
    pub group: Option<String>,
    /// Print the maximum principle of a model with a `cost` instead of the equations: the Hamiltonian H* (minimised
    /// over the inputs), the optimal inputs, the equations of the costate and its jumps at impacts.
    #[arg(long, conflicts_with_all = ["bracket", "jacobiator", "group"])]
    pub control: bool,
    /// Output format.
    #[arg(long, value_enum, default_value_t = DeriveFormat::Text)]
    pub format: DeriveFormat,
    /// Write the derivation as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE", conflicts_with = "format")]
    pub json: Option<PathBuf>,
}
