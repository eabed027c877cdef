//! The flags of `orbit`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{ModelArgs, SeriesArgs, StateArgs};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "The section consists of the states that arrive at the surface. Newton's method starts at the first arrival of \
the motion from the given state. The Floquet multipliers are the eigenvalues of the derivative of the return map \
on the section. The trivial multiplier 1 along the motion is not among them; a conserved energy gives a \
multiplier 1. For a section that is not a wall, declare a surface with the law `reset { }`. Exit status: 0 an \
orbit was found, 1 none was found, 2 bad flags or input.

--modulo lets the orbit close up to symmetries: a walker that advances along the slope, a top that precesses. \
The fields must be proved symmetries of the motion, of the surfaces and of their maps. The multipliers exclude \
the directions of the symmetries; the conserved momentum of a symmetry gives a multiplier 1.

--continue follows the orbit over a parameter by pseudo-arclength continuation, through folds, to both ends of \
the range. If the model's value of the parameter lies outside of the range, the orbit is followed to the nearest \
end first. Derivatives with respect to the state and the parameter are exact across impacts. Bifurcations are \
located to nine digits:

  fold            the branch turns back; a multiplier is 1
  flip            a multiplier is -1; orbits of twice the period branch off
  neimark_sacker  two complex multipliers have modulus 1; a torus branches off
  branch_point    a multiplier is 1 without a fold; another branch crosses

A branch may end inside the range: at a surface that the orbit grazes, where the return map is not defined, or \
where the parameter leaves the values of its declaration. The points up to there are kept, and the exit status \
is 0.

--across follows each of these bifurcations over a second parameter. The curves bound the regions of stability. \
A curve ends where a parameter leaves its range, and for the same reasons as a branch. A curve of Neimark-Sacker \
bifurcations also ends at a strong resonance, where its two multipliers meet at 1 or -1.

More examples:
  dalembert orbit compass_walker --surface heel --continue gamma=0.001..0.017 --plot gaits.svg --axis omega
  dalembert orbit mathieu --surface period --initial x=0 --continue delta=0.1..0.6 --across eps=0.1..1 --plot tongue.svg
  dalembert orbit walker_foot_slip --surface step --modulo 'partial(x_c)'
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
    /// Symmetries up to which the orbit closes, as claims write them, separated by commas: `partial(x)`, or
    /// `partial(phi) - y*partial(x) + x*partial(y)`.
    #[arg(long, value_name = "FIELDS", allow_hyphen_values = true)]
    pub modulo: Option<String>,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// Largest time of the orbit. Default: 3600, or the model's `until` if that is longer.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub until: Option<f64>,
    /// The motion.
    #[command(flatten)]
    pub series: SeriesArgs,
    /// Continuation.
    #[command(flatten)]
    pub branch: BranchArgs,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Flags of the branch of an orbit.
#[derive(Debug, Args)]
pub struct BranchArgs {
    /// Follow the orbit over a parameter to both ends of a range, and locate its bifurcations.
    #[arg(
        long = "continue",
        id = "continue",
        value_name = "NAME=A..B",
        allow_hyphen_values = true
    )]
    pub range: Option<String>,
    /// Follow the bifurcations of the branch over a second parameter: curves in the plane of both parameters. --csv has a
    /// row for every point of a curve, --plot draws the plane.
    #[arg(
        long,
        value_name = "NAME=A..B",
        requires = "continue",
        conflicts_with = "axis",
        allow_hyphen_values = true
    )]
    pub across: Option<String>,
    /// Largest number of steps along the branch, and along each curve, in either direction.
    #[arg(long, value_name = "N", requires = "continue", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..), default_value_t = 1000)]
    pub points: u32,
    /// Write a row for every point of the branch. `-` is the standard output.
    #[arg(long, value_name = "FILE", requires = "continue")]
    pub csv: Option<PathBuf>,
    /// Draw the branch over the parameter.
    #[arg(long, value_name = "FILE.svg", requires = "continue")]
    pub plot: Option<PathBuf>,
    /// Quantity along y: `period`, or a coordinate, a velocity `x_dot`, a momentum `p_x`, `energy` or an output at the
    /// surface, before the event there. Default: the first coordinate or velocity that changes along the branch.
    #[arg(long, value_name = "NAME", requires = "plot")]
    pub axis: Option<String>,
}
