//! The flags of a search for motions between two ends.

use clap::Args;

/// Numbers of impacts, and the extent of the search.
#[derive(Debug, Args)]
pub struct SearchArgs {
    /// Number of impacts, or its least and largest value, both included: `2`, `0..3`.
    #[arg(
        long,
        value_name = "N|A..B",
        allow_hyphen_values = true,
        default_value = "0"
    )]
    pub impacts: String,
    /// Number of directions that are scanned, for two unknowns or more. Default: 96 for two, 240 for three, 480 for
    /// more.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(4..=1_000_000))]
    pub starts: Option<u32>,
    /// Seed of the directions of --starts.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}
