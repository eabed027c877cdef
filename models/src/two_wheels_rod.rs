//! Two wheels on parallel axles, joined by a rod that slides between two stops.
//!
//! Facts: both rolling constraints are integrable (`x - r theta` is constant); an elastic stop exchanges
//! momentum between the wheels. Source: J. Cortes and A. Vinogradov, section 6.4.

dalembert::model! {
    /// Two wheels joined by a rod of variable length (J. Cortes and A. Vinogradov, section 6.4).
    pub TwoWheelsRod {
        coordinates { x1; x2; theta1; theta2; }
        parameters {
            /// Radius of the first wheel.
            r1 > 0 = 1/2;
            /// Radius of the second wheel.
            r2 > 0 = 1;
            /// Shortest length of the rod.
            a > 0 = 1;
            /// Longest length of the rod.
            b > 0 = 3;
        }
        let length = sqrt((r2 - r1)^2 + (x2 - x1)^2);
        lagrangian = 1/2*(dot(x1)^2 + dot(x2)^2 + dot(theta1)^2 + dot(theta2)^2);
        constraints {
            wheel1: d(x1) - r1*d(theta1) = 0;
            wheel2: d(x2) - r2*d(theta2) = 0;
        }
        impacts {
            rod_max: b - length >= 0;
            rod_min: length - a >= 0;
        }
        initial { x2 = 2; dot(theta1) = 1; dot(theta2) = -0.25; until = 20; }
        outputs { rod: length; }
        claims {
            density: exact;
            conserved: energy;
            conserved: dot(theta1);
            conserved under rod_max: energy;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn wheels_do_not_slip_across_impacts() {
        let wheels = TwoWheelsRod::default();
        let state = wheels
            .state(
                0.0,
                &[0.0, 2.0, 0.0, 0.0].into(),
                &[0.5, -0.25, 1.0, -0.25].into(),
            )
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&wheels, stepper, wheels.effects())
            .run(0.0, state, 50.0, &mut ())
            .unwrap();
        assert!(run.counters.impacts > 10);
        assert!((run.state[0] - wheels.r1 * run.state[2]).abs() < 1e-12);
        assert!((run.state[1] - 2.0 - wheels.r2 * run.state[3]).abs() < 1e-12);
    }
}
