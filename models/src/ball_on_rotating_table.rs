//! A homogeneous ball that rolls on a turning table: affine constraints.
//!
//! Facts: the centre runs on circles at the rate `Om k^2/(r^2 + k^2)`, 2/7 of the table's for a solid ball; the
//! energy is not constant. Source: J. Cortes and A. Vinogradov, section 6.3.

dalembert::model_file!("src/ball_on_rotating_table.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_centre_of_the_circle_stands_still() {
        let ball = BallOnRotatingTable::default();
        let q = [1.0, 0.5, 0.2, 1.1, -0.4].into();
        let state = ball
            .state_projected(0.0, &q, &[0.0, 0.0, 0.1, 0.05, 0.1].into())
            .unwrap();
        let rate = ball.Om * ball.k.powi(2) / (ball.r.powi(2) + ball.k.powi(2));
        let centre = |t: f64, state: &_| {
            let qdot = ball.velocity(t, state).unwrap();
            let q = ball.position(state);
            [q[0] - qdot[1] / rate, q[1] + qdot[0] / rate]
        };
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&ball, stepper, ())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        let (before, after) = (centre(0.0, &state), centre(3.0, &run.state));
        assert!((before[0] - after[0]).abs() < 1e-10 && (before[1] - after[1]).abs() < 1e-10);
    }
}
