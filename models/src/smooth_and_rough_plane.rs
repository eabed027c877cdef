//! A ball on a plane that is smooth to the left of `x = 0` and rough to the right: constraints that begin at a line.
//!
//! Facts: on the smooth side the ball slides and spins freely; where it comes onto the rough side it is focused on the rolling
//! constraint, and loses energy; where that turns it back it goes on on the smooth side. Source: J. Cortes and A. Vinogradov,
//! section 6.1.

dalembert::model! {
    /// Ball on a smooth and a rough half-plane (J. Cortes and A. Vinogradov, section 6.1).
    pub SmoothAndRoughPlane {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters {
            /// Radius of the ball.
            r > 0 = 1;
            /// Radius of gyration.
            k > 0 = 2/3;
        }
        let omega_x = cos(psi)*dot(theta) + sin(psi)*sin(theta)*dot(phi);
        let omega_y = sin(psi)*dot(theta) - cos(psi)*sin(theta)*dot(phi);
        let omega_z = cos(theta)*dot(phi) + dot(psi);
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2) + k^2/2*(dot(phi)^2 + dot(psi)^2 + 2*cos(theta)*dot(phi)*dot(psi) + dot(theta)^2);
        modes {
            /// x < 0: the ball slides.
            smooth {
                initial { x = -1; theta = 1.2; dot(x) = 1; dot(y) = 0.5; dot(theta) = 0.4; dot(phi) = 0.3; until = 4; }
            }
            /// x > 0: it rolls.
            rough {
                constraints {
                    rolling_x: dot(x) - r*omega_y = 0;
                    rolling_y: dot(y) + r*omega_x = 0;
                }
                frame {
                    wx: sin(psi)*sin(theta)*d(phi) + cos(psi)*d(theta);
                    wy: -cos(psi)*sin(theta)*d(phi) + sin(psi)*d(theta);
                    wz: cos(theta)*d(phi) + d(psi);
                }
            }
        }
        transitions {
            enter: smooth -> rough when x >= 0;
            leave: rough -> smooth when x <= 0;
        }
        view { path: (x, y); }
        outputs { spin_x: omega_x; spin_y: omega_y; spin_z: omega_z; }
        claims { conserved: energy; conserved: omega_z; }
    }
}

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
