//! The flags of `linearise`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::ValueParser;

use super::{ModelArgs, SeriesArgs, StateArgs};
use crate::scalar;

pub(super) const EXAMPLES: &str =
    "Small deviations y of the state, u of the inputs and z of the outputs follow

  d/dt y = A y + B u,   z = C y + D u

with the derivatives of the equations of motion, exact to rounding. The state consists of positions and \
velocities; with constraints, of positions and quasi-velocities; in a first-order model, of the coordinates. \
Impacts are left out. A model with modes is linearised in the mode that --mode names, as if there were no other.

--trim searches for an equilibrium near the given state by the Levenberg-Marquardt method. It changes all \
components of the state and all inputs, or only the named ones: `--trim=u,theta`. --moving names coordinates \
that need not rest, such as the position of a wheel that rolls steadily. An equilibrium is stable if all \
eigenvalues of A have negative real parts, unstable if one has a positive real part.

--every T follows the motion from that state with constant inputs. It prints the state at t + T as `next`, and \
the matrices of

  y(t + T) = Phi y(t) + Gamma u

across impacts, with the saltation matrix of each impact. --samples N repeats this N times. Along a periodic \
orbit, whose start and period `orbit` prints, these are the matrices of a periodic linear-quadratic regulator.

Exit status: 0 the equations were linearised, 1 no equilibrium was found or the equations have no derivative \
there, 2 bad flags or input.

More examples:
  dalembert linearise double_pendulum --initial theta1=3,theta2=3 --trim
  dalembert linearise dimensionless_walker --trim --json -
  dalembert linearise rolling_disk --trim=turn --moving x,y,theta
  dalembert linearise bouncing_ball --every 0.5 --samples 3";

/// `linearise`
#[derive(Debug, Args)]
pub struct LineariseArgs {
    /// The model.
    #[command(flatten)]
    pub model: ModelArgs,
    /// Set inputs to constant values; 0 by default. May be repeated.
    #[arg(
        long,
        value_name = "NAME=VALUE,..",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub input: Vec<String>,
    /// The state.
    #[command(flatten)]
    pub state: StateArgs,
    /// Time of the state, for equations that depend on time.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::parse), default_value = "0")]
    pub at: f64,
    /// Search for an equilibrium first. With names, the search changes only these components of the state and inputs.
    #[arg(
        long,
        value_name = "NAME,..",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = ""
    )]
    pub trim: Option<String>,
    /// Components whose rates need not vanish at the equilibrium.
    #[arg(long, value_name = "NAME,..", requires = "trim")]
    pub moving: Option<String>,
    /// Follow the motion from the state. After each time T, print the state and the matrices Phi and Gamma; see below.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = ValueParser::new(scalar::positive))]
    pub every: Option<f64>,
    /// Number of samples of the motion, at multiples of the time --every.
    #[arg(long, value_name = "N", requires = "every", allow_hyphen_values = true, value_parser = clap::value_parser!(u32).range(1..=100_000), default_value_t = 1)]
    pub samples: u32,
    /// The sampled motion.
    #[command(flatten)]
    pub series: SeriesArgs,
    /// Write the results as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
