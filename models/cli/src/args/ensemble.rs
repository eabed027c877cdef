//! The flags of `ensemble`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{CourseArgs, RunArgs};
use crate::scalar;

/// The end of `ensemble --help`.
pub const EXAMPLES: &str = "--vary names a coordinate, a velocity or a parameter; where several are varied, every value of one meets every
value of the others, the last one running fastest. Member k is the same whatever the number of threads and whatever the
shard. The rows of --csv come in order of members: columns `member`, `in.NAME` for what is varied, `outcome`, `t`,
`end.NAME` for the last state, `energy`, `energy_change`, `out.NAME`, `impacts.SURFACE`, `contacts`, counters, `reason`.
Everything that tells the ensemble apart (model with its hash and source, integrator, tolerance, seed, shard) is in
FILE.meta.json beside it, and within a Parquet file under keys `dalembert.NAME`.

Exit status: 0 every member reached its end, 1 some member did not, 2 bad flags or input.

Examples:
  dalembert ensemble rolling_disk --vary theta_dot=9.995..10.005 --members 10000 --csv disks.csv
  dalembert ensemble bouncing_ball --vary x=0.5..2:20 --vary g=1.62,9.81 --until 10
  dalembert ensemble double_pendulum --random 7 --members 1000 --vary a=1+-0.01 --vary b=0..pi --csv swing.csv
  dalembert ensemble double_pendulum --from states.csv --shard 3/8 --csv part3.csv --resume
  dalembert ensemble rolling_disk --vary theta_dot=9..11 --members 64 --until 2000 --density x,y:200 --plot disks.svg";

/// `ensemble`
#[derive(Debug, Args)]
pub struct EnsembleArgs {
    /// What all members share.
    #[command(flatten)]
    pub run: RunArgs,
    /// Their integrator and their end.
    #[command(flatten)]
    pub course: CourseArgs,
    /// Vary a coordinate, a velocity or a parameter over equally spaced values, both ends included, or over a list. With
    /// --random: A..B is uniform there, C+-S normal with mean C and standard deviation S. May be repeated.
    #[arg(
        long,
        value_name = "NAME=A..B[:COUNT]|V,V,..|C+-S",
        allow_hyphen_values = true
    )]
    pub vary: Vec<String>,
    /// The number of members: the values of the one `A..B` without a count, or how many are drawn with --random.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub members: Option<u64>,
    /// Draw what is varied at random, from this seed.
    #[arg(long, value_name = "SEED", conflicts_with = "from")]
    pub random: Option<u64>,
    /// Take the members from a table, one a row: columns named like coordinates, velocities and parameters, as `simulate
    /// --csv` and `ensemble --csv` write them; `-` is the standard input.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["vary", "members"])]
    pub from: Option<PathBuf>,
    /// Run only the I-th of N blocks of members, counted from 1. The rows of all blocks, one after the other, are those of
    /// the whole.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub shard: Option<String>,
    /// Threads; without it as many as the machine runs at one time.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Write a row for every member, as they are done; `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the same rows as Parquet, once all are done (needs a build with the feature `parquet`).
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,
    /// Go on with the files of --csv or --parquet where they were cut off.
    #[arg(long)]
    pub resume: bool,
    /// Write what is known of the whole as one JSON document: what was asked for, outcomes, density; `-` is the standard
    /// output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Count how much time the motion spends where, on a grid of BINS by BINS cells (100 without it) over two coordinates,
    /// velocities or outputs, or `energy`. Angles are counted from -pi to pi. A range that is not given is that of a few
    /// members for a while, with some room; what lies outside is counted too.
    #[arg(
        long,
        value_name = "X[=A..B],Y[=A..B][:BINS[xBINS]]",
        allow_hyphen_values = true
    )]
    pub density: Option<String>,
    /// Time between the states that --density counts.
    #[arg(long, value_name = "DT", allow_hyphen_values = true, requires = "density", value_parser = ValueParser::new(scalar::positive), default_value = "1")]
    pub every: f64,
    /// Time that passes in every member before --density begins to count.
    #[arg(long, value_name = "T", allow_hyphen_values = true, requires = "density", value_parser = ValueParser::new(scalar::nonnegative), default_value = "0")]
    pub discard: f64,
    /// Write the counts of --density as a table, a cell a row; `-` is the standard output.
    #[arg(long, value_name = "FILE", requires = "density")]
    pub cells: Option<PathBuf>,
    /// Draw the density.
    #[arg(long, value_name = "FILE.svg", requires = "density")]
    pub plot: Option<PathBuf>,
}
