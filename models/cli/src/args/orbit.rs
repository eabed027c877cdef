//! The flags of `orbit`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{ModelArgs, PolicyArgs, StateArgs, law_help};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "The section consists of the states that arrive at the surface. Newton's method starts at the first arrival of the
motion from the given state. The Floquet multipliers are the eigenvalues of the derivative of the return map on the
section. The direction of the motion is not among them; a conserved energy gives a multiplier 1. For a section that is
not a wall, declare a surface with the law `reset { }`. Exit status: 0 an orbit was found, 1 none was found, 2 bad
flags or input.

More examples:
  dalembert orbit dimensionless_walker --surface step --set alpha=0.3 --initial xi=-0.9 --json -
  dalembert orbit point_billiard --surface wall --period 2 --set ta=2 --initial x=0,y=0,x_dot=0,y_dot=1";

/// `orbit`
#[derive(Debug, Args)]
pub struct OrbitArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Surface of the section.
    #[arg(long, value_name = "SURFACE")]
    pub surface: String,
    /// Number of returns after which the orbit closes.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..), default_value_t = 1)]
    pub period: u32,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// Largest time of the orbit. Default: 3600, or the model's `until` if that is longer.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// Tolerance: relative local error per step of the Taylor series, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-14", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// Laws in place of the declared ones.
    #[arg(long, value_name = "[SURFACE=]LAW[:E]", help = law_help())]
    pub law: Vec<String>,
    /// Treatment of impacts after which the law alone does not determine the motion.
    #[command(flatten)]
    pub policies: PolicyArgs,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
