//! The flags of `map`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{CourseArgs, RowsArgs, RunArgs};
use crate::scalar;

/// The end of `map --help`.
pub const EXAMPLES: &str = "The first --vary runs along x, the second along y; with only one, the map is a strip. Every cell is a run from \
the model's initial state, or from the state that the flags give, with the varied quantities set to the values \
of the cell. The class of a cell is one of:

  failed at once      --fail holds before the first return
  failed              --fail holds later
  orbit K (period P)  its returns repeat after P of them; orbits are numbered in the order of
                      cells. Where a parameter is varied, every cell has an orbit of its own,
                      and the class is the period alone
  unsettled           it makes all returns, and they do not repeat
  done, zeno, ..      any other outcome of the run

Expressions have the syntax of `outputs` in a model file: coordinates, velocities `dot(x)`, parameters, \
definitions. --fail is evaluated at the start, at every return and after every step of the integrator, which \
--max-step shortens.

Columns of --csv: `member`, `in.NAME` for varied quantities, `class`, `outcome`, `returns`, `period`, `orbit` (0 \
without one), `t`, `end.NAME` (the state after the last return, or at the end without returns), `exponent` with \
--lyapunov, `value` with a --class that is an expression, `out.NAME` with --output, `contour.K`, `reason`. The \
rows and the picture do not depend on the number of threads.

Exit status: 0 every cell was run, 1 some start was refused, 2 bad flags or input.

More examples:
  dalembert map dimensionless_walker --vary eta=-2..2:400 --vary xi=-3..1:400 --returns 50 --fail 'theta > pi/2' --plot map.svg
  dalembert map dimensionless_walker --vary alpha=0.05..0.6:40 --vary delta=0.1..0.7:40 --returns 50 --fail 'theta > pi/2' --lyapunov 5 --class lyapunov --plot stability.svg
  dalembert map double_pendulum --vary theta1=-3..3:100 --vary theta2=-3..3:100 --until 20 --fail 'theta2^2 > pi^2' --contour '2*cos(theta1) + cos(theta2) = 1' --plot flips.svg";

/// `map`
#[derive(Debug, Args)]
#[command(mut_arg("input", |arg| arg.hide(true)))]
pub struct MapArgs {
    /// Model, start and laws of all cells.
    #[command(flatten)]
    pub run: RunArgs,
    /// Integrator and end of all cells.
    #[command(flatten)]
    pub course: CourseArgs,
    /// Vary a coordinate, a velocity or a parameter over equally spaced values, both ends included. Give it once or
    /// twice.
    #[arg(
        long,
        value_name = "NAME=A..B:COUNT",
        allow_hyphen_values = true,
        required = true
    )]
    pub vary: Vec<String>,
    /// Set a component of the start to an expression of parameters and other components. May be repeated.
    #[arg(long, value_name = "NAME = EXPR", allow_hyphen_values = true)]
    pub start: Vec<String>,
    /// Stop a run after this many returns to the surface. Without --until it may then take up to 3600 units of time, or
    /// the model's `until` if that is longer.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u64).range(1..))]
    pub returns: Option<u64>,
    /// The surface whose impacts are the returns; needed if the model has several.
    #[arg(long, value_name = "SURFACE", requires = "returns")]
    pub surface: Option<String>,
    /// Stop a run when this condition holds, and count the run as failed.
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    pub fail: Option<String>,
    /// Quantity that the colours show: `end`, the class of the cell; `returns`, the number of returns; `lyapunov`, the
    /// Lyapunov exponent; or an expression at the last return. A comparison has two colours.
    #[arg(
        long,
        value_name = "end|returns|lyapunov|EXPR",
        allow_hyphen_values = true,
        default_value = "end"
    )]
    pub class: String,
    /// Draw the curve of starts on which this equation holds, such as `xi = 2*eta`, or on which this expression is 0. May
    /// be repeated.
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    pub contour: Vec<String>,
    /// Add a column `out.NAME` with an expression at the end of each run, such as `S = integral(lagrangian)`. May be
    /// repeated.
    #[arg(long, value_name = "NAME = EXPR", allow_hyphen_values = true)]
    pub output: Vec<String>,
    /// Longest period of the orbits to search for, in returns.
    #[arg(long, value_name = "N", allow_hyphen_values = true, requires = "returns", value_parser = clap::value_parser!(u32).range(1..=64), default_value_t = 8)]
    pub period: u32,
    /// Largest difference between returns that count as equal: relative for values above 1, absolute otherwise.
    /// Default: 1e-6, or 1000 times --tol if that is larger. Cells have the same orbit if their returns differ by at
    /// most 1000 times this value.
    #[arg(long, value_name = "X", allow_hyphen_values = true, requires = "returns", value_parser = ValueParser::new(scalar::positive))]
    pub near: Option<f64>,
    /// Coordinates and velocities in which returns need not repeat, such as the distance travelled.
    #[arg(
        long,
        value_name = "NAME,..",
        requires = "returns",
        value_delimiter = ','
    )]
    pub ignore: Vec<String>,
    /// Compute the Lyapunov exponent of each cell: the mean logarithm of the growth of a small deviation per return, over
    /// this many further returns. On an orbit it is the logarithm of its largest multiplier, divided by its period,
    /// whatever N is.
    #[arg(long, value_name = "N", allow_hyphen_values = true, requires = "returns", value_parser = clap::value_parser!(u32).range(1..))]
    pub lyapunov: Option<u32>,
    /// Threads and rows.
    #[command(flatten)]
    pub rows: RowsArgs,
    /// Write the request, the classes and the orbits as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw the map.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Draw a dot for each cell in the plane of two quantities instead of the map. Quantities are the varied ones,
    /// names of --output, coordinates and velocities at the end, `t`, and columns of the table, such as `end.x` where x
    /// is varied. Colours are those of --class.
    #[arg(
        long,
        value_name = "X,Y",
        requires = "plot",
        conflicts_with = "contour"
    )]
    pub axes: Option<String>,
}

impl MapArgs {
    /// Difference below which returns repeat.
    pub fn nearness(&self) -> f64 {
        self.near
            .unwrap_or(f64::max(1e-6, 1000.0 * self.course.tol))
    }
}
