//! Motion without impacts: chains, oscillators, beads, and constraints that are not linear in the velocities.

use core::f64::consts::FRAC_PI_2;

use dalembert::{Constrained, Fault, Instance, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::state;
use dalembert_stability::text::{Model, shipped, value};

use super::{course, end};

/// The rate of the state with these positions and velocities.
fn rate(model: &Model, q: &[f64], qdot: &[f64]) -> Result<<Model as VectorField>::State, Fault> {
    let state = state(model, q, qdot);
    let mut rate = state;
    model.rate(0.0, &state, &mut rate)?;
    Ok(rate)
}

#[test]
fn follows_the_cosine() {
    let oscillator = shipped("harmonic_oscillator").with([("m", 2.0), ("k", 8.0)]);
    let run = end(course(&oscillator, &[1.0], &[0.0], 10.0).alone());
    assert!((run.state.as_ref()[0] - 20.0_f64.cos()).abs() < 1e-10);
}

/// The textbook equations of the double pendulum, evaluated by hand for two horizontal rods.
#[test]
fn horizontal_rods_at_rest_feel_the_torques_of_gravity() -> Result<(), Fault> {
    let pendulum = shipped("double_pendulum").model();
    let rate = rate(&pendulum, &[FRAC_PI_2, FRAC_PI_2], &[0.0, 0.0])?;
    let rate = rate.as_ref();
    // pdot = dL/dq consists of the torques -(m1 + m2) g l1 and -m2 g l2.
    assert!((rate[2] + 2.0 * 9.81).abs() < 1e-14);
    assert!((rate[3] + 9.81).abs() < 1e-14);
    Ok(())
}

#[test]
fn two_links_are_the_double_pendulum() -> Result<(), Fault> {
    let [chain, pendulum] = ["chain2", "double_pendulum"].map(|name| shipped(name).model());
    let (q, qdot) = ([0.3, -1.1], [0.7, 0.2]);
    let (of_chain, expected) = (rate(&chain, &q, &qdot)?, rate(&pendulum, &q, &qdot)?);
    assert_eq!(of_chain.as_ref().len(), 4);
    for (actual, expected) in of_chain.as_ref().iter().zip(expected.as_ref()) {
        assert!((actual - expected).abs() < 1e-13);
    }
    Ok(())
}

#[test]
fn the_bead_stays_on_its_ellipse_at_constant_speed() -> Result<(), Fault> {
    let bead = shipped("holonomic_bead_on_ellipses").model();
    let run = end(course(&bead, &[0.0, 1.0], &[1.0, 0.0], 100.0).tol(1e-10));
    let level = bead.levels(100.0, &bead.position(&run.state)).as_ref()[0];
    assert!((level - 1.0).abs() < 1e-14, "{level}");
    assert!((bead.energy(100.0, &run.state)? - 0.5).abs() < 1e-8);
    Ok(())
}

#[test]
fn it_falls_along_a_straight_line_with_constant_acceleration() {
    let machine = shipped("appell_hamel").model();
    let run = end(course(&machine, &[0.0; 3], &[0.6, -0.8, -0.5], 4.0).tol(1e-13));
    let [g, k] = ["g", "k"].map(|name| value(&machine, name));
    let way = 4.0 + 0.5 * g * k / (k * k + 1.0) * 16.0;
    let expected = [0.6 * way, -0.8 * way, -0.5 * way];
    for (actual, expected) in run.state.as_ref().iter().zip(expected) {
        assert!((actual - expected).abs() < 1e-11);
    }
}

#[test]
fn the_direction_falls_as_a_hyperbolic_tangent() {
    let particle = shipped("constant_speed").model();
    let start = particle.initial();
    let qdot = particle
        .complete_velocity(0.0, &start.q, &start.qdot, &start.named)
        .expect("velocities");
    let velocity = qdot.as_ref();
    assert!(
        (velocity[1] - 1.6).abs() < 1e-15,
        "the velocity of `y`, which `initial` does not name"
    );
    let run = course(&particle, start.q.as_ref(), velocity, 3.0)
        .tol(1e-13)
        .observed(Integrator::Taylor, &mut ());
    let [g, v] = ["g", "v"].map(|name| value(&particle, name));
    let (from, to) = ((-0.8_f64).atanh(), (-0.8_f64).atanh() + 3.0 * g / v);
    let height = -v * v / g * (to.cosh() / from.cosh()).ln();
    let along = v * v / g * (to.sinh().atan() - from.sinh().atan());
    assert!((run.state.as_ref()[0] - along).abs() < 1e-11);
    assert!((run.state.as_ref()[1] - height).abs() < 1e-11);
}

#[test]
fn falls_with_the_acceleration_of_gravity() -> Result<(), Fault> {
    let ball = shipped("bouncing_ball").with([("m", 2.0), ("g", 9.81)]);
    assert_eq!(rate(&ball, &[1.0], &[0.5])?.as_ref(), [0.5, -2.0 * 9.81]);
    Ok(())
}
