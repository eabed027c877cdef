//! The flags of `ensemble`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{CourseArgs, RowsArgs, RunArgs};
use crate::scalar;

/// The end of `ensemble --help`.
pub const EXAMPLES: &str = "Several --vary make a grid: all combinations of their values, the last one changing fastest. Member k does not \
depend on the number of threads or on the shard. The rows of --csv are in the order of members, with the columns \
`member`, `in.NAME` for varied quantities, `outcome`, `t`, `end.NAME` for the last state, `energy`, \
`energy_change`, `out.NAME`, `impacts.SURFACE`, `contacts`, counters, `reason`. The file FILE.meta.json beside \
the table identifies the ensemble: model with its hash and source, integrator, tolerance, seed, shard. A Parquet \
file has the same entries under keys `dalembert.NAME`.

Exit status: 0 every member reached its end, 1 some member did not, 2 bad flags or input.

More examples:
  dalembert ensemble rolling_disk --vary theta_dot=9.995..10.005 --members 10000 --csv disks.csv
  dalembert ensemble bouncing_ball --vary x=0.5..2:20 --vary g=1.62,9.81 --until 10
  dalembert ensemble double_pendulum --random 7 --members 1000 --vary theta1=1+-0.01 --csv swing.csv
  dalembert ensemble double_pendulum --from states.csv --shard 3/8 --csv part3.csv --resume
  dalembert ensemble double_pendulum --from states.csv --merge part1.csv part2.csv part3.csv --csv all.csv
  dalembert ensemble rolling_disk --vary theta_dot=9..11 --members 64 --density x,y --plot disks.svg";

/// `ensemble`
#[derive(Debug, Args)]
#[command(mut_arg("input", |arg| arg.hide(true)))]
pub struct EnsembleArgs {
    /// Common part of all members.
    #[command(flatten)]
    pub run: RunArgs,
    /// Integrator and end of the runs.
    #[command(flatten)]
    pub course: CourseArgs,
    /// Vary a coordinate, a velocity or a parameter over equally spaced values, both ends included, or over a list. With
    /// --random, A..B is a uniform distribution, C+-S a normal one with mean C and standard deviation S. May be repeated.
    #[arg(
        long,
        value_name = "NAME=A..B[:COUNT]|V,V,..|C+-S",
        allow_hyphen_values = true
    )]
    pub vary: Vec<String>,
    /// Number of members. Without --random, it is the count of the one range `A..B` that has none; with --random, it is
    /// the number of draws.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub members: Option<u64>,
    /// Draw the varied quantities at random, from this seed.
    #[arg(long, value_name = "SEED", conflicts_with = "from")]
    pub random: Option<u64>,
    /// Read the members from a table, one in each row. Columns are named after coordinates, velocities and parameters,
    /// as in the tables of `simulate --csv` and `ensemble --csv`. `-` is the standard input.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["vary", "members"])]
    pub from: Option<PathBuf>,
    /// Add an output to the model for these runs, such as `S = integral(lagrangian)`. The expression has the syntax of
    /// `outputs` in a model; it cannot refer to another output. May be repeated.
    #[arg(long, value_name = "NAME = EXPR", allow_hyphen_values = true)]
    pub output: Vec<String>,
    /// Run only block I of N blocks of members, counted from 1. The rows of all blocks together are those of the whole
    /// ensemble.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub shard: Option<String>,
    /// Merge the files of all shards instead of running members. Rows, sums, density and pictures are those of one run
    /// of the whole ensemble. Give the flags with which the shards were run.
    #[arg(long, value_name = "PART.csv", num_args = 1.., conflicts_with_all = ["shard", "resume"])]
    pub merge: Vec<PathBuf>,
    /// Threads and rows.
    #[command(flatten)]
    pub rows: RowsArgs,
    /// Write the request, the outcomes and the density of the ensemble as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Count the states of all members in the cells of a grid over two coordinates, velocities or outputs, or `energy`.
    /// BINS is the number of cells in each direction, by default 100. Angles are reduced to -pi to pi. A range that is
    /// not given is estimated from short runs of a few members. States outside of the grid are counted separately.
    #[arg(
        long,
        value_name = "X[=A..B],Y[=A..B][:BINS[xBINS]]",
        allow_hyphen_values = true
    )]
    pub density: Option<String>,
    /// Time between the states that --density counts.
    #[arg(long, value_name = "DT", allow_hyphen_values = true, requires = "density", value_parser = ValueParser::new(scalar::positive), default_value = "1")]
    pub every: f64,
    /// Time from the start of every member during which --density does not count states.
    #[arg(long, value_name = "T", allow_hyphen_values = true, requires = "density", value_parser = ValueParser::new(scalar::nonnegative), default_value = "0")]
    pub discard: f64,
    /// Write the counts of --density as a table, one cell in each row. `-` is the standard output.
    #[arg(long, value_name = "FILE", requires = "density")]
    pub cells: Option<PathBuf>,
    /// Draw the density.
    #[arg(long, value_name = "FILE.svg", requires = "density")]
    pub plot: Option<PathBuf>,
}
