//! Rolling disks and balls: on a plane, on a partly smooth plane, on a rotating table, and against a wall.

use core::f64::consts::FRAC_PI_2;

use dalembert::{EventLog, Fault, Outcome, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, vector};
use dalembert_stability::text::{mode, shipped, value};

use super::{course, end, mode_number};

#[test]
fn the_contact_point_runs_on_a_circle() {
    let disk = shipped("rolling_disk").model();
    let (roll, turn, size) = (10.0, 2.0, value(&disk, "R"));
    let (q, qdot) = ([0.0, 0.0, 0.0, FRAC_PI_2], [0.0, size * roll, roll, turn]);
    let run = end(course(&disk, &q, &qdot, 3.0).alone().tol(1e-13));
    let (radius, phi) = (size * roll / turn, FRAC_PI_2 + 3.0 * turn);
    let state = run.state.as_ref();
    assert!((state[0] - radius * (phi.sin() - FRAC_PI_2.sin())).abs() < 1e-12);
    assert!((state[1] + radius * (phi.cos() - FRAC_PI_2.cos())).abs() < 1e-12);
}

#[test]
fn the_centre_moves_on_a_straight_line() -> Result<(), Fault> {
    let ball = shipped("rolling_ball_euler").large([]);
    let (q, qdot) = ([0.0, 0.0, 0.2, 1.1, -0.4], [0.0, 0.0, 0.3, -0.2, 0.5]);
    let course = Course::new(&ball, &q, &qdot, 2.0).alone().tol(1e-13);
    let before = ball.velocity(0.0, course.start())?;
    let run = end(course);
    for (place, speed) in run.state.as_ref().iter().zip(before.as_ref()).take(2) {
        assert!((place - 2.0 * speed).abs() < 1e-11);
    }
    Ok(())
}

#[test]
fn the_ball_leaves_the_wall_rolling_along_it() -> Result<(), Fault> {
    let ball = shipped("rolling_ball_wall").large([]);
    let (q, qdot) = ([0.0, 0.0, 0.2, 1.1, -0.4], [1.0, 0.4, -0.5, 0.8, 0.3]);
    let start = ball.state_projected(0.0, &vector(&q), &vector(&qdot));
    let start = start.expect("an admissible start");
    let before = ball.velocity(0.0, &start)?;
    let before = before.as_ref();
    assert!(before[0] > 0.1, "it moves towards the wall");
    let spin = before[2] * q[3].cos() + before[4];
    let [r, k, distance] = ["r", "k", "distance"].map(|name| value(&ball, name));
    let until = 1.5 * (distance - r) / before[0];
    let run = end(Course::from_state(&ball, start, until).tol(1e-13));
    assert_eq!(run.counters.impacts, 1);
    let after = ball.velocity(until, &run.state)?;
    let (after, k2) = (after.as_ref(), k * k);
    let along = ((r * r + k2) * before[1] - k2 * r * spin) / (r * r + 2.0 * k2);
    assert!((after[0] + before[0]).abs() < 1e-12);
    assert!((after[1] - along).abs() < 1e-12);
    let theta = run.state.as_ref()[3];
    assert!((after[2] * theta.cos() + after[4] + along / r).abs() < 1e-11);
    Ok(())
}

#[test]
fn the_centre_of_the_circle_stands_still() -> Result<(), Fault> {
    let ball = shipped("ball_on_rotating_table").large([]);
    let (q, qdot) = ([1.0, 0.5, 0.2, 1.1, -0.4], [0.0, 0.0, 0.1, 0.05, 0.1]);
    let [table, r, k] = ["Om", "r", "k"].map(|name| value(&ball, name));
    let rate = table * k.powi(2) / (r.powi(2) + k.powi(2));
    let centre = |t: f64, state: &_| -> Result<[f64; 2], Fault> {
        let (q, qdot) = (ball.position(state), ball.velocity(t, state)?);
        let (q, qdot) = (q.as_ref(), qdot.as_ref());
        Ok([q[0] - qdot[1] / rate, q[1] + qdot[0] / rate])
    };
    let course = Course::new(&ball, &q, &qdot, 3.0).alone().tol(1e-13);
    let before = centre(0.0, course.start())?;
    let after = centre(3.0, &end(course).state)?;
    assert!((before[0] - after[0]).abs() < 1e-10 && (before[1] - after[1]).abs() < 1e-10);
    Ok(())
}

#[test]
fn the_table_changes_its_speed_each_time() {
    let ball = shipped("ball_on_switching_table").large([]);
    // With psi = 0 the rates of the Euler angles follow directly from the angular velocities.
    let (theta, speed) = (1.5_f64, [1.0, -0.5]);
    let spin = [0.5 * 0.5 - speed[1], speed[0] + 0.5 * 1.5];
    let qdot = [speed[0], speed[1], -spin[1] / theta.sin(), spin[0], 0.3];
    let mut log = EventLog::<_, 16>::new();
    let run = course(&ball, &[0.5, 1.5, 0.0, theta, 0.0], &qdot, 60.0)
        .observed(Integrator::Dop853, &mut log);
    assert_eq!(run.outcome, Outcome::Done);
    assert_eq!(log.iter().count(), 6);
    for (n, event) in log.iter().enumerate() {
        assert_eq!(
            [&event.before, &event.after].map(|state| ball.mode(state)),
            [n % 2, 1 - n % 2]
        );
    }
}

/// A ball that already rolls when it reaches the rough side keeps rolling without loss.
#[test]
fn a_ball_that_rolls_already_is_not_disturbed() -> Result<(), Fault> {
    let ball = shipped("smooth_and_rough_plane").large([]);
    let (q, near) = ([-1.0, 0.0, 0.2, 1.1, -0.4], [1.0, 0.3, 0.1, 0.2, 0.3]);
    let rough = mode_number(&ball, "rough");
    let rolling = mode(&ball, rough);
    let nearest = rolling.state_projected(0.0, &vector(&q), &vector(&near));
    let qdot = rolling.velocity(0.0, &nearest.expect("an admissible start"))?;
    let course = course(&ball, &q, qdot.as_ref(), 2.0);
    let energy = ball.energy(0.0, course.start())?;
    let run = end(course);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    assert_eq!(ball.mode(&run.state), rough);
    assert!((ball.energy(2.0, &run.state)? - energy).abs() < 1e-11);
    Ok(())
}
