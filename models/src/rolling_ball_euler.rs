//! A homogeneous ball that rolls on an elliptical table, orientation by Euler angles (z-x-z).
//!
//! Facts: the centre moves on straight lines, the angular velocity is constant between impacts. The chart ends
//! where `sin(theta) = 0`. Source: W. Clark and A. Bloch, section 8; J. Cortes and A. Vinogradov, section 6.

dalembert::model! {
    /// Homogeneous ball rolling without slipping; its centre is what meets the rim of the table.
    pub RollingBallEuler {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters {
            /// Radius of the ball.
            r > 0 = 1;
            /// Radius of gyration.
            k > 0 = 2/3;
            /// Half axis of the table along x.
            ta > 0 = 3;
            /// Half axis of the table along y.
            tb > 0 = 2;
        }
        let omega_x = cos(psi)*dot(theta) + sin(psi)*sin(theta)*dot(phi);
        let omega_y = sin(psi)*dot(theta) - cos(psi)*sin(theta)*dot(phi);
        let spin = dot(phi)^2 + dot(psi)^2 + 2*cos(theta)*dot(phi)*dot(psi) + dot(theta)^2;
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2) + k^2/2*spin;
        constraints {
            rolling_x: dot(x) - r*omega_y = 0;
            rolling_y: dot(y) + r*omega_x = 0;
        }
        frame {
            wx: sin(psi)*sin(theta)*d(phi) + cos(psi)*d(theta);
            wy: -cos(psi)*sin(theta)*d(phi) + sin(psi)*d(theta);
            wz: cos(theta)*d(phi) + d(psi);
        }
        impacts { table_edge: 1 - x^2/ta^2 - y^2/tb^2 >= 0; }
        initial { theta = 1; dot(phi) = 1; dot(theta) = 0.5; until = 20; }
        view { path: (x, y); region: 1 - x^2/ta^2 - y^2/tb^2 >= 0; }
        outputs { omega_z: dot(phi)*cos(theta) + dot(psi); }
        claims {
            density: exact;
            conserved: energy;
            conserved: dot(x);
            conserved: dot(phi)*cos(theta) + dot(psi);
            conserved under table_edge: dot(phi)*cos(theta) + dot(psi);
        }
    }
}

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
