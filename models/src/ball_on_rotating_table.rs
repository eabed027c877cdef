//! A homogeneous ball that rolls on a turning table: affine constraints.
//!
//! Facts: the centre runs on circles at the rate `Om k^2/(r^2 + k^2)`, 2/7 of the table's for a solid ball; the
//! energy is not constant. Source: J. Cortes and A. Vinogradov, section 6.3.

dalembert::model! {
    /// Homogeneous ball rolling on a table that turns at the rate `Om`.
    pub BallOnRotatingTable {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters {
            /// Radius of the ball.
            r > 0 = 1;
            /// Radius of gyration.
            k > 0 = 2/3;
            /// Angular velocity of the table.
            Om = 1/2;
        }
        let omega_x = cos(psi)*dot(theta) + sin(psi)*sin(theta)*dot(phi);
        let omega_y = sin(psi)*dot(theta) - cos(psi)*sin(theta)*dot(phi);
        let spin = dot(phi)^2 + dot(psi)^2 + 2*cos(theta)*dot(phi)*dot(psi) + dot(theta)^2;
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2) + k^2/2*spin;
        constraints {
            rolling_x: dot(x) - r*omega_y = -Om*y;
            rolling_y: dot(y) + r*omega_x = Om*x;
        }
        frame {
            wx: sin(psi)*sin(theta)*d(phi) + cos(psi)*d(theta);
            wy: -cos(psi)*sin(theta)*d(phi) + sin(psi)*d(theta);
            wz: cos(theta)*d(phi) + d(psi);
        }
        initial { x = 1; theta = 1.2; dot(theta) = 0.1; dot(psi) = 0.1; until = 30; }
        view { path: (x, y); }
        outputs { omega_z: dot(phi)*cos(theta) + dot(psi); }
        claims {
            density: exact;
            conserved: dot(phi)*cos(theta) + dot(psi);
            not conserved: energy;
        }
    }
}

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
