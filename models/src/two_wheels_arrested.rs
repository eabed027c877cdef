//! Two wheels on parallel axles, joined by a rod that is arrested when it becomes shortest or longest.
//!
//! Fact: the arrest is the projection on the boundary of the constraints, after which both wheels roll on at the same speed.
//! Source: J. Cortes and A. Vinogradov, section 6.4, the inelastic case.

dalembert::model! {
    /// Two wheels joined by a rod that is arrested at its extreme lengths (J. Cortes and A. Vinogradov, section 6.4).
    pub TwoWheelsArrested {
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
        modes {
            /// The rod slides.
            sliding { initial { x2 = 2; dot(theta1) = 1; dot(theta2) = -0.25; until = 6; } }
            /// Its length is fixed.
            arrested { constraints { rod: d(x2 - x1) = 0; } }
        }
        transitions {
            longest: sliding -> arrested when length >= b;
            shortest: sliding -> arrested when length <= a;
        }
        outputs { rod_length: length; }
        claims { conserved: energy; }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

    #[test]
    fn both_wheels_roll_on_at_one_speed() {
        let wheels = TwoWheelsArrested::default();
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
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
        let qdot = wheels.velocity(50.0, &run.state).unwrap();
        assert!((qdot[0] - qdot[1]).abs() < 1e-15);
        let length = (run.state[1] - run.state[0]).hypot(wheels.r2 - wheels.r1);
        assert!((length - wheels.a).abs() < 1e-13);
    }
}
