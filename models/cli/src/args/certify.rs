//! The flags of certified motion.

use clap::Args;

/// Examples of the help of `simulate`.
pub const EXAMPLES: &str = "
  dalembert simulate point_billiard --set ta=1 --certify --impacts 10
  dalembert simulate double_pendulum --certify --until 2 --json -
  dalembert simulate bouncing_ball --certify --until 2 --certify-within x=0.99..1.01 --certify-within g=0.99..1.01";

/// Certified motion in place of a run.
#[derive(Debug, Args)]
pub struct CertifyArgs {
    /// Enclose the motion by interval arithmetic, in place of a run by an integrator. Prints ranges that contain the
    /// time of every impact and all positions and velocities at the end, rounding and truncation included. Initial
    /// values and parameters are the doubles nearest to the given decimals. If a range becomes too wide to decide the
    /// next event, the motion is certified up to that time and the exit status is 1. Sliding and resting contact are
    /// not certified, and intervals of coordinates are not checked.
    #[arg(
        long,
        conflicts_with_all = [
            "csv", "plot", "axes", "verify", "samples", "integrator", "step", "max_step", "tol", "steps", "rest", "penetration",
            "corner", "split", "projection"
        ]
    )]
    pub certify: bool,
    /// Certify all motions for which a coordinate, a velocity `x_dot` (with constraints, a quasi-velocity) or a
    /// parameter starts in this range. May be repeated. Ends that are not doubles are rounded outward. Declared
    /// values that depend on such a parameter move with it; with constraints they are refused, as is a start that
    /// satisfies the constraints for one value of the parameter only. Values that follow from the constraints are computed
    /// at the middle of other ranges.
    #[arg(
        long,
        value_name = "NAME=LO..HI",
        requires = "certify",
        allow_hyphen_values = true
    )]
    pub certify_within: Vec<String>,
}
