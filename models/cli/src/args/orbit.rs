//! The flags of `orbit`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{ModelArgs, PolicyArgs, StateArgs, law_help};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "The run begins at the state that the flags or the model give; Newton's method begins at its first arrival at the surface. The
section are the states that arrive there. The multipliers are the eigenvalues of the derivative of the return along the section: the
direction of the motion is not among them, a conserved energy gives a 1. A section that is no wall is a surface with the law
`reset { }`. Exit status: 0 an orbit was found, 1 none was found, 2 bad flags or input.

Examples:
  dalembert orbit dimensionless_walker --surface step
  dalembert orbit dimensionless_walker --surface step --set alpha=0.3 --initial xi=-0.9 --json walker.json
  dalembert orbit point_billiard --surface wall --period 2 --set ta=2 --initial x=0,y=0,x_dot=0,y_dot=1";

/// `orbit`
#[derive(Debug, Args)]
pub struct OrbitArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// The surface that is the section.
    #[arg(long, value_name = "SURFACE")]
    pub surface: String,
    /// After how many returns the orbit closes.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..), default_value_t = 1)]
    pub period: u32,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// The time that may pass before the orbit closes; without it 3600, or the model's `until` if that is longer.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// Relative error allowed per step of the Taylor series, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-14", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// The laws to use instead of the declared ones.
    #[arg(long, value_name = "[SURFACE=]LAW[:E]", help = law_help())]
    pub law: Vec<String>,
    /// Where a law alone does not tell how to go on.
    #[command(flatten)]
    pub policies: PolicyArgs,
    /// Write everything as one JSON document; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
