//! A ball on a plane that is smooth to the left of `x = 0` and rough to the right: constraints that begin at a line.
//!
//! Facts: on the smooth side the ball slides and spins freely; where it comes onto the rough side it is focused on the rolling
//! constraint, and loses energy; where that turns it back it goes on on the smooth side. Source: J. Cortes and A. Vinogradov,
//! section 6.1.

dalembert::model_file!("src/smooth_and_rough_plane.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

    /// A ball that rolls when it comes to the rough side keeps rolling: nothing is lost.
    #[test]
    fn a_ball_that_rolls_already_is_not_disturbed() {
        let ball = SmoothAndRoughPlane::default();
        let q = [-1.0, 0.0, 0.2, 1.1, -0.4].into();
        let rolling = smooth_and_rough_plane::Rough(ball);
        let nearest = rolling
            .state_projected(0.0, &q, &[1.0, 0.3, 0.1, 0.2, 0.3].into())
            .unwrap();
        let qdot = rolling.velocity(0.0, &nearest).unwrap();
        let state = ball.state(0.0, &q, &qdot).unwrap();
        let energy = ball.energy(0.0, &state).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&ball, stepper, ball.effects())
            .run(0.0, state, 2.0, &mut ())
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
        assert_eq!(
            ball.mode(&run.state),
            smooth_and_rough_plane::Mode::Rough as usize
        );
        assert!((ball.energy(2.0, &run.state).unwrap() - energy).abs() < 1e-11);
    }
}
