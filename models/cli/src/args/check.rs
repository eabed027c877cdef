//! The flags of `check`.

use std::path::PathBuf;

use clap::Args;

use super::{FeedbackArgs, Format};

/// `check`
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// Feedback laws of inputs.
    #[command(flatten)]
    pub feedback: FeedbackArgs,
    /// Output format.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write the findings as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE", conflicts_with = "format")]
    pub json: Option<PathBuf>,
    /// Write the claims with the grounds of their proofs as JSON, for the checker `python/check_certificate.py`.
    #[arg(long, value_name = "FILE")]
    pub certificate: Option<PathBuf>,
    /// Decide the hypotheses of the Poincare-Bendixson theorem for planar hybrid systems by interval arithmetic
    /// instead. For a cycle of modes with one degree of freedom each, the inequalities of their energies are evaluated.
    /// Exit status 0 if all hypotheses are proved.
    #[arg(long, conflicts_with = "certificate")]
    pub bendixson: bool,
    /// Set parameters, for --bendixson. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "bendixson"
    )]
    pub set: Vec<String>,
}
