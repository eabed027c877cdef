//! The flags of motions by Taylor series, which `orbit`, `connect` and `linearise` share.

use clap::Args;
use clap::builder::ValueParser;
use dalembert::Tolerance;

use super::{PolicyArgs, law_help};
use crate::error::CliError;
use crate::scalar;

/// Motion by Taylor series with a small tolerance, across impacts.
#[derive(Debug, Args)]
pub struct SeriesArgs {
    /// Tolerance: relative local error per step of the Taylor series, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-14", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// Laws in place of the declared ones.
    #[arg(long, value_name = "[SURFACE=]LAW[:E]", help = law_help())]
    pub law: Vec<String>,
    /// Treatment of impacts after which the law alone does not determine the motion.
    #[command(flatten)]
    pub policies: PolicyArgs,
}

impl SeriesArgs {
    /// The tolerance.
    pub fn tolerance(&self) -> Result<Tolerance, CliError> {
        Tolerance::new(self.tol)
            .map_err(|error| CliError::value("--tol", self.tol.to_string(), error.to_string()))
    }
}
