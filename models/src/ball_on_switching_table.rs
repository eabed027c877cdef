//! A ball that rolls on a turning table whose angular velocity changes each time the ball comes to the line `x = y`.
//!
//! Facts: between two changes the centre runs on a circle; at a change the ball is focused on the new affine constraints,
//! which act on both sides of the line, so that it may be thrown back. Source: J. Cortes and A. Vinogradov, section 6.3, with the
//! reading the section ends with.

dalembert::model! {
    /// Ball on a table that changes its speed where the ball crosses `x = y` (J. Cortes and A. Vinogradov, section 6.3).
    pub BallOnSwitchingTable {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters {
            /// Radius of the ball.
            r > 0 = 1;
            /// Radius of gyration.
            k > 0 = 2/3;
            /// The lower angular velocity of the table.
            Om_minus = 1/2;
            /// The higher angular velocity of the table.
            Om_plus = 2;
        }
        let omega_x = cos(psi)*dot(theta) + sin(psi)*sin(theta)*dot(phi);
        let omega_y = sin(psi)*dot(theta) - cos(psi)*sin(theta)*dot(phi);
        let omega_z = cos(theta)*dot(phi) + dot(psi);
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2) + k^2/2*(dot(phi)^2 + dot(psi)^2 + 2*cos(theta)*dot(phi)*dot(psi) + dot(theta)^2);
        frame {
            wx: sin(psi)*sin(theta)*d(phi) + cos(psi)*d(theta);
            wy: -cos(psi)*sin(theta)*d(phi) + sin(psi)*d(theta);
            wz: cos(theta)*d(phi) + d(psi);
        }
        modes {
            slow {
                constraints {
                    rolling_x: dot(x) - r*omega_y = -Om_minus*y;
                    rolling_y: dot(y) + r*omega_x = Om_minus*x;
                }
                initial { x = -1; y = 0.5; theta = 1.5; dot(psi) = 0.3; dot(phi) = 0.1; until = 12; }
            }
            fast {
                constraints {
                    rolling_x: dot(x) - r*omega_y = -Om_plus*y;
                    rolling_y: dot(y) + r*omega_x = Om_plus*x;
                }
            }
        }
        transitions {
            faster_from_left: slow -> fast when x >= y;
            faster_from_right: slow -> fast when x <= y;
            slower_from_left: fast -> slow when x >= y;
            slower_from_right: fast -> slow when x <= y;
        }
        view { path: (x, y); }
        outputs { spin_x: omega_x; spin_y: omega_y; spin_z: omega_z; }
        claims { conserved: omega_z; not conserved: energy; }
    }
}

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
