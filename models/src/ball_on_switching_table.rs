//! A ball that rolls on a turning table whose angular velocity changes each time the ball comes to the line `x = y`.
//!
//! Facts: between two changes the centre runs on a circle; at a change the ball is focused on the new affine constraints,
//! which act on both sides of the line, so that it may be thrown back. Source: J. Cortes and A. Vinogradov, section 6.3, with the
//! reading the section ends with.

dalembert::model_file!("src/ball_on_switching_table.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, EventLog, Outcome, Scene, Simulation, System, Tolerance};

    #[test]
    fn the_table_changes_its_speed_each_time() {
        let ball = BallOnSwitchingTable::default();
        // With psi = 0 the rates of the Euler angles are read off the angular velocities.
        let (theta, speed) = (1.5_f64, [1.0, -0.5]);
        let spin = [0.5 * 0.5 - speed[1], speed[0] + 0.5 * 1.5];
        let qdot = [speed[0], speed[1], -spin[1] / theta.sin(), spin[0], 0.3];
        let q = [0.5, 1.5, 0.0, theta, 0.0].into();
        let state = ball.state(0.0, &q, &qdot.into()).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let mut log = EventLog::<_, 16>::new();
        let run = Simulation::new(&ball, stepper, ball.effects())
            .run(0.0, state, 60.0, &mut log)
            .unwrap();
        assert_eq!(run.outcome, Outcome::Done);
        assert_eq!(log.iter().count(), 6);
        for (n, event) in log.iter().enumerate() {
            assert_eq!(
                [&event.before, &event.after].map(|own| ball.mode(own)),
                [n % 2, 1 - n % 2]
            );
        }
    }
}
