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
    /// Prove where the motion is, in place of a run by an integrator: print ranges that contain the time of every impact, and all
    /// positions and velocities at the end, whatever rounding and truncation do. Numbers of the start and of parameters are the doubles
    /// nearest to what is written. Where a range is as wide as to leave open what happens next, the motion is certified up to that
    /// time, and the exit status is 1. Motion along a surface that holds it is not certified; intervals of coordinates are not looked at.
    #[arg(
        long,
        conflicts_with_all = [
            "csv", "plot", "axes", "verify", "samples", "integrator", "step", "max_step", "tol", "steps", "rest", "penetration",
            "corner", "split", "projection"
        ]
    )]
    pub certify: bool,
    /// Certify all motions that begin with any value of this range: of a coordinate, of a velocity `x_dot` (with constraints of a
    /// quasi-velocity), or of a parameter; may be repeated. Ends that are no doubles are moved outward. What the constraints choose of a
    /// start they choose at the middles of the ranges.
    #[arg(
        long,
        value_name = "NAME=LO..HI",
        requires = "certify",
        allow_hyphen_values = true
    )]
    pub certify_within: Vec<String>,
}
