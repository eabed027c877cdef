//! Billiards and other motion between walls.

use dalembert::law::Law;
use dalembert::{EventLog, Fault, Impacting, Instance, Outcome, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::vector;
use dalembert_stability::text::{shipped, value};

use super::{course, end};

#[test]
fn a_head_on_reflection_reverses_the_velocity() -> Result<(), Fault> {
    let table = shipped("point_billiard").model();
    let mut state = table.state_unchecked(0.0, &vector(&[1.5, 0.0]), &vector(&[2.0, 0.0]))?;
    let mut surfaces = table.description().surfaces.iter();
    let wall = surfaces.position(|surface| surface.name == "wall");
    let contact = table.contact(wall.expect("a wall"), 0.0, &state)?;
    table.kick(
        &mut state,
        contact.impulse(Law::Elastic),
        &contact.direction,
    );
    let state = state.as_ref();
    assert!((state[2] + 2.0).abs() < 1e-14 && state[3].abs() < 1e-14);
    Ok(())
}

#[test]
fn the_free_sleigh_follows_tanh_and_sech() -> Result<(), Fault> {
    let sleigh = shipped("chaplygin_sleigh").with([("m", 1.3), ("I", 0.7), ("a", 0.4)]);
    let (v0, w0) = (-1.0, 0.5);
    let free = course(&sleigh, &[0.0; 3], &[v0, 0.0, w0], 20.0).alone();
    let run = end(free.tol(1e-13));
    let qdot = sleigh.velocity(20.0, &run.state)?;
    let (theta, qdot) = (run.state.as_ref()[2], qdot.as_ref());
    let speed = qdot[0] * theta.cos() + qdot[1] * theta.sin();
    assert!((speed - 1.0837967441759566).abs() < 1e-10, "{speed}");
    assert!((qdot[2] - 5.255241495e-05).abs() < 1e-12, "{}", qdot[2]);
    Ok(())
}

#[test]
fn an_impact_turns_the_gap_rate_and_gains_what_the_edge_gives() -> Result<(), Fault> {
    let disk = shipped("moving_wall_disk").model();
    let (phi, roll, radius) = (-1.125_f64, 2.0, value(&disk, "R"));
    let qdot = [
        radius * phi.cos() * roll,
        radius * phi.sin() * roll,
        roll,
        1.0,
    ];
    let mut log = EventLog::<_, 8>::new();
    course(&disk, &[-0.375, -0.1875, 0.0, phi], &qdot, 8.0)
        .tol(1e-13)
        .observed(Integrator::Taylor, &mut log);
    assert_eq!(log.iter().count(), 8);
    for event in log.iter() {
        let (t, surface) = (event.t, event.surface);
        let gap_rate =
            |state| -> Result<f64, Fault> { Ok(disk.gap_rates(t, state)?.as_ref()[surface]) };
        let (before, after) = (gap_rate(&event.before)?, gap_rate(&event.after)?);
        assert!((after + before).abs() < 1e-12 * before.abs());
        // An impulse `P dh` adds the energy `P (dh(qdot-) + dh(qdot+))/2` and changes the gap rate by `P` times a
        // positive number. An elastic impulse adds `-P d_t h`, since `dh(qdot)` is the gap rate minus `d_t h`. At rest
        // the gap rate is `d_t h`.
        let q = disk.position(&event.after);
        let still = disk.state(t, &q, &vector(&[0.0; 4])).expect("a state");
        let gain = disk.energy(t, &event.after)? - disk.energy(t, &event.before)?;
        assert!(gain * -gap_rate(&still)? > 0.0);
    }
    Ok(())
}

#[test]
fn wheels_do_not_slip_across_impacts() {
    let wheels = shipped("two_wheels_rod").model();
    let (q, qdot) = ([0.0, 2.0, 0.0, 0.0], [0.5, -0.25, 1.0, -0.25]);
    let run = end(course(&wheels, &q, &qdot, 50.0));
    assert!(run.counters.impacts > 10);
    let [r1, r2] = ["r1", "r2"].map(|name| value(&wheels, name));
    let state = run.state.as_ref();
    assert!((state[0] - r1 * state[2]).abs() < 1e-12);
    assert!((state[1] - 2.0 - r2 * state[3]).abs() < 1e-12);
}

#[test]
fn both_wheels_roll_on_at_one_speed() -> Result<(), Fault> {
    let wheels = shipped("two_wheels_arrested").large([]);
    let (q, qdot) = ([0.0, 2.0, 0.0, 0.0], [0.5, -0.25, 1.0, -0.25]);
    let run = end(course(&wheels, &q, &qdot, 50.0));
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let qdot = wheels.velocity(50.0, &run.state)?;
    assert!((qdot.as_ref()[0] - qdot.as_ref()[1]).abs() < 1e-15);
    let [r1, r2, shortest] = ["r1", "r2", "a"].map(|name| value(&wheels, name));
    let state = run.state.as_ref();
    let length = (state[1] - state[0]).hypot(r2 - r1);
    assert!((length - shortest).abs() < 1e-13);
    Ok(())
}

#[test]
fn impacts_come_in_a_geometric_series() {
    let strip = shipped("super_elastic_strip").model();
    let mut log = EventLog::<_, 17>::new();
    let run = course(&strip, &[0.0, 0.0], &[1.0, 1.0], 4.9).observed(Integrator::Taylor, &mut log);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 17));
    let (al, mut t) = (value(&strip, "al"), 0.0);
    for (n, event) in log.iter().enumerate() {
        t += al.powi(-(n as i32));
        assert!((event.t - t).abs() < 1e-13 * t, "{n}: {} for {t}", event.t);
    }
}

#[test]
fn impacts_come_as_the_motion_escapes() {
    let system = shipped("spasmodic_hamiltonian").model();
    let mut log = EventLog::<_, 8>::new();
    let run = course(&system, &[0.0, 0.5, 1.0, 1.0], &[0.0; 4], 1.57)
        .tol(1e-14)
        .observed(Integrator::Taylor, &mut log);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 7));
    for (n, event) in log.iter().enumerate() {
        let t = (-(n as f64 + 0.5)).exp().acos();
        assert!((event.t - t).abs() < 1e-12, "{n}: {} for {t}", event.t);
    }
}
