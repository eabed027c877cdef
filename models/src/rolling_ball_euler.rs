//! A homogeneous ball that rolls on an elliptical table, orientation by Euler angles (z-x-z).
//!
//! Facts: the centre moves on straight lines, the angular velocity is constant between impacts. The chart ends
//! where `sin(theta) = 0`. Source: W. Clark and A. Bloch, section 8; J. Cortes and A. Vinogradov, section 6.

dalembert::model_file!("src/rolling_ball_euler.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_centre_moves_on_a_straight_line() {
        let ball = RollingBallEuler::default();
        let q = [0.0, 0.0, 0.2, 1.1, -0.4].into();
        let state = ball
            .state_projected(0.0, &q, &[0.0, 0.0, 0.3, -0.2, 0.5].into())
            .unwrap();
        let before = ball.velocity(0.0, &state).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&ball, stepper, ())
            .run(0.0, state, 2.0, &mut ())
            .unwrap();
        assert!((run.state[0] - 2.0 * before[0]).abs() < 1e-11);
        assert!((run.state[1] - 2.0 * before[1]).abs() < 1e-11);
    }
}
