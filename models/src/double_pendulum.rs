//! A planar double pendulum: two point masses on two rods, absolute angles from the downward vertical.
//!
//! Facts: the energy is constant; small oscillations of equal masses on equal rods have the frequencies
//! `sqrt((2 -+ sqrt 2) g/l)`.

dalembert::model! {
    /// A planar double pendulum; absolute angles from the downward vertical.
    pub DoublePendulum {
        coordinates { theta1: angle; theta2: angle; }
        parameters {
            /// Mass of the upper bob.
            m1 > 0 = 1;
            /// Mass of the lower bob.
            m2 > 0 = 1;
            /// Length of the upper rod.
            l1 > 0 = 1;
            /// Length of the lower rod.
            l2 > 0 = 1;
            /// Acceleration of gravity.
            g = 9.81;
        }
        let x1 = l1*sin(theta1);
        let y1 = -l1*cos(theta1);
        let x2 = x1 + l2*sin(theta2);
        let y2 = y1 - l2*cos(theta2);
        lagrangian = m1/2*(dot(x1)^2 + dot(y1)^2) + m2/2*(dot(x2)^2 + dot(y2)^2) - m1*g*y1 - m2*g*y2;
        initial { theta1 = 2; theta2 = 5/2; until = 20; }
        view { path: (x2, y2); }
        claims {
            conserved: energy;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{System, VectorField};

    /// The upright plane pendulum's textbook equations at a state worked by hand: both rods horizontal.
    #[test]
    fn horizontal_rods_at_rest_fall_as_a_beam_on_a_pivot() {
        let pendulum = DoublePendulum::default();
        let quarter = core::f64::consts::FRAC_PI_2;
        let state = pendulum
            .state(0.0, &[quarter, quarter].into(), &[0.0, 0.0].into())
            .unwrap();
        let mut rate = state;
        pendulum.rate(0.0, &state, &mut rate).unwrap();
        // pdot = dL/dq: the torques -(m1 + m2) g l1 and -m2 g l2.
        assert!((rate[2] + 2.0 * 9.81).abs() < 1e-14);
        assert!((rate[3] + 9.81).abs() < 1e-14);
    }
}
