//! The flags of `connect`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{ModelArgs, SearchArgs, SeriesArgs};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "The velocity at the start is unknown. As many coordinates must be given at the end as this velocity has free \
components: all of them if there are no constraints. Coordinates that --from does not name are those of the \
model's initial state. Angles are not reduced: an end that differs by a whole turn is another end.

With one unknown, both directions are scanned, and every change of sign of the miss is a bracket. With more \
unknowns, --starts directions are scanned. Newton's method continues from the starts that come nearest to the \
end, within one sequence of impacts. Derivatives across impacts are exact. The scan begins with energies that \
are estimated from the problem. It continues with faster starts until all of them have too many impacts, or up \
to a large multiple of the first speed. No search is exhaustive: two motions that differ by less than the \
resolution of the scan may be missed.

An impact at the end time is not counted. At a conjugate point, the determinant of the derivative of the \
configuration with respect to the initial velocity passes through 0: motions with neighbouring velocities meet \
there.

Exit status: 0 motions were found, 1 none was found, 2 bad flags or input.

More examples:
  dalembert connect bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 0..3 --plot paths.svg
  dalembert connect bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 2 --json -
  dalembert connect point_billiard --from x=0.5,y=0 --to x=-0.5,y=0 --time 1 --impacts 1 --axes x,y --plot chords.svg
  dalembert connect double_pendulum --from theta1=0,theta2=0 --to theta1=1,theta2=1 --time 1 --energy 100";

/// `connect`
#[derive(Debug, Args)]
pub struct ConnectArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Positions at the start, at `t = 0`. Default: the model's initial positions. May be repeated.
    #[arg(long, value_name = "NAME=VALUE,..", allow_hyphen_values = true)]
    pub from: Vec<String>,
    /// Positions at the end. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        allow_hyphen_values = true,
        required = true
    )]
    pub to: Vec<String>,
    /// Time of the end.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub time: f64,
    /// The search.
    #[command(flatten)]
    pub search: SearchArgs,
    /// Largest kinetic energy at the start. Default: an estimate from the problem, see below.
    #[arg(long, value_name = "E", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub energy: Option<f64>,
    /// Also compute the envelope of the motions: the conjugate points of N starts in each direction. Needs a problem with
    /// one unknown.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub envelope: Option<u32>,
    /// The motion.
    #[command(flatten)]
    pub series: SeriesArgs,
    /// Write a table with a row for each motion. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw all motions against time, or on the axes of --axes.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Quantities of the picture: one along x, one or more along y, as for `simulate`. Default: t,q
    #[arg(long, value_name = "X,Y[,Y..]", requires = "plot")]
    pub axes: Option<String>,
    /// Width of the picture, in pixels.
    #[arg(long, value_name = "PIXELS", requires = "plot", value_parser = clap::value_parser!(u32).range(300..=4000), default_value_t = 900)]
    pub plot_width: u32,
}
