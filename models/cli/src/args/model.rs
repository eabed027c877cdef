//! Flags that select a model, its scene and its parameters.

use clap::Args;

/// The flags that select a model.
#[derive(Debug)]
pub struct Selection<'a> {
    /// The argument that names it.
    pub model: &'a mut String,
    /// Feedback laws of inputs.
    pub feedback: &'a [String],
    /// True if claims are not examined.
    pub skips_claims: bool,
}

/// Feedback laws of inputs.
#[derive(Debug, Default, Args)]
pub struct FeedbackArgs {
    /// Replace an input by a law: an expression of time, coordinates, velocities, parameters and definitions, such as
    /// `u=-4*x-dot(x)`. The closed loop is a model like any other, with derivatives, series and enclosures. May be repeated.
    #[arg(long, value_name = "INPUT=LAW", allow_hyphen_values = true)]
    pub feedback: Vec<String>,
}

/// Treatment of claims.
#[derive(Debug, Default, Args)]
pub struct ClaimsArgs {
    /// Do not examine the claims of a model that is read from a file.
    #[arg(long)]
    pub no_claims: bool,
}

/// The model, its scene and its parameters.
#[derive(Debug, Args)]
pub struct ModelArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// Scene, a selection of forces and surfaces. `list --format json` prints the scenes.
    #[arg(long, value_name = "SCENE", default_value = "all")]
    pub scene: String,
    /// Set parameters. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub set: Vec<String>,
    /// Feedback laws of inputs.
    #[command(flatten)]
    pub feedback: FeedbackArgs,
    /// Claims.
    #[command(flatten)]
    pub claims: ClaimsArgs,
    /// Initial mode, for a model with modes. Default: the mode declared first.
    #[arg(long, value_name = "MODE")]
    pub mode: Option<String>,
}

impl ModelArgs {
    /// The flags that select the model.
    pub fn selection(&mut self) -> Selection<'_> {
        Selection {
            model: &mut self.model,
            feedback: &self.feedback.feedback,
            skips_claims: self.claims.no_claims,
        }
    }
}
