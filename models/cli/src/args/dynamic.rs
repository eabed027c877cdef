//! The flags of dynamic programming.

use clap::builder::ValueParser;
use clap::{Args, ValueEnum};

use crate::scalar;

/// Quantity of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Shown {
    /// The least cost from the node to the end.
    Cost,
    /// The best input.
    Input,
    /// The number of impacts of the best motion.
    Impacts,
}

/// The grid, the paths, and the picture of dynamic programming.
#[derive(Debug, Args)]
pub struct DynamicArgs {
    /// Solve by dynamic programming on this grid instead: an axis for each of the two components of the state and for
    /// the input.
    #[arg(
        long,
        value_name = "NAME=A..B:COUNT,..",
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with = "end"
    )]
    pub dp: Vec<String>,
    /// Number of time steps; the input is constant in each of them.
    #[arg(long, value_name = "N", requires = "dp", value_parser = clap::value_parser!(u32).range(1..=100_000), default_value_t = 100)]
    pub steps: u32,
    /// Follow the path of least cost from this state. Default: the initial state. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        requires = "dp",
        allow_hyphen_values = true
    )]
    pub path: Vec<String>,
    /// Time of the map of --plot and of the rows of --csv, rounded to the nearest step. Default: 0.
    #[arg(long, value_name = "T", requires = "dp", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::parse))]
    pub at: Option<f64>,
    /// Quantity of the map.
    #[arg(long, value_enum, value_name = "QUANTITY", requires = "dp", default_value_t = Shown::Cost)]
    pub show: Shown,
    /// Number of threads of --dp and --vary. Default: the number that the machine runs in parallel.
    #[arg(long, value_name = "N", requires = "parallel", allow_hyphen_values = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl DynamicArgs {
    /// True if a grid is given.
    pub fn is_wanted(&self) -> bool {
        !self.dp.is_empty()
    }

    /// Number of threads.
    pub fn thread_count(&self) -> u64 {
        super::thread_count(self.threads)
    }
}
