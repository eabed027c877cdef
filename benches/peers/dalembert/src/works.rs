//! The workloads that consist of one run each. `benches/peers/README.md` defines them.

use dalembert::{Scene, System, VectorField};

use crate::Plan;
use crate::course::Course;
use crate::models::{Ball, Disk, Pendulum, Sleigh, sleigh};

/// The start of the disk with this angular velocity of rolling.
pub fn rolling(disk: &Disk, roll: f64) -> <Disk as VectorField>::State {
    let phi = core::f64::consts::FRAC_PI_2;
    let (sin, cos) = phi.sin_cos();
    let qdot = [disk.R * cos * roll, disk.R * sin * roll, roll, 0.2];
    disk.state(0.0, &[0.0, 0.0, 0.0, phi].into(), &qdot.into())
        .expect("an admissible state")
}

/// Measures W1 and W1r: the generator finds the reduction to the velocities of rolling and turning.
pub fn disk_billiard(plan: &Plan) {
    let disk = Disk::default();
    Course {
        work: "W1",
        system: &disk,
        effects: disk.effects(),
        start: rolling(&disk, 10.0),
        until: 200.0,
        probes: &[],
    }
    .measure(plan);
}

/// Measures W2.
pub fn sleigh(plan: &Plan) {
    let sleigh = sleigh::Free(Sleigh::default());
    let start = sleigh.state(0.0, &[0.0; 3].into(), &[-1.0, 0.0, 0.2].into());
    Course {
        work: "W2",
        system: &sleigh,
        effects: sleigh.effects(),
        start: start.expect("an admissible state"),
        until: 1000.0,
        probes: &[1.0, 10.0, 100.0],
    }
    .measure(plan);
}

/// Measures W2b.
pub fn sleigh_billiard(plan: &Plan) {
    let sleigh = Sleigh::default();
    let theta = 0.3_f64;
    let qdot = [theta.cos(), theta.sin(), 1.0];
    let start = sleigh.state(0.0, &[0.0, 0.0, theta].into(), &qdot.into());
    Course {
        work: "W2b",
        system: &sleigh,
        effects: sleigh.effects(),
        start: start.expect("an admissible state"),
        until: 200.0,
        probes: &[],
    }
    .measure(plan);
}

/// Measures W3.
pub fn double_pendulum(plan: &Plan) {
    let pendulum = Pendulum::default();
    let start = pendulum.state(0.0, &[2.0, 2.5].into(), &[0.0, 0.0].into());
    Course {
        work: "W3",
        system: &pendulum,
        effects: (),
        start: start.expect("an admissible state"),
        until: 100.0,
        probes: &[1.0, 10.0, 20.0],
    }
    .measure(plan);
}

/// Measures W4.
pub fn bouncing_ball(plan: &Plan) {
    let ball = Ball::default();
    let start = ball.state(0.0, &[1.0].into(), &[0.0].into());
    Course {
        work: "W4",
        system: &ball,
        effects: ball.effects(),
        start: start.expect("an admissible state"),
        until: 20.0,
        probes: &[],
    }
    .measure(plan);
}
