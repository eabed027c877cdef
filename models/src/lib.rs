//! The systems of the source papers as dalembert models. Each has a text, `rolling_disk.dal`, and a module with its source and the facts known in
//! closed form. `tests/facts` has a test of such a fact.
//!
//! The `dalembert` command runs the same texts without compiling them.

pub mod appell_hamel;
pub mod ball_on_rotating_table;
pub mod ball_on_switching_table;
pub mod bouncing_ball;
pub mod chain;
pub mod chaplygin_sleigh;
pub mod compass_walker;
pub mod constant_speed;
pub mod controlled_ball;
pub mod dimensionless_walker;
pub mod double_pendulum;
pub mod filippov_field;
pub mod harmonic_oscillator;
pub mod holonomic_bead_on_ellipses;
pub mod moving_wall_disk;
pub mod point_billiard;
pub mod refracted_particle;
pub mod rimless_wheel_five;
pub mod rimless_wheel_ten;
pub mod rolling_ball_euler;
pub mod rolling_ball_wall;
pub mod rolling_disk;
pub mod smooth_and_rough_plane;
pub mod spasmodic_hamiltonian;
pub mod sphere_in_plane;
pub mod spring_mass_walker;
pub mod super_elastic_strip;
pub mod tent_map;
pub mod two_wheels_arrested;
pub mod two_wheels_rod;
pub mod walker_foot_slip;

pub use appell_hamel::AppellHamel;
pub use ball_on_rotating_table::BallOnRotatingTable;
pub use ball_on_switching_table::BallOnSwitchingTable;
pub use bouncing_ball::BouncingBall;
pub use chain::{Chain2, Chain3, Chain4, Chain8, Chain16};
pub use chaplygin_sleigh::ChaplyginSleigh;
pub use compass_walker::CompassWalker;
pub use constant_speed::ConstantSpeed;
pub use controlled_ball::ControlledBall;
pub use dimensionless_walker::DimensionlessWalker;
pub use double_pendulum::DoublePendulum;
pub use filippov_field::FilippovField;
pub use harmonic_oscillator::HarmonicOscillator;
pub use holonomic_bead_on_ellipses::HolonomicBeadOnEllipses;
pub use moving_wall_disk::MovingWallDisk;
pub use point_billiard::PointBilliard;
pub use refracted_particle::RefractedParticle;
pub use rimless_wheel_five::RimlessWheelFive;
pub use rimless_wheel_ten::RimlessWheelTen;
pub use rolling_ball_euler::RollingBallEuler;
pub use rolling_ball_wall::RollingBallWall;
pub use rolling_disk::RollingDisk;
pub use smooth_and_rough_plane::SmoothAndRoughPlane;
pub use spasmodic_hamiltonian::SpasmodicHamiltonian;
pub use sphere_in_plane::SphereInPlane;
pub use spring_mass_walker::SpringMassWalker;
pub use super_elastic_strip::SuperElasticStrip;
pub use tent_map::TentMap;
pub use two_wheels_arrested::TwoWheelsArrested;
pub use two_wheels_rod::TwoWheelsRod;
pub use walker_foot_slip::WalkerFootSlip;
