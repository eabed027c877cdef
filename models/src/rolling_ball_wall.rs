//! A homogeneous ball that rolls on a table and does not slip on a wall in the moment it hits it.
//!
//! Facts: in the moment of an impact the velocity along the wall becomes what rolling on table and wall together leaves of
//! it, `ydot+ = ((r^2 + k^2) ydot - k^2 r omega_z)/(r^2 + 2 k^2)`; at an elastic impact the velocity towards the wall is turned
//! round, at a plastic one the ball goes on along the wall. Source: J. Cortes and A. Vinogradov, section 6.2. The point
//! that touches the wall is `r` ahead of the centre, so that it rests where `ydot + r omega_z = 0`; the source has a minus.

dalembert::model_file!("src/rolling_ball_wall.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn the_ball_leaves_the_wall_rolling_along_it() {
        let ball = RollingBallWall::default();
        let q = [0.0, 0.0, 0.2, 1.1, -0.4].into();
        let qdot = [1.0, 0.4, -0.5, 0.8, 0.3].into();
        let state = ball.state_projected(0.0, &q, &qdot).unwrap();
        let before = ball.velocity(0.0, &state).unwrap();
        assert!(before[0] > 0.1, "it moves towards the wall");
        let spin = before[2] * q[3].cos() + before[4];
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let until = 1.5 * (ball.distance - ball.r) / before[0];
        let run = Simulation::new(&ball, stepper, ball.effects())
            .run(0.0, state, until, &mut ())
            .unwrap();
        assert_eq!(run.counters.impacts, 1);
        let after = ball.velocity(until, &run.state).unwrap();
        let (r, k2) = (ball.r, ball.k * ball.k);
        let along = ((r * r + k2) * before[1] - k2 * r * spin) / (r * r + 2.0 * k2);
        assert!((after[0] + before[0]).abs() < 1e-12);
        assert!((after[1] - along).abs() < 1e-12);
        let theta = run.state[3];
        assert!((after[2] * theta.cos() + after[4] + along / r).abs() < 1e-11);
    }
}
