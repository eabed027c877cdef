//! Two wheels on parallel axles, joined by a rod that is arrested when it becomes shortest or longest.
//!
//! Fact: the arrest is the projection on the boundary of the constraints, after which both wheels roll on at the same speed.
//! Source: J. Cortes and A. Vinogradov, section 6.4, the inelastic case.

dalembert::model_file!("src/two_wheels_arrested.dal");

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
