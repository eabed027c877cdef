//! The flags of `control`.

use std::path::PathBuf;

use clap::builder::ValueParser;
use clap::{ArgGroup, Args};

use super::{DynamicArgs, ModelArgs, SearchArgs};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "The model declares `inputs` and a `cost { running = ..; terminal = ..; }`. Extremals satisfy the maximum \
principle: state and costate satisfy Hamilton's equations with H*, the Hamiltonian minimised over the inputs, \
and both jump at impacts. `derive MODEL --control` prints the equations. The state consists of the coordinates \
of a first-order model, or of the positions and velocities of a Lagrangian model: x, x_dot.

The costate at the start is unknown. At the end, --end fixes components of the state; the costate of each other \
component is the derivative of the terminal cost. Costates are scanned in --starts directions. Newton's method \
continues from the costates that come nearest to these conditions, within one sequence of impacts, with exact \
derivatives across impacts. No search is exhaustive: extremals may be missed. The extremals that are found are \
listed in order of cost. Each is extremal among motions with its number of impacts.

The second-order test gives `minimum` if every neighbouring motion with the same sequence of impacts costs more. \
It gives `fails` if some of them cost less, as after a focal point, and `open` if the inputs do not control all \
directions of the state.

With --dp, the least cost is computed backwards in --steps steps on a grid of the state, for models with two \
components of the state and one input. The input is constant in each step; its values are those of its axis and \
values between them. Motions that leave the grid have no cost. A path of least cost is a motion with the best \
inputs; it is compared with the cheapest extremal for --impacts. --csv has a row for each node at the time --at: \
state, cost, input, number of impacts. --inputs has the first path. --plot draws a map of --show with the paths \
on top. With --axes, it draws the paths on axes of t, the state, the input and cost.

Bounds on inputs and states, constraints, and impact laws without an inverse, such as plastic ones, are refused.

Exit status: 0 extremals were found, 1 none was found, 2 bad flags or input.

More examples:
  dalembert control controlled_ball --initial x=2 --impacts 0..2 --plot balls.svg
  dalembert control controlled_ball --initial x=1 --end x=1,y=0 --impacts 0..1 --set e=0.8
  dalembert control controlled_ball --impacts 2 --inputs best.csv --json -
  dalembert control controlled_ball --initial x=1 --end x=1,y=0 --impacts 1..2 --vary e=0.5..1:21 --plot loss.svg
  dalembert control controlled_ball --impacts 0..2 --dp x=0..3:61,y=-6..6:61,u=-4..4:17 --plot cost.svg";

/// `control`
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("parallel").args(["dp", "vary"]).multiple(true))]
pub struct ControlArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Change the model's initial state by name: `x=..`, `x_dot=..`. May be repeated.
    #[arg(long, value_name = "NAME=VALUE,..", allow_hyphen_values = true)]
    pub initial: Vec<String>,
    /// Components of the state at the end; the others are free. May be repeated.
    #[arg(long, value_name = "NAME=VALUE,..", allow_hyphen_values = true)]
    pub end: Vec<String>,
    /// Time of the end. Default: the model's `until`.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// Repeat the search for every value of a parameter or of a component of the start: `e=0.5..1:11`, `y=-4,0,4`.
    /// --csv has the rows of all values. --plot draws the costs against the values: for each number of impacts a line
    /// of the least cost, and dots for the other extremals.
    #[arg(long, value_name = "NAME=A..B:COUNT", allow_hyphen_values = true, conflicts_with_all = ["dp", "inputs", "axes"])]
    pub vary: Option<String>,
    /// The search.
    #[command(flatten)]
    pub search: SearchArgs,
    /// Dynamic programming.
    #[command(flatten)]
    pub dynamic: DynamicArgs,
    /// Tolerance: relative local error per step of the Taylor series, between 1e-15 and 0.1.
    #[arg(long, value_name = "X", default_value = "1e-14", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::tolerance))]
    pub tol: f64,
    /// Write a table with a row for each extremal. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the extremal of least cost as a table: time, state, costate, cost so far, inputs, Hamiltonian H*. Each
    /// impact has two rows, one before it and one after it. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub inputs: Option<PathBuf>,
    /// Number of rows of the table of --inputs, equally spaced in time; rows at impacts are added.
    #[arg(long, value_name = "N", requires = "inputs", value_parser = clap::value_parser!(u32).range(2..=10_000_000), default_value_t = 501)]
    pub samples: u32,
    /// Draw all extremals: state and inputs against time, or the axes of --axes.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Quantities of the picture: one along x, one or more along y. Quantities are `t`, the components of the state,
    /// `costate_x` and so on, `cost`, the inputs and `hamiltonian`. Default: t, the state, the inputs
    #[arg(long, value_name = "X,Y[,Y..]", requires = "plot")]
    pub axes: Option<String>,
    /// Width of the picture, in pixels.
    #[arg(long, value_name = "PIXELS", requires = "plot", value_parser = clap::value_parser!(u32).range(300..=4000), default_value_t = 900)]
    pub plot_width: u32,
}
